//! A plane (in the plane: a line) between two small convex sets, as far from both as there is one.

use super::vector::{add_scaled, dot, normal, sub, unit};

/// Four points: the convex hull of the first `SPLIT` and that of the others are looked at.
pub type Four<const D: usize> = [[f64; D]; 4];

/// A unit normal, and by how much it separates the first hull from the second.
#[derive(Clone, Copy)]
pub struct Separation<const D: usize> {
    pub normal: [f64; D],
    /// The least of nᵀ(a − b) over both hulls; at most their distance, and their distance if n is right.
    pub width: f64,
}

impl<const D: usize> Separation<D> {
    /// Takes this direction, or its opposite, if it separates better.
    #[inline(always)]
    fn offer<const SPLIT: usize>(&mut self, direction: [f64; D], p: &Four<D>) {
        let Some(n) = unit(direction) else { return };
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for a in &p[..SPLIT] {
            for b in &p[SPLIT..] {
                let width = dot(n, sub(*a, *b));
                (least, most) = (least.min(width), most.max(width));
            }
        }
        if least > self.width {
            (self.normal, self.width) = (n, least);
        }
        if -most > self.width {
            (self.normal, self.width) = (n.map(|x| -x), -most);
        }
    }
}

/// From the point of the segment a–b that is nearest to p, to p.
#[inline(always)]
fn from_segment<const D: usize>(p: [f64; D], a: [f64; D], b: [f64; D]) -> [f64; D] {
    let (e, w) = (sub(b, a), sub(p, a));
    let square = dot(e, e);
    let along = dot(w, e);
    if !(along > 0.0) {
        return w;
    }
    if along >= square {
        return sub(p, b);
    }
    // once more, so that it is perpendicular to e even where it is much shorter than w
    let w = add_scaled(w, -along / square, e);
    add_scaled(w, -dot(w, e) / square, e)
}

/// The widest separation that a normal of nearest features gives: of a point and a triangle (SPLIT = 1; a triangle
/// with a corner twice is a segment) or of two segments (SPLIT = 2). Which of the features are the nearest is not
/// asked: each of the few normals that can be the right one is tried.
#[inline(always)]
pub fn separate<const D: usize, const SPLIT: usize>(p: &Four<D>) -> Separation<D> {
    let mut best = Separation {
        normal: [0.0; D],
        width: f64::NEG_INFINITY,
    };
    if SPLIT == 1 {
        let (e, f) = (sub(p[2], p[1]), sub(p[3], p[1]));
        best.offer::<SPLIT>(normal(e, f), p);
        for (i, j) in [(1, 2), (2, 3), (3, 1)] {
            // in the plane the third point is the second once more
            if D == 3 || i == 1 {
                best.offer::<SPLIT>(from_segment(p[0], p[i], p[j]), p);
            }
        }
    } else {
        best.offer::<SPLIT>(normal(sub(p[1], p[0]), sub(p[3], p[2])), p);
        for (point, i, j) in [(0, 2, 3), (1, 2, 3), (2, 0, 1), (3, 0, 1)] {
            best.offer::<SPLIT>(from_segment(p[point], p[i], p[j]), p);
        }
    }
    best
}
