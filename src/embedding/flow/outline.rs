//! The analogue in the plane: an outline goes to a circle by its curvature.
//!
//! Conformal curvature flow of a plane curve keeps its lengths, and takes its curvature κ to the mean of it (Crane,
//! Pinkall & Schröder 2013): κ_t = (1 − t) κ + t·2π/length, with t going from 0 to 1. No inner loop is pinched off, as
//! curve-shortening does it. What does not close then is made up for by all edges in proportion to their lengths
//! (Sederberg et al. 1993).
//!
//! An outline that does not turn once around in all has no such path; it becomes a circle at once.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Steps from the outline to the circle.
const STEPS: usize = 16;

/// Edges shorter than this part of the mean length have that length: edges of the circle must have one.
const LEAST_EDGE: f64 = 1e-3;

/// A closed polygon that flows.
pub struct Outline {
    /// The vertices as they follow each other.
    order: Vec<u32>,
    /// Where they were first.
    first: Vec<DVec2>,
    /// Of the edges from each vertex to the next: lengths, directions as they were, continuous, and on the circle,
    lengths: Vec<f64>,
    bent: Vec<f64>,
    round: Vec<f64>,
    /// Is there a path, or the circle only?
    has_path: bool,
    steps: usize,
}

impl Outline {
    /// Of directed edges that have the body on their left; `None` if they are not one polygon. An outline that is
    /// not outer goes around a hole, clockwise.
    pub fn new(edges: &[[u32; 2]], x: &[DVec3], is_outer: bool) -> Option<Self> {
        let mut next = vec![None; x.len()];
        for &[a, b] in edges {
            if next[a as usize].replace(b).is_some() {
                return None;
            }
        }
        let mut order = vec![0];
        loop {
            match next[order[order.len() - 1] as usize]? {
                0 => break,
                _ if order.len() == x.len() => return None,
                v => order.push(v),
            }
        }
        if order.len() < x.len() {
            return None;
        }
        let n = order.len();
        let first: Vec<DVec2> = order.iter().map(|&v| x[v as usize].truncate()).collect();
        let edge = |k: usize| first[(k + 1) % n] - first[k];
        let mut lengths: Vec<f64> = (0..n).map(|k| edge(k).length()).collect();
        let least = LEAST_EDGE * lengths.iter().sum::<f64>() / n as f64;
        // edges without a direction have that of the last that has one
        let has_direction = |k: &usize| lengths[*k] > 0.0;
        let begin = (0..n).rev().find(has_direction)?;
        let (mut bent, mut last) = (vec![0.0; n], begin);
        let mut direction = 0.0;
        for k in 0..n {
            if has_direction(&k) {
                let (a, b) = (edge(last), edge(k));
                direction += f64::atan2(a.perp_dot(b), a.dot(b));
                last = k;
            }
            bent[k] = direction;
        }
        // from the last edge around to the last edge: all of the turns
        let turning = direction;
        let wanted = if is_outer { TAU } else { -TAU };
        lengths.iter_mut().for_each(|l| *l = l.max(least));
        let length: f64 = lengths.iter().sum();
        let mut along = 0.0;
        let round = lengths.iter().map(|l| {
            along += l;
            wanted * (along - 0.5 * l) / length
        });
        Some(Self {
            round: round.collect(),
            has_path: (turning - wanted).abs() < PI,
            order,
            first,
            lengths,
            bent,
            steps: 0,
        })
    }

    /// One step; false if it is a circle already.
    pub fn step(&mut self, x: &mut [DVec3]) -> bool {
        if self.steps == STEPS {
            return false;
        }
        self.steps = if self.has_path { self.steps + 1 } else { STEPS };
        let t = self.steps as f64 / STEPS as f64;
        let length: f64 = self.lengths.iter().sum();
        let radius = length / TAU;
        let edges = (self.lengths.iter().zip(&self.bent).zip(&self.round)).map(|((l, b), r)| {
            // the chord of an arc of this length
            let chord = 2.0 * radius * (0.5 * l / radius).sin();
            let l = (1.0 - t) * l + t * chord;
            l * DVec2::from_angle((1.0 - t) * b + t * r)
        });
        let edges: Vec<DVec2> = edges.collect();
        let gap: DVec2 = edges.iter().sum();
        let mut at = DVec2::ZERO;
        let mut polygon = Vec::with_capacity(edges.len());
        for (edge, l) in edges.iter().zip(&self.lengths) {
            polygon.push(at);
            at += *edge - l / length * gap;
        }
        let (old_length, old) = length_and_centroid(&self.first);
        let (new_length, new) = length_and_centroid(&polygon);
        let scale = old_length / new_length;
        // turned so that it lies on the first outline as well as it can
        let mut fit = DVec2::ZERO;
        for (k, l) in self.lengths.iter().enumerate() {
            let middle = |p: &[DVec2]| 0.5 * (p[k] + p[(k + 1) % p.len()]);
            let (a, b) = (middle(&polygon) - new, middle(&self.first) - old);
            fit += l * DVec2::new(a.dot(b), a.perp_dot(b));
        }
        let turn = fit.try_normalize().unwrap_or(DVec2::X);
        for (&v, p) in self.order.iter().zip(&polygon) {
            let p = old + scale * turn.rotate(*p - new);
            x[v as usize] = p.extend(x[v as usize].z);
        }
        true
    }
}

