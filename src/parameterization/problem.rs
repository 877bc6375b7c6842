//! A mesh, made ready, and the solver that flattens it.

use super::atlas::Atlas;
use super::bijective::bijective;
use super::landmarks::{Landmark, Landmarks};
use super::shelves::lay_out;
use super::starts::start;
use super::{EnergyKind, Method, ParameterizationOptions, Start};
use crate::Error;
use crate::certificate::Certificate;
use crate::embedding::DirectMap;
use crate::energy::{Arap, Energy, SymmetricDirichlet};
use crate::geometry::{RestShape, surface_area};
use crate::local_global::ArapLocalGlobal;
use crate::mesh::{MeshError, SurfaceMesh};
use crate::newton::{Hybrid, Newton, NewtonOptions};
use crate::optim::{BuildError, Solver, StepReport, Stopwatch};
use crate::slim::slim;
use crate::space::Plane;
use crate::wrapd::{Linear, Problem, Reweighting, RotationAware, Wrapd, WrapdOptions};
use core::ops::Range;
use glam::DVec2;

/// A flattening in progress.
pub struct Parameterization {
    mesh: SurfaceMesh,
    input_vertices: Vec<u32>,
    seam_edges: usize,
    charts: Vec<Range<u32>>,
    notes: Vec<String>,
    /// Lengths of the input × `scale` = lengths of the solver, where the surface has unit area.
    scale: f64,
    start_kind: Start,
    setup_seconds: f64,
    solver: Box<dyn Solver>,
}

fn interleave(map: &[DVec2]) -> Vec<f64> {
    map.iter().flat_map(|p| [p.x, p.y]).collect()
}

/// Of each chart the vertex that is pinned.
fn central_vertices(map: &[DVec2], atlas: &Atlas) -> Vec<u32> {
    let charts = atlas.charts.iter().map(|chart| &chart.vertices);
    charts
        .map(|v| v.start + central_vertex(&map[v.start as usize..v.end as usize]))
        .collect()
}

/// The vertex nearest to the centre of the bounding box.
fn central_vertex(map: &[DVec2]) -> u32 {
    let low = map.iter().fold(DVec2::INFINITY, |a, &b| a.min(b));
    let high = map.iter().fold(DVec2::NEG_INFINITY, |a, &b| a.max(b));
    let centre = 0.5 * (low + high);
    let nearest = map
        .iter()
        .enumerate()
        .fold((0, f64::INFINITY), |best, (v, p)| {
            let d = p.distance_squared(centre);
            if d < best.1 { (v, d) } else { best }
        });
    nearest.0 as u32
}

impl Parameterization {
    /// Checks the mesh, cuts each of its pieces to a disk (or refuses), scales it to unit area, finds the start and
    /// builds the solver.
    ///
    /// # Errors
    /// [`MeshError`] for a mesh that cannot be flattened, [`BuildError`] for options out of range or a
    /// problem too large for the memory.
    pub fn new(mesh: &SurfaceMesh, options: &ParameterizationOptions) -> Result<Self, Error> {
        Self::with_landmarks(mesh, options, &[])
    }

