//! Bodies that would pass through each other on the way to where their pins go: a table of steps, contacts and times.
//!
//! `cargo run --release --example overlap [cells] [problem] [-v]`: cells along the thin side of the bodies; with -v every
//! step.

#[path = "../tests/overlap_problems/mod.rs"]
mod overlap_problems;

use foldfree::deformation::{Material, Untangling};
use foldfree::gini::GiniOptions;
use foldfree::optim::Status;
use overlap_problems::*;

fn options() -> GiniOptions {
    GiniOptions {
        settle: 0.0,
        ..GiniOptions::overlap()
    }
}

/// What the steps of a run did.
#[derive(Default)]
struct Sum {
    steps: usize,
    polished: usize,
    contacts: usize,
    seconds: f64,
    collision: f64,
}

impl Sum {
    fn run(&mut self, u: &mut Untangling, verbose: bool) -> Status {
        while u.solver().status() == Status::Running {
            let report = match u.step() {
                Ok(report) => report,
                Err(error) => {
                    println!("{error}");
                    break;
                }
            };
            let gini = report.gini.expect("a step of GINI");
            self.steps += 1;
            self.polished += gini.polish.len();
            self.contacts = self.contacts.max(gini.contacts);
            self.collision += 1e-3 * gini.collision_milliseconds;
            if verbose {
                println!(
                    "  step {} qp {} of {} active, {} contacts, accepted {}, energy {:.4e}, least {:.2e}, η {:.1e}",
                    report.iteration,
                    gini.active,
                    gini.constraints,
                    gini.contacts,
                    gini.accepted,
                    report.energy,
                    gini.smallest_measure,
                    gini.least_offset
                );
                for p in &gini.polish {
                    print!(
                        " {}/{}/{}/{}",
                        p.inverted, p.collisions, p.violated, p.zones
                    );
                }
                println!();
            }
        }
        self.seconds = u.solver().report().seconds;
        u.solver().status()
    }

    fn line(&self, name: &str, elements: usize, status: Status, u: &Untangling) {
        let outcome = u.outcome();
        println!(
            "{name:24} {elements:7} elements: {}, injective {:?}, {} pairs meet, {:3} steps, {:4} polished, {:5} contacts, {:.3} s, {:.3} s of them collisions, least {:.1e}",
            status.name(),
            outcome.globally_injective,
            outcome.intersections.unwrap_or(0),
            self.steps,
            self.polished,
            self.contacts,
            self.seconds,
            self.collision,
            outcome.smallest_measure,
        );
    }
}

fn follow<const K: usize>(name: &str, problem: &Moves<K>, mut u: Untangling, verbose: bool) {
    let mut sum = Sum::default();
    let mut status = u.solver().status();
    for (k, pins) in problem.moves.iter().enumerate() {
        if verbose {
            println!("move {k}");
        }
        if let Err(error) = u.move_pins(pins) {
            println!("{name}: {error}");
            return;
        }
        status = sum.run(&mut u, verbose);
        if !matches!(status, Status::Converged(_)) {
            break;
        }
    }
    sum.line(name, problem.rest.simplices.len(), status, &u);
}

fn main() -> Result<(), foldfree::Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let fine = arguments.first().and_then(|n| n.parse().ok()).unwrap_or(3);
    let only = arguments.get(1).map(String::as_str).unwrap_or("");
    let verbose = arguments.iter().any(|a| a == "-v");
    let solids = [
        ("interlocked-arms", interlocked_arms(fine)),
        ("folded-sheet", folded_sheet(fine)),
        ("twisted-beam", twisted_beam(fine, 4)),
        ("sliding-boxes", sliding_boxes(fine)),
        ("parallel-edges", parallel_edges(fine)),
        // no constant was chosen on those that follow
        ("linked-rings", linked_rings(fine)),
        ("combs", combs(fine)),
        ("peg", peg(fine)),
        ("buckling-beam", buckling_beam(fine)),
        ("stack", stack(fine)),
    ];
    let material = Material::Arap;
    for (name, problem) in &solids {
        if only.is_empty() || only == *name {
            let Moves {
                rest, start, pins, ..
            } = problem;
            let u = Untangling::of_solid(rest, start, pins, &[], material, &options())?;
            follow(name, problem, u, verbose);
        }
    }
    let planar = [
        ("arms in the plane", interlocked_arms_in_the_plane(3 * fine)),
        ("gears in the plane", gears_in_the_plane(fine)),
    ];
    for (name, problem) in planar {
        if !(only.is_empty() || only == "plane") {
            continue;
        }
        let Moves {
            rest, start, pins, ..
        } = &problem;
        let u = Untangling::of_plane(rest, start, pins, &[], material, &options())?;
        follow(name, &problem, u, verbose);
    }
    if only.is_empty() || only == "press" {
        let press = Press::new(3 * fine);
        let Moves {
            rest, start, pins, ..
        } = &press.problem;
        let mut u = Untangling::of_solid(rest, start, pins, &[], material, &options())?;
        let (mut sum, mut scale, mut status) = (Sum::default(), 1.0, Status::Running);
        let mut reached = 1.0;
        while reached > 0.1 {
            scale *= 0.97;
            if let Err(error) = u.move_pins(&press.walls(scale)) {
                println!("{error}");
                break;
            }
            status = sum.run(&mut u, verbose);
            reached = press.volume(&u.positions());
            if verbose {
                println!(
                    "walls at {scale:.3}: {:.1} % of its volume",
                    100.0 * reached
                );
            }
            if !matches!(status, Status::Converged(_)) {
                break;
            }
        }
        sum.line("shrinking box", press.ball[1], status, &u);
        println!("pressed to {:.1} % of its volume", 100.0 * reached);
    }
    Ok(())
}
