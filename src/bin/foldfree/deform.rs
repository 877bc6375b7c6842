//! `foldfree deform`.

use crate::arguments::Deform;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::report::{self, DeformReport, Iteration};
use crate::solids::{read_positions, read_solid, write_deformed};
use crate::{Outcome, files, handles, say, solids};
use foldfree::deformation::Deformation;
use foldfree::optim::{CancelToken, Solver, Status, Stopwatch};
use glam::DVec3;

/// Reads, deforms, writes, reports.
pub fn run(arguments: &Deform) -> Result<Outcome, Failure> {
    let options = arguments.options();
    for path in [&arguments.out, &arguments.report].into_iter().flatten() {
        files::check_writable(path)?;
    }
    if let Some(path) = &arguments.out {
        solids::check_format(path)?;
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build_global()
        .map_err(Failure::new)?;
    let rest_path = arguments.rest.as_ref().unwrap_or(&arguments.init);
    let file = read_solid(rest_path)?;
    let rest = file.mesh;
    let start = read_positions(&arguments.init)?;
    if start.len() != rest.positions.len() {
        let (found, expected) = (start.len(), rest.positions.len());
        let what = format!("has {found} vertices, the rest shape {expected}");
        return Err(Failure::of_file(&arguments.init, what));
    }
    let mut pins = match &arguments.pins {
        Some(path) => handles::read_pins(path, start.len())?,
        None => Vec::new(),
    };
    let targets = match &arguments.targets {
        Some(path) => handles::read_targets(path, start.len())?,
        None => Vec::new(),
    };
    if arguments.hard {
        pins.extend(targets.iter().map(|t| t.vertex));
    }
    let reference = match &arguments.reference {
        Some(path) => {
            let solution = read_positions(path)?;
            if solution.len() != start.len() {
                let what = format!("has {} vertices, the start {}", solution.len(), start.len());
                return Err(Failure::of_file(path, what));
            }
            Some(solution)
        }
        None => None,
    };
    let mut deformation = Deformation::with_targets(&rest, &start, &pins, &targets, &options)
        .map_err(Failure::new)?;
    let notes: Vec<String> = file
        .notes
        .iter()
        .chain(deformation.notes())
        .cloned()
        .collect();
    if !arguments.quiet {
        notes.iter().for_each(|note| say(note));
    }

    let distance = |positions: &[f64], solution: &[DVec3]| {
        let positions = positions.as_chunks::<3>().0.iter();
        let squares = positions
            .zip(solution)
            .map(|(&p, s)| DVec3::from_array(p).distance_squared(*s));
        squares.sum::<f64>().sqrt()
    };
    let mut progress = Progress::new(arguments.quiet, options.tolerance, options.max_iterations);
    let mut iterations = Vec::new();
    let first = reference
        .as_ref()
        .map(|solution| distance(deformation.solver().positions(), solution));
    let mut observe = |solver: &dyn Solver| {
        let mut iteration = Iteration::from(solver.report());
        iteration.position_error = match (&reference, first) {
            (Some(solution), Some(first)) => Some(distance(solver.positions(), solution) / first),
            _ => None,
        };
        iterations.push(iteration);
        progress.show(solver.report());
    };
    let cancel = CancelToken::default();
    let clock = Stopwatch::start();
    let status = foldfree::optim::run(deformation.solver_mut(), &mut observe, &cancel)
        .map_err(Failure::new)?;
    let elapsed = clock.seconds();
    progress.finish();

    if let Some(path) = &arguments.out {
        write_deformed(path, &rest, deformation.positions())?;
    }
    let clock = Stopwatch::start();
    let certificate = deformation.certificate();
    let certificate_seconds = clock.seconds();
    let last = deformation.solver().report().clone();
    if !arguments.quiet {
        say(&format!(
            "{} after {} iterations: {:.3} s to set up, {elapsed:.3} s to solve; energy {:.10e}, {} inverted.",
            status.name(),
            last.iteration,
            deformation.setup_seconds(),
            last.energy,
            last.inverted,
        ));
        if let Some(certificate) = &certificate {
            say(&certificate.summary());
        }
        if let Some(error) = iterations.last().and_then(|i| i.position_error) {
            say(&format!("position error against the reference: {error:e}"));
        }
    }
    if let Some(path) = &arguments.report {
        let report = DeformReport {
            program: report::PROGRAM,
            rest: rest_path.display().to_string(),
            init: arguments.init.display().to_string(),
            status: status.name(),
            criterion: report::criterion(status),
            options,
            threads: rayon::current_num_threads(),
            vertices: rest.positions.len(),
            tetrahedra: rest.simplices.len(),
            pins: pins.len(),
            targets: targets.len(),
            notes,
            setup_seconds: deformation.setup_seconds(),
            seconds: last.seconds,
            iterations,
            certificate,
            certificate_seconds,
        };
        files::write(path, &report::to_json(&report)?)?;
    }
    Ok(match status {
        Status::Converged(_) => Outcome::Done,
        _ => Outcome::NotReached,
    })
}
