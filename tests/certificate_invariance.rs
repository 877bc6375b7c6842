//! What a certificate says does not depend on scale, rotation, or the order of things; and one ulp is
//! enough to change it.

use foldfree::certificate::{Certificate, CrossingKind};
use foldfree::mesh::SurfaceMesh;
use glam::{DMat3, DVec2, DVec3};
use proptest::prelude::*;

/// A bumpy grid of n × n quads and a map of it with some folds.
fn bumpy(n: u32, fold: f64) -> (SurfaceMesh, Vec<DVec2>) {
    let m = n + 1;
    let at = |i: u32| DVec2::new(f64::from(i % m), f64::from(i / m)) / f64::from(n);
    let positions: Vec<DVec3> = (0..m * m)
        .map(|i| {
            let p = at(i);
            p.extend(0.3 * (5.0 * p.x).sin() * (3.0 * p.y).cos())
        })
        .collect();
    let simplices = (0..n * n)
        .flat_map(|i| {
            let a = i / n * m + i % n;
            [[a, a + 1, a + m + 1], [a, a + m + 1, a + m]]
        })
        .collect();
    let uv = (0..m * m)
        .map(|i| {
            let p = at(i);
            let wave = DVec2::new((7.0 * p.y + p.x).sin(), (9.0 * p.x).cos());
            p + fold * wave
        })
        .collect();
    (
        SurfaceMesh {
            positions,
            simplices,
        },
        uv,
    )
}

fn claims(c: &Certificate) -> impl PartialEq + std::fmt::Debug + use<> {
    let crossings: Vec<_> = c.boundary_crossings.clone();
    (
        (
            c.inverted.clone(),
            c.degenerate.clone(),
            crossings,
            c.sheets,
        ),
        (
            c.locally_injective,
            c.globally_injective,
            c.is_disk,
            c.overwound.clone(),
        ),
    )
}

fn assert_close(a: f64, b: f64, tolerance: f64) {
    let same = (a - b).abs() <= tolerance * a.abs().max(b.abs()) || a == b;
    assert!(same, "{a} and {b}");
}

fn assert_measures_close(a: &Certificate, b: &Certificate, tolerance: f64) {
    assert_close(a.symmetric_dirichlet, b.symmetric_dirichlet, tolerance);
    assert_close(a.smallest_sigma, b.smallest_sigma, tolerance);
    assert_close(a.largest_sigma, b.largest_sigma, tolerance);
    assert_close(a.worst_anisotropy, b.worst_anisotropy, tolerance);
}

#[test]
fn an_isometry_has_energy_one() {
    let (mut mesh, _) = bumpy(12, 0.0);
    mesh.positions.iter_mut().for_each(|p| p.z = 0.0);
    let turn = DVec2::from_angle(0.7);
    let uv: Vec<DVec2> = mesh
        .positions
        .iter()
        .map(|p| turn.rotate(p.truncate()) + DVec2::new(3.0, -1.0))
        .collect();
    let c = Certificate::of_map(&mesh, &uv);
    assert!(c.globally_injective && c.is_disk && c.locally_injective);
    assert_close(c.symmetric_dirichlet, 1.0, 1e-12);
    assert_close(c.smallest_sigma, 1.0, 1e-12);
    assert_close(c.largest_sigma, 1.0, 1e-12);
    assert!(
        c.summary().contains("injective (proven exactly)"),
        "{}",
        c.summary()
    );
    // Stretched by two: ψ = 2 (4 + 1/4), E = (8.5 − 4)/4 + 1.
    let twice: Vec<DVec2> = uv.iter().map(|p| 2.0 * *p).collect();
    assert_close(
        Certificate::of_map(&mesh, &twice).symmetric_dirichlet,
        2.125,
        1e-12,
    );
}

#[test]
fn scale_of_everything_changes_nothing() {
    for fold in [0.01, 0.05, 0.3] {
        let (mesh, uv) = bumpy(20, fold);
        let c = Certificate::of_map(&mesh, &uv);
        for s in [1e-3, 0.25, 7.0, 1e3, 2f64.powi(-700), 2f64.powi(600)] {
            let scaled = SurfaceMesh {
                positions: mesh.positions.iter().map(|p| *p * s).collect(),
                simplices: mesh.simplices.clone(),
            };
            let map: Vec<DVec2> = uv.iter().map(|p| *p * s).collect();
            let d = Certificate::of_map(&scaled, &map);
            assert_eq!(claims(&c), claims(&d));
            assert_measures_close(&c, &d, 1e-11);
        }
    }
}

