//! Gaps between a vertex and a facet of the boundary (§6), and when pairs are opposite to each other.
//!
//! The corners are the vertex and those of the facet: a face, counter-clockwise seen from outside, or, in the plane, an
//! edge with the body on its left. c = nᵀ(xᵢ − xⱼ), n the outward unit normal, is the same for every point xⱼ of the
//! facet's plane; with xⱼ the foot of the perpendicular its gradient is (n, −βₖ n), β the barycentric coordinates of
//! the foot. Outside the facet, where β would be a longer and longer lever, it is that of the foot moved onto it.

use super::simplex::Corners;
use crate::collision::Pair;
use crate::collision::vector::{dot, normal, sub, unit};

/// The outward unit normal, if the facet has one.
#[inline]
fn outward<const D: usize>(p: &Corners<D>) -> Option<[f64; D]> {
    unit(normal(sub(p[2], p[1]), sub(p[3], p[1])))
}

/// c: positive outside; infinite over a facet without extent, which has no outside.
#[inline]
pub fn gap<const D: usize>(p: &Corners<D>) -> f64 {
    outward(p).map_or(f64::INFINITY, |n| dot(n, sub(p[0], p[1])))
}

/// Barycentric coordinates of the foot of the perpendicular; in the plane the third is 0.
#[inline]
fn foot<const D: usize>(p: &Corners<D>) -> [f64; 3] {
    let (e, w) = (sub(p[2], p[1]), sub(p[0], p[1]));
    if D == 2 {
        let t = dot(w, e) / dot(e, e);
        return [1.0 - t, t, 0.0];
    }
    let f = sub(p[3], p[1]);
    let n = normal(e, f);
    let square = dot(n, n);
    let second = dot(n, normal(w, f)) / square;
    let third = dot(n, normal(e, w)) / square;
    [1.0 - second - third, second, third]
}

/// ∇c, 0 over a facet without extent.
#[inline]
pub fn gap_gradient<const D: usize>(p: &Corners<D>) -> [[f64; D]; 4] {
    let Some(n) = outward(p) else {
        return [[0.0; D]; 4];
    };
    let on_facet = foot(p).map(|b| b.clamp(0.0, 1.0));
    let sum: f64 = on_facet.iter().sum();
    let [a, b, c] = on_facet.map(|b| n.map(|n| -b / sum * n));
    [n, a, b, c]
}

/// Is the foot on the facet?
pub fn is_above<const D: usize>(p: &Corners<D>) -> bool {
    foot(p).iter().all(|&b| b >= 0.0)
}

/// Barycentric coordinates of the nearest points of a vertex and a facet, or of two edges, the second one's negative:
/// the points' difference is the sum of the corners with these weights.
pub fn weights<const D: usize>(pair: Pair, p: &Corners<D>) -> [f64; 4] {
    match pair {
        Pair::VertexFace if D == 3 && is_above(p) => {
            let [a, b, c] = foot(p);
            [1.0, -a, -b, -c]
        }
        Pair::VertexFace => {
            let sides = [(1, 2), (2, 3), (3, 1)].map(|(i, j)| {
                let mut w = [1.0, 0.0, 0.0, 0.0];
                let t = along(p[0], p[i], p[j]);
                w[i] -= 1.0 - t;
                w[j] -= t;
                w
            });
            nearest(p, sides.into_iter())
        }
        Pair::EdgeEdge => {
            let ends = [
                (0, 2, 3, 1.0),
                (1, 2, 3, 1.0),
                (2, 0, 1, -1.0),
                (3, 0, 1, -1.0),
            ];
            let ends = ends.map(|(v, i, j, sign)| {
                let mut w = [0.0; 4];
                let t = along(p[v], p[i], p[j]);
                (w[v], w[i], w[j]) = (sign, sign * (t - 1.0), -sign * t);
                w
            });
            let (e, f, c) = (sub(p[1], p[0]), sub(p[3], p[2]), sub(p[2], p[0]));
            let n = normal(e, f);
            let square = dot(n, n);
            let (s, u) = (dot(n, normal(c, f)) / square, dot(n, normal(c, e)) / square);
            let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&u);
            let across = inside.then_some([1.0 - s, s, u - 1.0, -u]);
            nearest(p, across.into_iter().chain(ends))
        }
    }
}

