//! The certificate of a solid against a brute force in whole numbers, and against itself: what it says does
//! not depend on scale, rotation, or the order of things.

use foldfree::certificate::SolidCertificate;
use foldfree::mesh::SolidMesh;
use glam::DVec3;
use proptest::prelude::*;

mod bar;
use bar::bar;

type Point = [i64; 3];

fn point(p: Point) -> DVec3 {
    DVec3::from_array(p.map(|x| x as f64))
}

/// Six times the volume; exact for coordinates below 2³⁰.
fn volume([a, b, c, d]: [Point; 4]) -> i128 {
    let [u, v, w] = [b, c, d].map(|p| [0, 1, 2].map(|i| i128::from(p[i] - a[i])));
    let minor = |i: usize, j: usize| v[i] * w[j] - v[j] * w[i];
    u[0] * minor(1, 2) + u[1] * minor(2, 0) + u[2] * minor(0, 1)
}

/// The part of the segment xy inside a positive tetrahedron: from and to which fraction of it, each a
/// numerator and a positive denominator.
fn clip(x: Point, y: Point, t: [Point; 4]) -> Option<[(i128, i128); 2]> {
    let [mut from, mut to] = [(0, 1), (1, 1)];
    for k in 0..4 {
        let beyond = |p: Point| {
            let mut t = t;
            t[k] = p;
            volume(t)
        };
        let (fx, fy) = (beyond(x), beyond(y));
        let less = |a: (i128, i128), b: (i128, i128)| a.0 * b.1 < b.0 * a.1;
        if fx < 0 && fy < 0 {
            return None;
        } else if fx < 0 {
            let at = (-fx, fy - fx);
            from = if less(from, at) { at } else { from };
        } else if fy < 0 {
            let at = (fx, fx - fy);
            to = if less(at, to) { at } else { to };
        }
        if less(to, from) {
            return None;
        }
    }
    Some([from, to])
}

/// Do positive tetrahedra meet beyond the vertices, edge or face they share? The corners of what they have
/// in common are on edges of one or the other.
fn overlap(s: &[u32; 4], t: &[u32; 4], at: &[Point]) -> bool {
    let one_way = |s: &[u32; 4], t: &[u32; 4]| {
        let corners = t.map(|v| at[v as usize]);
        (0..4).any(|i| {
            (0..i).any(|j| {
                let (x, y) = match t.contains(&s[i]) {
                    true => (s[i], s[j]),
                    false => (s[j], s[i]),
                };
                let inside = clip(at[x as usize], at[y as usize], corners);
                match (t.contains(&x), t.contains(&y)) {
                    (true, true) => false,
                    (true, false) => inside.is_some_and(|[_, to]| to.0 > 0),
                    _ => inside.is_some(),
                }
            })
        })
    };
    one_way(s, t) || one_way(t, s)
}

/// Checks a certificate against the brute force. The tetrahedra have to form a manifold and to be positive
/// at rest.
fn agree(rest: &SolidMesh, image: &[Point], scale: f64) -> SolidCertificate {
    let positions: Vec<DVec3> = image.iter().map(|&p| point(p) * scale).collect();
    let c = SolidCertificate::of_solid(rest, &positions);
    let t = &rest.simplices;
    let with_sign = |wanted: i128| -> Vec<u32> {
        let sign = |&i: &u32| volume(t[i as usize].map(|v| image[v as usize])).signum();
        (0..t.len() as u32).filter(|i| sign(i) == wanted).collect()
    };
    assert_eq!(
        (&c.inverted, &c.degenerate),
        (&with_sign(-1), &with_sign(0))
    );
    assert!(c.flat_at_rest.is_empty() && c.irregular_faces.is_empty());
    assert!(c.irregular_edges.is_empty() && c.irregular_vertices.is_empty());
    let positive = c.inverted.is_empty() && c.degenerate.is_empty();
    let overlapping = || {
        (0..t.len()).find_map(|i| {
            let shares = |j: &usize| t[*j].iter().any(|v| t[i].contains(v));
            (0..i)
                .filter(shares)
                .find(|&j| overlap(&t[i], &t[j], image))
                .map(|j| (j, i))
        })
    };
    if positive {
        let found = overlapping();
        assert_eq!(
            c.locally_injective,
            found.is_none(),
            "{found:?} {c:#?} {image:?}"
        );
    } else {
        assert!(!c.locally_injective && c.overwound_edges.is_empty());
    }
    c
}

