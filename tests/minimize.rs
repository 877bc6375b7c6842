//! Once GINI has converged, Newton's method lowers the energy, and the map stays as injective as it was.

mod overlap_problems;
mod untangle_problems;

use foldfree::certificate::Certificate;
use foldfree::deformation::{Material, Target, Untangling, UntanglingOptions};
use foldfree::gini::GiniOptions;
use foldfree::mesh::{SolidMesh, SolidShape};
use foldfree::newton::NewtonOptions;
use foldfree::optim::{Criterion, Status};
use foldfree::{collision, geometry::RestShape};
use glam::{DVec2, DVec3};
use overlap_problems::{
    Moves, block, cubes, interlocked_arms, interlocked_arms_in_the_plane, point,
};
use untangle_problems::{Bend, Inside, solid};

fn options(gini: GiniOptions) -> UntanglingOptions {
    UntanglingOptions {
        gini,
        minimize: Some(NewtonOptions {
            tolerance: 1e-8,
            max_iterations: 300,
            ..Default::default()
        }),
    }
}

fn settled() -> GiniOptions {
    GiniOptions {
        settle: 0.01,
        ..GiniOptions::overlap()
    }
}

/// Pairs of facets of the boundary that meet, exactly.
fn meeting(rest: &SolidMesh, x: &[DVec3]) -> usize {
    let (shape, _) = RestShape::of_solid(rest).expect("a solid");
    let boundary = collision::Boundary::<3>::new(&shape.vertices).expect("a boundary");
    let x: Vec<[f64; 3]> = x.iter().map(DVec3::to_array).collect();
    collision::intersections(&boundary, &x, &mut collision::BroadPhase::default(), 10).len()
}

/// Steps to the end; the energies after the hand-over, of which none is above the one before.
fn run(u: &mut Untangling, mut look: impl FnMut(&Untangling)) -> Vec<f64> {
    let mut energies = Vec::new();
    while u.solver().status() == Status::Running {
        let report = u.step().expect("a step");
        if report.switched_at.is_some() {
            assert_eq!(report.inverted, 0);
            energies.push(report.energy);
            look(u);
        }
    }
    assert!(energies.is_sorted_by(|a, b| a >= b), "{energies:?}");
    energies
}

#[test]
fn a_held_solid_comes_to_the_minimum() {
    let t = solid(SolidShape::Box, 1500, Bend::Twisted, Inside::Random);
    for material in [
        Material::SymmetricDirichlet,
        Material::NeoHookean {
            young: 1.0,
            poisson: 0.4,
        },
    ] {
        let options = options(GiniOptions::default());
        let mut u = Untangling::of_solid(&t.rest, &t.start, &t.pins, &[], material, options)
            .expect("a solid");
        let energies = run(&mut u, |u| assert!(u.outcome().not_positive.is_empty()));
        assert!(energies.len() > 2, "{material:?}: {energies:?}");
        assert!(
            energies[energies.len() - 1] < 0.9 * energies[0],
            "{energies:?}"
        );
        assert!(
            matches!(
                u.solver().status(),
                Status::Converged(Criterion::EnergyChange | Criterion::GradientNorm)
            ),
            "{material:?}: {:?}",
            u.solver().status()
        );
    }
}

#[test]
fn bodies_stay_apart() {
    let problem = interlocked_arms(1);
    let Moves {
        rest, start, pins, ..
    } = &problem;
    let material = Material::NeoHookean {
        young: 1.0,
        poisson: 0.4,
    };
    let options = options(settled());
    let mut u = Untangling::of_solid(rest, start, pins, &[], material, options).expect("free");
    for pins in &problem.moves {
        // GINI goes on from where Newton's method has ended
        let before = u.positions();
        u.move_pins(pins).expect("pins");
        assert_eq!(u.positions(), before);
        let energies = run(&mut u, |u| assert_eq!(meeting(rest, &u.positions()), 0));
        assert!(!energies.is_empty(), "{:?}", u.solver().report());
        assert_eq!(u.outcome().globally_injective, Some(true));
        for &(vertex, position) in pins {
            assert_eq!(u.positions()[vertex as usize], position);
        }
    }
}