#[test]
fn rotation_by_right_angles_is_exact() {
    for fold in [0.02, 0.2] {
        let (mesh, uv) = bumpy(20, fold);
        let c = Certificate::of_map(&mesh, &uv);
        let turned: Vec<DVec2> = uv.iter().map(|p| p.perp()).collect();
        let d = Certificate::of_map(&mesh, &turned);
        assert_eq!(claims(&c), claims(&d));
        assert_measures_close(&c, &d, 1e-13);
    }
}

#[test]
fn rotation_in_general_is_good_to_rounding() {
    let (mesh, uv) = bumpy(20, 0.03);
    let c = Certificate::of_map(&mesh, &uv);
    assert!(c.globally_injective);
    for angle in [0.1, 1.0, 2.5, 5.0] {
        let r = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, angle);
        let rotated = SurfaceMesh {
            positions: mesh.positions.iter().map(|p| r * *p).collect(),
            simplices: mesh.simplices.clone(),
        };
        let map: Vec<DVec2> = uv
            .iter()
            .map(|p| DVec2::from_angle(-angle).rotate(*p))
            .collect();
        let d = Certificate::of_map(&rotated, &map);
        assert_eq!(claims(&c), claims(&d));
        assert_measures_close(&c, &d, 1e-11);
    }
}

#[test]
fn order_of_vertices_and_triangles_does_not_matter() {
    for fold in [0.03, 0.2] {
        let (mesh, uv) = bumpy(15, fold);
        let c = Certificate::of_map(&mesh, &uv);
        let n = uv.len() as u32;
        // v ↦ 7v + 3 mod 256 is a permutation of the 256 vertices.
        let to = |v: u32| (7 * v + 3) % n;
        let mut permuted = mesh.clone();
        let mut map = uv.clone();
        for v in 0..n {
            permuted.positions[to(v) as usize] = mesh.positions[v as usize];
            map[to(v) as usize] = uv[v as usize];
        }
        permuted.simplices = mesh
            .simplices
            .iter()
            .enumerate()
            .map(|(i, t)| {
                let mut t = t.map(to);
                t.rotate_left(i % 3);
                t
            })
            .collect();
        let d = Certificate::of_map(&permuted, &map);
        assert_eq!((&c.inverted, &c.degenerate), (&d.inverted, &d.degenerate));
        assert_eq!(c.boundary_crossing_count, d.boundary_crossing_count);
        assert_eq!(c.globally_injective, d.globally_injective);
        assert_measures_close(&c, &d, 1e-11);
        permuted.simplices.reverse();
        let e = Certificate::of_map(&permuted, &map);
        let last = mesh.simplices.len() as u32 - 1;
        let mirrored: Vec<u32> = e.inverted.iter().rev().map(|i| last - i).collect();
        assert_eq!(c.inverted, mirrored);
        assert_eq!(d.boundary_crossings, e.boundary_crossings);
    }
}

#[test]
fn a_mirrored_map_is_called_mirrored() {
    let (mesh, uv) = bumpy(10, 0.02);
    let c = Certificate::of_map(&mesh, &uv);
    let mirror: Vec<DVec2> = uv.iter().map(|p| DVec2::new(p.y, p.x)).collect();
    let d = Certificate::of_map(&mesh, &mirror);
    assert!(d.mirrored && !c.mirrored && d.inverted.len() == 200);
    assert!(d.locally_injective && d.globally_injective);
    assert_measures_close(&c, &d, 1e-12);
    assert!(d.summary().contains("mirrored"), "{}", d.summary());
}

/// A U of seven quads whose arms end `gap` apart at the right: arms along y = 0..1 and 1+gap..2+gap.
fn arms(gap: f64) -> (SurfaceMesh, Vec<DVec2>) {
    let (low, high) = (1.0, 1.0 + gap);
    let uv = vec![
        DVec2::new(4.0, 0.0),
        DVec2::new(4.0, low),
        DVec2::new(1.0, 0.0),
        DVec2::new(1.0, 0.5),
        DVec2::new(0.0, 0.5),
        DVec2::new(0.5, 1.0 + gap / 2.0),
        DVec2::new(0.0, 1.5),
        DVec2::new(1.0, 1.5),
        DVec2::new(1.0, 3.0),
        DVec2::new(4.0, high),
        DVec2::new(4.0, 3.0),
    ];
    let simplices = vec![
        [2, 0, 1],
        [2, 1, 3],
        [2, 3, 4],
        [4, 3, 5],
        [4, 5, 6],
        [6, 5, 7],
        [6, 7, 8],
        [8, 7, 9],
        [8, 9, 10],
    ];
    let positions = uv.iter().map(|p| p.extend(0.0)).collect();
    (
        SurfaceMesh {
            positions,
            simplices,
        },
        uv,
    )
}

