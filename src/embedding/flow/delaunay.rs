//! Weights of the Laplacian of a surface that are not negative, whatever its triangles are like.
//!
//! Cotangent weights are negative at edges that are not Delaunay, and then a vertex can leave the hull of its neighbours.
//! Edges are flipped inside of the surface, which stays what it is, until all are Delaunay (Bobenko & Springborn 2007;
//! Fisher et al. 2006): the triangulation is described by its lengths alone.

use glam::DVec3;

/// Bound of cotangents: triangles flatter than that have the weights of one that is as flat.
const MOST_COTANGENT: f64 = 1e4;

/// Sums of cotangents that are as good as 0.
const FLAT: f64 = 1e-9;

/// Flips a half-edge after which it ends in any case.
const MOST_FLIPS: usize = 20;

const NONE: u32 = u32::MAX;

/// The edges of the intrinsic Delaunay triangulation, each once, and (cot α + cot β)/2 of each. What rounding, flat
/// triangles or more than two triangles at an edge leave negative is 0.
pub fn delaunay_weights(triangles: &[[u32; 3]], x: &[DVec3]) -> (Vec<[u32; 2]>, Vec<f64>) {
    let mut surface = Intrinsic::new(triangles, x);
    surface.flip_all();
    let half = |h: u32| {
        let (a, b) = (surface.origin(h), surface.origin(next(h)));
        ([a.min(b), a.max(b)], 0.5 * surface.cotangent(h))
    };
    let mut halves: Vec<([u32; 2], f64)> = (0..surface.halves.len() as u32).map(half).collect();
    // loops weigh nothing
    halves.retain(|([a, b], _)| a != b);
    // by value too: the sum does not depend on the order of the triangles
    halves.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let same = halves.chunk_by(|a, b| a.0 == b.0);
    same.map(|same| {
        let weight: f64 = same.iter().map(|half| half.1).sum();
        (same[0].0, weight.max(0.0))
    })
    .unzip()
}

/// The half-edge behind this one in its triangle; half-edges 3t, 3t + 1 and 3t + 2 are those of triangle t.
fn next(h: u32) -> u32 {
    h / 3 * 3 + (h + 1) % 3
}

#[derive(Clone, Copy)]
struct Half {
    origin: u32,
    length: f64,
    /// The same edge in the triangle beside it, if there is exactly one.
    twin: u32,
}

struct Intrinsic {
    halves: Vec<Half>,
}

impl Intrinsic {
    fn new(triangles: &[[u32; 3]], x: &[DVec3]) -> Self {
        let mut halves = Vec::with_capacity(3 * triangles.len());
        let mut ends = Vec::with_capacity(3 * triangles.len());
        for t in triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                ends.push(([a.min(b), a.max(b)], halves.len() as u32));
                halves.push(Half {
                    origin: a,
                    length: x[a as usize].distance(x[b as usize]),
                    twin: NONE,
                });
            }
        }
        ends.sort_unstable();
        for same in ends.chunk_by(|a, b| a.0 == b.0) {
            if let [(_, g), (_, h)] = *same
                && halves[g as usize].origin != halves[h as usize].origin
            {
                halves[g as usize].twin = h;
                halves[h as usize].twin = g;
            }
        }
        Self { halves }
    }

    fn origin(&self, h: u32) -> u32 {
        self.halves[h as usize].origin
    }

    fn twin(&self, h: u32) -> u32 {
        self.halves[h as usize].twin
    }

    /// Of this edge and the two behind it.
    fn lengths(&self, h: u32) -> [f64; 3] {
        [h, next(h), next(next(h))].map(|h| self.halves[h as usize].length)
    }

    /// Of the angle opposite to this edge; a triangle on one point is as good as any, and taken for an equilateral one, so
    /// that it can open.
    fn cotangent(&self, h: u32) -> f64 {
        let [a, b, c] = self.lengths(h);
        let longest = a.max(b).max(c).powi(2);
        if !(longest > 0.0) {
            return 1.0 / 3f64.sqrt();
        }
        // b² − a² without the loss of two squares
        let twice_dot = (b - a) * (b + a) + c * c;
        twice_dot / (4.0 * area([a, b, c])).max(2.0 * longest / MOST_COTANGENT)
    }

    fn flip_all(&mut self) {
        let mut open: Vec<u32> = (0..self.halves.len() as u32).rev().collect();
        let mut left = MOST_FLIPS * self.halves.len();
        while let Some(h) = open.pop() {
            let g = self.twin(h);
            let is_flat = g != NONE
                && g / 3 != h / 3
                && self.halves[h as usize].length > 0.0
                && self.cotangent(h) + self.cotangent(g) < -FLAT;
            if is_flat && left > 0 {
                left -= 1;
                self.flip(h);
                let around = [h, g].map(|h| [h / 3 * 3 + 1, h / 3 * 3 + 2]);
                open.extend(around.as_flattened());
            }
        }
    }

    /// Replaces the edge by the other diagonal of its two triangles.
    fn flip(&mut self, h: u32) {
        let g = self.twin(h);
        // h goes from i to j with k beside it, its twin has m beside it: i, m, j, k are the quadrilateral
        let (jk, im) = (next(h), next(g));
        let (ki, mj) = (next(jk), next(im));
        let (first, second) = (h / 3 * 3, g / 3 * 3);
        let (k, m) = (self.origin(ki), self.origin(mj));
        let length = self.diagonal(h, g);
        let moved = [
            (ki, first + 1),
            (im, first + 2),
            (mj, second + 1),
            (jk, second + 2),
        ];
        let to = |h: u32| moved.iter().find(|m| m.0 == h).map_or(h, |m| m.1);
        let new = moved.map(|(from, place)| {
            let half = self.halves[from as usize];
            let twin = match half.twin {
                NONE => NONE,
                twin => to(twin),
            };
            (place, Half { twin, ..half })
        });
        for (place, half) in new {
            self.halves[place as usize] = half;
            if half.twin != NONE {
                self.halves[half.twin as usize].twin = place;
            }
        }
        for (place, origin, twin) in [(first, m, second), (second, k, first)] {
            self.halves[place as usize] = Half {
                origin,
                length,
                twin,
            };
        }
    }

    /// The distance of the corners opposite to an edge when its triangles lie in one plane.
    fn diagonal(&self, h: u32, g: u32) -> f64 {
        // of both triangles: the opposite corner along the edge from the origin of h, and beside it
        let [l, jk, ki] = self.lengths(h);
        let [_, im, mj] = self.lengths(g);
        let along = |from: f64, to: f64| 0.5 * (l + (from - to) * (from + to) / l);
        let beside = |h: u32| 2.0 * area(self.lengths(h)) / l;
        f64::hypot(along(ki, jk) - along(im, mj), beside(h) + beside(g))
    }
}

