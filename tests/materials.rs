//! Every material on a bar, by WRAPD and by L-BFGS: they share the element kernels and the system matrix, and
//! the plain evaluation, which shares neither, has the last word.

mod bar;

use bar::{bar, twisted};
use foldfree::deformation::{Deformation, DeformationMethod, DeformationOptions, Material};
use foldfree::energy::total::total;
use foldfree::energy::{
    Arap, Dirichlet, Energy, NeoHookean, StVenantKirchhoff, StableNeoHookean, SymmetricDirichlet,
};
use foldfree::geometry::RestShape;
use foldfree::mesh::SolidMesh;
use foldfree::optim::{BuildError, Solver, Status, StepReport};
use foldfree::quasi_newton::{QuasiNewton, QuasiNewtonOptions};
use foldfree::space::Solid;
use foldfree::wrapd::Problem;
use glam::DVec3;

const YOUNG: f64 = 1e3;
const POISSON: f64 = 0.4;

fn materials() -> [Material; 6] {
    let (young, poisson) = (YOUNG, POISSON);
    [
        Material::NeoHookean { young, poisson },
        Material::StableNeoHookean { young, poisson },
        Material::StVenantKirchhoff { young, poisson },
        Material::Arap,
        Material::SymmetricDirichlet,
        Material::Dirichlet,
    ]
}

/// Energy, norm of the gradient at the vertices that are not pins, and flips, by the plain evaluation.
fn plain(material: Material, rest: &RestShape, x: &[DVec3], pins: &[u32]) -> (f64, f64, usize) {
    let x: Vec<f64> = x.iter().flat_map(|p| p.to_array()).collect();
    fn by<E: Energy<Solid>>(
        energy: E,
        rest: &RestShape,
        x: &[f64],
        pins: &[u32],
    ) -> (f64, f64, usize) {
        let mut total = total::<Solid, E>(energy, rest, x);
        for &pin in pins {
            total.gradient[3 * pin as usize..][..3].fill(0.0);
        }
        let squares: f64 = total.gradient.iter().map(|g| g * g).sum();
        (total.energy, squares.sqrt(), total.inverted)
    }
    match material {
        Material::NeoHookean { young, poisson } => {
            by(NeoHookean::new(young, poisson).unwrap(), rest, &x, pins)
        }
        Material::StableNeoHookean { young, poisson } => by(
            StableNeoHookean::new(young, poisson).unwrap(),
            rest,
            &x,
            pins,
        ),
        Material::StVenantKirchhoff { young, poisson } => by(
            StVenantKirchhoff::new(young, poisson).unwrap(),
            rest,
            &x,
            pins,
        ),
        Material::Arap => by(Arap, rest, &x, pins),
        Material::SymmetricDirichlet => by(SymmetricDirichlet, rest, &x, pins),
        Material::Dirichlet => by(Dirichlet, rest, &x, pins),
    }
}

fn solve(
    mesh: &SolidMesh,
    (start, pins): (&[DVec3], &[u32]),
    options: &DeformationOptions,
) -> Deformation {
    let mut deformation = Deformation::new(mesh, start, pins, options).unwrap();
    while deformation.solver().status() == Status::Running {
        deformation.step().unwrap();
    }
    deformation
}

#[test]
fn every_material_by_two_methods() {
    let mesh = bar(6, 2);
    let (rest, _) = RestShape::of_solid(&mesh).unwrap();
    let (start, pins) = twisted(&mesh, 1.2);
    for material in materials() {
        let [wrapd, lbfgs] = [DeformationMethod::Wrapd, DeformationMethod::Lbfgs].map(|method| {
            let options = DeformationOptions {
                material,
                method,
                tolerance: 1e-14,
                max_iterations: 3000,
                ..Default::default()
            };
            let begin = plain(material, &rest, &start, &pins);
            let done = solve(&mesh, (&start, &pins), &options);
            let report = done.solver().report();
            let (energy, gradient, inverted) = plain(material, &rest, &done.positions(), &pins);
            println!(
                "{material:?} {method:?}: {energy} after {} iterations, gradient {gradient:e} of {:e}, {}",
                report.iteration,
                begin.1,
                report.status.name()
            );
            assert!(matches!(report.status, Status::Converged(_)));
            assert!((energy - report.energy).abs() <= 1e-10 * (energy.abs() + begin.0));
            assert!((gradient - report.gradient_norm).abs() <= 1e-8 * begin.1);
            assert!(gradient <= 1e-5 * begin.1, "{gradient:e}");
            assert_eq!(inverted, 0);
            energy
        });
        assert!(
            (wrapd / lbfgs - 1.0).abs() < 1e-8,
            "{material:?}: {wrapd} {lbfgs}"
        );
    }
}