/// Directions around the origin, none parallel.
const OCTAGON: [[i64; 2]; 8] = [
    [10, 1],
    [6, 8],
    [-1, 10],
    [-8, 6],
    [-10, -2],
    [-6, -9],
    [2, -10],
    [9, -6],
];

/// A ring of n tetrahedra around the edge (0, 1), or a fan of n − 1; at rest once around it.
fn around(n: usize, closed: bool) -> SolidMesh {
    let mut positions = vec![DVec3::ZERO, DVec3::Z];
    positions.extend((0..n).map(|i| {
        let angle = 6.0 * i as f64 / n as f64;
        DVec3::new(angle.cos(), angle.sin(), 0.5)
    }));
    let last = if closed { n } else { n - 1 };
    let vertex = |i: usize| 2 + (i % n) as u32;
    SolidMesh {
        positions,
        simplices: (0..last)
            .map(|i| [0, 1, vertex(i), vertex(i + 1)])
            .collect(),
    }
}

/// The tetrahedra over a strip of n quads with their tip in vertex 0; vertex 2i + 1 of the strip is below
/// vertex 2i + 2. At rest it goes half around the tip.
fn shell(n: usize) -> SolidMesh {
    let mut positions = vec![DVec3::ZERO];
    for i in 0..=n {
        let angle = 3.0 * i as f64 / n as f64;
        positions.extend([1.0, 2.0].map(|z| DVec3::new(angle.cos(), angle.sin(), z)));
    }
    let quad = |i: u32| {
        let [a, b, c, d] = [1, 2, 3, 4].map(|k| 2 * i + k);
        [[0, a, c, b], [0, b, c, d]]
    };
    SolidMesh {
        simplices: (0..n as u32).flat_map(quad).collect(),
        positions,
    }
}

/// Eight tetrahedra around vertex 6.
fn octahedron() -> SolidMesh {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let mut positions: Vec<DVec3> = axes.iter().flat_map(|&a| [a, -a]).collect();
    positions.push(DVec3::ZERO);
    let corner = |i: u32| {
        let [x, y, z] = [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2)];
        let odd = i.count_ones() % 2 == 1;
        if odd { [6, y, x, z] } else { [6, x, y, z] }
    };
    SolidMesh {
        positions,
        simplices: (0..8).map(corner).collect(),
    }
}

/// A mesh with its vertices on a lattice, `cell` apart.
fn lattice(mesh: &SolidMesh, cell: f64) -> Vec<Point> {
    let round = |p: &DVec3| (*p * cell).round().to_array().map(|x| x as i64);
    mesh.positions.iter().map(round).collect()
}

fn offsets(n: usize, range: i64) -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec(prop::array::uniform3(-range..=range), n)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn rings_and_fans_of_any_turn(
        spokes in prop::collection::vec((1usize..4, 1i64..4, -8i64..9), 3..12),
        start in 0usize..8, closed: bool, whole: bool,
    ) {
        // Spokes turn by one to three eighths, so that nothing is inverted but the end of an open one.
        let mut image = vec![[0, 0, -6], [0, 0, 6]];
        let mut turn = start;
        for &(step, length, height) in &spokes {
            turn += if whole { 3 } else { step };
            let [x, y] = OCTAGON[turn % 8];
            image.push([x * length, y * length, height]);
        }
        agree(&around(spokes.len(), closed), &image, 0.25);
    }

    #[test]
    fn shells_that_wind_around_their_tip(
        ribs in prop::collection::vec((1usize..4, 0i64..5, 1i64..5), 2..14), start in 0usize..8, rise in 0i64..3,
    ) {
        let mut image = vec![[0, 0, 0]];
        let mut turn = start;
        for (i, &(step, low, width)) in ribs.iter().enumerate() {
            turn += step;
            let [x, y] = OCTAGON[turn % 8];
            let low = low + rise * i as i64;
            image.extend([[x, y, low], [x, y, low + width]]);
        }
        agree(&shell(ribs.len() - 1), &image, 1.0);
    }

    #[test]
    fn stars_of_a_vertex_anywhere(moves in offsets(7, 3), cell in 2u32..8) {
        let mesh = octahedron();
        let image: Vec<Point> = lattice(&mesh, f64::from(cell))
            .iter()
            .zip(&moves)
            .map(|(p, d)| [0, 1, 2].map(|i| p[i] + d[i]))
            .collect();
        agree(&mesh, &image, 3.0);
        agree(&mesh, &moves, 1.0);
    }

    #[test]
    fn disturbed_bars(moves in offsets(27, 4), amplitude in 0i64..=4, e in -60i32..60) {
        let mesh = bar(2, 2);
        let image: Vec<Point> = lattice(&mesh, 20.0)
            .iter()
            .zip(&moves)
            .map(|(p, d)| [0, 1, 2].map(|i| p[i] + d[i] * amplitude / 3))
            .collect();
        agree(&mesh, &image, 2f64.powi(e));
    }
}

