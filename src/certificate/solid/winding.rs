//! Do the tetrahedra around an edge go around it more than once? Decided exactly, of tetrahedra that are
//! all positive.
//!
//! Let side(i) be the orientation of (p, q, r₀, rᵢ), for the edge (p, q) and the vertices rᵢ around it.
//! Positive means that rᵢ is less than half a turn ahead of r₀. Every tetrahedron (p, q, rᵢ, rᵢ₊₁) turns by
//! less than half a turn, so the direction of r₀ is in its half-open wedge [rᵢ, rᵢ₊₁) exactly when
//! side(i) ≤ 0 and side(i+1) > 0: with side(i) = 0 the vertex rᵢ is in the direction of r₀ or in the
//! opposite one, and from the opposite one the next vertex is behind r₀. Likewise r₀ is in the closed wedge
//! exactly when side(i) ≤ 0 and side(i+1) ≥ 0; not both are 0.

use super::rings::{Ring, Rings};
use crate::certificate::orientation_of_tetrahedron;
use glam::DVec3;
use std::cmp::Ordering;

/// The rings that go around their edge more than once and the fans that reach around it up to their own
/// beginning or beyond.
pub(super) fn overwound<'a>(rings: &'a Rings, positions: &[DVec3]) -> Vec<&'a Ring> {
    let is_overwound = |ring: &&Ring| winds_on(rings.link(ring), ring, positions);
    rings.rings.iter().filter(is_overwound).collect()
}

fn winds_on(link: &[u32], ring: &Ring, positions: &[DVec3]) -> bool {
    // Two turns of less than half a turn a tetrahedron take five, one turn takes three.
    let tetrahedra = if ring.closed {
        link.len()
    } else {
        link.len() - 1
    };
    if tetrahedra < if ring.closed { 5 } else { 3 } {
        return false;
    }
    let [p, q] = ring.ends.map(|v| positions[v as usize]);
    let first = positions[link[0] as usize];
    let side = |&r: &u32| orientation_of_tetrahedron(p, q, first, positions[r as usize]);
    // The first wedge has r₀ as its beginning. Does a later one have it?
    let again = match ring.closed {
        true => Ordering::is_gt,
        false => Ordering::is_ge,
    };
    let mut before = Ordering::Greater;
    link[2..].iter().map(side).any(|side| {
        let found = before.is_le() && again(side);
        before = side;
        found
    })
}
