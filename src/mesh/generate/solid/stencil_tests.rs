//! The dihedral angles of everything that the stencils can produce.

use super::super::stuffing::{ALPHA_LONG, ALPHA_SHORT};
use super::{Coordinates, Side, fill, is_long};
use glam::DVec3;

/// One lattice tetrahedron: 0–1 and 2–3 are long.
const AT: [Coordinates; 4] = [[0, 0, 0], [2, 0, 0], [1, 1, 1], [1, -1, 1]];

fn point(at: Coordinates) -> DVec3 {
    DVec3::from_array(at.map(|c| c as f64))
}

fn alpha(a: Coordinates, b: Coordinates) -> f64 {
    if is_long(a, b) {
        ALPHA_LONG
    } else {
        ALPHA_SHORT
    }
}

/// Where a vertex can have been moved to, with the corner of the tetrahedron it was moved towards.
fn moves(at: Coordinates) -> Vec<(DVec3, Option<usize>)> {
    let mut ends = Vec::new();
    for axis in 0..3 {
        for step in [-2, 2] {
            let mut end = at;
            end[axis] += step;
            ends.push(end);
        }
    }
    ends.extend((0..8).map(|corner| [0, 1, 2].map(|k| at[k] + 2 * (corner >> k & 1) - 1)));
    let mut moves = vec![(point(at), None)];
    for end in ends {
        let towards = AT.iter().position(|&corner| corner == end);
        moves.push((point(at).lerp(point(end), alpha(at, end)), towards));
    }
    moves
}

fn cosines([a, b, c, d]: [DVec3; 4]) -> [f64; 6] {
    [
        [a, b, c, d],
        [a, c, b, d],
        [a, d, b, c],
        [b, c, a, d],
        [b, d, a, c],
        [c, d, a, b],
    ]
    .map(|[from, to, left, right]| {
        let edge = (to - from).normalize();
        let left = (left - from).reject_from_normalized(edge);
        let right = (right - from).reject_from_normalized(edge);
        left.dot(right) / (left.length() * right.length())
    })
}

/// All 65 sign patterns with an inside corner, vertices moved as far as they can be in any direction,
/// cut points at either end of where they can be: the angles are extreme at such ends. Left out is
/// what cannot happen: two vertices that moved towards each other along one edge.
#[test]
fn every_stencil_keeps_the_bounds_of_the_angles() {
    let sides = [Side::Inside, Side::On, Side::Outside];
    let (mut least, mut greatest, mut count) = (-1.0f64, 1.0f64, 0usize);
    for pattern in 0..81usize {
        let side = [1, 3, 9, 27].map(|digit| sides[pattern / digit % 3]);
        let mut tetrahedra = Vec::new();
        // A node is a corner, or 4 + 4·inside + outside.
        let cut = |i: usize, j: usize| (4 + 4 * i + j) as u32;
        fill(side, &AT, |i| i as u32, cut, &mut tetrahedra);
        for tetrahedron in tetrahedra {
            let places = tetrahedron.map(|node| match node as usize {
                corner @ 0..4 if side[corner] == Side::On => moves(AT[corner]),
                corner @ 0..4 => vec![(point(AT[corner]), None)],
                cut => {
                    let [a, b] = [(cut - 4) / 4, (cut - 4) % 4].map(|i| AT[i]);
                    let near = alpha(a, b);
                    [near, 1.0 - near]
                        .map(|share| (point(a).lerp(point(b), share), None))
                        .to_vec()
                }
            });
            for a in &places[0] {
                for b in &places[1] {
                    for c in &places[2] {
                        for d in &places[3] {
                            let chosen = [a, b, c, d];
                            let met = (0..4).any(|i| {
                                let Some(to) = chosen[i].1 else { return false };
                                let other = tetrahedron.iter().position(|&n| n as usize == to);
                                other.is_some_and(|j| chosen[j].1 == Some(tetrahedron[i] as usize))
                            });
                            if met {
                                continue;
                            }
                            let [a, b, c, d] = chosen.map(|place| place.0);
                            assert!((b - a).cross(c - a).dot(d - a) > 1e-3, "{side:?}");
                            for cosine in cosines([a, b, c, d]) {
                                least = least.max(cosine);
                                greatest = greatest.min(cosine);
                            }
                            count += 1;
                        }
                    }
                }
            }
        }
    }
    let [least, greatest] = [least, greatest].map(|cosine| cosine.acos().to_degrees());
    println!("{count} tetrahedra, angles {least:.3} to {greatest:.3}");
    assert!((10.78..10.79).contains(&least), "{least}");
    assert!((164.73..164.74).contains(&greatest), "{greatest}");
}