#[test]
fn triangles_do_too() {
    let problem = interlocked_arms_in_the_plane(2);
    let Moves {
        rest, start, pins, ..
    } = &problem;
    let options = options(settled());
    let material = Material::SymmetricDirichlet;
    let mut u = Untangling::of_plane(rest, start, pins, &[], material, options).expect("free");
    u.move_pins(&problem.moves[0]).expect("pins");
    let energies = run(&mut u, |u| {
        let uv: Vec<DVec2> = u.positions().iter().map(|p| p.truncate()).collect();
        assert!(Certificate::of_map(rest, &uv).globally_injective);
    });
    assert!(energies.len() > 1);
    assert_eq!(u.outcome().globally_injective, Some(true));
}

#[test]
fn energies_whose_minima_fold_are_refused() {
    let t = solid(SolidShape::Box, 500, Bend::Bent, Inside::Random);
    for material in [Material::Arap, Material::Dirichlet] {
        let options = options(GiniOptions::default());
        let made = Untangling::of_solid(&t.rest, &t.start, &t.pins, &[], material, options);
        let error = made.map(|_| ()).expect_err("folds").to_string();
        assert!(
            error.contains("minimize") && error.contains("fold"),
            "{error}"
        );
    }
}

/// Two boxes, one above the other, that are to go where the other is.
fn pressed(shift: DVec3) -> (SolidMesh, Vec<Target>) {
    let mut cells = block([0, 0, 0], [3, 2, 1], 2, 0);
    cells.extend(block([0, 0, 1], [3, 2, 2], 2, 1));
    let rest = cubes(&cells, |at, part| {
        point(at, 2) + DVec3::new(0.05, 0.08, 0.1) * f64::from(part) + shift
    });
    let ends: Vec<(u32, f64)> = (0..)
        .zip(&rest.positions)
        .filter_map(|(v, p)| match p.z - shift.z {
            z if z < 0.01 => Some((v, 0.2)),
            z if z > 2.05 => Some((v, -0.2)),
            _ => None,
        })
        .collect();
    let target = |&(vertex, up): &(u32, f64)| Target {
        vertex,
        position: rest.positions[vertex as usize] + up * DVec3::Z,
    };
    let targets = ends.iter().map(target).collect();
    (rest, targets)
}

#[test]
fn what_presses_stalls_and_still_does_not_meet() {
    for shift in [DVec3::ZERO, DVec3::new(3e4, -1e4, 2e4)] {
        let (rest, targets) = pressed(shift);
        let options = options(GiniOptions {
            settle: 0.1,
            target_stiffness: 1e-2,
            ..GiniOptions::overlap()
        });
        let material = Material::NeoHookean {
            young: 1.0,
            poisson: 0.4,
        };
        let start = &rest.positions;
        let mut u =
            Untangling::of_solid(&rest, start, &[], &targets, material, options).expect("apart");
        let energies = run(&mut u, |u| {
            let outcome = u.outcome();
            assert_eq!(outcome.globally_injective, Some(true), "{outcome:?}");
        });
        assert!(energies.len() > 1, "{:?}", u.solver().report());
        let report = u.solver().report();
        assert_eq!(report.status, Status::Stalled, "{report:?}");
        assert!(report.gradient_norm > 0.0);
        assert!(report.gini.is_none() && u.trace().is_empty() && u.quadratic_trace().is_empty());
    }
}

#[test]
fn pins_that_cannot_be_moved_change_nothing() {
    let problem = interlocked_arms(1);
    let (rest, start, pins) = (&problem.rest, &problem.start, &problem.pins);
    let material = Material::StableNeoHookean {
        young: 1.0,
        poisson: 0.4,
    };
    let mut u =
        Untangling::of_solid(rest, start, pins, &[], material, options(settled())).expect("apart");
    u.move_pins(&problem.moves[0]).expect("pins");
    run(&mut u, |_| {});
    let before = (u.positions(), u.solver().report().clone());
    let free = (0..).find(|v| !pins.contains(v)).expect("a free vertex");
    let error = u.move_pins(&[(pins[0], DVec3::ZERO), (free, DVec3::ZERO)]);
    assert!(error.is_err());
    assert_eq!(before, (u.positions(), u.solver().report().clone()));
    // the clock goes on from there
    u.move_pins(&[(pins[0], start[pins[0] as usize])])
        .expect("a pin");
    assert!(u.solver().report().seconds >= before.1.seconds);
    assert!((u.solver().report().energy / before.1.energy - 1.0).abs() < 1e-6);
}
