//! Does the boundary meet itself right beside a vertex? Decided exactly.
//!
//! As seen from a vertex of the boundary, the boundary faces around it are arcs on the sphere of
//! directions, which form closed loops: the boundary of the vertex's link. Arcs of one loop that do not
//! follow each other must not meet. (Two that do meet beyond their common end only if the fan of
//! tetrahedra between them closes up, which is for `winding` to find.)
//!
//! Broad phase: a binary tree of boxes over the arcs in the order of the loop, so that what is close in
//! the tree is close on the sphere. The boxes are made in floating point, and larger than the arcs by far
//! more than rounding.

use super::super::distortion::normalizing;
use super::arcs;
use glam::DVec3;

/// What boxes are larger by than the arcs in them, on the unit sphere.
const MARGIN: f64 = 1e-9;

/// The boundary vertices, in ascending order, beside which the boundary meets itself. `boundary` are its
/// faces, `skip` the vertices not to look at: a boundary vertex that is not among them has one fan of
/// tetrahedra at every edge.
pub(super) fn overwound(
    boundary: &[[u32; 3]],
    skip: impl Fn(u32) -> bool,
    positions: &[DVec3],
) -> Vec<u32> {
    let mut arcs = Vec::with_capacity(3 * boundary.len());
    for &[a, b, c] in boundary {
        arcs.extend([(a, b, c), (b, c, a), (c, a, b)]);
    }
    arcs.sort_unstable();
    let mut search = Search::default();
    let mut found = Vec::new();
    for star in arcs.chunk_by(|a, b| a.0 == b.0) {
        let vertex = star[0].0;
        if star.len() > 3 && !skip(vertex) && search.meets_itself(star, positions) {
            found.push(vertex);
        }
    }
    found
}

#[derive(Clone, Copy)]
struct Box3 {
    low: DVec3,
    high: DVec3,
}

impl Box3 {
    const ALL: Self = Self {
        low: DVec3::NEG_INFINITY,
        high: DVec3::INFINITY,
    };