#[test]
fn one_ulp_between_two_arms_decides() {
    let at = |high: f64| {
        let (mesh, mut uv) = arms(0.5);
        uv[9].y = high;
        Certificate::of_map(&mesh, &uv)
    };
    let open = at(1.0f64.next_up());
    assert!(open.globally_injective, "{open:#?}");
    let touch = at(1.0);
    assert!(touch.locally_injective && !touch.globally_injective);
    assert!(
        touch
            .boundary_crossings
            .iter()
            .all(|c| c.kind == CrossingKind::Touch)
    );
    assert_eq!(
        touch.boundary_crossing_count, 4,
        "{:?}",
        touch.boundary_crossings
    );
    let cross = at(1.0f64.next_down());
    assert!(
        cross
            .boundary_crossings
            .iter()
            .any(|c| c.kind == CrossingKind::Proper)
    );
}

#[test]
fn one_ulp_turns_a_triangle_over() {
    let (mesh, mut uv) = bumpy(1, 0.0);
    // Triangle 0 is 0, 1, 3.
    (uv[0], uv[1]) = (DVec2::new(0.1, 0.1), DVec2::new(0.7, 0.7));
    for (y, inverted, degenerate) in [
        (0.3f64, 0, 1),
        (0.3f64.next_down(), 1, 0),
        (0.3f64.next_up(), 0, 0),
    ] {
        uv[3] = DVec2::new(0.3, y);
        uv[2] = DVec2::new(0.0, 1.0);
        let c = Certificate::of_map(&mesh, &uv);
        let first = |list: &[u32]| list.iter().filter(|&&i| i == 0).count();
        assert_eq!(
            (first(&c.inverted), first(&c.degenerate)),
            (inverted, degenerate)
        );
        assert_eq!(
            c.smallest_sigma > 0.0,
            inverted + degenerate == 0 && c.inverted.is_empty()
        );
    }
}

#[test]
fn maps_that_are_hardly_maps() {
    let (mesh, mut uv) = bumpy(3, 0.0);
    // All in one point.
    let c = Certificate::of_map(&mesh, &vec![DVec2::ONE; uv.len()]);
    assert_eq!((c.degenerate.len(), c.boundary_crossing_count), (18, 66));
    assert!(c.symmetric_dirichlet.is_infinite() && c.smallest_sigma == 0.0 && !c.locally_injective);
    // A coordinate that is not a number.
    uv[5].x = f64::NAN;
    let c = Certificate::of_map(&mesh, &uv);
    assert_eq!(c.degenerate.len(), 6);
    assert!(!c.locally_injective && !c.globally_injective && c.summary().contains("undefined"));
    // Nothing at all.
    let c = Certificate::of_map(&SurfaceMesh::default(), &[]);
    assert!(!c.globally_injective && c.elements == 0 && c.symmetric_dirichlet.is_nan());
    // Arguments that do not fit.
    let error = Certificate::try_of_map(&mesh, &uv[1..]).expect_err("too short");
    assert_eq!(error.code(), "wrong-length");
    let mut bad = mesh;
    bad.simplices[4][1] = 99;
    let error = Certificate::try_of_map(&bad, &uv).expect_err("no such vertex");
    assert_eq!(error.code(), "index-out-of-range");
}

proptest! {
    #[test]
    fn random_maps_of_any_scale(seed in prop::collection::vec(-1.0f64..1.0, 32), s in -10i32..10) {
        let (mesh, uv) = bumpy(3, 0.0);
        let uv: Vec<DVec2> = uv.iter().zip(seed.chunks(2)).map(|(p, d)| *p + 0.2 * DVec2::new(d[0], d[1])).collect();
        let c = Certificate::of_map(&mesh, &uv);
        let scaled: Vec<DVec2> = uv.iter().map(|p| *p * 2f64.powi(s)).collect();
        let d = Certificate::of_map(&mesh, &scaled);
        prop_assert_eq!(claims(&c), claims(&d));
        // The claims imply each other.
        prop_assert!(!c.globally_injective || c.locally_injective);
        prop_assert!(!c.locally_injective || c.inverted.is_empty() || c.mirrored);
        prop_assert!(c.globally_injective == (c.locally_injective && c.boundary_crossing_count == 0));
    }
}
