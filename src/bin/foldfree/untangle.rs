//! `foldfree untangle`.

use crate::arguments::{positive, threads};
use crate::failure::Failure;
use crate::relaxation::check_start;
use crate::report::{self, Iteration, snake_keys};
use crate::solids::{self, read_positions, read_solid, write_deformed};
use crate::{Outcome, files, handles, say};
use clap::Args;
use clap::builder::PossibleValuesParser;
use foldfree::certificate::{Certificate, SolidCertificate};
use foldfree::deformation::{Material, Target, Untangling, UntanglingOptions};
use foldfree::embedding::Flowed;
use foldfree::gini::GiniOptions;
use foldfree::mesh::{SolidMesh, SurfaceMesh, io};
use foldfree::newton::NewtonOptions;
use foldfree::optim::{CancelToken, Solver, Status, Stopwatch};
use glam::{DVec2, DVec3};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Energies, the first being the default.
const ENERGIES: &[&str] = &[
    "arap",
    "neo-hookean",
    "stable-neo-hookean",
    "symmetric-dirichlet",
    "dirichlet",
];

/// Untangle a map: from any start of a solid, or of triangles in the plane, to one without inverted elements; exit
/// code 2 when some are left.
#[derive(Debug, Args)]
pub struct Untangle {
    /// Rest shape: .node and .ele (either name stands for both), .mesh, .msh or .vtk, or triangles in a plane
    /// z = constant (.obj, .off, .ply, .stl and these), also with .gz behind. INIT if left out.
    #[arg(long, value_name = "R")]
    pub rest: Option<PathBuf>,
    /// Where it starts, in any of these formats.
    #[arg(long, value_name = "I")]
    pub init: PathBuf,
    /// Vertices held where they start: a text file of indices, the first vertex being 0. There may be none.
    #[arg(long, value_name = "P")]
    pub pins: Option<PathBuf>,
    /// Points that vertices are pulled to: a text file of lines `index x y z`. A pinned vertex is moved to its point.
    #[arg(long, value_name = "T")]
    pub targets: Option<PathBuf>,
    /// Hold the vertices of --targets at their points instead of pulling at them.
    #[arg(long, requires = "targets")]
    pub hard: bool,
    /// Keep the boundary from passing through itself or through other bodies. That of INIT must not meet itself (or see
    /// --flow); pins with targets move there while the way is free.
    #[arg(long)]
    pub overlap: bool,
    /// INIT's boundary is where the boundary is wanted, and may meet itself: there it is first parted by mean curvature
    /// flow, then every vertex of it that has no target is pulled back. Pins go back to where they are in INIT.
    #[arg(long, requires = "overlap")]
    pub flow: bool,
    /// Then lower the energy (not arap or dirichlet, whose minima fold) by Newton's method; it keeps all elements positive
    /// and, with --overlap, the boundary from meeting itself.
    #[arg(long)]
    pub minimize: bool,
    /// With --minimize: stop when the energy changes by less than this part in a step.
    #[arg(long, value_name = "T", requires = "minimize", default_value_t = 1e-6, value_parser = positive)]
    pub tolerance: f64,
    /// How hard targets pull, relative to how hard the body holds on to the vertex it holds on to most: 1, with
    /// --overlap 1e-5.
    #[arg(long, value_name = "K", value_parser = positive)]
    pub target_stiffness: Option<f64>,
    /// What is kept low on the way; the neo-Hookean ones are for solids.
    #[arg(long, default_value = ENERGIES[0], value_parser = PossibleValuesParser::new(ENERGIES))]
    pub energy: String,
    /// Young's modulus (neo-hookean, stable-neo-hookean).
    #[arg(long, value_name = "E", default_value_t = Material::YOUNG)]
    pub young: f64,
    /// Poisson's ratio (the same).
    #[arg(long, value_name = "N", default_value_t = Material::POISSON)]
    pub poisson: f64,
    /// Stop after this many steps, and with --minimize after as many of Newton's method; 0: the start is the result.
    #[arg(long, value_name = "N", default_value_t = GiniOptions::default().max_iterations)]
    pub iterations: usize,
    /// Threads; 0: as many as the machine has.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads)]
    pub threads: usize,
    /// Write the map: the vertices of a solid (.node), a solid (.mesh, .msh, .vtk), its surface or triangles (.obj,
    /// .off, .ply, .stl; triangles also .mesh, .msh, .vtk); also with .gz behind.
    #[arg(long, value_name = "OUT")]
    pub out: Option<PathBuf>,
    /// Write what happened, step by step, as JSON.
    #[arg(long, value_name = "REPORT.json")]
    pub report: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// REPORT.json.
#[derive(Debug, Serialize)]
struct UntangleReport<C: Serialize> {
    program: &'static str,
    rest: String,
    init: String,
    /// `converged`, `max-iterations`, `stalled`.
    status: &'static str,
    criterion: Option<String>,
    energy: String,
    #[serde(serialize_with = "snake_keys")]
    options: GiniOptions,
    /// With --minimize: its tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    minimized_to: Option<f64>,
    threads: usize,
    vertices: usize,
    elements: usize,
    pins: usize,
    targets: usize,
    notes: Vec<String>,
    /// With --flow: how the start's boundary was parted.
    #[serde(skip_serializing_if = "Option::is_none")]
    flow: Option<Flowed>,
    setup_seconds: f64,
    /// Seconds of all steps.
    seconds: f64,
    iterations: Vec<Iteration>,
    #[serde(serialize_with = "snake_keys")]
    outcome: foldfree::gini::Outcome,
    #[serde(serialize_with = "snake_keys")]
    certificate: C,
    certificate_seconds: f64,
}

/// Reads, untangles, writes, reports.
pub fn run(arguments: &Untangle) -> Result<Outcome, Failure> {
    let rest = arguments.rest.as_ref().unwrap_or(&arguments.init);
    match solids::read_if_solid(rest)? {
        Some(_) => solid(arguments, rest),
        None => planar(arguments, rest),
    }
}

fn solid(arguments: &Untangle, rest_path: &Path) -> Result<Outcome, Failure> {
    if let Some(path) = &arguments.out {
        solids::check_format(path)?;
    }
    arguments.prepare()?;
    let file = read_solid(rest_path)?;
    let rest: SolidMesh = file.mesh;
    let start = read_positions(&arguments.init)?;
    check_start(&arguments.init, &start, rest.positions.len())?;
    let (pins, targets) = arguments.handles(start.len())?;
    let (material, options) = (arguments.material(), arguments.settings());
    let new = match arguments.flow {
        true => Untangling::through_flow,
        false => Untangling::of_solid,
    };
    let untangling =
        new(&rest, &start, &pins, &targets, material, options).map_err(Failure::new)?;
    let body = Body {
        path: rest_path,
        elements: rest.simplices.len(),
        handles: [pins.len(), targets.len()],
        notes: file.notes,
    };
    let write = |path: &Path, to| write_deformed(path, &rest, to);
    arguments.run(untangling, body, write, |positions| {
        let certificate = SolidCertificate::of_solid(&rest, positions);
        let words = certificate.summary();
        (certificate, words)
    })
}

fn planar(arguments: &Untangle, rest_path: &Path) -> Result<Outcome, Failure> {
    if let Some(path) = &arguments.out {
        files::format(path)?;
    }
    arguments.prepare()?;
    let file = files::read_mesh(rest_path)?;
    let rest: SurfaceMesh = file.mesh;
    let start = files::read_mesh(&arguments.init)?.mesh.positions;
    check_start(&arguments.init, &start, rest.positions.len())?;
    let (pins, targets) = arguments.handles(start.len())?;
    let (material, options) = (arguments.material(), arguments.settings());
    let new = match arguments.flow {
        true => Untangling::through_flow_in_plane,
        false => Untangling::of_plane,
    };
    let untangling =
        new(&rest, &start, &pins, &targets, material, options).map_err(Failure::new)?;
    let body = Body {
        path: rest_path,
        elements: rest.simplices.len(),
        handles: [pins.len(), targets.len()],
        notes: file.notes,
    };
    let write = |path: &Path, positions| {
        let map = SurfaceMesh {
            positions,
            simplices: rest.simplices.clone(),
        };
        files::write(path, &io::write(&map, files::format(path)?))
    };
    arguments.run(untangling, body, write, |positions| {
        let uv: Vec<DVec2> = positions.iter().map(|p| p.truncate()).collect();
        let certificate = Certificate::of_map(&rest, &uv);
        let words = certificate.summary();
        (certificate, words)
    })
}

/// What a report says of the body.
struct Body<'a> {
    path: &'a Path,
    elements: usize,
    /// Pins and targets.
    handles: [usize; 2],
    notes: Vec<String>,
}

