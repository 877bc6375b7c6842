//! Second-order methods on planar maps: energies never rise, nothing is ever inverted, and the minimum is
//! that of other methods.

mod flattening;
mod random;

use flattening::{Run, endless, from};
use foldfree::Error;
use foldfree::energy::total::total;
use foldfree::energy::{Arap, SymmetricDirichlet};
use foldfree::geometry::RestShape;
use foldfree::mesh::{Shape, SurfaceMesh, generate};
use foldfree::newton::{Newton, NewtonOptions};
use foldfree::optim::{BuildError, Solver, Status, StepReport};
use foldfree::parameterization::{
    EnergyKind, Method, Parameterization, ParameterizationOptions, Start,
};
use foldfree::slim::{Reweightable, slim};
use foldfree::space::Plane;
use foldfree::wrapd::Problem;
use glam::DVec3;
use random::Random;

/// A small disk, from tame to nasty: a grid whose vertices are moved about, with spikes and slivers.
fn disk(seed: u64) -> SurfaceMesh {
    let mut random = Random(seed);
    let mut unit = move || 0.5 * (random.next() + 1.0);
    let (nx, ny) = (2 + (unit() * 5.0) as usize, 2 + (unit() * 5.0) as usize);
    let stretch = 10f64.powf(3.0 * unit() - 1.5);
    let height = 10f64.powf(3.0 * unit() - 2.0);
    let jitter = 0.9 * unit();
    let mut mesh = SurfaceMesh::default();
    for v in 0..(nx + 1) * (ny + 1) {
        let (x, y) = ((v % (nx + 1)) as f64, (v / (nx + 1)) as f64);
        let spike = if unit() < 0.05 { 30.0 } else { 1.0 };
        mesh.positions.push(DVec3::new(
            stretch * (x + jitter * (unit() - 0.5)),
            y + jitter * (unit() - 0.5),
            height * spike * unit(),
        ));
    }
    for cell in 0..nx * ny {
        let a = (cell / nx * (nx + 1) + cell % nx) as u32;
        let [b, c, d] = [a + 1, a + nx as u32 + 1, a + nx as u32 + 2];
        match unit() < 0.5 {
            true => mesh.simplices.extend([[a, b, d], [a, d, c]]),
            false => mesh.simplices.extend([[a, b, c], [b, d, c]]),
        }
    }
    mesh
}

/// Each report is better than the one before, or the solver has ended.
#[track_caller]
fn falls(reports: &[StepReport], context: &str) {
    for pair in reports.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        assert!(
            b.energy.is_finite() && b.gradient_norm.is_finite(),
            "{context}: {b:?}"
        );
        assert!(
            b.energy <= a.energy,
            "{context}: {} then {}",
            a.energy,
            b.energy
        );
        assert_eq!(b.inverted, 0, "{context}, iteration {}", b.iteration);
        assert!(b.smallest_sigma > 0.0, "{context}");
    }
}

#[test]
fn a_thousand_disks() {
    let mut converged = 0;
    for seed in 0..1000 {
        let options = ParameterizationOptions {
            method: Method::Cm,
            tolerance: 1e-10,
            max_iterations: 60,
            ..Default::default()
        };
        let run = Run::new(&disk(seed), &options);
        assert_eq!(run.last().inverted, 0, "the start of {seed}");
        let run = run.steps(60);
        falls(&run.reports, &format!("disk {seed}"));
        assert!(run.parameterization.certificate().inverted.is_empty());
        converged += usize::from(matches!(run.last().status, Status::Converged(_)));
    }
    println!("{converged} of 1000 converged within 60 iterations");
    assert!(converged > 980, "{converged}");
}

#[test]
fn hybrids_and_slim_on_disks() {
    for seed in 0..100 {
        let mesh = disk(seed);
        let options = |method| ParameterizationOptions {
            method,
            tolerance: 1e-10,
            max_iterations: 200,
            ..Default::default()
        };
        let run = Run::new(&mesh, &options(Method::Slim)).steps(40);
        falls(&run.reports, &format!("slim, disk {seed}"));
        let cm = Run::new(&mesh, &options(Method::Cm)).steps(200);
        let run = Run::new(&mesh, &options(Method::WrapdCm)).steps(200);
        let switch = run
            .last()
            .switched_at
            .expect("an iterate without inverted triangles");
        falls(&run.reports[switch..], &format!("wrapd+cm, disk {seed}"));
        assert!(run.reports[1..switch].iter().all(|r| r.inverted > 0));
        assert_eq!(run.reports[switch].inverted, 0);
        assert!(
            run.reports[..switch]
                .iter()
                .all(|r| r.switched_at.is_none())
        );
        for (k, report) in run.reports.iter().enumerate() {
            assert_eq!(report.iteration, k);
        }
        let (a, b) = (run.last().energy, cm.last().energy);
        assert!((a - b).abs() < 1e-5 * b, "disk {seed}: {a} and {b}");
    }
}

