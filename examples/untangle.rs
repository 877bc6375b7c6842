//! Untangles generated solids and sheets whose boundaries are bent and held, from harmonic, random and one-point
//! starts: a table of what is left inverted (by the exact check) and of times.
//!
//! `cargo run --release --example untangle [tetrahedra]`

#[path = "../tests/untangle_problems/mod.rs"]
mod untangle_problems;

use foldfree::deformation::{Material, Untangling};
use foldfree::gini::GiniOptions;
use foldfree::mesh::SolidShape;
use foldfree::optim::{Solver, Status};
use untangle_problems::{Bend, Inside, Tangle, sheet, solid};

/// One line of the table; true if nothing is left inverted.
fn report<const K: usize>(name: &str, tangle: &Tangle<K>, mut untangling: Untangling) -> bool {
    let solver: &mut dyn Solver = untangling.solver_mut();
    let inverted = solver.report().inverted;
    let mut polish = 0;
    while solver.status() == Status::Running {
        match solver.step() {
            Ok(report) => polish += report.gini.map_or(0, |g| g.polish.len()),
            Err(error) => {
                println!("{name}: {error}");
                return false;
            }
        }
    }
    let (outcome, report) = (untangling.outcome(), untangling.solver().report());
    println!(
        "{name:34} {:6} elements {inverted:6} inverted: {:4} left, {:3} steps, {polish:4} polished, {:.3} + {:.3} s, least {:.1e}, η {:.0e}",
        tangle.rest.simplices.len(),
        outcome.not_positive.len(),
        report.iteration,
        untangling.setup_seconds(),
        report.seconds,
        outcome.smallest_measure,
        report.gini.as_ref().map_or(0.1, |g| g.least_offset),
    );
    outcome.not_positive.is_empty()
}

fn main() -> Result<(), foldfree::Error> {
    let count = std::env::args().nth(1).and_then(|n| n.parse().ok());
    let count = count.unwrap_or(5000usize);
    let options = GiniOptions::default();
    let (mut solved, mut all) = (0, 0);
    for shape in SolidShape::ALL {
        for bend in Bend::ALL {
            for inside in Inside::ALL {
                let t = solid(shape, count, bend, inside);
                let u = Untangling::of_solid(
                    &t.rest,
                    &t.start,
                    &t.pins,
                    &[],
                    Material::Arap,
                    &options,
                )?;
                all += 1;
                solved += usize::from(report(
                    &format!("{} {bend:?} {inside:?}", shape.name()),
                    &t,
                    u,
                ));
            }
        }
    }
    println!("solids: {solved} of {all}");
    let (mut solved, mut all) = (0, 0);
    for n in [20, 60] {
        for bend in Bend::ALL {
            for inside in Inside::ALL {
                let t = sheet(n, bend, inside);
                let u = Untangling::of_plane(
                    &t.rest,
                    &t.start,
                    &t.pins,
                    &[],
                    Material::Arap,
                    &options,
                )?;
                all += 1;
                solved += usize::from(report(&format!("sheet {n} {bend:?} {inside:?}"), &t, u));
            }
        }
    }
    println!("sheets: {solved} of {all}");
    Ok(())
}
