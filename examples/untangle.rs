//! Untangles generated solids and sheets whose boundaries are bent and held, from harmonic, random and one-point
//! starts, and wheels whose spikes are smoothed away: a table of what is left inverted (by the exact check) and of times.
//!
//! `cargo run --release --example untangle [tetrahedra | wheels]`

#[path = "../tests/untangle_problems/mod.rs"]
mod untangle_problems;

use foldfree::deformation::{Material, Untangling};
use foldfree::gini::GiniOptions;
use foldfree::mesh::SolidShape;
use foldfree::optim::{Solver, Status};
use untangle_problems::{Bend, Inside, Tangle, sheet, solid, spiked_wheel};

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
    let wheels_only = std::env::args().nth(1).as_deref() == Some("wheels");
    for shape in SolidShape::ALL.into_iter().filter(|_| !wheels_only) {
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
    for n in [20, 60].into_iter().filter(|_| !wheels_only) {
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
    // the failure case of the paper (table 2)
    let (mut solved, mut all) = (0, 0);
    for smoothings in 1..=6 {
        for inside in std::iter::once(None).chain(Inside::ALL.map(Some)) {
            let t = spiked_wheel(smoothings, inside);
            let material = Material::Arap;
            let u = Untangling::of_solid(&t.rest, &t.start, &t.pins, &[], material, &options)?;
            let from = inside.map_or("Rest".to_string(), |i| format!("{i:?}"));
            all += 1;
            solved += usize::from(report(
                &format!("wheel, smoothed {smoothings}, {from}"),
                &t,
                u,
            ));
        }
    }
    println!("wheels: {solved} of {all}");
    Ok(())
}
