//! Bijective texture maps (Overby, Kaufman & Narain 2021, §8.5, fig. 13): of generated surfaces, from harmonic and
//! conformal starts; no triangle inverted, no crossing of the boundary, by exact predicates.

use foldfree::mesh::{Shape, SurfaceMesh, generate};
use foldfree::optim::{Criterion, Status};
use foldfree::parameterization::{
    EnergyKind, Landmark, Method, Parameterization, ParameterizationOptions, Start,
};
use glam::{DVec2, DVec3};

fn options(method: Method, start: Start) -> ParameterizationOptions {
    ParameterizationOptions {
        method,
        start,
        max_iterations: 1000,
        ..Default::default()
    }
}

/// Steps until it ends; every state that is handed out on the way has to be free of crossings.
fn run(mesh: &SurfaceMesh, options: &ParameterizationOptions) -> Parameterization {
    let mut p = Parameterization::new(mesh, options).expect("a surface");
    let mut count = 0;
    while p.solver().status() == Status::Running {
        let report = p.step().expect("a step");
        count += 1;
        if report.inverted == 0 && (count < 20 || count % 20 == 0) {
            assert!(
                p.certificate().boundary_crossings.is_empty(),
                "step {count}"
            );
        }
    }
    p
}

fn is_bijective(p: &Parameterization) {
    let certificate = p.certificate();
    assert!(certificate.inverted.is_empty());
    assert!(certificate.boundary_crossings.is_empty());
    assert!(certificate.globally_injective);
}

#[test]
fn textures_do_not_overlap() {
    // energies: a little above the least that overlapping maps have (isometries 1; the cap 1.166)
    for (shape, most) in [
        (Shape::BumpyCap, 1.2),
        (Shape::SpiralRamp, 1.05),
        (Shape::HilbertStrip, 1.05),
    ] {
        let mesh = generate(shape, 1500);
        for start in [Start::Harmonic, Start::Lscm] {
            for method in [Method::Gini, Method::GiniCm] {
                let p = run(&mesh, &options(method, start));
                is_bijective(&p);
                let energy = p.solver().report().energy;
                assert!(energy < most, "{shape:?} {start:?} {method:?}: {energy}");
            }
        }
    }
}

#[test]
fn what_the_others_let_overlap() {
    // a strip that winds round more than once: the isometry of the whole lies on itself
    let mesh = generate(Shape::SpiralRamp, 1500);
    let others = run_free(&mesh, Method::Cm);
    assert!(!others.certificate().boundary_crossings.is_empty());
    is_bijective(&run(&mesh, &options(Method::GiniCm, Start::Harmonic)));
}

/// Steps without looking.
fn run_free(mesh: &SurfaceMesh, method: Method) -> Parameterization {
    let mut p = Parameterization::new(mesh, &options(method, Start::Harmonic)).expect("a surface");
    while p.solver().status() == Status::Running {
        p.step().expect("a step");
    }
    p
}

#[test]
fn a_start_that_meets_itself_is_led_to_and_said() {
    let mesh = generate(Shape::SpiralRamp, 1500);
    let p = run(&mesh, &options(Method::Gini, Start::Lscm));
    is_bijective(&p);
    let notes = p.notes().join(" ");
    assert!(notes.contains("meets itself"), "{notes}");
    // so does one that is all over the place
    for start in [Start::Random, Start::Collapsed] {
        let p = run(
            &generate(Shape::BumpyCap, 500),
            &options(Method::Gini, start),
        );
        is_bijective(&p);
    }
}

#[test]
fn composite_majorization_takes_over_and_lowers_the_energy() {
    let mesh = generate(Shape::BumpyCap, 1500);
    let mut p = Parameterization::new(&mesh, &options(Method::GiniCm, Start::Lscm)).expect("a cap");
    let mut energies = Vec::new();
    while p.solver().status() == Status::Running {
        let report = p.step().expect("a step");
        if report.switched_at.is_some_and(|at| report.iteration >= at) {
            energies.push(report.energy);
        }
    }
    assert!(matches!(
        p.solver().status(),
        Status::Converged(Criterion::EnergyChange | Criterion::GradientNorm)
    ));
    assert!(energies.len() > 1);
    assert!(energies.is_sorted_by(|a, b| a >= b), "{energies:?}");
    // nothing touches: the same minimum as without constraints
    let free = run_free(&mesh, Method::Cm).solver().report().energy;
    let here = p.solver().report().energy;
    assert!((here - free).abs() < 1e-5 * free, "{here} and {free}");
}

#[test]
fn pieces_lie_side_by_side() {
    let mut mesh = generate(Shape::BumpyCap, 300);
    let other = generate(Shape::SpiralRamp, 300);
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(
        other
            .positions
            .iter()
            .map(|p| *p + DVec3::new(9.0, 0.0, 0.0)),
    );
    mesh.simplices
        .extend(other.simplices.iter().map(|t| t.map(|v| v + first)));
    is_bijective(&run(&mesh, &options(Method::GiniCm, Start::Harmonic)));
}

#[test]
fn energies_and_landmarks_are_checked() {
    let mesh = generate(Shape::BumpyCap, 300);
    let arap = |method| ParameterizationOptions {
        energy: EnergyKind::Arap,
        ..options(method, Start::Harmonic)
    };
    is_bijective(&run(&mesh, &arap(Method::Gini)));
    let error = Parameterization::new(&mesh, &arap(Method::GiniCm));
    let error = error.map(|_| ()).expect_err("not its energy").to_string();
    assert!(error.contains("energy"), "{error}");
    let landmark = Landmark {
        vertex: 0,
        uv: DVec2::ZERO,
        hard: true,
    };
    let with = Parameterization::with_landmarks(
        &mesh,
        &options(Method::Gini, Start::Harmonic),
        &[landmark],
    );
    let error = with.map(|_| ()).expect_err("no landmarks").to_string();
    assert!(error.contains("landmarks"), "{error}");
}

#[test]
fn pieces_are_not_in_each_others_way() {
    let one = generate(Shape::SpiralRamp, 300);
    let energy = |mesh: &SurfaceMesh| {
        let p = run(mesh, &options(Method::GiniCm, Start::Harmonic));
        is_bijective(&p);
        p.solver().report().energy
    };
    let alone = energy(&one);
    let mut three = one.clone();
    for k in 1..3 {
        let first = three.positions.len() as u32;
        let shift = DVec3::X * 9.0 * f64::from(k);
        let moved = one.positions.iter().map(|p| *p + shift);
        three.positions.extend(moved);
        let simplices = one.simplices.iter().map(|t| t.map(|v| v + first));
        three.simplices.extend(simplices);
    }
    let together = energy(&three);
    assert!(
        together < 1.01 * alone,
        "{alone} alone, {together} beside others"
    );
}