/// Length, and centroid of its edges.
fn length_and_centroid(polygon: &[DVec2]) -> (f64, DVec2) {
    let (mut length, mut sum) = (0.0, DVec2::ZERO);
    for (k, p) in polygon.iter().enumerate() {
        let q = polygon[(k + 1) % polygon.len()];
        let l = p.distance(q);
        length += l;
        sum += 0.5 * l * (*p + q);
    }
    (length, sum / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polygon through points of a curve, and its edges.
    fn polygon(n: u32, curve: impl Fn(f64) -> DVec2) -> (Vec<[u32; 2]>, Vec<DVec3>) {
        let points = (0..n).map(|k| curve(TAU * f64::from(k) / f64::from(n)).extend(0.0));
        ((0..n).map(|k| [k, (k + 1) % n]).collect(), points.collect())
    }

    fn flat(x: &[DVec3]) -> Vec<DVec2> {
        x.iter().map(|p| p.truncate()).collect()
    }

    fn signed_area(x: &[DVec3]) -> f64 {
        let n = x.len();
        (0..n).map(|k| 0.5 * x[k].cross(x[(k + 1) % n]).z).sum()
    }

    #[test]
    fn an_ellipse_becomes_a_circle_of_its_length() {
        let shift = DVec2::new(5.0, -3.0);
        let ellipse = |a: f64| shift + DVec2::new(3.0 * a.cos(), a.sin());
        let (edges, mut x) = polygon(60, ellipse);
        let mut outline = Outline::new(&edges, &x, true).expect("a polygon");
        let (length, centroid) = length_and_centroid(&flat(&x));
        let mut last = signed_area(&x);
        for k in 0..STEPS {
            let before = x.clone();
            assert!(outline.step(&mut x));
            let (now, centre) = length_and_centroid(&flat(&x));
            assert!((now - length).abs() < 1e-12 * length && centre.distance(centroid) < 1e-12);
            // isoperimetric: the rounder the more
            let area = signed_area(&x);
            assert!(area > last, "{k}: {area} {last}");
            last = area;
            let most = x.iter().zip(&before).map(|(a, b)| a.distance(*b));
            assert!(most.fold(0.0, f64::max) < 0.25);
        }
        assert!(!outline.step(&mut x));
        let radii = x.iter().map(|p| p.truncate().distance(centroid));
        for r in radii {
            assert!((TAU * r / length - 1.0).abs() < 2e-3, "{r}");
        }
        // lengths of arcs are in proportion to those of the ellipse
        let first = outline.first[0].distance(outline.first[1]);
        let ratio = x[0].distance(x[1]) / first;
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }

    #[test]
    fn a_hole_is_clockwise_and_what_is_turned_over_is_turned_back() {
        let circle = |a: f64| DVec2::new(a.cos(), -2.0 * a.sin());
        for (is_outer, steps) in [(false, STEPS), (true, 1)] {
            let (edges, mut x) = polygon(40, circle);
            let mut outline = Outline::new(&edges, &x, is_outer).expect("a polygon");
            let mut taken = 0;
            while outline.step(&mut x) {
                taken += 1;
            }
            assert_eq!(taken, steps);
            assert_eq!(signed_area(&x) > 0.0, is_outer);
        }
    }

    #[test]
    fn branches_and_several_loops_are_no_outline() {
        let x = [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::ONE,
            DVec3::NEG_X,
            DVec3::NEG_Y,
        ];
        let two = [[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3]];
        assert!(Outline::new(&two[..3], &x[..3], true).is_some());
        assert!(Outline::new(&two, &x, true).is_none());
        let branch = [[0, 1], [1, 2], [2, 0], [0, 3], [3, 4], [4, 0]];
        assert!(Outline::new(&branch, &x[..5], true).is_none());
        assert!(
            Outline::new(&two[..3], &[DVec3::ZERO; 3], true).is_none(),
            "a point"
        );
    }

    #[test]
    fn edges_without_length_get_one() {
        let corner = |a: f64| DVec2::new((a.cos()).clamp(-0.5, 0.5), a.sin().clamp(-0.5, 0.5));
        let (edges, mut x) = polygon(80, corner);
        assert!(x.windows(2).any(|w| w[0] == w[1]));
        let mut outline = Outline::new(&edges, &x, true).expect("a polygon");
        while outline.step(&mut x) {}
        assert!((0..80).all(|k| x[k] != x[(k + 1) % 80]));
        assert!(signed_area(&x) > 0.0);
    }
}