#[test]
fn all_reach_the_same_minimum() {
    for shape in [Shape::BumpyCap, Shape::Terrain] {
        let mesh = generate(shape, 1_500);
        let energy = |method, steps| Run::new(&mesh, &endless(method)).steps(steps).last().energy;
        let wrapd = energy(Method::Wrapd, 300);
        for (method, steps, tolerance) in [
            (Method::Cm, 40, 1e-9),
            (Method::WrapdCm, 40, 1e-9),
            (Method::Slim, 200, 1e-5),
        ] {
            let found = energy(method, steps);
            assert!(
                (found - wrapd).abs() < tolerance * wrapd,
                "{method:?}: {found} {wrapd}"
            );
        }
    }
}

#[test]
fn the_end_is_a_minimum_to_rounding() {
    let mesh = generate(Shape::BumpyCap, 800);
    let run = Run::new(&mesh, &endless(Method::Cm)).steps(100);
    let last = run.last();
    assert_eq!(last.status, Status::Stalled);
    assert!(last.iteration < 60, "{}", last.iteration);
    assert!(last.gradient_norm < 1e-8, "{}", last.gradient_norm);
    // quadratic convergence: two orders of magnitude at once, at least, before the end
    let gradients: Vec<f64> = run.reports.iter().map(|r| r.gradient_norm).collect();
    assert!(
        gradients
            .windows(2)
            .any(|g| g[0] < 1e-2 && g[1] < 1e-3 * g[0]),
        "{gradients:?}"
    );
    // and with a tolerance it converges
    let options = ParameterizationOptions {
        method: Method::Cm,
        ..Default::default()
    };
    let run = Run::new(&mesh, &options).steps(100);
    assert!(matches!(run.last().status, Status::Converged(_)));
    assert!(run.last().energy <= last.energy * (1.0 + 1e-6));
    // a further step is taken all the same, and is no worse
    let before = run.last().energy;
    let mut run = run;
    assert!(run.parameterization.step().unwrap().energy <= before);
}

#[test]
fn inverted_starts_are_refused_but_by_the_hybrid() {
    let mesh = generate(Shape::BumpyCap, 500);
    for method in [Method::Cm, Method::Slim] {
        let error = Parameterization::new(&mesh, &from(Start::Random, method)).err();
        let Some(Error::Build(BuildError::NotInjectiveStart { inverted })) = error else {
            panic!("{method:?}: {error:?}");
        };
        assert!(inverted > 0);
    }
    let run = Run::new(&mesh, &from(Start::Random, Method::WrapdCm)).steps(300);
    let best = Run::new(&mesh, &endless(Method::Cm))
        .steps(60)
        .last()
        .energy;
    assert!(run.last().switched_at.is_some());
    assert!(
        (run.last().energy - best).abs() < 1e-6 * best,
        "{}",
        run.last().energy
    );
    for method in [Method::Cm, Method::WrapdCm] {
        let options = ParameterizationOptions {
            energy: EnergyKind::Arap,
            ..endless(method)
        };
        let error = Parameterization::new(&mesh, &options).err();
        let named = matches!(
            error,
            Some(Error::Build(BuildError::InvalidOption {
                option: "energy",
                ..
            }))
        );
        assert!(named, "{error:?}");
    }
}

/// A grid in the plane, its rest shape, and a sheared start of it.
fn sheet(n: usize) -> (RestShape, Vec<f64>) {
    let mut mesh = SurfaceMesh::default();
    for v in 0..(n + 1) * (n + 1) {
        let (x, y) = ((v % (n + 1)) as f64, (v / (n + 1)) as f64);
        mesh.positions.push(DVec3::new(x, y, 0.0) / n as f64);
    }
    for cell in 0..n * n {
        let a = (cell / n * (n + 1) + cell % n) as u32;
        let c = a + n as u32 + 1;
        mesh.simplices.extend([[a, a + 1, c + 1], [a, c + 1, c]]);
    }
    let start = mesh
        .positions
        .iter()
        .flat_map(|p| [1.7 * p.x + 0.4 * p.y * p.y + 5.0, 0.6 * p.y - 0.3 * p.x]);
    let start = start.collect();
    (RestShape::of_surface(&mesh, 1.0).unwrap(), start)
}