/// Area of a triangle by its lengths (Kahan 1986); 0 if there is none.
fn area(lengths: [f64; 3]) -> f64 {
    let mut sorted = lengths;
    sorted.sort_unstable_by(f64::total_cmp);
    let [c, b, a] = sorted;
    let square = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    0.25 * square.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{Shape, generate};

    #[test]
    fn a_flat_pair_is_flipped_and_weighs_as_its_other_diagonal() {
        // two triangles back to back twice: a kite with its long diagonal, closed
        let x =
            [[-2.0, 0.0], [2.0, 0.0], [0.0, 1.0], [0.0, -1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let long = [[0, 1, 2], [1, 0, 3], [0, 2, 3], [1, 3, 2]];
        let (edges, weights) = delaunay_weights(&long, &x);
        let weight = |a: u32, b: u32| match edges.iter().position(|&e| e == [a, b]) {
            Some(place) => weights[place],
            None => 0.0,
        };
        // all four triangles have the short diagonal now: legs 1 and 2, hypotenuse √5
        assert!(weight(0, 1) < 1e-9, "{edges:?} {weights:?}");
        let apex = 2.0 * f64::atan(0.5);
        let base = f64::atan(2.0);
        assert!(
            (weight(2, 3) - 2.0 / apex.tan()).abs() < 1e-12,
            "{weights:?}"
        );
        for (a, b) in [(0, 2), (0, 3), (1, 2), (1, 3)] {
            assert!(
                (weight(a, b) - 1.0 / base.tan()).abs() < 1e-12,
                "{weights:?}"
            );
        }
    }

    #[test]
    fn all_edges_of_a_stretched_sphere_become_delaunay_and_its_area_stays() {
        // a stretched sphere has many edges that are not Delaunay
        let mut sphere = generate(Shape::Sphere, 1500);
        sphere
            .positions
            .iter_mut()
            .for_each(|p| *p *= DVec3::new(5.0, 1.0, 0.3));
        let mut surface = Intrinsic::new(&sphere.simplices, &sphere.positions);
        let whole = |surface: &Intrinsic| -> f64 {
            let each = (0..surface.halves.len() as u32).step_by(3);
            each.map(|h| area(surface.lengths(h))).sum()
        };
        let all = 0..surface.halves.len() as u32;
        let sums = |surface: &Intrinsic| {
            let sum = |h: u32| surface.cotangent(h) + surface.cotangent(surface.twin(h));
            all.clone().map(sum).fold(f64::MAX, f64::min)
        };
        let before = whole(&surface);
        assert!(sums(&surface) < -1.0);
        surface.flip_all();
        assert!(sums(&surface) >= -2.0 * FLAT, "{}", sums(&surface));
        assert!((whole(&surface) - before).abs() < 1e-10 * before);
        for h in all.clone() {
            let g = surface.twin(h);
            assert_eq!(surface.twin(g), h);
            assert_eq!(surface.origin(g), surface.origin(next(h)));
        }
    }

    #[test]
    fn flat_triangles_have_bounded_weights() {
        let x = [[0.0, 0.0], [1.0, 0.0], [0.5, 1e-9], [0.5, -1e-9]];
        let x = x.map(|[a, b]| DVec3::new(a, b, 0.0));
        // also a triangle that is an edge, and an edge of three triangles
        let (_, weights) = delaunay_weights(&[[0, 1, 2], [1, 0, 3], [0, 2, 2], [0, 1, 3]], &x);
        let most = 4.0 * MOST_COTANGENT;
        assert!(
            weights.iter().all(|w| (0.0..=most).contains(w)),
            "{weights:?}"
        );
    }
}
