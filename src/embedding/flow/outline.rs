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
