//! Projected Newton and its hybrid with WRAPD on solids.

mod bar;
mod random;

use bar::{bar, twisted};
use foldfree::Error;
use foldfree::deformation::{
    ClothOptions, Deformation, DeformationMethod, DeformationOptions, Material, Target,
};
use foldfree::energy::SymmetricDirichlet;
use foldfree::geometry::RestShape;
use foldfree::mesh::{Shape, SolidMesh, generate};
use foldfree::newton::NewtonOptions;
use foldfree::optim::{BuildError, Solver, Status, StepReport};
use foldfree::slim::slim;
use foldfree::space::Solid;
use foldfree::wrapd::Problem;
use glam::DVec3;
use random::Random;

const YOUNG: f64 = 1e4;
const POISSON: f64 = 0.4;

fn materials() -> impl Iterator<Item = Material> {
    let named = |name: &&str| Material::named(name, YOUNG, POISSON).unwrap();
    Material::NAMES
        .iter()
        .map(named)
        .collect::<Vec<_>>()
        .into_iter()
}

fn solve(
    mesh: &SolidMesh,
    start: &[DVec3],
    pins: &[u32],
    options: &DeformationOptions,
    steps: usize,
) -> (Deformation, Vec<StepReport>) {
    let mut solid = Deformation::new(mesh, start, pins, options).unwrap();
    let mut reports = vec![solid.solver().report().clone()];
    while solid.solver().status() == Status::Running && reports.len() <= steps {
        reports.push(solid.step().unwrap());
    }
    (solid, reports)
}

fn with(method: DeformationMethod, material: Material) -> DeformationOptions {
    DeformationOptions {
        method,
        material,
        tolerance: 1e-12,
        ..Default::default()
    }
}

#[test]
fn the_same_minimum_as_wrapd_in_a_few_steps() {
    let mesh = bar(6, 2);
    let (start, pins) = twisted(&mesh, 1.0);
    for material in materials() {
        let (_, reference) = solve(
            &mesh,
            &start,
            &pins,
            &with(DeformationMethod::Wrapd, material),
            3000,
        );
        let best = reference.last().unwrap().energy;
        for method in [DeformationMethod::Newton, DeformationMethod::WrapdNewton] {
            let (solid, reports) = solve(&mesh, &start, &pins, &with(method, material), 100);
            let last = reports.last().unwrap();
            assert!(
                matches!(last.status, Status::Converged(_)),
                "{material:?} {method:?}: {:?}",
                last.status
            );
            assert!(
                last.iteration < 40,
                "{material:?} {method:?}: {}",
                last.iteration
            );
            assert!(
                (last.energy - best).abs() <= 1e-7 * best.abs().max(1e-3),
                "{material:?} {method:?}: {} and {best}",
                last.energy
            );
            let from = last.switched_at.unwrap_or(0);
            // the linear problem is solved by the first iteration of WRAPD
            let handed_over =
                method == DeformationMethod::WrapdNewton && material != Material::Dirichlet;
            assert_eq!(from > 0, handed_over, "{material:?}");
            for pair in reports[from..].windows(2) {
                assert!(pair[1].energy <= pair[0].energy, "{material:?} {method:?}");
                assert_eq!(pair[1].inverted, 0);
            }
            for &v in &pins {
                assert_eq!(solid.positions()[v as usize], start[v as usize]);
            }
        }
    }
}

/// A start with inverted elements: free vertices scattered about where they were.
fn scattered(start: &[DVec3], pins: &[u32], amount: f64) -> Vec<DVec3> {
    let mut random = Random(3);
    let mut moved = start.to_vec();
    for (v, p) in moved.iter_mut().enumerate() {
        if !pins.contains(&(v as u32)) {
            *p += amount * DVec3::from_array(random.many());
        }
    }
    moved
}

#[test]
fn inverted_starts() {
    let mesh = bar(5, 2);
    let (start, pins) = twisted(&mesh, 0.5);
    let from = scattered(&start, &pins, 0.5);
    // energies that are finite where elements are inverted pass through
    for name in ["stable-neo-hookean", "neo-hookean", "dirichlet"] {
        let material = Material::named(name, YOUNG, POISSON).unwrap();
        let (_, best) = solve(
            &mesh,
            &start,
            &pins,
            &with(DeformationMethod::Newton, material),
            100,
        );
        let (_, reports) = solve(
            &mesh,
            &from,
            &pins,
            &with(DeformationMethod::Newton, material),
            400,
        );
        assert!(name == "dirichlet" || reports[0].inverted > 0);
        for pair in reports.windows(2) {
            assert!(pair[1].energy <= pair[0].energy, "{name}");
        }
        if name == "neo-hookean" {
            // it has minima with inverted elements: no method that only goes down need come out of them
            continue;
        }
        let (last, best) = (reports.last().unwrap(), best.last().unwrap().energy);
        assert!(
            (last.energy - best).abs() <= 1e-6 * best,
            "{name}: {} {best}",
            last.energy
        );
        assert_eq!(last.inverted, 0);
    }
    // a barrier refuses them, the hybrid does not
    let material = Material::SymmetricDirichlet;
    let options = with(DeformationMethod::Newton, material);
    let error = Deformation::new(&mesh, &from, &pins, &options).err();
    let refused = matches!(error, Some(Error::Build(BuildError::NotInjectiveStart { inverted })) if inverted > 0);
    assert!(refused, "{error:?}");
    let options = with(DeformationMethod::WrapdNewton, material);
    let (_, reports) = solve(&mesh, &from, &pins, &options, 500);
    let last = reports.last().unwrap();
    let switch = last.switched_at.unwrap();
    assert!(switch >= 1 && reports[1..switch].iter().all(|r| r.inverted > 0));
    assert!(reports[switch..].iter().all(|r| r.inverted == 0));
    assert!(matches!(last.status, Status::Converged(_)));
}

