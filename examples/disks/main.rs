//! Flattens generated disks, from tame to nasty, by WRAPD and composite majorization, and says which reached the
//! minimum.
//!
//! `cargo run --release --example disks [first seed] [count] [mesh.obj]`; with a file name the first disk is written
//! there, and nothing is flattened. Set RAYON_NUM_THREADS=1 to compare times.

mod patch;
mod shapes;

use foldfree::geometry::{RestShape, surface_area};
use foldfree::newton::{Newton, NewtonOptions};
use foldfree::optim::{Solver, Status};
use foldfree::parameterization::{Method, Parameterization, ParameterizationOptions};
use foldfree::wrapd::Problem;
use shapes::Disk;
use std::error::Error;
use std::io::Write;

/// As near to the minimum as this is there.
const NEAR: f64 = 1e-6;

/// One disk in so many is also flattened by composite majorization alone.
const SAMPLE: u64 = 10;

/// Iterations of a run, and of what follows it to find out where it would have ended.
const MOST: usize = 1000;
const MOST_AFTER: usize = 600;

/// How a run ended.
struct Run {
    status: &'static str,
    iterations: usize,
    switched_at: Option<usize>,
    seconds: f64,
    /// Energy after every iteration, infinite where triangles are inverted.
    energies: Vec<f64>,
    inverted: usize,
    map: Vec<f64>,
}

fn run(disk: &Disk, method: Method) -> Result<Run, Box<dyn Error>> {
    let options = ParameterizationOptions {
        method,
        tolerance: 1e-12,
        max_iterations: MOST,
        ..Default::default()
    };
    let mut map = Parameterization::new(&disk.mesh, &options)?;
    let mut energies = Vec::new();
    while map.solver().status() == Status::Running {
        let report = map.step()?;
        energies.push(match report.inverted {
            0 => report.energy,
            _ => f64::INFINITY,
        });
    }
    let report = map.solver().report();
    Ok(Run {
        status: report.status.name(),
        iterations: report.iteration,
        switched_at: report.switched_at,
        seconds: map.setup_seconds() + report.seconds,
        inverted: map.certificate().inverted.len(),
        energies,
        map: map.solver().positions().to_vec(),
    })
}

/// Where a map ends when composite majorization goes on from it until no step lowers the energy.
fn end_of(disk: &Disk, map: &[f64]) -> Result<f64, Box<dyn Error>> {
    let scale = surface_area(&disk.mesh).sqrt().recip();
    let rest = RestShape::of_surface(&disk.mesh, scale)?;
    let problem = Problem {
        rest: &rest,
        start: map,
        pins: &[],
        external: None,
    };
    let options = NewtonOptions {
        tolerance: 0.0,
        turning: true,
        max_iterations: MOST_AFTER,
        ..Default::default()
    };
    let mut solver = Newton::composite_majorization(problem, options)?;
    // ten steps of rounding are enough: a stall does not always show at once
    let mut quiet = 0;
    while solver.status() == Status::Running && quiet < 10 {
        let before = solver.report().energy;
        let after = solver.step()?.energy;
        quiet = if before - after < 1e-13 * before {
            quiet + 1
        } else {
            0
        };
    }
    Ok(solver.report().energy)
}

/// Flattens one disk and prints a line; was the minimum reached, and in how many iterations?
fn flatten(seed: u64, disk: &Disk) -> Result<(bool, &'static str), Box<dyn Error>> {
    let found = run(disk, Method::WrapdCm)?;
    let last = found.energies.last().copied().unwrap_or(f64::INFINITY);
    let mut best = match found.inverted {
        0 => end_of(disk, &found.map)?.min(last),
        _ => last,
    };
    let mut beside = String::new();
    if seed.is_multiple_of(SAMPLE) {
        match run(disk, Method::Cm) {
            Ok(alone) => {
                let end = end_of(disk, &alone.map)?;
                beside = format!(
                    ", cm alone: {} iterations, {:.2} s, E* {:+.1e}",
                    alone.iterations,
                    alone.seconds,
                    end / best - 1.0
                );
                best = best.min(end);
            }
            Err(error) => beside = format!(", cm alone: {error}"),
        }
    }
    let near = found
        .energies
        .iter()
        .position(|e| *e <= best * (1.0 + NEAR));
    let reached = near.is_some() && found.inverted == 0 && last.is_finite();
    println!(
        "{seed} {} triangles, {} ({:.2}): {} iterations, {:.2} s, energy {last:.9}, {} inverted, {}, began at {:?}, {:.0e} above, {}{beside}",
        disk.mesh.simplices.len(),
        disk.kind,
        disk.nastiness,
        found.iterations,
        found.seconds,
        found.inverted,
        found.status,
        found.switched_at.unwrap_or(0),
        last / best - 1.0,
        match near {
            Some(k) => format!("1e-6 after {}", k + 1),
            None => "1e-6 NOT REACHED".into(),
        },
    );
    Ok((reached, found.status))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut number = |otherwise| arguments.next().map_or(Ok(otherwise), |n| n.parse::<u64>());
    let (first, count) = (number(0)?, number(16)?);
    if let Some(file) = arguments.next() {
        let mesh = shapes::disk(first).mesh;
        let mut out = std::io::BufWriter::new(std::fs::File::create(file)?);
        for p in &mesh.positions {
            writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
        }
        for t in &mesh.simplices {
            writeln!(out, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1)?;
        }
        return Ok(());
    }
    let (mut failed, mut converged) = (Vec::new(), 0);
    for seed in first..first + count {
        match flatten(seed, &shapes::disk(seed)) {
            Ok((reached, status)) => {
                converged += usize::from(status == "converged");
                if !reached {
                    failed.push(seed);
                }
            }
            Err(error) => {
                println!("{seed} {}: ERROR {error}", shapes::disk(seed).kind);
                failed.push(seed);
            }
        }
    }
    println!(
        "{count} disks: {converged} met the tolerance, {} did not reach 1e-6 ({:.1} %): {failed:?}",
        failed.len(),
        100.0 * failed.len() as f64 / count.max(1) as f64
    );
    Ok(())
}
