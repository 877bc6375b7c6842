//! Continuous collision detection of one pair of primitives that move linearly: conservative, never misses.
//!
//! It is additive (Li, Kaufman & Jiang 2021, *Codimensional incremental potential contact*, algorithm 1): time
//! advances by steps in which the pair cannot meet, until it is over or the pair is close. How long a step may be
//! does not follow from the lengths of the displacements, though, but from a plane between the two: along a fixed
//! normal the separation of two convex hulls whose corners move linearly is a concave function, piecewise linear in
//! time, so that its root is known. Pairs that slide along each other take one step where displacements would ask for
//! thousands, and no step is shorter than by displacements.
//!
//! Any unit vector whatever would do as the normal: a bad one makes steps short, never wrong. So parallel edges,
//! motion in one plane, edges and faces without extent need no cases.

use super::separation::{Four, separate};
use super::vector::{add_scaled, dot, sub};

/// What can meet first when two boundaries meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pair {
    /// Of a vertex (the first point) and a face (the others). In the plane: of a vertex and an edge, whose second end
    /// is given twice.
    VertexFace,
    /// Of two edges in space, of two points each.
    EdgeEdge,
}

/// How two primitives meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact<const D: usize> {
    /// When, or before.
    pub time: f64,
    /// The unit normal along which they are apart until then, from the second to the first; 0 if there is none.
    pub normal: [f64; D],
}

/// Most steps. What needs more counts as meeting at the time that was reached.
const MOST_STEPS: usize = 128;

/// Rounding errors of a separation, relative to the largest difference of coordinates: there are fewer than 16
/// operations between a separation and the coordinates, each off by 2⁻⁵³ at most, in each of three components.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A pair meets when it is closer than at the start by this factor, unless that is more than `gap`.
const CLOSER: f64 = 0.1;

/// When do they meet that move from `start` to `end` between the times 0 and 1? `None`: not at all, proven. `Some(t)`:
/// at t or later, or no more than come close: nearer than `gap` and a tenth of the distance they had at the start (what
/// comes nearer than half of that is always told).
/// With `gap` = 0 only what is nearer than rounding can tell (64 · 2⁻⁵² of the largest difference of coordinates)
/// counts as meeting; with infinity it is algorithm 1 of the paper with s = 0.1.
///
/// Touching at the start is `Some(0.0)`, and so is anything that is not finite.
pub fn time_of_impact<const D: usize>(
    pair: Pair,
    start: &Four<D>,
    end: &Four<D>,
    gap: f64,
) -> Option<f64> {
    impact(pair, start, end, gap).map(|impact| impact.time)
}

/// The same with the normal.
pub fn impact<const D: usize>(
    pair: Pair,
    start: &Four<D>,
    end: &Four<D>,
    gap: f64,
) -> Option<Impact<D>> {
    match pair {
        Pair::VertexFace => advance::<D, 1>(start, end, gap),
        Pair::EdgeEdge => advance::<D, 2>(start, end, gap),
    }
}

