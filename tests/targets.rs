//! Handles: pins that move and springs that pull, also while the solver runs.

use foldfree::deformation::{Deformation, DeformationMethod, DeformationOptions, Material, Target};
use foldfree::optim::{Field, Status};
use glam::{DMat3, DVec3};

mod bar;
use bar::bar;

fn options() -> DeformationOptions {
    DeformationOptions {
        material: Material::NeoHookean {
            young: 1e3,
            poisson: 0.4,
        },
        tolerance: 1e-14,
        ..Default::default()
    }
}

fn run(deformation: &mut Deformation) -> usize {
    let first = deformation.solver().report().iteration;
    while deformation.solver().status() == Status::Running {
        deformation.step().unwrap();
    }
    let status = deformation.solver().status();
    assert!(matches!(status, Status::Converged(_)), "{status:?}");
    deformation.solver().report().iteration - first
}

/// Vertices of the bar with this x.
fn slab(positions: &[DVec3], x: f64) -> Vec<u32> {
    let at = |&v: &u32| positions[v as usize].x == x;
    (0..positions.len() as u32).filter(at).collect()
}

/// Targets that take these vertices through a motion.
fn targets(positions: &[DVec3], vertices: &[u32], motion: impl Fn(DVec3) -> DVec3) -> Vec<Target> {
    let target = |&vertex: &u32| Target {
        vertex,
        position: motion(positions[vertex as usize]),
    };
    vertices.iter().map(target).collect()
}

fn apart(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |most, (p, q)| most.max(p.distance(*q)))
}

#[test]
fn springs_alone_carry_a_body_away_without_strain() {
    let mesh = bar(4, 2);
    let turn = DMat3::from_rotation_z(0.7);
    let motion = |p: DVec3| turn * p + DVec3::new(5.0, -2.0, 1.0);
    let corners = [0, 4, 10, 44];
    let targets = targets(&mesh.positions, &corners, motion);
    let mut body =
        Deformation::with_targets(&mesh, &mesh.positions, &[], &targets, &options()).unwrap();
    run(&mut body);
    let expected: Vec<DVec3> = mesh.positions.iter().map(|&p| motion(p)).collect();
    assert!(apart(&body.positions(), &expected) < 1e-5);
    assert!(body.solver().report().energy < 1e-8);
}

#[test]
fn a_moved_pin_leads_where_a_fresh_start_does() {
    for method in [
        DeformationMethod::Wrapd,
        DeformationMethod::AdmmPd,
        DeformationMethod::Lbfgs,
    ] {
        moved_pin(method);
    }
}

fn moved_pin(method: DeformationMethod) {
    let options = DeformationOptions {
        method,
        ..options()
    };
    let mesh = bar(5, 2);
    let (left, right) = (slab(&mesh.positions, 0.0), slab(&mesh.positions, 2.5));
    let pins: Vec<u32> = left.iter().chain(&right).copied().collect();
    let motion = |p: DVec3| {
        let centre = DVec3::new(0.0, 0.5, 0.5);
        DMat3::from_rotation_x(0.8) * (p - centre) + centre + 0.3 * DVec3::X
    };
    let moved = targets(&mesh.positions, &right, motion);
    let mut dragged = Deformation::new(&mesh, &mesh.positions, &pins, &options).unwrap();
    run(&mut dragged);
    dragged.set_targets(&moved).unwrap();
    assert_eq!(dragged.solver().status(), Status::Running);
    for target in &moved {
        // the pins are there at once
        assert_eq!(dragged.positions()[target.vertex as usize], target.position);
    }
    run(&mut dragged);

    let mut start = mesh.positions.clone();
    for target in &moved {
        start[target.vertex as usize] = target.position;
    }
    let mut fresh = Deformation::new(&mesh, &start, &pins, &options).unwrap();
    run(&mut fresh);
    assert!(apart(&dragged.positions(), &fresh.positions()) < 1e-4);
    let [a, b] = [&dragged, &fresh].map(|d| d.solver().report().energy);
    assert!((a - b).abs() < 1e-9 * b, "{a} {b}");
}

