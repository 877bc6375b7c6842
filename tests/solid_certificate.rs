//! The certificate of a solid: each way in which a deformation can fail to be injective.

use foldfree::certificate::SolidCertificate;
use foldfree::mesh::SolidMesh;
use glam::{DMat3, DVec3, Vec3Swizzles};

mod bar;
use bar::bar;

/// `n` vertices around the edge (0, 1), which is vertical, `turns` turns of it in all; a closed ring of n
/// tetrahedra, or a fan of n − 1.
fn around(n: usize, turns: f64, closed: bool) -> SolidMesh {
    let mut positions = vec![DVec3::ZERO, DVec3::Z];
    let tetrahedra = if closed { n } else { n - 1 };
    positions.extend((0..n).map(|i| {
        let angle = std::f64::consts::TAU * turns * i as f64 / tetrahedra as f64;
        DVec3::new(angle.cos(), angle.sin(), 0.5)
    }));
    let vertex = |i: usize| 2 + (i % n) as u32;
    SolidMesh {
        positions,
        simplices: (0..tetrahedra)
            .map(|i| [0, 1, vertex(i), vertex(i + 1)])
            .collect(),
    }
}

/// The tetrahedra over a strip of n quads, which goes around the z axis, with their tip in the origin: a
/// snail's shell. Of the sides of the strip one is at height 1, the other outside and higher by `rise` a
/// turn.
fn shell(n: usize, turns: f64, rise: f64) -> SolidMesh {
    let mut positions = vec![DVec3::ZERO];
    for i in 0..=n {
        let angle = std::f64::consts::TAU * turns * i as f64 / n as f64;
        let height = 1.0 + rise * turns * i as f64 / n as f64;
        for (radius, height) in [(1.0, height), (1.0, height + 0.5)] {
            positions.push(DVec3::new(
                radius * angle.cos(),
                radius * angle.sin(),
                height,
            ));
        }
    }
    let simplices = (0..n as u32)
        .flat_map(|i| {
            let [a, b, c, d] = [1, 2, 3, 4].map(|k| 2 * i + k);
            [[0, a, c, b], [0, b, c, d]]
        })
        .collect();
    SolidMesh {
        positions,
        simplices,
    }
}

fn undeformed(mesh: &SolidMesh) -> SolidCertificate {
    SolidCertificate::of_solid(mesh, &mesh.positions)
}

#[test]
fn a_bar_that_is_twisted_and_bent_stays_injective() {
    let mesh = bar(8, 3);
    let bent: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|p| {
            let turned = DMat3::from_rotation_x(0.6 * p.x) * (*p - DVec3::new(0.0, 0.5, 0.5));
            DMat3::from_rotation_z(-0.3 * p.x) * (turned + DVec3::new(0.0, 4.0, 0.0))
        })
        .collect();
    for positions in [&mesh.positions, &bent] {
        let c = SolidCertificate::of_solid(&mesh, positions);
        assert!(c.locally_injective && c.is_free_of_folds(), "{c:#?}");
        assert_eq!(c.elements, 8 * 9 * 5);
        assert_eq!(c.boundary_faces, 2 * 2 * (9 + 24 + 24));
        assert!(c.summary().contains("0 inverted, 0 degenerate (exact)"));
        assert!(c.summary().contains("proven exactly"), "{}", c.summary());
    }
    let c = undeformed(&mesh);
    assert!((c.smallest_sigma - 1.0).abs() < 1e-12 && (c.largest_sigma - 1.0).abs() < 1e-12);
    let stretched: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|p| *p * DVec3::new(2.0, 0.5, 1.0))
        .collect();
    let c = SolidCertificate::of_solid(&mesh, &stretched);
    assert!((c.smallest_sigma - 0.5).abs() < 1e-12 && (c.largest_sigma - 2.0).abs() < 1e-12);
}