#[test]
fn the_generators_reach_every_case() {
    // Two turns in sixteen steps of an eighth: rising by its own width a turn the strip touches itself, by
    // less it overlaps, by more it does not.
    let spiral = |rise: i64, width: i64| -> Vec<Point> {
        let rib = |i: i64| {
            let [x, y] = OCTAGON[(i % 8) as usize];
            [[x, y, rise * i], [x, y, rise * i + width]]
        };
        std::iter::once([0; 3])
            .chain((0..=16).flat_map(rib))
            .collect()
    };
    for (width, injective) in [(7, true), (8, false), (9, false)] {
        let c = agree(&shell(16), &spiral(1, width), 1.0);
        assert_eq!(c.locally_injective, injective);
        assert!(c.overwound_edges.is_empty());
        assert_eq!(c.overwound_vertices.is_empty(), injective);
    }
    // Eight spokes three eighths apart go around three times.
    let three = |i: i64| {
        let [x, y] = OCTAGON[(3 * i % 8) as usize];
        [x, y, 0]
    };
    let image: Vec<Point> = [[0, 0, -1], [0, 0, 1]]
        .into_iter()
        .chain((0..8).map(three))
        .collect();
    let c = agree(&around(8, true), &image, 1.0);
    assert_eq!(
        (&c.overwound_edges[..], c.overwound_inside),
        (&[[0, 1]][..], 1)
    );
    // An open fan of a full turn touches itself.
    let image: Vec<Point> = [[0, 0, -1], [0, 0, 1]]
        .into_iter()
        .chain((0..9).map(|i| [OCTAGON[i % 8][0], OCTAGON[i % 8][1], 0]))
        .collect();
    let c = agree(&around(9, false), &image, 1.0);
    assert_eq!(
        (&c.overwound_edges[..], c.overwound_inside),
        (&[[0, 1]][..], 0)
    );
}

/// Everything but floating point.
fn claims(c: &SolidCertificate) -> SolidCertificate {
    SolidCertificate {
        smallest_sigma: 0.0,
        largest_sigma: 0.0,
        ..c.clone()
    }
}

/// A shell that overlaps at its tip beside a ring that winds twice, a disturbed bar, a folded bar.
fn samples() -> Vec<(SolidMesh, Vec<DVec3>)> {
    let points = |image: Vec<Point>| -> Vec<DVec3> { image.into_iter().map(point).collect() };
    let rib = |i: i64| {
        let [x, y] = OCTAGON[(i % 8) as usize];
        [[x, y, i], [x, y, i + 9]]
    };
    let spiral = std::iter::once([0; 3])
        .chain((0..=16).flat_map(rib))
        .collect();
    let wound = [[0, 0, -1], [0, 0, 1]]
        .into_iter()
        .chain((0..8).map(|i| [OCTAGON[3 * i % 8][0], OCTAGON[3 * i % 8][1], 0]))
        .collect();
    let mesh = bar(3, 2);
    let wave = |amplitude: f64| -> Vec<DVec3> {
        let moved = |p: &DVec3| {
            *p + amplitude * DVec3::new((7.0 * p.y).sin(), (9.0 * p.z).cos(), (8.0 * p.x).sin())
        };
        mesh.positions.iter().map(moved).collect()
    };
    let (little, much) = (wave(0.05), wave(0.4));
    vec![
        (shell(16), points(spiral)),
        (around(8, true), points(wound)),
        (mesh.clone(), little),
        (mesh, much),
    ]
}