/// The weights with the shortest difference.
fn nearest<const D: usize>(p: &Corners<D>, all: impl Iterator<Item = [f64; 4]>) -> [f64; 4] {
    let square = |w: &[f64; 4]| {
        let difference: [f64; D] = std::array::from_fn(|i| (0..4).map(|k| w[k] * p[k][i]).sum());
        dot(difference, difference)
    };
    all.min_by(|a, b| square(a).total_cmp(&square(b)))
        .unwrap_or([0.0; 4])
}

/// Where on the segment a–b the point nearest to p is, from 0 to 1.
fn along<const D: usize>(p: [f64; D], a: [f64; D], b: [f64; D]) -> f64 {
    let e = sub(b, a);
    let t = dot(sub(p, a), e) / dot(e, e);
    // NaN: a segment without length
    if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) }
}

/// Are the nearest points of the lines of two edges on the edges?
pub fn is_across<const D: usize>(p: &Corners<D>) -> bool {
    let (e, f, w) = (sub(p[1], p[0]), sub(p[3], p[2]), sub(p[2], p[0]));
    let n = normal(e, f);
    let square = dot(n, n);
    // of parallel edges no points are the nearest
    let range = 0.0..=square;
    square > 0.0 && range.contains(&dot(n, normal(w, f))) && range.contains(&dot(n, normal(w, e)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Central differences of the gap.
    fn difference<const D: usize>(p: &Corners<D>, v: usize, i: usize) -> f64 {
        let h = 1e-6;
        let (mut more, mut less) = (*p, *p);
        more[v][i] += h;
        less[v][i] -= h;
        (gap(&more) - gap(&less)) / (2.0 * h)
    }

    #[test]
    fn gradients_are_those_of_the_gap() {
        let space = [
            [0.5, 0.3, 0.4],
            [0.1, -0.1, 0.2],
            [1.3, 0.2, -0.1],
            [0.2, 1.1, 0.3],
        ];
        assert!(is_above(&space) && gap(&space) > 0.0);
        let plane = [[0.4, -0.7], [-0.5, 0.1], [1.2, 0.3], [1.2, 0.3]];
        assert!(is_above(&plane) && gap(&plane) > 0.0);
        let (in_space, in_plane) = (gap_gradient(&space), gap_gradient(&plane));
        for v in 0..4 {
            for i in 0..3 {
                let d = difference(&space, v, i);
                assert!((in_space[v][i] - d).abs() < 1e-8, "{v} {i} {d}");
            }
        }
        // the second end of an edge is given twice
        let mut both = plane;
        for i in 0..2 {
            both[2][i] += 1e-6;
            both[3][i] += 1e-6;
            let d = (gap(&both) - gap(&plane)) / 1e-6;
            let g = in_plane[2][i] + in_plane[3][i];
            assert!((g - d).abs() < 1e-5, "{i} {g} {d}");
            both = plane;
        }
        for (v, i) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            assert!((in_plane[v][i] - difference(&plane, v, i)).abs() < 1e-8);
        }
    }

    #[test]
    fn facets_without_extent_ask_for_nothing() {
        let p = [[0.0, 0.0, 1.0], [0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        assert_eq!(gap(&p), f64::INFINITY);
        assert_eq!(gap_gradient(&p), [[0.0; 3]; 4]);
        assert!(!is_above(&p));
    }

    #[test]
    fn edges_are_across_where_their_nearest_points_are() {
        let edges = |x: f64| {
            [
                [-1.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [x, -1.0, 0.5],
                [x, 1.0, 0.5],
            ]
        };
        assert!(is_across(&edges(0.3)) && is_across(&edges(1.0)));
        assert!(!is_across(&edges(1.1)) && !is_across(&edges(-1.1)));
        let parallel = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert!(!is_across(&parallel));
    }
}
