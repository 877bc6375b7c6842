//! The units of lengths and of the modulus decide nothing: neither when an iteration ends nor where.

mod bar;
mod cloth_square;

use bar::{bar, twisted};
use cloth_square::{corners, square, wrinkled};
use foldfree::deformation::{
    ClothOptions, Deformation, DeformationMethod, DeformationOptions, Material,
};
use foldfree::mesh::{SolidMesh, SurfaceMesh};
use foldfree::optim::{Criterion, Status};
use glam::DVec3;

/// How a run ended.
#[derive(Debug)]
struct End {
    iterations: usize,
    criterion: Criterion,
    energy: f64,
    positions: Vec<DVec3>,
}

fn run(mut deformation: Deformation) -> End {
    while deformation.solver().status() == Status::Running {
        deformation.step().unwrap();
    }
    let report = deformation.solver().report();
    let Status::Converged(criterion) = report.status else {
        panic!("{report:?}");
    };
    End {
        iterations: report.iteration,
        criterion,
        energy: report.energy,
        positions: deformation.positions(),
    }
}

/// Of the same body in units where lengths are `length` and energies `energy` times as large, the energy
/// of an isometry being `offset`. Its stiffness times measure is about `unit`: of a minimum that is 0 what
/// is left is rounding.
#[track_caller]
fn same(
    (plain, unit): (&End, f64),
    other: &End,
    length: f64,
    energy: f64,
    offset: f64,
    what: &str,
) {
    assert_eq!(plain.iterations, other.iterations, "{what}");
    assert_eq!(plain.criterion, other.criterion, "{what}");
    let (a, b) = (plain.energy - offset, (other.energy - offset) / energy);
    // an offset leaves no more digits than this of the energy beside it
    let digits = 1e-15 * (offset / energy + unit);
    assert!(
        (a - b).abs() <= 1e-9 * a.abs() + digits,
        "{what}: {a:e} {b:e}"
    );
    for (p, q) in plain.positions.iter().zip(&other.positions) {
        assert!(p.distance(*q / length) < 1e-8, "{what}: {p} {q}");
    }
}

fn solid(start: Start, length: f64, options: &DeformationOptions) -> End {
    let mut mesh = bar(4, 2);
    let (mut positions, pins) = start(&mesh);
    mesh.positions.iter_mut().for_each(|p| *p *= length);
    positions.iter_mut().for_each(|p| *p *= length);
    run(Deformation::new(&mesh, &positions, &pins, options).unwrap())
}

/// Where a bar starts, and its pins.
type Start = fn(&SolidMesh) -> (Vec<DVec3>, Vec<u32>);

/// Twisted and held at both ends: the minimum is positive.
fn held(mesh: &SolidMesh) -> (Vec<DVec3>, Vec<u32>) {
    twisted(mesh, 1.0)
}

/// Held at one end: the minimum is 0.
fn freed(mesh: &SolidMesh) -> (Vec<DVec3>, Vec<u32>) {
    let (start, mut pins) = twisted(mesh, 1.0);
    pins.retain(|&v| mesh.positions[v as usize].x == 0.0);
    (start, pins)
}

const YOUNG: f64 = 1e4;

/// The elastic ones with this modulus.
fn elastic(young: f64) -> [Material; 3] {
    let poisson = 0.4;
    [
        Material::NeoHookean { young, poisson },
        Material::StableNeoHookean { young, poisson },
        Material::StVenantKirchhoff { young, poisson },
    ]
}