#[test]
fn handles_move_while_it_runs() {
    let mesh = bar(5, 2);
    let (start, pins) = twisted(&mesh, 0.3);
    let held: Vec<u32> = pins
        .iter()
        .copied()
        .filter(|&v| mesh.positions[v as usize].x == 0.0)
        .collect();
    let pulled: Vec<u32> = pins.iter().copied().filter(|v| !held.contains(v)).collect();
    let targets = |shift: DVec3| -> Vec<Target> {
        let target = |&vertex: &u32| Target {
            vertex,
            position: start[vertex as usize] + shift,
        };
        pulled.iter().map(target).collect()
    };
    let away = DVec3::new(0.4, 0.3, -0.2);
    for material in materials() {
        let energy = |method, pins: &[u32]| {
            let options = with(method, material);
            let mut solid =
                Deformation::with_targets(&mesh, &start, pins, &targets(DVec3::ZERO), &options)
                    .unwrap();
            for _ in 0..5 {
                solid.step().unwrap();
            }
            // by steps that invert nothing
            for part in 1..=4 {
                solid
                    .set_targets(&targets(away * f64::from(part) / 4.0))
                    .unwrap();
                let most = if part < 4 { 10 } else { 2000 };
                for _ in 0..most {
                    if solid.step().unwrap().status != Status::Running {
                        break;
                    }
                }
            }
            solid.solver().report().energy
        };
        for pins in [&held, &pins] {
            let best = energy(DeformationMethod::Wrapd, pins);
            for method in [DeformationMethod::Newton, DeformationMethod::WrapdNewton] {
                let found = energy(method, pins);
                assert!(
                    (found - best).abs() <= 1e-6 * best.abs().max(1e-3),
                    "{material:?} {method:?}: {found} {best}"
                );
            }
        }
    }
}

#[test]
fn a_move_that_inverts_is_an_error_for_a_barrier() {
    let mesh = bar(3, 2);
    let (start, pins) = twisted(&mesh, 0.0);
    let options = with(DeformationMethod::Newton, Material::SymmetricDirichlet);
    let mut solid = Deformation::new(&mesh, &start, &pins, &options).unwrap();
    let vertex = *pins.last().unwrap();
    let target = Target {
        vertex,
        position: DVec3::new(-4.0, 0.0, 0.0),
    };
    solid.set_targets(&[target]).unwrap();
    assert_eq!(solid.step().unwrap_err().code(), "not-injective");
    let options = with(DeformationMethod::WrapdNewton, Material::SymmetricDirichlet);
    let mut solid = Deformation::new(&mesh, &start, &pins, &options).unwrap();
    for _ in 0..3 {
        solid.step().unwrap();
    }
    let target = Target {
        vertex,
        position: start[vertex as usize] + DVec3::new(0.1, 0.0, 0.0),
    };
    solid.set_targets(&[target]).unwrap();
    for _ in 0..50 {
        let report = solid.step().unwrap();
        assert!(report.energy.is_finite());
    }
    assert_eq!(solid.solver().report().inverted, 0);
}

#[test]
fn slim_of_a_solid() {
    let mesh = bar(4, 2);
    let (start, pins) = twisted(&mesh, 0.8);
    let (_, best) = solve(
        &mesh,
        &start,
        &pins,
        &with(DeformationMethod::Newton, Material::SymmetricDirichlet),
        100,
    );
    let best = best.last().unwrap().energy;
    for scale in [1.0, 0.1, 1e3] {
        let scaled = SolidMesh {
            positions: mesh.positions.iter().map(|&p| scale * p).collect(),
            simplices: mesh.simplices.clone(),
        };
        let (rest, _) = RestShape::of_solid(&scaled).unwrap();
        let x: Vec<f64> = start.iter().flat_map(|p| (scale * *p).to_array()).collect();
        let problem = Problem {
            rest: &rest,
            start: &x,
            pins: &pins,
            external: None,
        };
        let options = NewtonOptions {
            tolerance: 0.0,
            ..Default::default()
        };
        let mut solver = slim::<Solid, _>(problem, SymmetricDirichlet, options).unwrap();
        let mut before = solver.report().energy;
        for _ in 0..100 {
            let report = solver.step().unwrap();
            assert!(report.energy <= before && report.inverted == 0);
            before = report.energy;
        }
        let measure = scale.powi(3);
        // the report's 1 of an isometry is not multiplied with the volume
        let (found, best) = ((before - 1.0) / measure, best - 1.0);
        assert!(
            (found - best).abs() < 1e-6 * best,
            "{scale}: {found} {best}"
        );
    }
}

#[test]
fn cloth_refuses_them() {
    let mesh = generate(Shape::Terrain, 100);
    for method in [DeformationMethod::Newton, DeformationMethod::WrapdNewton] {
        let options = ClothOptions {
            method,
            ..Default::default()
        };
        let error = Deformation::of_cloth(&mesh, &mesh.positions, &[0], &[], &options).err();
        let named = matches!(
            error,
            Some(Error::Build(BuildError::InvalidOption {
                option: "method",
                ..
            }))
        );
        assert!(named, "{error:?}");
    }
}