#[test]
fn without_pins_a_flat_sheet_becomes_isometric() {
    let (rest, start) = sheet(8);
    let problem = |pins: &'static [u32]| Problem {
        rest: &rest,
        start: &start,
        pins,
        external: None,
    };
    let options = NewtonOptions {
        tolerance: 0.0,
        ..Default::default()
    };
    for pins in [&[][..], &[3]] {
        let solvers = [
            Newton::composite_majorization(problem(pins), options).unwrap(),
            Newton::projected::<Plane, _>(problem(pins), SymmetricDirichlet, options).unwrap(),
            slim::<Plane, _>(problem(pins), SymmetricDirichlet, options).unwrap(),
        ];
        for mut solver in solvers {
            let mut before = solver.report().energy;
            for _ in 0..60 {
                let report = solver.step().unwrap();
                assert!(report.energy <= before && report.inverted == 0);
                before = report.energy;
            }
            assert!((before - 1.0).abs() < 1e-12, "{before}");
            let check = total::<Plane, _>(SymmetricDirichlet, &rest, solver.positions());
            assert!((check.energy - before).abs() < 1e-13);
        }
        let mut solvers = [
            Newton::projected::<Plane, _>(problem(pins), Arap, options).unwrap(),
            slim::<Plane, _>(problem(pins), Arap, options).unwrap(),
        ];
        for solver in &mut solvers {
            for _ in 0..60 {
                solver.step().unwrap();
            }
            assert!(solver.report().energy < 1e-12, "{}", solver.report().energy);
        }
    }
}

/// Composite majorization is the projected Hessian of this energy: the same steps.
#[test]
fn the_closed_form_takes_the_steps_of_projected_newton() {
    let (rest, start) = sheet(6);
    let problem = Problem {
        rest: &rest,
        start: &start,
        pins: &[0, 5],
        external: None,
    };
    let options = NewtonOptions::default();
    let mut a = Newton::composite_majorization(problem, options).unwrap();
    let mut b = Newton::projected::<Plane, _>(problem, SymmetricDirichlet, options).unwrap();
    for _ in 0..6 {
        let (a, b) = (a.step().unwrap(), b.step().unwrap());
        assert!(
            (a.energy - b.energy).abs() < 1e-8 * b.energy,
            "{} {}",
            a.energy,
            b.energy
        );
    }
}

#[test]
fn weights_of_slim() {
    fn weight<E: Reweightable<Plane>>(energy: E, sigma: f64) -> f64 {
        energy.weight_squared(sigma)
    }
    for sigma in [1e-3, 0.3, 0.9, 1.1, 2.0, 50.0] {
        let by_definition = |gradient: f64| gradient / (2.0 * (sigma - 1.0));
        let expected = by_definition(2.0 * sigma - 2.0 * sigma.powi(-3));
        let found = weight(SymmetricDirichlet, sigma);
        assert!(
            (found - expected).abs() < 1e-12 * expected,
            "{sigma}: {found} {expected}"
        );
        assert_eq!(weight(Arap, sigma), 1.0);
    }
    // ψ''(1)/2
    assert_eq!(weight(SymmetricDirichlet, 1.0), 4.0);
}

#[test]
fn options_out_of_range() {
    let (rest, start) = sheet(2);
    let problem = Problem {
        rest: &rest,
        start: &start,
        pins: &[],
        external: None,
    };
    let good = NewtonOptions::default();
    let bad = [
        (
            "fraction",
            NewtonOptions {
                fraction: 1.0,
                ..good
            },
        ),
        (
            "decrease",
            NewtonOptions {
                decrease: 0.5,
                ..good
            },
        ),
        (
            "shift",
            NewtonOptions {
                shift: f64::NAN,
                ..good
            },
        ),
        (
            "longest",
            NewtonOptions {
                longest: 0.9,
                ..good
            },
        ),
        (
            "tolerance",
            NewtonOptions {
                tolerance: -1.0,
                ..good
            },
        ),
    ];
    for (name, options) in bad {
        let error = Newton::composite_majorization(problem, options).err();
        let named =
            matches!(&error, Some(BuildError::InvalidOption { option, .. }) if *option == name);
        assert!(named, "{name}: {error:?}");
    }
}