#[test]
fn scale_by_powers_of_two_changes_nothing_at_all() {
    for (rest, image) in samples() {
        let expected = SolidCertificate::of_solid(&rest, &image);
        for e in [-300, -260, -80, -1, 1, 100, 296, 300, 340] {
            let scale = 2f64.powi(e);
            let scaled = SolidMesh {
                positions: rest.positions.iter().map(|p| *p * scale).collect(),
                simplices: rest.simplices.clone(),
            };
            let moved: Vec<DVec3> = image.iter().map(|p| *p * scale).collect();
            assert_eq!(
                SolidCertificate::of_solid(&scaled, &moved),
                expected,
                "2^{e}"
            );
            // The image alone: only the singular values are others.
            let c = SolidCertificate::of_solid(&rest, &moved);
            assert_eq!(claims(&c), claims(&expected));
            assert_eq!(c.largest_sigma, expected.largest_sigma * scale);
        }
    }
}

#[test]
fn rotations_that_are_exact_change_no_claim_and_reflections_invert_everything() {
    let permutations = [
        [0, 1, 2],
        [1, 2, 0],
        [2, 0, 1],
        [1, 0, 2],
        [0, 2, 1],
        [2, 1, 0],
    ];
    for (rest, image) in samples() {
        let expected = SolidCertificate::of_solid(&rest, &image);
        for (k, permutation) in permutations.iter().enumerate() {
            for signs in 0u32..8 {
                let turn = |p: &DVec3| {
                    DVec3::from_array([0, 1, 2].map(|i| {
                        let x = p[permutation[i]];
                        if signs >> i & 1 == 1 { -x } else { x }
                    }))
                };
                let turned: Vec<DVec3> = image.iter().map(turn).collect();
                let c = SolidCertificate::of_solid(&rest, &turned);
                if (k < 3) == (signs.count_ones() % 2 == 0) {
                    assert_eq!(claims(&c), claims(&expected));
                    assert!(
                        (c.smallest_sigma - expected.smallest_sigma).abs()
                            < 1e-13 * c.largest_sigma
                    );
                } else {
                    assert_eq!(
                        c.inverted.len() + expected.inverted.len(),
                        rest.simplices.len()
                    );
                    assert_eq!(c.degenerate, expected.degenerate);
                }
                // Rest shape and image turned alike, also by a reflection.
                let both = SolidMesh {
                    positions: rest.positions.iter().map(turn).collect(),
                    simplices: rest.simplices.clone(),
                };
                let c = SolidCertificate::of_solid(&both, &turned);
                assert_eq!(claims(&c), claims(&expected));
            }
        }
    }
}

#[test]
fn order_of_vertices_and_tetrahedra_does_not_matter() {
    for (rest, image) in samples() {
        let expected = SolidCertificate::of_solid(&rest, &image);
        let n = image.len();
        // v ↦ n − 1 − v, the corners of every tetrahedron in another order, the last first.
        let to = |v: u32| n as u32 - 1 - v;
        let mut other = SolidMesh {
            positions: rest.positions.iter().rev().copied().collect(),
            simplices: rest.simplices.iter().rev().map(|t| t.map(to)).collect(),
        };
        for (i, t) in other.simplices.iter_mut().enumerate() {
            t.rotate_left(i % 4);
        }
        let moved: Vec<DVec3> = image.iter().rev().copied().collect();
        let c = SolidCertificate::of_solid(&other, &moved);
        let last = rest.simplices.len() as u32 - 1;
        let back = |list: &[u32]| list.iter().rev().map(|i| last - i).collect::<Vec<u32>>();
        assert_eq!(back(&c.inverted), expected.inverted);
        assert_eq!(back(&c.degenerate), expected.degenerate);
        let vertices: Vec<u32> = c.overwound_vertices.iter().rev().map(|&v| to(v)).collect();
        assert_eq!(vertices, expected.overwound_vertices);
        let mut edges: Vec<[u32; 2]> = c
            .overwound_edges
            .iter()
            .map(|&[p, q]| [to(q), to(p)])
            .collect();
        edges.sort_unstable();
        assert_eq!(edges, expected.overwound_edges);
        assert_eq!(c.locally_injective, expected.locally_injective);
        assert_eq!(c.boundary_faces, expected.boundary_faces);
    }
}