#[test]
fn of_a_solid_with_a_modulus() {
    for (i, method) in [
        (0, DeformationMethod::Wrapd),
        (1, DeformationMethod::Wrapd),
        (2, DeformationMethod::Wrapd),
        (0, DeformationMethod::AdmmPd),
        (0, DeformationMethod::Lbfgs),
        (1, DeformationMethod::Lbfgs),
    ] {
        for (name, start) in [("held", held as Start), ("freed", freed)] {
            let end = |length: f64, stiffer: f64| {
                let options = DeformationOptions {
                    material: elastic(stiffer * YOUNG)[i],
                    method,
                    // above what rounding leaves of a minimum that is 0
                    tolerance: if name == "held" { 1e-9 } else { 1e-7 },
                    ..Default::default()
                };
                solid(start, length, &options)
            };
            let plain = end(1.0, 1.0);
            println!(
                "{i} {method:?} {name}: {} {:?} {:e}",
                plain.iterations, plain.criterion, plain.energy
            );
            for (length, stiffer) in [
                (1e-3, 1.0),
                (1e3, 1.0),
                (1.0, 1e-6),
                (1.0, 1e6),
                (1e-3, 1e-6),
            ] {
                let other = end(length, stiffer);
                let what = format!("{i}, {method:?}, {name}, {length:e}, {stiffer:e}");
                same(
                    (&plain, 10.0 * YOUNG),
                    &other,
                    length,
                    stiffer * length.powi(3),
                    0.0,
                    &what,
                );
            }
        }
    }
}

#[test]
fn of_a_solid_without() {
    for (material, offset) in [
        (Material::Arap, 0.0),
        (Material::Dirichlet, 0.0),
        (Material::SymmetricDirichlet, 1.0),
    ] {
        for (name, start) in [("held", held as Start), ("freed", freed)] {
            if material == Material::Dirichlet && name == "freed" {
                // it vanishes, and what is inverted has not converged
                continue;
            }
            let end = |length: f64| {
                let options = DeformationOptions {
                    material,
                    tolerance: 1e-9,
                    ..Default::default()
                };
                solid(start, length, &options)
            };
            let plain = end(1.0);
            println!(
                "{material:?} {name}: {} {:?} {:e}",
                plain.iterations, plain.criterion, plain.energy
            );
            for length in [1e-3, 1e3] {
                let what = format!("{material:?}, {name}, {length:e}");
                same(
                    (&plain, 10.0),
                    &end(length),
                    length,
                    length.powi(3),
                    offset,
                    &what,
                );
            }
        }
    }
}

/// Lengths × l and the modulus × m: with stretch × m l, bending × m l³ and density × m all forces are m l²
/// times as large.
#[test]
fn of_a_cloth() {
    let n = 8;
    for (limits, gravity, method) in [
        (Some([0.95, 1.05]), 9.81, DeformationMethod::Wrapd),
        (None, 9.81, DeformationMethod::Wrapd),
        (None, 0.0, DeformationMethod::Wrapd),
        (None, 9.81, DeformationMethod::Lbfgs),
        (None, 0.0, DeformationMethod::Lbfgs),
    ] {
        let end = |l: f64, m: f64| {
            let mesh = square(n);
            let pins = corners(n);
            // without weight wrinkles would be one of many minima: it is stretched instead
            let mut start = match gravity > 0.0 {
                true => wrinkled(&mesh, &pins),
                false => mesh.positions.iter().map(|p| *p * 1.02).collect(),
            };
            let mut scaled: SurfaceMesh = mesh;
            scaled.positions.iter_mut().for_each(|p| *p *= l);
            start.iter_mut().for_each(|p| *p *= l);
            let options = ClothOptions {
                stretch: 300.0 * m * l,
                bending: 1e-3 * m * l.powi(3),
                density: 0.25 * m,
                gravity: [0.0, 0.0, -gravity],
                limits,
                method,
                tolerance: 1e-9,
                ..Default::default()
            };
            run(Deformation::of_cloth(&scaled, &start, &pins, &[], &options).unwrap())
        };
        let plain = end(1.0, 1.0);
        println!(
            "{limits:?} {gravity} {method:?}: {} {:?} {:e}",
            plain.iterations, plain.criterion, plain.energy
        );
        for (l, m) in [
            (1e-3, 1.0),
            (1e3, 1.0),
            (1.0, 1e-6),
            (1.0, 1e6),
            (1e3, 1e-6),
        ] {
            let what = format!("{limits:?}, {gravity}, {method:?}, {l:e}, {m:e}");
            same((&plain, 300.0), &end(l, m), l, m * l.powi(3), 0.0, &what);
        }
    }
}
