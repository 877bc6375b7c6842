//! Do arcs on the sphere of directions around a point meet? Decided exactly.
//!
//! The arc from a to b is the shorter part of the great circle through the directions of a and b from v:
//! the triangle v, a, b, which is not degenerate, as seen from v.

use crate::certificate::{orientation, orientation_of_tetrahedron};
use glam::{DVec2, DVec3};
use std::cmp::Ordering;

/// Do the closed arcs ab and cd meet?
pub(super) fn meet(v: DVec3, [a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> bool {
    let side = |x, y, z| orientation_of_tetrahedron(v, x, y, z);
    let (abc, abd) = (side(a, b, c), side(a, b, d));
    if abc == abd && abc.is_ne() {
        return false;
    }
    let (cda, cdb) = (side(c, d, a), side(c, d, b));
    // The arcs cross when each has its ends on both sides of the other, and on the sides that belong
    // together: otherwise one of them crosses the antipode of the other.
    let crossing = abc.is_ne() && abd == abc.reverse() && cda == abd && cdb == abc;
    crossing
        || (abc.is_eq() && within(v, a, b, c))
        || (abd.is_eq() && within(v, a, b, d))
        || (cda.is_eq() && within(v, c, d, a))
        || (cdb.is_eq() && within(v, c, d, b))
}

/// Is the direction of c, which is in the plane of v, a, b, on the closed arc ab?
fn within(v: DVec3, a: DVec3, b: DVec3, c: DVec3) -> bool {
    // Seen along an axis along which the triangle v, a, b is not seen edge on.
    for axis in 0..3 {
        let flat = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
        let turn = |x, y| orientation(flat(v), flat(x), flat(y));
        let turned = turn(a, b);
        if turned.is_ne() {
            let inside = |side: Ordering| side.is_eq() || side == turned;
            return inside(turn(a, c)) && inside(turn(c, b));
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Directions on a grid of the plane z = 1 as (x, y).
    fn up(x: i32, y: i32) -> DVec3 {
        DVec3::new(f64::from(x), f64::from(y), 1.0)
    }

    #[test]
    fn arcs_above_the_plane_meet_as_their_segments_do() {
        let cross = [[up(-1, 0), up(1, 0)], [up(0, -1), up(0, 1)]];
        let cases = [
            (cross[0], cross[1], true),
            (cross[0], [up(0, 0), up(0, 5)], true),
            (cross[0], [up(0, 1), up(0, 5)], false),
            (cross[0], [up(1, 0), up(3, 0)], true),
            (cross[0], [up(2, 0), up(3, 0)], false),
            (cross[0], [up(-3, 0), up(3, 0)], true),
            (cross[0], [up(1, 0), up(3, 2)], true),
            (cross[0], [up(2, -1), up(2, 1)], false),
        ];
        for v in [DVec3::ZERO, DVec3::new(0.25, -8.0, 3.0)] {
            for (ab, cd, expected) in cases {
                for s in [1.0, 2f64.powi(-20)] {
                    let [ab, cd] = [ab, cd].map(|arc| arc.map(|p| v + p * s));
                    let back = |[a, b]: [DVec3; 2]| [b, a];
                    assert_eq!(meet(v, ab, cd), expected, "{ab:?} {cd:?}");
                    assert_eq!(meet(v, cd, ab), expected);
                    assert_eq!(meet(v, back(ab), cd), expected);
                    assert_eq!(meet(v, ab, back(cd)), expected);
                    // Lengths along a direction do not matter.
                    let far = cd.map(|p| v + (p - v) * 4.0);
                    assert_eq!(meet(v, ab, far), expected);
                    // At the antipode nothing meets.
                    let behind = cd.map(|p| v - (p - v));
                    assert!(!meet(v, ab, behind), "{ab:?} {cd:?}");
                }
            }
        }
    }

    #[test]
    fn long_arcs_of_one_great_circle() {
        let at = |k: i32| {
            let turn = [(8, 1), (1, 8), (-8, 1), (-1, -8), (8, -2)];
            let (x, y) = turn[k as usize % 5];
            DVec3::new(f64::from(x), f64::from(y), 0.0)
        };
        // 0 → 1 → 2 → 3 → 4 turn once, by less than half a turn each.
        let o = DVec3::ZERO;
        assert!(!meet(o, [at(0), at(1)], [at(2), at(3)]));
        assert!(meet(o, [at(0), at(1)], [at(1), at(2)]));
        assert!(!meet(o, [at(3), at(4)], [at(0), at(1)]));
        assert!(meet(o, [at(3), at(0)], [at(4), at(1)]));
        assert!(!meet(o, [at(0), at(2)], [at(3), at(4)]));
    }
}