    /// The same with places for some vertices: pulled there, or held. The start is turned and shifted to where
    /// they are, and held vertices take others with them; that may invert triangles, which the methods that begin
    /// with ADMM mend and the others refuse. Without any, the vertex at the middle of the start is held.
    ///
    /// # Errors
    /// As [`Self::new`]; `InvalidOption` for landmarks that name no vertex, or one twice, or one on a seam, and for
    /// methods that know none.
    pub fn with_landmarks(
        mesh: &SurfaceMesh,
        options: &ParameterizationOptions,
        landmarks: &[Landmark],
    ) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        options.validate()?;
        let vertices = mesh.positions.len();
        let mut atlas = Atlas::new(mesh, options.cut)?;
        let area = surface_area(&atlas.mesh);
        let scale = area.sqrt().recip();
        if !(scale.is_finite() && scale > 0.0) {
            return Err(MeshError::ZeroArea.into());
        }
        let rest = RestShape::of_surface(&atlas.mesh, scale)?;
        let direct = matches!(
            options.method,
            Method::Lscm | Method::Harmonic | Method::Tutte
        );
        let wanted = match options.start {
            Start::Automatic if direct => Start::Collapsed,
            kind => kind,
        };
        let bare = matches!(options.method, Method::Arap | Method::Gini | Method::GiniCm);
        if !landmarks.is_empty() && (direct || bare) {
            return Err(BuildError::InvalidOption {
                option: "landmarks",
                what: "are for the ADMM methods, cm, wrapd+cm and slim".into(),
            }
            .into());
        }
        if !landmarks.is_empty() && atlas.charts.len() > 1 {
            return Err(BuildError::InvalidOption {
                option: "landmarks",
                what: format!("are for one chart; there are {}", atlas.charts.len()),
            }
            .into());
        }
        let landmarks = Landmarks::new(landmarks, vertices, &atlas.input_vertices, scale)?;
        let (mut map, start_kind) = start(wanted, options.seed, &atlas, &rest, scale)?;
        if options.start == Start::Automatic && start_kind == Start::Tutte {
            let notes = &mut atlas.notes;
            notes.push("the harmonic start has flips: Tutte's embedding instead".into());
        }
        let external = landmarks.external(&rest, map.len(), 8.0 * options.landmark_stiffness);
        let pins = match landmarks.is_empty() {
            true => central_vertices(&map, &atlas),
            false => {
                landmarks.apply(&rest, &mut map)?;
                landmarks.pins()
            }
        };
        let positions = interleave(&map);
        let problem = Problem {
            rest: &rest,
            start: &positions,
            pins: &pins,
            external: external.as_ref(),
        };
        let solver: Box<dyn Solver> = match options.method {
            Method::Wrapd | Method::RAdmm | Method::WAdmm | Method::AdmmPd => {
                match options.energy {
                    EnergyKind::SymmetricDirichlet => admm(problem, SymmetricDirichlet, options)?,
                    EnergyKind::Arap => admm(problem, Arap, options)?,
                }
            }
            Method::Cm => Box::new(Newton::composite_majorization(
                problem,
                second_order(options),
            )?),
            Method::WrapdCm => Box::new(Hybrid::composite_majorization(
                problem,
                wrapd_options(options),
                second_order(options),
            )?),
            Method::Slim => Box::new(match options.energy {
                EnergyKind::SymmetricDirichlet => {
                    slim::<Plane, _>(problem, SymmetricDirichlet, second_order(options))?
                }
                EnergyKind::Arap => slim::<Plane, _>(problem, Arap, second_order(options))?,
            }),
            Method::Arap => Box::new(ArapLocalGlobal::<Plane>::new(
                problem,
                options.tolerance,
                options.max_iterations,
            )?),
            Method::Gini | Method::GiniCm => {
                let (solver, note) = bijective(&atlas, &rest, map, options, scale)?;
                atlas.notes.extend(note);
                solver
            }
            Method::Lscm | Method::Harmonic | Method::Tutte => {
                let clock = Stopwatch::start();
                let kind = match options.method {
                    Method::Lscm => Start::Lscm,
                    Method::Harmonic => Start::Harmonic,
                    _ => Start::Tutte,
                };
                let (map, _) = start(kind, options.seed, &atlas, &rest, scale)?;
                let seconds = clock.seconds();
                Box::new(DirectMap::new(rest, positions, interleave(&map), seconds))
            }
        };
        Ok(Self {
            charts: atlas.charts.iter().map(|c| c.vertices.clone()).collect(),
            mesh: atlas.mesh,
            input_vertices: atlas.input_vertices,
            seam_edges: atlas.seam_edges,
            notes: atlas.notes,
            scale,
            start_kind,
            setup_seconds: clock.seconds(),
            solver,
        })
    }

    /// The disk that is flattened, in the input's units: the input itself, or cut open. Its triangles
    /// are the input's, in the input's order.
    pub fn mesh(&self) -> &SurfaceMesh {
        &self.mesh
    }
    /// For each vertex of [`Self::mesh`], the vertex of the input it comes from.
    pub fn input_vertices(&self) -> &[u32] {
        &self.input_vertices
    }
    /// Number of edges cut; 0 if the input is a disk.
    pub fn seam_edges(&self) -> usize {
        self.seam_edges
    }
    /// What was mended or chosen, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
    /// The solver.
    pub fn solver(&self) -> &dyn Solver {
        &*self.solver
    }
    /// The solver, to be stepped.
    pub fn solver_mut(&mut self) -> &mut dyn Solver {
        &mut *self.solver
    }
    /// Takes one step.
    pub fn step(&mut self) -> Result<StepReport, Error> {
        Ok(self.solver.step()?)
    }
    /// The charts: of each its vertices in [`Self::mesh`]. One, unless the surface has several pieces.
    pub fn charts(&self) -> &[Range<u32>] {
        &self.charts
    }
    /// The map, a point a vertex of [`Self::mesh`], in the input's units; charts side by side.
    pub fn uv(&self) -> Vec<DVec2> {
        let unit = self.scale.recip();
        let positions = self.solver.positions().as_chunks::<2>().0.iter();
        let mut map: Vec<DVec2> = positions.map(|&[x, y]| unit * DVec2::new(x, y)).collect();
        lay_out(&mut map, &self.charts, 0.0);
        map
    }
    /// The start that was used (what `Automatic` became).
    pub fn start_kind(&self) -> Start {
        self.start_kind
    }
    /// Seconds that [`Self::new`] took.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }
    /// What is proven of the present map.
    pub fn certificate(&self) -> Certificate {
        Certificate::of_map(&self.mesh, &self.uv())
    }
}

/// What the options mean to a second-order solver.
fn second_order(options: &ParameterizationOptions) -> NewtonOptions {
    NewtonOptions {
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        ..Default::default()
    }
}

/// What they mean to an ADMM solver.
fn wrapd_options(options: &ParameterizationOptions) -> WrapdOptions {
    let reweighting = matches!(
        options.method,
        Method::Wrapd | Method::WAdmm | Method::WrapdCm
    );
    WrapdOptions {
        reweighting: reweighting.then_some(Reweighting::PARAMETERIZATION),
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        ..Default::default()
    }
}

/// The ADMM solver the method names: the paper's four curves differ in the coupling and in whether
/// weights change.
fn admm<E: Energy<Plane>>(
    problem: Problem,
    energy: E,
    options: &ParameterizationOptions,
) -> Result<Box<dyn Solver>, BuildError> {
    let settings = wrapd_options(options);
    Ok(match options.method {
        Method::Wrapd | Method::RAdmm => Box::new(Wrapd::new::<Plane, RotationAware, E>(
            problem, energy, settings,
        )?),
        _ => Box::new(Wrapd::new::<Plane, Linear, E>(problem, energy, settings)?),
    })
}