#[test]
fn a_vertex_pushed_through_a_face_inverts_and_one_ulp_decides() {
    let mesh = bar(2, 2);
    // The vertex in the middle, moved along x up to the plane of its neighbours and beyond.
    let middle = mesh
        .positions
        .iter()
        .position(|p| *p == DVec3::new(0.5, 0.5, 0.5))
        .expect("middle");
    let at = |x: f64| {
        let mut positions = mesh.positions.clone();
        positions[middle].x = x;
        SolidCertificate::of_solid(&mesh, &positions)
    };
    assert!(at(0.75).locally_injective);
    let folded = at(1.25);
    assert!(!folded.inverted.is_empty() && folded.degenerate.is_empty());
    assert!(!folded.is_free_of_folds() && !folded.locally_injective && !folded.mirrored);
    assert!(folded.smallest_sigma < 0.0 && folded.summary().contains("The map folds."));
    assert!(folded.overwound_edges.is_empty());
    // Bisect to the last injective place.
    let (mut good, mut bad) = (0.75f64, 1.25f64);
    while good.next_up() < bad {
        let x = 0.5 * (good + bad);
        if at(x).is_free_of_folds() {
            good = x;
        } else {
            bad = x;
        }
    }
    let (good, bad) = (at(good), at(bad));
    assert!(good.locally_injective && good.smallest_sigma > 0.0);
    assert!(!bad.degenerate.is_empty() && bad.inverted.is_empty() && bad.smallest_sigma == 0.0);
}

#[test]
fn an_edge_wound_twice_is_seen_though_all_tetrahedra_are_positive() {
    for n in [5, 6, 8, 9, 17] {
        let rest = around(n, 1.0, true);
        assert!(undeformed(&rest).locally_injective, "{n}");
        let twice = around(n, 2.0, true);
        let c = SolidCertificate::of_solid(&rest, &twice.positions);
        assert!(c.inverted.is_empty() && c.degenerate.is_empty() && c.is_free_of_folds());
        assert_eq!(
            (&c.overwound_edges[..], c.overwound_inside),
            (&[[0, 1]][..], 1),
            "{n}"
        );
        assert!(!c.locally_injective);
        assert!(c.summary().contains("1 inner edge"), "{}", c.summary());
    }
    let c = SolidCertificate::of_solid(&around(8, 1.0, true), &around(8, 3.0, true).positions);
    assert_eq!(c.overwound_edges, [[0, 1]]);
}

#[test]
fn a_fan_may_reach_around_its_edge_but_not_touch_itself() {
    let rest = around(9, 0.5, false);
    let at = |turns: f64| SolidCertificate::of_solid(&rest, &around(9, turns, false).positions);
    assert!(at(0.2).locally_injective && at(0.999).locally_injective);
    let over = at(1.001);
    assert_eq!(
        (&over.overwound_edges[..], over.overwound_inside),
        (&[[0, 1]][..], 0)
    );
    assert!(over.is_free_of_folds() && !over.locally_injective);
    assert_eq!(at(1.9).overwound_edges, [[0, 1]]);
    assert!(
        over.summary().contains("1 boundary edge"),
        "{}",
        over.summary()
    );
    // Closed up exactly: first and last face lie on each other.
    let mut closed = around(9, 1.0, false);
    closed.positions[10] = closed.positions[2];
    let touching = SolidCertificate::of_solid(&rest, &closed.positions);
    assert_eq!(touching.overwound_edges, [[0, 1]]);
    // One ulp apart it is fine.
    closed.positions[10].y = -f64::from_bits(1);
    let apart = SolidCertificate::of_solid(&rest, &closed.positions);
    assert!(apart.locally_injective, "{apart:#?}");
    // The same length along the face does not matter.
    closed.positions[10] = DVec3::new(3.0, 0.0, 0.25);
    let touching = SolidCertificate::of_solid(&rest, &closed.positions);
    assert_eq!(touching.overwound_edges, [[0, 1]]);
}

