//! L-BFGS where it cannot go on: at the minimum to rounding it has converged, whatever was asked of it.

mod bar;
mod cloth_square;

use bar::{bar, twisted};
use cloth_square::{corners, square, wrinkled};
use foldfree::deformation::{
    ClothOptions, Deformation, DeformationMethod, DeformationOptions, Material,
};
use foldfree::optim::{Status, StepReport};

fn run(mut deformation: Deformation) -> (f64, StepReport) {
    let first = deformation.solver().report().gradient_norm;
    while deformation.solver().status() == Status::Running {
        deformation.step().unwrap();
    }
    (first, deformation.solver().report().clone())
}

#[test]
fn cloth_converges() {
    let n = 12;
    let mesh = square(n);
    let pins = corners(n);
    for tolerance in [1e-9, 1e-12, 1e-15] {
        for (stretch, bending, pulled) in [
            (300.0, 1e-3, false),
            (1000.0, 1e-4, false),
            (300.0, 1e-3, true),
        ] {
            let start = match pulled {
                true => mesh.positions.iter().map(|p| *p * 1.02).collect(),
                false => wrinkled(&mesh, &pins),
            };
            let options = ClothOptions {
                stretch,
                bending,
                limits: None,
                method: DeformationMethod::Lbfgs,
                tolerance,
                ..Default::default()
            };
            let (first, report) =
                run(Deformation::of_cloth(&mesh, &start, &pins, &[], &options).unwrap());
            println!(
                "{tolerance:e} {stretch} {pulled}: {} {:?} {:e} gradient {:e} of {first:e}",
                report.iteration, report.status, report.energy, report.gradient_norm
            );
            assert!(
                matches!(report.status, Status::Converged(_)),
                "{tolerance:e}, {stretch}: {report:?}"
            );
            assert!(report.gradient_norm < 1e-4 * first);
        }
    }
}

/// Asked for more than numbers can give, it ends where rounding begins and says so, with minima that are
/// positive and with such that are 0.
#[test]
fn solids_end_where_rounding_begins() {
    let mesh = bar(6, 2);
    let (young, poisson) = (1e7, 0.45);
    for material in [
        Material::NeoHookean { young, poisson },
        Material::StableNeoHookean { young, poisson },
        Material::StVenantKirchhoff { young, poisson },
        Material::Arap,
        Material::SymmetricDirichlet,
    ] {
        for held in [true, false] {
            let (start, mut pins) = twisted(&mesh, 1.0);
            pins.retain(|&v| held || mesh.positions[v as usize].x == 0.0);
            let options = DeformationOptions {
                material,
                method: DeformationMethod::Lbfgs,
                tolerance: 1e-18,
                max_iterations: 3000,
                ..Default::default()
            };
            let (first, report) = run(Deformation::new(&mesh, &start, &pins, &options).unwrap());
            println!(
                "{material:?} {held}: {} {:?} {:e} gradient {:e} of {first:e}",
                report.iteration, report.status, report.energy, report.gradient_norm
            );
            assert!(
                matches!(report.status, Status::Converged(_)),
                "{material:?}, {held}: {report:?}"
            );
            // where the minimum is a number of some size, as a sum or as a difference, the energy is the
            // same long before the gradient is rounding
            let vanishes = !held && material != Material::SymmetricDirichlet;
            let least = if vanishes { 1e-9 } else { 1e-6 };
            assert!(report.gradient_norm <= least * first, "{material:?}");
        }
    }
}
