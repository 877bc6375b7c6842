//! What `deform` and `cloth` have in common: their arguments beside the body itself, and the run.

use crate::arguments::{names, positive, threads, tolerance};
use crate::failure::Failure;
use crate::progress::Progress;
use crate::report::{self, BodyCertificate, DeformReport, Iteration};
use crate::{Outcome, files, handles, say};
use clap::Args;
use foldfree::deformation::{Deformation, DeformationMethod, DeformationOptions, Target};
use foldfree::optim::{CancelToken, Solver, Status, Stopwatch};
use glam::DVec3;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Handles, method, and what to write.
#[derive(Debug, Args)]
pub struct Relaxation {
    /// Vertices held where they start: a text file of indices, the first vertex being 0.
    #[arg(long, value_name = "P")]
    pub pins: Option<PathBuf>,
    /// Points that vertices are pulled to: a text file of lines `index x y z`. A pinned vertex is moved
    /// to its point.
    #[arg(long, value_name = "T")]
    pub targets: Option<PathBuf>,
    /// Hold the vertices of --targets at their points instead of pulling at them.
    #[arg(long, requires = "targets")]
    pub hard: bool,
    /// How hard targets pull, relative to how hard the body holds on to a vertex.
    #[arg(long, value_name = "K", default_value_t = DeformationOptions::default().target_stiffness, value_parser = positive)]
    pub target_stiffness: f64,
    /// How; newton, wrapd+newton and lim are for solids, lim is also for triangles in the plane.
    #[arg(long, default_value = "wrapd", value_parser = names::<DeformationMethod>(&["wrapd", "r-admm", "w-admm", "admm-pd", "l-bfgs", "newton", "wrapd+newton", "lim"]))]
    pub method: DeformationMethod,
    /// Stop after this many iterations; 0: the start is the result.
    #[arg(long, value_name = "N", default_value_t = DeformationOptions::default().max_iterations)]
    pub iterations: usize,
    /// Stop when the change of the energy, relative to |E| and that of a strain of 1.1e-4 all over, is
    /// below this, or the gradient relative to the body's stiffness and size.
    #[arg(long, value_name = "T", default_value_t = DeformationOptions::default().tolerance, value_parser = tolerance)]
    pub tolerance: f64,
    /// Threads; 0: as many as the machine has.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads)]
    pub threads: usize,
    /// Write the deformed body: the vertices of a solid (.node), a solid (.mesh, .msh, .vtk), its surface or
    /// a cloth (.obj, .off, .ply, .stl; a cloth also .mesh, .msh, .vtk); also with .gz behind.
    #[arg(long, value_name = "OUT")]
    pub out: Option<PathBuf>,
    /// Write what happened, iteration by iteration, as JSON.
    #[arg(long, value_name = "REPORT.json")]
    pub report: Option<PathBuf>,
    /// Compare with a solution, a mesh of the same vertices, in a format that INIT could have:
    /// ‖x − x*‖/‖x₀ − x*‖.
    #[arg(long, value_name = "SOLUTION")]
    pub reference: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// The files of handles, read.
pub struct Handles {
    pub pins: Vec<u32>,
    pub targets: Vec<Target>,
    reference: Option<Vec<DVec3>>,
}

/// What a report says of the body.
pub struct Body<'a, O> {
    pub rest: &'a Path,
    pub init: &'a Path,
    pub options: O,
    pub vertices: usize,
    /// Of a cloth.
    pub triangles: Option<usize>,
    /// Of a solid.
    pub tetrahedra: Option<usize>,
    /// What the reader noted.
    pub notes: Vec<String>,
}

/// Fails when the start does not have the vertices of the rest shape.
pub fn check_start(init: &Path, start: &[DVec3], expected: usize) -> Result<(), Failure> {
    let found = start.len();
    if found == expected {
        return Ok(());
    }
    let what = format!("has {found} vertices, the rest shape {expected}");
    Err(Failure::of_file(init, what))
}

impl Relaxation {
    /// Says what cannot be written before the work, and makes the threads.
    pub fn prepare(&self) -> Result<(), Failure> {
        for path in [&self.out, &self.report].into_iter().flatten() {
            files::check_writable(path)?;
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build_global()
            .map_err(Failure::new)
    }

    /// Reads the handles of a body of so many vertices.
    pub fn read(
        &self,
        vertices: usize,
        read_positions: impl Fn(&Path) -> Result<Vec<DVec3>, Failure>,
    ) -> Result<Handles, Failure> {
        let mut pins = match &self.pins {
            Some(path) => handles::read_pins(path, vertices)?,
            None => Vec::new(),
        };
        let targets = match &self.targets {
            Some(path) => handles::read_targets(path, vertices)?,
            None => Vec::new(),
        };
        if self.hard {
            pins.extend(targets.iter().map(|t| t.vertex));
        }
        let reference = match &self.reference {
            Some(path) => {
                let solution = read_positions(path)?;
                if solution.len() != vertices {
                    let what = format!("has {} vertices, the start {vertices}", solution.len());
                    return Err(Failure::of_file(path, what));
                }
                Some(solution)
            }
            None => None,
        };
        Ok(Handles {
            pins,
            targets,
            reference,
        })
    }

    /// Solves, writes, reports.
    pub fn run<O: Serialize>(
        &self,
        mut deformation: Deformation,
        handles: Handles,
        body: Body<O>,
        write: impl Fn(&Path, Vec<DVec3>) -> Result<(), Failure>,
    ) -> Result<Outcome, Failure> {
        let mut notes = body.notes;
        notes.extend_from_slice(deformation.notes());
        if !self.quiet {
            notes.iter().for_each(|note| say(note));
        }
        let reference = handles.reference.as_deref();
        let mut progress = Progress::new(self.quiet, self.tolerance, self.iterations);
        let mut iterations = Vec::new();
        let first = reference.map(|solution| distance(deformation.solver(), solution));
        let mut observe = |solver: &dyn Solver| {
            let mut iteration = Iteration::from(solver.report());
            iteration.position_error = match (reference, first) {
                (Some(solution), Some(first)) => Some(distance(solver, solution) / first),
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

        if let Some(path) = &self.out {
            write(path, deformation.positions())?;
        }
        let clock = Stopwatch::start();
        let certificate = BodyCertificate::of(&deformation);
        let certificate_seconds = clock.seconds();
        let last = deformation.solver().report().clone();
        if !self.quiet {
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
        if let Some(path) = &self.report {
            let report = DeformReport {
                program: report::PROGRAM,
                rest: body.rest.display().to_string(),
                init: body.init.display().to_string(),
                status: status.name(),
                criterion: report::criterion(status),
                options: body.options,
                threads: rayon::current_num_threads(),
                vertices: body.vertices,
                triangles: body.triangles,
                tetrahedra: body.tetrahedra,
                pins: handles.pins.len(),
                targets: handles.targets.len(),
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
}

fn distance(solver: &dyn Solver, solution: &[DVec3]) -> f64 {
    // of triangles in the plane without z, in which nothing moves
    let dimension = solver.dimension();
    let positions = solver.positions().chunks_exact(dimension);
    let squares = positions.zip(solution).map(|(p, s)| {
        let coordinates = p.iter().zip(s.to_array());
        coordinates.map(|(p, s)| (p - s) * (p - s)).sum::<f64>()
    });
    squares.sum::<f64>().sqrt()
}
