//! The certificate against a brute force in whole numbers.

mod certificate_support;

use certificate_support::{Point, agree};
use foldfree::certificate::CrossingKind;
use proptest::prelude::*;

/// A strip of n quads; vertex 2i below, 2i+1 above.
fn strip(n: u32, closed: bool) -> Vec<[u32; 3]> {
    let vertices = if closed { 2 * n } else { 2 * n + 2 };
    (0..n)
        .flat_map(|i| {
            let [a, b, c, d] = [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1].map(|v| v % vertices);
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A grid of n × n quads.
fn grid(n: u32) -> Vec<[u32; 3]> {
    (0..n * n)
        .flat_map(|i| {
            let a = i / n * (n + 1) + i % n;
            let (b, c, d) = (a + 1, a + n + 2, a + n + 1);
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

/// A wheel: vertex 0 in the middle.
fn wheel(n: u32, closed: bool) -> Vec<[u32; 3]> {
    let last = if closed { n } else { n - 1 };
    (0..last).map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect()
}

/// Directions around the origin, none parallel.
const OCTAGON: [Point; 8] = [
    (10, 1),
    (6, 8),
    (-1, 10),
    (-8, 6),
    (-10, -2),
    (-6, -9),
    (2, -10),
    (9, -6),
];

fn points(n: usize, range: i64) -> impl Strategy<Value = Vec<Point>> {
    prop::collection::vec((-range..=range, -range..=range), n)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn disturbed_grids(offsets in points(25, 12), amplitude in 0i64..=12, e in -60i32..60) {
        let uv: Vec<Point> = (0..25i64)
            .map(|i| (i % 5 * 10 + offsets[i as usize].0 * amplitude / 12,
                      i / 5 * 10 + offsets[i as usize].1 * amplitude / 12))
            .collect();
        agree(&grid(4), &uv, 2f64.powi(e));
    }

    #[test]
    fn anything_on_few_points(uv in points(9, 3)) {
        agree(&grid(2), &uv, 1.0);
        agree(&wheel(8, true), &uv, 0.125);
        agree(&strip(4, true), &uv[..8], 3.0);
    }

    #[test]
    fn open_and_closed_wheels_of_any_turn(
        spokes in prop::collection::vec((0usize..3, 1i64..4), 2..14), start in 0usize..8, closed: bool,
    ) {
        // Spokes turn by 1 to 3 eighths each, so that nothing is inverted but the fan may wind twice.
        let mut uv = vec![(0, 0)];
        let mut turn = start;
        for &(step, length) in &spokes {
            turn += step + 1;
            let p = OCTAGON[turn % 8];
            uv.push((p.0 * length, p.1 * length));
        }
        agree(&wheel(spokes.len() as u32, closed), &uv, 1.0);
    }

    #[test]
    fn two_triangles_anywhere(uv in points(6, 4)) {
        agree(&[[0, 1, 2], [3, 4, 5]], &uv, 1.0);
        agree(&[[0, 1, 2], [0, 3, 4]], &uv[..5], 1.0);
        agree(&[[0, 1, 2], [1, 0, 3]], &uv[..4], 1.0);
    }

    #[test]
    fn several_positive_triangles(uv in prop::collection::vec((points(3, 9), -20i64..20, -20i64..20), 2..6)) {
        // Each turned to be positive; most do not meet, some are nested.
        let mut flat = Vec::new();
        for (t, dx, dy) in &uv {
            let mut t: Vec<Point> = t.iter().map(|p| (p.0 + dx, p.1 + dy)).collect();
            if certificate_support::turn(t[0], t[1], t[2]) < 0 {
                t.swap(1, 2);
            }
            flat.extend(t);
        }
        let triangles: Vec<[u32; 3]> = (0..uv.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        agree(&triangles, &flat, 1.0);
    }
}

#[test]
fn every_map_of_two_neighbours_to_a_small_grid() {
    // All 9⁴ places of the vertices of two triangles.
    for i in 0..9i64.pow(4) {
        let uv: Vec<Point> = [1, 9, 81, 729]
            .iter()
            .map(|d| (i / d % 9 % 3, i / d % 9 / 3))
            .collect();
        agree(&[[0, 1, 2], [0, 2, 3]], &uv, 1.0);
    }
}

#[test]
fn a_wheel_that_winds_twice_has_positive_triangles_and_is_no_immersion() {
    let uv: Vec<Point> = [(0, 0)]
        .into_iter()
        .chain(
            (0..8)
                .map(|i| OCTAGON[(3 * i) % 8])
                .map(|(x, y)| (x * 7, y * 7)),
        )
        .collect();
    let c = agree(&wheel(8, true), &uv, 1.0);
    assert!(c.inverted.is_empty() && c.is_disk);
    assert_eq!((&c.overwound[..], c.overwound_inside), (&[0][..], 1));
    assert!(c.is_free_of_folds() && c.summary().contains("1 inner vertex wind"));
    assert!(!c.locally_injective && !c.globally_injective);
}

#[test]
fn an_open_fan_of_more_than_a_full_turn_laps_over_itself_at_its_vertex() {
    let fan = |n: usize| {
        let mut uv = vec![(0, 0)];
        uv.extend(
            (0..n)
                .map(|i| OCTAGON[i % 8])
                .zip(9..)
                .map(|(p, r)| (p.0 * r, p.1 * r)),
        );
        agree(&wheel(n as u32, false), &uv, 1.0)
    };
    assert!(fan(8).globally_injective);
    // Exactly a full turn: first and last edge lie on each other.
    let full = fan(9);
    assert_eq!((&full.overwound[..], full.overwound_inside), (&[0][..], 0));
    assert_eq!(full.boundary_crossings[0].kind, CrossingKind::Overlap);
    let more = fan(10);
    assert_eq!(more.overwound, [0]);
    assert!(more.is_free_of_folds() && !more.locally_injective);
    assert!(
        more.summary().contains("1 boundary vertex wind"),
        "{}",
        more.summary()
    );
}

/// A spiral strip of n quads, 8 to a turn, at radius r (inner) and r + width.
fn spiral(n: i64, growth: i64, width: i64) -> Vec<Point> {
    (0..=n)
        .flat_map(|i| {
            let p = OCTAGON[(i % 8) as usize];
            let at = |r: i64| (p.0 * r, p.1 * r);
            // Outer side first: the strip's lower vertices lie outside.
            [at(100 + growth * i + width), at(100 + growth * i)]
        })
        .collect()
}

#[test]
fn strips_that_spiral_overlap_or_not() {
    let apart = agree(&strip(20, false), &spiral(20, 12, 30), 1.0);
    assert!(apart.globally_injective && apart.is_disk && apart.sheets == Some(1));
    let over = agree(&strip(20, false), &spiral(20, 5, 90), 1.0);
    assert!(over.locally_injective && !over.globally_injective);
    assert!(over.boundary_crossing_count > 0);
    let touching = agree(&strip(8, false), &spiral(8, 4, 32), 1.0);
    assert!(touching.locally_injective && !touching.globally_injective);
    assert!(
        touching
            .boundary_crossings
            .iter()
            .any(|c| c.kind != CrossingKind::Proper)
    );
}

#[test]
fn annuli_and_nested_pieces() {
    let ring = agree(&strip(8, true), &spiral(7, 0, 50), 1.0);
    assert!(ring.globally_injective && !ring.is_disk && ring.boundary_loops == 2);
    // Twice around: every triangle is positive, locally injective, but every point is covered twice.
    let twice = agree(&strip(16, true), &spiral(15, 0, 50), 1.0);
    assert!(twice.locally_injective && !twice.globally_injective);

    // A triangle on a triangle, boundaries apart: only the winding number sees it.
    let nested = [(0, 0), (100, 0), (0, 100), (10, 10), (30, 10), (10, 30)];
    let two = [[0, 1, 2], [3, 4, 5]];
    let c = agree(&two, &nested, 1.0);
    assert_eq!((c.boundary_crossing_count, c.sheets), (0, Some(2)));
    assert!(c.locally_injective && !c.globally_injective);
    // The same triangle in the hole of a ring: fine.
    let mut uv = spiral(7, 0, 50);
    uv.extend([(1, 1), (50, 2), (3, 40)]);
    let mut triangles = strip(8, true);
    triangles.push([16, 17, 18]);
    let c = agree(&triangles, &uv, 1.0);
    assert!(c.globally_injective && c.sheets == Some(1));
}