impl Untangle {
    fn prepare(&self) -> Result<(), Failure> {
        for path in [&self.out, &self.report].into_iter().flatten() {
            files::check_writable(path)?;
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build_global()
            .map_err(Failure::new)
    }

    fn handles(&self, vertices: usize) -> Result<(Vec<u32>, Vec<Target>), Failure> {
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
        Ok((pins, targets))
    }

    fn material(&self) -> Material {
        // the names are checked by the parser
        Material::named(&self.energy, self.young, self.poisson).unwrap_or(Material::Arap)
    }

    fn options(&self) -> GiniOptions {
        let defaults = match self.overlap {
            true => GiniOptions::overlap(),
            false => GiniOptions::default(),
        };
        GiniOptions {
            target_stiffness: self.target_stiffness.unwrap_or(defaults.target_stiffness),
            max_iterations: self.iterations,
            ..defaults
        }
    }

    fn settings(&self) -> UntanglingOptions {
        UntanglingOptions {
            gini: self.options(),
            minimize: self.minimize.then(|| NewtonOptions {
                tolerance: self.tolerance,
                max_iterations: self.iterations,
                ..NewtonOptions::default()
            }),
        }
    }

    fn run<C: Serialize>(
        &self,
        mut untangling: Untangling,
        body: Body,
        write: impl Fn(&Path, Vec<DVec3>) -> Result<(), Failure>,
        certify: impl Fn(&[DVec3]) -> (C, String),
    ) -> Result<Outcome, Failure> {
        let mut notes = body.notes;
        notes.extend_from_slice(untangling.notes());
        if !self.quiet {
            notes.iter().for_each(|note| say(note));
        }
        let mut iterations = Vec::new();
        let mut observe = |solver: &dyn Solver| iterations.push(Iteration::from(solver.report()));
        let cancel = CancelToken::default();
        let status = foldfree::optim::run(untangling.solver_mut(), &mut observe, &cancel)
            .map_err(Failure::new)?;
        let positions = untangling.positions();
        let clock = Stopwatch::start();
        let (certificate, words) = certify(&positions);
        let certificate_seconds = clock.seconds();
        let outcome = untangling.outcome();
        let last = untangling.solver().report();
        if !self.quiet {
            say(&format!(
                "{} after {} steps: {:.3} s to set up, {:.3} s to solve; {} inverted or degenerate, smallest measure {:.3e} of that at rest.",
                status.name(),
                last.iteration,
                untangling.setup_seconds(),
                last.seconds,
                outcome.not_positive.len(),
                outcome.smallest_measure,
            ));
            match outcome.globally_injective {
                Some(true) => {
                    say("No two points of the bodies have the same image (proven exactly).")
                }
                Some(false) => say("Not proven injective as a whole."),
                None => {}
            }
            outcome.obstacles().iter().for_each(|words| say(words));
            say(&words);
        }
        let seconds = last.seconds;
        if let Some(path) = &self.report {
            let report = UntangleReport {
                program: report::PROGRAM,
                rest: body.path.display().to_string(),
                init: self.init.display().to_string(),
                status: status.name(),
                criterion: report::criterion(status),
                energy: self.energy.clone(),
                options: self.options(),
                minimized_to: self.minimize.then_some(self.tolerance),
                threads: rayon::current_num_threads(),
                vertices: positions.len(),
                elements: body.elements,
                pins: body.handles[0],
                targets: body.handles[1],
                notes,
                flow: untangling.flowed().cloned(),
                setup_seconds: untangling.setup_seconds(),
                seconds,
                iterations,
                outcome,
                certificate,
                certificate_seconds,
            };
            files::write(path, &report::to_json(&report)?)?;
        }
        if let Some(path) = &self.out {
            write(path, positions)?;
        }
        Ok(match status {
            Status::Converged(_) => Outcome::Done,
            _ => Outcome::NotReached,
        })
    }
}