    /// Around the arc between two unit vectors: the ball over its chord contains it.
    fn of_arc(a: DVec3, b: DVec3) -> Self {
        let centre = 0.5 * (a + b);
        let radius = DVec3::splat(0.5 * (a - b).length() + MARGIN);
        if !(centre.is_finite() && radius.is_finite()) {
            return Self::ALL;
        }
        Self {
            low: centre - radius,
            high: centre + radius,
        }
    }
    fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
    fn overlaps(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

/// A range of arcs and its node in the tree.
type Range = (usize, usize, usize);

fn halves((node, start, end): Range) -> [Range; 2] {
    let middle = start + (end - start) / 2;
    [(2 * node, start, middle), (2 * node + 1, middle, end)]
}

/// One loop, with room that is used again for the next.
#[derive(Default)]
struct Search {
    vertex: DVec3,
    /// The vertices of the loop.
    points: Vec<DVec3>,
    directions: Vec<DVec3>,
    boxes: Vec<Box3>,
    seen: Vec<bool>,
}

impl Search {
    /// Does a loop of arcs (v, from, to) around one vertex, sorted, meet itself?
    fn meets_itself(&mut self, star: &[(u32, u32, u32)], positions: &[DVec3]) -> bool {
        self.vertex = positions[star[0].0 as usize];
        self.seen.clear();
        self.seen.resize(star.len(), false);
        for first in 0..star.len() {
            self.points.clear();
            let mut next = Some(first);
            while let Some(i) = next.filter(|&i| !self.seen[i]) {
                self.seen[i] = true;
                self.points.push(positions[star[i].1 as usize]);
                next = star.binary_search_by_key(&star[i].2, |arc| arc.1).ok();
            }
            if self.points.len() > 3 && self.loop_meets_itself() {
                return true;
            }
        }
        false
    }

    fn loop_meets_itself(&mut self) -> bool {
        let vertex = self.vertex;
        self.directions.clear();
        self.directions.extend(self.points.iter().map(|&p| {
            let edge = p - vertex;
            (edge * normalizing(edge.abs().max_element())).normalize()
        }));
        let n = self.points.len();
        self.boxes.clear();
        self.boxes.resize(2 * n.next_power_of_two(), Box3::ALL);
        let all = (1, 0, n);
        self.build(all);
        self.within(all)
    }

    fn build(&mut self, range: Range) -> Box3 {
        let (node, start, end) = range;
        let bounds = if end - start == 1 {
            let next = (start + 1) % self.directions.len();
            Box3::of_arc(self.directions[start], self.directions[next])
        } else {
            let [lower, upper] = halves(range);
            self.build(lower).union(self.build(upper))
        };
        self.boxes[node] = bounds;
        bounds
    }

    /// Pairs inside one range.
    fn within(&self, range: Range) -> bool {
        let (_, start, end) = range;
        if end - start < 3 {
            return false;
        }
        let [lower, upper] = halves(range);
        self.within(lower) || self.within(upper) || self.between(lower, upper)
    }

    /// Pairs with one arc in each of two ranges, the first before the second.
    fn between(&self, a: Range, b: Range) -> bool {
        if !self.boxes[a.0].overlaps(&self.boxes[b.0]) {
            return false;
        }
        let (na, nb) = (a.2 - a.1, b.2 - b.1);
        if na == 1 && nb == 1 {
            return self.arcs_meet(a.1, b.1);
        }
        if na > nb {
            halves(a).into_iter().any(|half| self.between(half, b))
        } else {
            halves(b).into_iter().any(|half| self.between(a, half))
        }
    }

    fn arcs_meet(&self, i: usize, j: usize) -> bool {
        let n = self.points.len();
        let follow = |i: usize, j: usize| (i + 1) % n == j;
        let arc = |i: usize| [self.points[i], self.points[(i + 1) % n]];
        !follow(i, j) && !follow(j, i) && arcs::meet(self.vertex, arc(i), arc(j))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn tree_and_brute_force(points: Vec<DVec3>) -> [bool; 2] {
        let n = points.len();
        let mut search = Search {
            vertex: DVec3::new(0.5, -2.0, 0.25),
            points,
            ..Default::default()
        };
        let tree = search.loop_meets_itself();
        let pairs = (0..n).any(|i| (0..i).any(|j| search.arcs_meet(j, i)));
        [tree, pairs]
    }

    proptest! {
        #[test]
        fn the_tree_misses_nothing(
            v in prop::collection::vec((-3i32..=3, -3i32..=3, -3i32..=3), 4..9), jitter in 0.0f64..0.5,
        ) {
            // Points on a lattice around a point beside it: many meet, some do not.
            let points = v.iter().map(|&(x, y, z)| {
                let p = DVec3::new(f64::from(x), f64::from(y), f64::from(z));
                p * (1.0 + jitter) + DVec3::splat(0.125)
            });
            let [tree, pairs] = tree_and_brute_force(points.collect());
            prop_assert_eq!(tree, pairs);
        }

        #[test]
        fn star_shaped_loops_do_not_meet_themselves(
            radii in prop::collection::vec(1.0f64..3.0, 4..200), swap: bool,
        ) {
            let n = radii.len();
            let swap = swap && n > 7;
            let radius = |i: usize| if swap && i < 5 { 2.0 } else { radii[i] };
            let mut points: Vec<DVec3> = (0..n).map(|i| {
                let angle = std::f64::consts::TAU * i as f64 / n as f64;
                let r = radius(i);
                DVec3::new(0.5 + r * angle.cos(), -2.0 + r * angle.sin(), 1.25)
            }).collect();
            prop_assert_eq!(tree_and_brute_force(points.clone()), [false, false]);
            if swap {
                // 0 → 3 and 1 → 4 cross, raised as 1 and 3 are.
                let (a, b) = (points[1], points[3]);
                points[1] = b.lerp(DVec3::new(0.5, -2.0, 1.25), -0.5);
                points[3] = a.lerp(DVec3::new(0.5, -2.0, 1.25), -0.5);
                prop_assert_eq!(tree_and_brute_force(points), [true, true]);
            }
        }
    }
}
