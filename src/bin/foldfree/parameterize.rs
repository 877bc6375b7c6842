//! `foldfree parameterize`.

use crate::arguments::Parameterize;
use crate::failure::Failure;
use crate::progress::Progress;
use crate::reference::Reference;
use crate::report::{self, Iteration, ParameterizeReport};
use crate::{Outcome, files, handles, say};
use foldfree::mesh::SurfaceMesh;
use foldfree::mesh::io::{CornerTexture, Format, write_obj};
use foldfree::optim::Stopwatch;
use foldfree::optim::{CancelToken, Solver, Status};
use foldfree::parameterization::{Landmark, Parameterization};
use glam::DVec2;
use std::path::Path;

/// Reads, flattens, writes, reports.
pub fn run(arguments: &Parameterize) -> Result<Outcome, Failure> {
    let options = arguments.options().map_err(Failure::new)?;
    check_outputs(arguments)?;
    rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build_global()
        .map_err(Failure::new)?;

    let clock = Stopwatch::start();
    let input = files::read_mesh(&arguments.input)?;
    let read_seconds = clock.seconds();
    let of_input = |error: foldfree::Error| Failure::of_file(&arguments.input, error);
    let landmarks = match &arguments.landmarks {
        Some(path) => read_landmarks(path, input.mesh.positions.len(), arguments.hard)?,
        None => Vec::new(),
    };
    let mut map =
        Parameterization::with_landmarks(&input.mesh, &options, &landmarks).map_err(of_input)?;
    let reference = match &arguments.reference {
        Some(path) => Some(Reference::read(path, &input.mesh, &map)?),
        None => None,
    };
    let notes: Vec<String> = input.notes.iter().chain(map.notes()).cloned().collect();
    if !arguments.quiet {
        notes.iter().for_each(|note| say(note));
    }

    let mut progress = Progress::new(arguments.quiet, options.tolerance, options.max_iterations);
    let mut iterations = Vec::new();
    let mut observe = |solver: &dyn Solver| {
        let step = solver.report();
        iterations.push(Iteration::from(step));
        progress.show(step);
    };
    let status = if options.max_iterations == 0 {
        observe(map.solver());
        Status::MaxIterations
    } else {
        let cancel = CancelToken::default();
        foldfree::optim::run(map.solver_mut(), &mut observe, &cancel)
            .map_err(|error| of_input(error.into()))?
    };
    progress.finish();

    let uv = map.uv();
    if let Some(path) = &arguments.out {
        files::write(path, &textured(&input.mesh, &map, &uv))?;
    }
    let clock = Stopwatch::start();
    let certificate = map.certificate();
    let certificate_seconds = clock.seconds();
    let seconds = iterations.last().map_or(0.0, |i: &Iteration| i.seconds);
    if !arguments.quiet {
        let steps = iterations.last().map_or(0, |i| i.iteration);
        say(&format!(
            "{} after {steps} {}: {:.3} s to set up, {seconds:.3} s to solve.",
            words(status),
            if steps == 1 {
                "iteration"
            } else {
                "iterations"
            },
            map.setup_seconds(),
        ));
        say(&certificate.summary());
    }
    let reference = reference.map(|r| r.compare(&uv, &certificate, &iterations));
    if let (Some(comparison), false) = (&reference, arguments.quiet) {
        say(&comparison.summary());
    }
    if let Some(path) = &arguments.report {
        let report = ParameterizeReport {
            program: report::PROGRAM,
            input: arguments.input.display().to_string(),
            status: status.name(),
            criterion: report::criterion(status),
            options,
            threads: rayon::current_num_threads(),
            start: report::name(&map.start_kind()),
            vertices: map.mesh().positions.len(),
            triangles: map.mesh().simplices.len(),
            seam_edges: map.seam_edges(),
            notes,
            read_seconds,
            setup_seconds: map.setup_seconds(),
            seconds,
            iterations,
            certificate,
            certificate_seconds,
            reference,
        };
        files::write(path, &report::to_json(&report)?)?;
    }
    Ok(match status {
        Status::Converged(_) => Outcome::Done,
        _ => Outcome::NotReached,
    })
}

fn read_landmarks(path: &Path, vertices: usize, hard: bool) -> Result<Vec<Landmark>, Failure> {
    let targets = handles::read_targets(path, vertices)?;
    if let Some(solid) = targets.iter().find(|t| t.position.z != 0.0) {
        let what = format!(
            "vertex {}: a place in the plane has two coordinates",
            solid.vertex
        );
        return Err(Failure::of_file(path, what));
    }
    let places = targets.iter().map(|target| Landmark {
        vertex: target.vertex,
        uv: target.position.truncate(),
        hard,
    });
    Ok(places.collect())
}

/// Says before the work what would go wrong after it.
fn check_outputs(arguments: &Parameterize) -> Result<(), Failure> {
    if let Some(path) = &arguments.out
        && files::format(path)? != Format::Obj
    {
        let what =
            "a map is written as .obj (or .obj.gz): the format has to hold texture coordinates";
        return Err(Failure::of_file(path, what));
    }
    let outputs = [&arguments.out, &arguments.report];
    let mut outputs = outputs.into_iter().flatten();
    outputs.try_for_each(|path: &std::path::PathBuf| files::check_writable(Path::new(path)))
}

fn words(status: Status) -> &'static str {
    match status {
        Status::Running => "Running",
        Status::Converged(_) => "Converged",
        Status::MaxIterations => "Not converged",
        Status::Stalled => "Stalled",
        Status::Cancelled => "Cancelled",
    }
}

/// The surface as it came, with the map as texture coordinates: seams are only in the texture.
fn textured(input: &SurfaceMesh, map: &Parameterization, uv: &[DVec2]) -> Vec<u8> {
    let source = map.input_vertices();
    let disk = &map.mesh().simplices;
    let surface = SurfaceMesh {
        positions: input.positions.clone(),
        simplices: disk.iter().map(|t| t.map(|v| source[v as usize])).collect(),
    };
    let texture = CornerTexture {
        coordinates: uv.to_vec(),
        corners: disk.clone(),
    };
    write_obj(&surface, Some(&texture))
}