#[test]
fn a_spring_pulls_until_its_force_is_the_bodys() {
    let mesh = bar(5, 2);
    let pins = slab(&mesh.positions, 0.0);
    let tip = 5;
    let target = [Target {
        vertex: tip,
        position: mesh.positions[tip as usize] + DVec3::new(0.4, 0.2, 0.1),
    }];
    let mut body = Deformation::new(&mesh, &mesh.positions, &pins, &options()).unwrap();
    body.set_targets(&target).unwrap();
    run(&mut body);
    assert!(body.solver().report().gradient_norm < 1e-4);
    let reached = body.positions()[tip as usize];
    let spring_energy = |k: f64| 0.5 * k * reached.distance_squared(target[0].position);
    // without the spring the force at the tip is what the spring's was: its stiffness follows from
    // the force, and from it the part of the energy
    let with = body.solver().report().energy;
    body.set_targets(&[]).unwrap();
    let report = body.solver().report();
    let stiffness = report.gradient_norm / reached.distance(target[0].position);
    let missing = with - report.energy;
    assert!(
        (missing - spring_energy(stiffness)).abs() < 1e-4 * missing,
        "{missing} {}",
        spring_energy(stiffness)
    );
    // and the body goes back to rest
    run(&mut body);
    assert!(apart(&body.positions(), &mesh.positions) < 1e-4);
}

#[test]
fn harder_springs_come_closer() {
    let mesh = bar(5, 2);
    let pins = slab(&mesh.positions, 0.0);
    let targets = targets(&mesh.positions, &slab(&mesh.positions, 2.5), |p| {
        p + DVec3::new(0.5, 0.3, 0.0)
    });
    let miss = |target_stiffness: f64| {
        let options = DeformationOptions {
            target_stiffness,
            ..options()
        };
        let mut body =
            Deformation::with_targets(&mesh, &mesh.positions, &pins, &targets, &options).unwrap();
        run(&mut body);
        let positions = body.positions();
        let misses = targets
            .iter()
            .map(|t| positions[t.vertex as usize].distance(t.position));
        misses.fold(0.0, f64::max)
    };
    let misses = [0.01, 1.0, 100.0, 1e4].map(miss);
    assert!(misses.is_sorted_by(|a, b| a > b), "{misses:?}");
    assert!(misses[0] > 0.1 && misses[3] < 1e-3, "{misses:?}");
}

#[test]
fn dragging_needs_few_steps_and_never_breaks() {
    let mesh = bar(6, 2);
    let (left, right) = (slab(&mesh.positions, 0.0), slab(&mesh.positions, 3.0));
    let pins: Vec<u32> = left.iter().chain(&right).copied().collect();
    let mut body = Deformation::new(&mesh, &mesh.positions, &pins, &options()).unwrap();
    for frame in 0..60 {
        let t = frame as f64 / 20.0;
        let motion = |p: DVec3| {
            let centre = DVec3::new(0.0, 0.5, 0.5);
            DMat3::from_rotation_x(t) * (p - centre) + centre + 0.2 * t.sin() * DVec3::Y
        };
        body.set_targets(&targets(&mesh.positions, &right, motion))
            .unwrap();
        let report = body.step().unwrap();
        assert_eq!(report.iteration, frame + 1);
        assert!(report.energy.is_finite());
        assert_eq!(report.inverted, 0, "frame {frame}");
    }
    assert!(run(&mut body) < 400);
}

#[test]
fn fields_say_how_a_tetrahedron_is_stretched() {
    let mesh = bar(3, 1);
    let pins = slab(&mesh.positions, 0.0);
    // uniform stretch by 2 along x, of ARAP material: ψ = Σ(σ−1)², t = σ ψ'/J = 2·2·1/2 along x
    let start: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|p| *p * DVec3::new(2.0, 1.0, 1.0))
        .collect();
    let options = DeformationOptions {
        material: Material::Arap,
        ..Default::default()
    };
    let body = Deformation::new(&mesh, &start, &pins, &options).unwrap();
    let expected = [
        (Field::Stretch, 2.0),
        (Field::Stress, 2.0),
        (Field::Distortion, (4.0 + 0.25 + 4.0) / 6.0),
    ];
    for (field, value) in expected {
        let values = body.field(field);
        assert_eq!(values.len(), mesh.simplices.len());
        assert!(
            values.iter().all(|v| (v - value).abs() < 1e-6),
            "{values:?}"
        );
    }
    let mirrored: Vec<DVec3> = start
        .iter()
        .map(|p| *p * DVec3::new(1.0, -1.0, 1.0))
        .collect();
    let body = Deformation::new(&mesh, &mirrored, &pins, &options).unwrap();
    for field in [Field::Stretch, Field::Stress, Field::Distortion] {
        assert!(body.field(field).iter().all(|&v| v == f32::INFINITY));
    }
}