#[test]
fn a_shell_that_laps_over_itself_at_its_tip_is_seen_at_the_vertex_alone() {
    let rest = shell(40, 0.5, 1.0);
    assert!(undeformed(&rest).locally_injective);
    // A turn and a half: apart when it rises by more than its width, overlapping when by less.
    let apart = SolidCertificate::of_solid(&rest, &shell(40, 1.5, 1.0).positions);
    assert!(apart.locally_injective, "{}", apart.summary());
    let over = SolidCertificate::of_solid(&rest, &shell(40, 1.5, 0.25).positions);
    assert!(over.overwound_edges.is_empty() && over.is_free_of_folds());
    assert_eq!(over.overwound_vertices, [0]);
    assert!(!over.locally_injective && over.summary().contains("1 boundary vertex overlap"));
    // When the upper side of the strip begins a turn later exactly where the lower side began, they touch.
    let mut shell = shell(8, 1.5, 0.5);
    for i in 0..=8 {
        // Six quads a turn: the seventh begins over the first.
        let (x, y) = [(2, 0), (1, 2), (-1, 2), (-2, 0), (-1, -2), (1, -2)][i % 6];
        for side in 0..2 {
            let height = 6.0 + 0.5 * i as f64 + 3.0 * side as f64;
            shell.positions[1 + 2 * i + side] = DVec3::new(f64::from(x), f64::from(y), height);
        }
    }
    let rest = self::shell(8, 0.5, 1.0);
    let touching = SolidCertificate::of_solid(&rest, &shell.positions);
    assert!(touching.is_free_of_folds() && touching.overwound_edges.is_empty());
    assert_eq!(touching.overwound_vertices, [0]);
    // A little higher a turn it is apart, by as little as one likes.
    for i in 6..=8 {
        for side in 0..2 {
            let z = &mut shell.positions[1 + 2 * i + side].z;
            *z = z.next_up();
        }
    }
    let apart = SolidCertificate::of_solid(&rest, &shell.positions);
    assert!(apart.locally_injective, "{apart:#?}");
}

#[test]
fn which_orientation_is_positive_follows_the_rest_shape() {
    let mesh = bar(4, 2);
    let positions: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|p| *p + 0.1 * p.yzx() * p.x)
        .collect();
    let expected = SolidCertificate::of_solid(&mesh, &positions);
    assert!(expected.locally_injective);
    // Inside out as a whole, or here and there: the map is the same.
    for step in [1, 2, 3] {
        let mut turned = mesh.clone();
        for t in turned.simplices.iter_mut().step_by(step) {
            t.swap(0, 2);
        }
        let c = SolidCertificate::of_solid(&turned, &positions);
        assert!((c.smallest_sigma - expected.smallest_sigma).abs() < 1e-13);
        let c = SolidCertificate {
            smallest_sigma: expected.smallest_sigma,
            largest_sigma: expected.largest_sigma,
            ..c
        };
        assert_eq!(c, expected);
    }
    // A mirror image is another map.
    let mirror: Vec<DVec3> = positions
        .iter()
        .map(|p| DVec3::new(-p.x, p.y, p.z))
        .collect();
    let c = SolidCertificate::of_solid(&mesh, &mirror);
    assert!(c.mirrored && c.inverted.len() == mesh.simplices.len());
    assert!(!c.locally_injective && !c.is_free_of_folds() && c.smallest_sigma < 0.0);
    assert!(c.summary().contains("mirrored"), "{}", c.summary());
    // Of a rest shape that is mirrored as well it is the deformation.
    let rest = SolidMesh {
        positions: mesh
            .positions
            .iter()
            .map(|p| DVec3::new(-p.x, p.y, p.z))
            .collect(),
        simplices: mesh.simplices,
    };
    let c = SolidCertificate::of_solid(&rest, &mirror);
    assert!(c.locally_injective && !c.mirrored);
}