/// The elastic ones agree where strains are small.
#[test]
fn small_strains_cost_the_same() {
    let mesh = bar(6, 2);
    let (start, pins) = twisted(&mesh, 1e-3);
    let energies: Vec<f64> = materials()[..3]
        .iter()
        .map(|&material| {
            let options = DeformationOptions {
                material,
                method: DeformationMethod::Lbfgs,
                tolerance: 1e-16,
                max_iterations: 3000,
                ..Default::default()
            };
            let done = solve(&mesh, (&start, &pins), &options);
            assert!(matches!(done.solver().status(), Status::Converged(_)));
            done.solver().report().energy
        })
        .collect();
    for energy in &energies {
        assert!((energy / energies[0] - 1.0).abs() < 1e-3, "{energies:?}");
    }
}

/// What is held all around as an affine map has it is that map within, whatever the start: for L-BFGS
/// the Laplacian is the Hessian, and one step does (a second may be needed to notice).
#[test]
fn the_dirichlet_minimum_is_harmonic() {
    let mesh = bar(6, 3);
    let affine = |p: DVec3| DVec3::new(2.0 * p.x + p.y, 0.5 * p.y - p.z, 2.0 * p.z + p.x) + 3.0;
    let on_the_border = |p: DVec3| {
        let inside = |x: f64, most: f64| x > 1e-9 && x < most - 1e-9;
        !(inside(p.x, 2.0) && inside(p.y, 1.0) && inside(p.z, 1.0))
    };
    let pins: Vec<u32> = (0..mesh.positions.len() as u32)
        .filter(|&v| on_the_border(mesh.positions[v as usize]))
        .collect();
    let start: Vec<DVec3> = mesh
        .positions
        .iter()
        .map(|&p| {
            if on_the_border(p) {
                affine(p)
            } else {
                DVec3::splat(9.0)
            }
        })
        .collect();
    assert!(pins.len() < start.len());
    for (method, most) in [
        (DeformationMethod::Lbfgs, 2),
        (DeformationMethod::Wrapd, 300),
    ] {
        let options = DeformationOptions {
            material: Material::Dirichlet,
            method,
            tolerance: 1e-15,
            ..Default::default()
        };
        let done = solve(&mesh, (&start, &pins), &options);
        let report = done.solver().report();
        assert!(
            matches!(report.status, Status::Converged(_)) && report.iteration <= most,
            "{method:?}: {report:?}"
        );
        for (p, q) in done.positions().iter().zip(&mesh.positions) {
            assert!(p.distance(affine(*q)) < 1e-6, "{method:?}: {p} {q}");
        }
    }
}

/// The version with the logarithm has no minimum at a point.
#[test]
fn stable_neo_hookean_unfolds() {
    let mesh = bar(4, 2);
    let (start, pins) = twisted(&mesh, 0.5);
    let material = materials()[1];
    let options = DeformationOptions {
        material,
        ..Default::default()
    };
    let best = solve(&mesh, (&start, &pins), &options)
        .solver()
        .report()
        .energy;
    let held = |v: usize| pins.contains(&(v as u32));
    let collapsed: Vec<DVec3> = (0..start.len())
        .map(|v| if held(v) { start[v] } else { DVec3::splat(0.5) })
        .collect();
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 40) as f64 / (1u64 << 24) as f64
    };
    let scattered: Vec<DVec3> = (0..start.len())
        .map(|v| match held(v) {
            true => start[v],
            false => DVec3::new(2.0 * random(), random(), random()),
        })
        .collect();
    for from in [collapsed, scattered] {
        let done = solve(&mesh, (&from, &pins), &options);
        let report = done.solver().report();
        assert!(matches!(report.status, Status::Converged(_)), "{report:?}");
        assert_eq!(report.inverted, 0);
        assert!(
            report.energy <= best * (1.0 + 1e-6),
            "{} {best}",
            report.energy
        );
    }
}

fn problem<'a>(rest: &'a RestShape, start: &'a [f64], pins: &'a [u32]) -> Problem<'a> {
    Problem {
        rest,
        start,
        pins,
        external: None,
    }
}