#[test]
fn bad_targets_change_nothing() {
    let mesh = bar(2, 1);
    let n = mesh.positions.len() as u32;
    let at = |vertex: u32, position: DVec3| Target { vertex, position };
    let mut body = Deformation::new(&mesh, &mesh.positions, &[0, 1], &options()).unwrap();
    for (bad, words) in [
        (vec![at(3, DVec3::NAN)], "vertex 3 is not finite"),
        (vec![at(0, DVec3::INFINITY)], "vertex 0 is not finite"),
        (vec![at(n, DVec3::ZERO)], "of 12"),
        (
            vec![at(4, DVec3::ZERO), at(4, DVec3::ONE)],
            "vertex 4 has two targets",
        ),
    ] {
        let error = body.set_targets(&bad).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
        assert_eq!(body.positions(), mesh.positions);
    }
    // without pins the last target may not go
    let held = [at(0, DVec3::ZERO)];
    let mut body =
        Deformation::with_targets(&mesh, &mesh.positions, &[], &held, &options()).unwrap();
    let error = body.set_targets(&[]).unwrap_err().to_string();
    assert!(error.contains("no pin and no target"), "{error}");
    let negative = DeformationOptions {
        target_stiffness: -1.0,
        ..options()
    };
    let refused = Deformation::new(&mesh, &mesh.positions, &[0], &negative);
    assert!(refused.is_err());
}

#[test]
fn the_most_iterations_are_counted_from_the_last_change_of_handles() {
    let mesh = bar(3, 1);
    let pins = slab(&mesh.positions, 0.0);
    for method in [DeformationMethod::Wrapd, DeformationMethod::Lbfgs] {
        let options = DeformationOptions {
            method,
            tolerance: 0.0,
            max_iterations: 5,
            ..options()
        };
        let mut body = Deformation::new(&mesh, &mesh.positions, &pins, &options).unwrap();
        for round in 1..=3 {
            let up = 0.1 * round as f64 * DVec3::Y;
            body.set_targets(&targets(
                &mesh.positions,
                &slab(&mesh.positions, 3.0),
                |p| p + up,
            ))
            .unwrap();
            assert_eq!(body.solver().status(), Status::Running);
            while body.solver().status() == Status::Running {
                body.step().unwrap();
            }
            assert_eq!(body.solver().report().iteration, 5 * round, "{method:?}");
        }
    }
}

#[test]
fn a_barrier_that_handles_break_is_never_called_converged() {
    let mesh = bar(4, 1);
    let (left, right) = (slab(&mesh.positions, 0.0), slab(&mesh.positions, 4.0));
    let pins: Vec<u32> = left.iter().chain(&right).copied().collect();
    let options = DeformationOptions {
        material: Material::SymmetricDirichlet,
        method: DeformationMethod::Lbfgs,
        max_iterations: 100,
        ..options()
    };
    let mut body = Deformation::new(&mesh, &mesh.positions, &pins, &options).unwrap();
    let through = targets(&mesh.positions, &right, |p| p - 6.0 * DVec3::X);
    body.set_targets(&through).unwrap();
    let report = body.solver().report();
    assert!(report.inverted > 0);
    assert_eq!(
        (report.energy, report.gradient_norm),
        (f64::INFINITY, f64::INFINITY)
    );
    while body.solver().status() == Status::Running {
        body.step().unwrap();
    }
    let report = body.solver().report();
    assert!(
        report.inverted == 0 || !matches!(report.status, Status::Converged(_)),
        "{report:?}"
    );
    // back again, it goes on
    body.set_targets(&targets(&mesh.positions, &right, |p| p))
        .unwrap();
    run(&mut body);
    assert_eq!(body.solver().report().inverted, 0);
}
