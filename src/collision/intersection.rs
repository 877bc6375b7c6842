//! Which facets of a boundary that stands still meet where they should not? By exact predicates.
//!
//! In space everything follows from one question: does an edge meet a triangle? Two triangles without a common vertex
//! meet only where an edge of one meets the other. Of two with one common vertex that meet beyond it, the edge
//! opposite to it of one meets the other: from the common vertex through a common point one gets out of one of the
//! two first, through that edge. Two with a common edge overlap if both are on one side of it in one plane.

use super::{Boundary, BroadPhase};
use crate::certificate::{meet, meet_beyond, orientation, orientation_of_tetrahedron};
use glam::{DVec2, DVec3};
use std::cmp::Ordering::{self, Equal};
use std::ops::ControlFlow;

/// Pairs of facets that meet, other than in what they share; sorted, at most `limit` of them (which of more, depends
/// on the tree). Facets without extent meet whatever they lie on. All positions of the boundary must be finite.
pub fn intersections<const D: usize>(
    boundary: &Boundary<D>,
    positions: &[[f64; D]],
    broad: &mut BroadPhase<D>,
    limit: usize,
) -> Vec<[u32; 2]> {
    let mut found = Vec::new();
    if limit == 0 {
        return found;
    }
    broad.facet_pairs(boundary, positions, &mut |i, j| {
        let facets = [i, j].map(|f| boundary.facets[f as usize]);
        if facets_meet(facets, positions) {
            found.push([i, j]);
            if found.len() >= limit {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(())
    });
    found.sort_unstable();
    found
}

fn facets_meet<const D: usize>([f, g]: [[u32; D]; 2], positions: &[[f64; D]]) -> bool {
    // the common vertices of both to the front
    let (mut f, mut g, mut shared) = (f, g, 0);
    for i in 0..D {
        if let Some(j) = g.iter().position(|&v| v == f[i]) {
            f.swap(shared, i);
            g.swap(shared, j);
            shared += 1;
        }
    }
    if D == 2 {
        let at = |v: u32| {
            let p = &positions[v as usize];
            DVec2::new(p[0], p[1])
        };
        let kind = match shared {
            0 => meet(at(f[0]), at(f[1]), at(g[0]), at(g[1])),
            1 => meet_beyond(at(f[0]), at(f[1]), at(g[1])),
            _ => return true,
        };
        return kind.is_some();
    }
    let corners = |f: [u32; D]| {
        [0, 1, 2].map(|i| {
            let p = &positions[f[i] as usize];
            DVec3::new(p[0], p[1], p[2])
        })
    };
    let (f, g) = (corners(f), corners(g));
    match shared {
        0 => (0..3).any(|i| {
            let j = (i + 1) % 3;
            edge_meets_triangle(f[i], f[j], g) || edge_meets_triangle(g[i], g[j], f)
        }),
        1 => edge_meets_triangle(f[1], f[2], g) || edge_meets_triangle(g[1], g[2], f),
        2 => fold(f[0], f[1], f[2], g[2]),
        _ => true,
    }
}

/// Does the closed segment p–q meet the closed triangle?
fn edge_meets_triangle(p: DVec3, q: DVec3, t: [DVec3; 3]) -> bool {
    let [a, b, c] = t;
    let side = |x| orientation_of_tetrahedron(a, b, c, x);
    let (sp, sq) = (side(p), side(q));
    if sp == sq {
        return sp == Equal && coplanar_meet(p, q, t);
    }
    // the line of p and q meets the plane in one point, between them or at one of them: is it inside?
    let around = [(a, b), (b, c), (c, a)].map(|(a, b)| orientation_of_tetrahedron(p, q, a, b));
    one_sided(around)
}

/// No two of them opposite?
fn one_sided(signs: [Ordering; 3]) -> bool {
    !(signs.contains(&Ordering::Less) && signs.contains(&Ordering::Greater))
}

/// The three projections along the axes.
fn projections(p: DVec3) -> [DVec2; 3] {
    [
        DVec2::new(p.y, p.z),
        DVec2::new(p.z, p.x),
        DVec2::new(p.x, p.y),
    ]
}

/// The same of points in one plane: they meet if they meet in all three projections, one of which is a bijection of
/// the plane (or line) that has them all.
fn coplanar_meet(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (pp, qq) = (projections(p), projections(q));
    let [aa, bb, cc] = [a, b, c].map(projections);
    let inside = (0..3).all(|k| {
        let around = [(aa[k], bb[k]), (bb[k], cc[k]), (cc[k], aa[k])];
        one_sided(around.map(|(a, b)| orientation(a, b, pp[k])))
    });
    // a triangle without area has no inside: its edges are all of it
    let has_area = (0..3).any(|k| orientation(aa[k], bb[k], cc[k]) != Equal);
    let crosses = |a: [DVec2; 3], b: [DVec2; 3]| {
        // p, q and the plane of the triangle are one plane; p, q and an edge of a triangle without area need not be
        (0..3).all(|k| meet(pp[k], qq[k], a[k], b[k]).is_some())
    };
    let in_one_plane = |a, b| has_area || orientation_of_tetrahedron(p, q, a, b) == Equal;
    inside && has_area
        || [(a, b, aa, bb), (b, c, bb, cc), (c, a, cc, aa)]
            .into_iter()
            .any(|(a, b, aa, bb)| in_one_plane(a, b) && crosses(aa, bb))
}

/// Do the triangles u, v, a and u, v, b lie on each other beside their common edge?
fn fold(u: DVec3, v: DVec3, a: DVec3, b: DVec3) -> bool {
    if orientation_of_tetrahedron(u, v, a, b) != Equal {
        return false;
    }
    let [u, v, a, b] = [u, v, a, b].map(projections);
    // in a projection in which the first has an area they are on different sides
    !(0..3).any(|k| {
        let (a, b) = (orientation(u[k], v[k], a[k]), orientation(u[k], v[k], b[k]));
        a != Equal && b == a.reverse()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle(v: [[f64; 3]; 3]) -> [DVec3; 3] {
        v.map(DVec3::from_array)
    }

    /// By rational arithmetic on a grid: both are triangles with area; a common point minimises the distance to 0.
    /// Solved by clipping one triangle with the other's plane and sides, in fractions.
    fn grid_point(i: &mut u64) -> DVec3 {
        *i = i
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        let x = *i >> 33;
        DVec3::new((x % 4) as f64, (x / 4 % 4) as f64, (x / 16 % 4) as f64)
    }

    /// Does the segment meet the triangle? By parameters, in integers that doubles hold exactly.
    fn oracle(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> Option<bool> {
        let n = (b - a).cross(c - a);
        let (np, nq) = (n.dot(p - a), n.dot(q - a));
        if n == DVec3::ZERO || np == nq {
            return None;
        }
        if np * nq > 0.0 {
            return Some(false);
        }
        // x = p + s (q − p), s = np/(np − nq), all times the denominator, which is made positive
        let den = (np - nq).abs();
        let x = den * p + np * (np - nq).signum() * (q - p);
        let inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|&(a, b)| n.dot((b - a).cross(x - den * a)) >= 0.0);
        Some(inside)
    }

    #[test]
    fn edges_meet_triangles_where_parameters_say_so() {
        let (mut seed, mut met, mut all) = (1, 0, 0);
        for _ in 0..200_000 {
            let [p, q, a, b, c] = std::array::from_fn(|_| grid_point(&mut seed));
            if let Some(expected) = oracle(p, q, [a, b, c]) {
                assert_eq!(
                    edge_meets_triangle(p, q, [a, b, c]),
                    expected,
                    "{p} {q} {a} {b} {c}"
                );
                met += usize::from(expected);
                all += 1;
            }
        }
        assert!(met > all / 100, "{met} of {all}");
    }

    #[test]
    fn in_one_plane_and_without_area() {
        let t = triangle([[0.0, 0.0, 0.0], [2.0, 0.0, 2.0], [0.0, 2.0, 0.0]]);
        let at = |x: f64, y: f64| DVec3::new(x, y, x);
        assert!(edge_meets_triangle(at(0.5, 0.5), at(0.6, 0.6), t), "inside");
        assert!(
            edge_meets_triangle(at(-1.0, 0.5), at(3.0, 0.5), t),
            "across"
        );
        assert!(
            edge_meets_triangle(at(-1.0, 0.0), at(0.0, 0.0), t),
            "at a corner"
        );
        assert!(
            !edge_meets_triangle(at(1.5, 1.5), at(3.0, 0.5), t),
            "outside"
        );
        let needle = triangle([[0.0; 3], [2.0, 2.0, 2.0], [1.0, 1.0, 1.0]]);
        let across = |z: f64| (DVec3::new(1.0, 0.0, z), DVec3::new(1.0, 2.0, z));
        let (p, q) = across(1.0);
        assert!(edge_meets_triangle(p, q, needle));
        let (p, q) = across(1.5);
        assert!(!edge_meets_triangle(p, q, needle));
        let point = [DVec3::ONE; 3];
        assert!(edge_meets_triangle(DVec3::ZERO, DVec3::splat(2.0), point));
        assert!(!edge_meets_triangle(DVec3::ZERO, DVec3::X, point));
    }

    #[test]
    fn pairs_that_share_vertices() {
        let boundary = |facets: &[[u32; 3]]| Boundary::<3>::of_facets(facets.to_vec());
        let check = |facets: &[[u32; 3]], x: &[[f64; 3]]| {
            !intersections(&boundary(facets), x, &mut BroadPhase::default(), 10).is_empty()
        };
        let hinge = |z: f64, y: f64| [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [0.4, y, z]];
        let two = [[0, 1, 2], [1, 0, 3]];
        assert!(!check(&two, &hinge(0.0, -1.0)), "flat");
        assert!(!check(&two, &hinge(1e-300, 1.0)), "nearly folded");
        assert!(check(&two, &hinge(0.0, 1.0)), "folded");
        let bow = |x: [[f64; 3]; 2]| [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], x[0], x[1]];
        let two = [[0, 1, 2], [0, 3, 4]];
        assert!(!check(&two, &bow([[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])));
        assert!(check(&two, &bow([[1.0, 1.0, 1.0], [1.0, 1.0, -1.0]])));
        assert!(check(&two, &bow([[0.1, 0.1, 0.0], [0.1, 0.2, 0.0]])));
    }
}