fn flat(positions: &[DVec3]) -> Vec<f64> {
    positions.iter().flat_map(|p| p.to_array()).collect()
}

#[test]
fn l_bfgs_descends_and_keeps_a_barrier() {
    let mesh = bar(6, 2);
    let (rest, _) = RestShape::of_solid(&mesh).unwrap();
    let (start, pins) = twisted(&mesh, 1.5);
    let start = flat(&start);
    let options = QuasiNewtonOptions::default();
    let mut solver =
        QuasiNewton::new::<Solid, _>(problem(&rest, &start, &pins), SymmetricDirichlet, options)
            .unwrap();
    let mut before = solver.report().energy;
    assert!(before.is_finite());
    while solver.status() == Status::Running {
        let report = solver.step().unwrap();
        assert!(report.energy <= before && report.inverted == 0);
        before = report.energy;
    }
    assert!(matches!(solver.status(), Status::Converged(_)));
    assert!(solver.inspect().distortion.iter().all(|d| *d >= 1.0 - 1e-6));

    let mut folded = start.clone();
    let free = (0..mesh.positions.len() as u32)
        .find(|v| !pins.contains(v))
        .unwrap() as usize;
    folded[3 * free] += 10.0;
    let error =
        QuasiNewton::new::<Solid, _>(problem(&rest, &folded, &pins), SymmetricDirichlet, options)
            .err();
    assert!(
        matches!(error, Some(BuildError::NotInjectiveStart { inverted }) if inverted > 0),
        "{error:?}"
    );
    // an energy without barrier takes it
    let energy = StableNeoHookean::new(YOUNG, POISSON).unwrap();
    let mut solver =
        QuasiNewton::new::<Solid, _>(problem(&rest, &folded, &pins), energy, options).unwrap();
    assert!(solver.report().inverted > 0);
    while solver.status() == Status::Running {
        solver.step().unwrap();
    }
    assert!(matches!(solver.status(), Status::Converged(_)));
    assert_eq!(solver.report().inverted, 0);
}

#[test]
fn l_bfgs_at_the_minimum_and_at_bad_input() {
    let mesh = bar(3, 1);
    let (rest, _) = RestShape::of_solid(&mesh).unwrap();
    let start = flat(&mesh.positions);
    let options = QuasiNewtonOptions::default();
    let mut solver =
        QuasiNewton::new::<Solid, _>(problem(&rest, &start, &[0]), Arap, options).unwrap();
    assert!(matches!(
        solver.step().unwrap().status,
        Status::Converged(_)
    ));
    for bad in [
        QuasiNewtonOptions {
            history: 0,
            ..options
        },
        QuasiNewtonOptions {
            decrease: 1.0,
            ..options
        },
        QuasiNewtonOptions {
            decrease: f64::NAN,
            ..options
        },
        QuasiNewtonOptions {
            tolerance: -1.0,
            ..options
        },
    ] {
        let refused = QuasiNewton::new::<Solid, _>(problem(&rest, &start, &[0]), Arap, bad);
        assert!(matches!(
            refused.err(),
            Some(BuildError::InvalidOption { .. })
        ));
    }
    let refused = QuasiNewton::new::<Solid, _>(problem(&rest, &start, &[]), Arap, options);
    assert!(refused.is_err());
    // so far away that its energy overflows: no step, and no panic
    let mut far = start.clone();
    far[3 * 5] = 1e200;
    let energy = StVenantKirchhoff::new(YOUNG, POISSON).unwrap();
    let mut solver =
        QuasiNewton::new::<Solid, _>(problem(&rest, &far, &[0]), energy, options).unwrap();
    assert!(solver.step().is_err());
}

#[test]
fn l_bfgs_gives_the_same_bits_on_any_number_of_threads() {
    let mesh = bar(12, 4);
    let (start, pins) = twisted(&mesh, 1.5);
    let run = |threads: usize| -> (Vec<DVec3>, Vec<f64>) {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let options = DeformationOptions {
            method: DeformationMethod::Lbfgs,
            ..Default::default()
        };
        pool.install(|| {
            let mut deformation = Deformation::new(&mesh, &start, &pins, &options).unwrap();
            let reports: Vec<StepReport> = (0..8).map(|_| deformation.step().unwrap()).collect();
            (
                deformation.positions(),
                reports.iter().map(|r| r.energy).collect(),
            )
        })
    };
    let alone = run(1);
    assert_eq!(run(2), alone);
    assert_eq!(run(3), alone);
}