fn advance<const D: usize, const SPLIT: usize>(
    start: &Four<D>,
    end: &Four<D>,
    gap: f64,
) -> Option<Impact<D>> {
    // seen from one of the points, so that what is far from the origin keeps its precision
    let origin = start[0];
    let from = start.map(|p| sub(p, origin));
    let to = end.map(|p| sub(p, origin));
    let velocity: Four<D> = std::array::from_fn(|i| sub(to[i], from[i]));
    let coordinates = from.iter().chain(&to).flatten();
    let mut size = 0.0f64;
    for x in coordinates {
        if !x.is_finite() {
            let normal = [0.0; D];
            return Some(Impact { time: 0.0, normal });
        }
        size = size.max(x.abs());
    }
    let rounding = ROUNDING * size;
    let mut close = 2.0 * rounding;
    let (mut time, mut normal) = (0.0, [0.0; D]);
    for step in 0..MOST_STEPS {
        let now: Four<D> = std::array::from_fn(|i| add_scaled(from[i], time, velocity[i]));
        let separation = separate::<D, SPLIT>(&now);
        normal = separation.normal;
        if step == 0 {
            close = close.max(gap.min(CLOSER * separation.width));
        }
        if !(separation.width > close) {
            return Some(Impact { time, normal });
        }
        // until one of the differences of corners has only this much of the separation left
        let left = 0.5 * close;
        let mut wait = f64::INFINITY;
        for i in 0..SPLIT {
            for j in SPLIT..4 {
                let approach = -dot(normal, sub(velocity[i], velocity[j]));
                if approach > 0.0 {
                    wait = wait.min((dot(normal, sub(now[i], now[j])) - left) / approach);
                }
            }
        }
        time += wait;
        if time >= 1.0 {
            return None;
        }
    }
    Some(Impact { time, normal })
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACE: [[f64; 3]; 3] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn with_face(p: [f64; 3]) -> Four<3> {
        [p, FACE[0], FACE[1], FACE[2]]
    }

    #[test]
    fn a_falling_vertex_meets_the_face() {
        let start = with_face([0.25, 0.25, 1.0]);
        for (z, expected) in [(-1.0, Some(0.5)), (0.0, Some(1.0)), (1e-6, None)] {
            let end = with_face([0.3, 0.2, z]);
            let t = time_of_impact(Pair::VertexFace, &start, &end, 0.0);
            assert_eq!(t.is_some(), expected.is_some(), "{z}");
            if let (Some(t), Some(e)) = (t, expected) {
                assert!(t <= e && t > e - 1e-9, "{t} {e}");
            }
        }
        // algorithm 1 as printed stops at a tenth of the distance
        let end = with_face([0.25, 0.25, 0.02]);
        assert!(time_of_impact(Pair::VertexFace, &start, &end, f64::INFINITY).is_some());
        assert!(time_of_impact(Pair::VertexFace, &start, &end, 1e-3).is_none());
    }

    #[test]
    fn what_touches_or_is_not_finite_meets_at_once() {
        let start = with_face([0.25, 0.25, 0.0]);
        let end = with_face([0.25, 0.25, 1.0]);
        assert_eq!(
            time_of_impact(Pair::VertexFace, &start, &end, 0.0),
            Some(0.0)
        );
        assert_eq!(
            time_of_impact(Pair::VertexFace, &[[0.0; 3]; 4], &[[0.0; 3]; 4], 0.0),
            Some(0.0)
        );
        let bad = with_face([f64::NAN, 0.0, 1.0]);
        assert_eq!(time_of_impact(Pair::VertexFace, &bad, &end, 0.0), Some(0.0));
    }

    #[test]
    fn sliding_takes_one_step() {
        // 1e-5 above, over a thousand lengths; by displacements that would be 1e8 steps
        let start = with_face([-500.0, 0.2, 1e-5]);
        let end = with_face([500.0, 0.2, 1e-5]);
        assert_eq!(time_of_impact(Pair::VertexFace, &start, &end, 1e-6), None);
        let edges = |x: f64, z: f64| [[x, 0.0, z], [x + 1.0, 0.0, z], [0.0; 3], [1.0, 0.0, 0.0]];
        // parallel edges, along each other and onto each other
        let (here, there) = (edges(0.0, 1e-5), edges(300.0, 1e-5));
        assert_eq!(time_of_impact(Pair::EdgeEdge, &here, &there, 1e-6), None);
        let t = time_of_impact(Pair::EdgeEdge, &edges(0.0, 1.0), &edges(0.0, -1.0), 0.0);
        assert!(t.is_some_and(|t| t <= 0.5 && t > 0.5 - 1e-9), "{t:?}");
        // in line, end to end
        let t = time_of_impact(Pair::EdgeEdge, &edges(3.0, 0.0), &edges(-3.0, 0.0), 0.0);
        assert!(t.is_some_and(|t| t <= 1.0 / 3.0 && t > 0.33), "{t:?}");
    }

    #[test]
    fn in_the_plane_a_vertex_meets_an_edge() {
        let four = |p: [f64; 2]| [p, [-1.0, 0.0], [1.0, 0.0], [1.0, 0.0]];
        let hit = time_of_impact(Pair::VertexFace, &four([0.0, 1.0]), &four([0.0, -3.0]), 0.0);
        assert!(hit.is_some_and(|t| t <= 0.25 && t > 0.25 - 1e-9), "{hit:?}");
        let beside = time_of_impact(Pair::VertexFace, &four([2.0, 1.0]), &four([2.0, -3.0]), 0.0);
        assert_eq!(beside, None);
        let along = time_of_impact(Pair::VertexFace, &four([2.0, 0.0]), &four([0.0, 0.0]), 0.0);
        assert!(
            along.is_some_and(|t| t <= 0.5 && t > 0.5 - 1e-9),
            "{along:?}"
        );
    }
}