#[test]
fn solids_that_are_no_manifold() {
    let mut mesh = bar(2, 1);
    // A tetrahedron that hangs on an edge, and one on a vertex; one on the far side of an inner face.
    let corner = mesh.positions.len() as u32;
    mesh.positions.extend([
        DVec3::new(-1.0, 0.0, 0.0),
        DVec3::new(-1.0, -1.0, 0.5),
        DVec3::splat(-2.0),
    ]);
    let edge = mesh.simplices[0];
    let mut hanging = mesh.clone();
    hanging
        .simplices
        .push([edge[0], corner, corner + 1, corner + 2]);
    let c = undeformed(&hanging);
    assert_eq!(c.irregular_vertices, [edge[0]]);
    assert!(c.is_free_of_folds() && !c.locally_injective && c.irregular_faces.is_empty());
    assert!(
        c.summary().contains("no manifold at 1 vertex"),
        "{}",
        c.summary()
    );
    let mut doubled = mesh.clone();
    doubled.simplices.push(mesh.simplices[3]);
    let c = undeformed(&doubled);
    assert_eq!(c.irregular_faces.len(), 4);
    assert!(!c.is_free_of_folds() && c.inverted.is_empty());
    // A rest shape that is folded already: two tetrahedra on one side of a face, whatever their order.
    let folded = SolidMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE],
        simplices: vec![[0, 1, 2, 3], [1, 0, 2, 4]],
    };
    let c = undeformed(&folded);
    assert_eq!(c.irregular_faces, [[0, 1, 2]]);
    assert!(!c.is_free_of_folds());
}

#[test]
fn what_has_no_volume() {
    let mesh = bar(2, 1);
    // Flat once deformed.
    let flat: Vec<DVec3> = mesh.positions.iter().map(|p| p.with_z(0.0)).collect();
    let c = SolidCertificate::of_solid(&mesh, &flat);
    assert_eq!(c.degenerate, (0..10).collect::<Vec<u32>>());
    assert!(c.smallest_sigma == 0.0 && !c.mirrored && !c.is_free_of_folds());
    // Flat at rest.
    let rest = SolidMesh {
        positions: flat,
        simplices: mesh.simplices.clone(),
    };
    let c = SolidCertificate::of_solid(&rest, &mesh.positions);
    assert_eq!(c.flat_at_rest.len(), 10);
    assert!(c.smallest_sigma.is_nan() && !c.is_free_of_folds() && !c.locally_injective);
    // One vertex twice in a tetrahedron.
    let mut repeated = mesh.clone();
    repeated.simplices[4][1] = repeated.simplices[4][0];
    let c = undeformed(&repeated);
    assert_eq!(c.flat_at_rest, [4]);
    assert!(!c.is_free_of_folds() && c.degenerate.is_empty());
    assert!(
        c.summary().contains("1 without volume at rest"),
        "{}",
        c.summary()
    );
    // A coordinate that is not a number.
    for bad in [f64::NAN, f64::INFINITY] {
        let mut positions = mesh.positions.clone();
        positions[0].y = bad;
        let c = SolidCertificate::of_solid(&mesh, &positions);
        let expected: Vec<u32> = (0..10)
            .filter(|&i| mesh.simplices[i as usize].contains(&0))
            .collect();
        assert_eq!(c.degenerate, expected);
        assert!(c.smallest_sigma.is_nan() && !c.locally_injective && c.inverted.is_empty());
    }
    // Nothing at all.
    let c = undeformed(&SolidMesh::default());
    assert!(c.elements == 0 && !c.locally_injective && !c.is_free_of_folds() && !c.mirrored);
    assert!(c.summary().contains("nothing to map"), "{}", c.summary());
}

#[test]
fn arguments_that_do_not_fit() {
    let mut mesh = bar(2, 1);
    let error = SolidCertificate::try_of_solid(&mesh, &mesh.positions[1..]).expect_err("too short");
    assert_eq!(error.code(), "wrong-length");
    mesh.simplices[3][2] = 99;
    let error = SolidCertificate::try_of_solid(&mesh, &mesh.positions).expect_err("no such vertex");
    assert_eq!(error.code(), "index-out-of-range");
}
