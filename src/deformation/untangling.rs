//! Untangling: from any start to a map without inverted elements.

use super::body::check;
use super::engine::{Engine, UntanglingOptions};
use super::injective::flat;
use super::{Material, Supports, Target};
use crate::Error;
use crate::certificate::{Certificate, SolidCertificate};
use crate::embedding::Flowed;
use crate::geometry::RestShape;
use crate::gini::{GiniProblem, Outcome, TraceState};
use crate::mesh::{SimplicialMesh, SolidMesh, SurfaceMesh};
use crate::optim::{BuildError, Solver, StepReport, Stopwatch};
use glam::{DVec2, DVec3};

/// An untangling in progress, of a solid or of triangles in a plane z = constant.
pub struct Untangling {
    solver: Body,
    pub(super) notes: Vec<String>,
    pub(super) setup_seconds: f64,
    /// z, in the plane.
    level: f64,
    rest: Rest,
    pub(super) flowed: Option<Flowed>,
}

/// What certificates compare with.
enum Rest {
    Plane(SurfaceMesh),
    Solid(SolidMesh),
}

enum Body {
    Plane(Engine<2>),
    Solid(Engine<3>),
}

impl Untangling {
    /// Of tetrahedra. `start` has one position a vertex; pins are held there, or, where they have targets, at these;
    /// targets of other vertices pull. A component without either is free. With [`GiniOptions::overlap`](crate::gini::GiniOptions::overlap) pins with
    /// targets begin where they start, and move there as soon as the way is free.
    ///
    /// # Errors
    /// [`MeshError`](crate::mesh::MeshError) for a rest shape that is none, [`BuildError`] for pins, targets, start
    /// or options that do not fit it, and for `material` st-venant-kirchhoff, whose minima fold.
    pub fn of_solid(
        rest: &SolidMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        material: Material,
        options: impl Into<UntanglingOptions>,
    ) -> Result<Self, Error> {
        let options = options.into();
        let clock = Stopwatch::start();
        check(rest, start)?;
        let (shape, turned) = RestShape::of_solid(rest)?;
        let mut notes = Vec::new();
        if turned {
            notes.push("the mesh was inside out: all tetrahedra were turned".into());
        }
        let keep = options.gini.overlap;
        let prepared = Prepared::new(rest, start, pins, targets, (3, keep), &mut notes)?;
        let problem = prepared.problem(&shape);
        let mut solver = Engine::of_solid(problem, material, &options)?;
        if !prepared.moves.is_empty() {
            solver.move_pins(&prepared.moves)?;
        }
        Ok(Self {
            solver: Body::Solid(solver),
            notes,
            setup_seconds: clock.seconds(),
            level: 0.0,
            rest: Rest::Solid(rest.clone()),
            flowed: None,
        })
    }

    /// The same of triangles in a plane z = constant, with ARAP, symmetric Dirichlet or Dirichlet.
    ///
    /// # Errors
    /// The same, and `InvalidOption` for vertices outside the plane of the first.
    pub fn of_plane(
        rest: &SurfaceMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        material: Material,
        options: impl Into<UntanglingOptions>,
    ) -> Result<Self, Error> {
        let options = options.into();
        let clock = Stopwatch::start();
        check(rest, start)?;
        flat("rest", &rest.positions)?;
        flat("start", start)?;
        let (shape, turned) = RestShape::of_plane(rest)?;
        let mut notes = Vec::new();
        if turned {
            notes.push("the mesh was clockwise: all triangles were turned".into());
        }
        let keep = options.gini.overlap;
        let prepared = Prepared::new(rest, start, pins, targets, (2, keep), &mut notes)?;
        let problem = prepared.problem(&shape);
        let mut solver = Engine::of_plane(problem, material, &options)?;
        if !prepared.moves.is_empty() {
            solver.move_pins(&in_plane(&prepared.moves))?;
        }
        Ok(Self {
            solver: Body::Plane(solver),
            notes,
            setup_seconds: clock.seconds(),
            level: start[0].z,
            // as they were turned
            rest: Rest::Plane(SurfaceMesh {
                positions: rest.positions.clone(),
                simplices: shape.vertices.as_chunks::<3>().0.to_vec(),
            }),
            flowed: None,
        })
    }

    /// With [`GiniOptions::overlap`](crate::gini::GiniOptions::overlap): has pinned vertices move to other points, and the run go on.
    ///
    /// # Errors
    /// As [`crate::gini::Gini::move_pins`].
    pub fn move_pins(&mut self, pins: &[(u32, DVec3)]) -> Result<(), BuildError> {
        let pins: Vec<(u32, [f64; 3])> = pins.iter().map(|&(v, p)| (v, p.to_array())).collect();
        match &mut self.solver {
            Body::Plane(solver) => solver.move_pins(&in_plane(&pins)),
            Body::Solid(solver) => solver.move_pins(&pins),
        }
    }

    /// What is known of the newest positions.
    pub fn outcome(&self) -> Outcome {
        match &self.solver {
            Body::Plane(solver) => solver.outcome(),
            Body::Solid(solver) => solver.outcome(),
        }
    }

    /// How the start's boundary was parted, if it came through the flow.
    pub fn flowed(&self) -> Option<&Flowed> {
        self.flowed.as_ref()
    }

    /// What was mended or chosen, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The solver.
    pub fn solver(&self) -> &dyn Solver {
        match &self.solver {
            Body::Plane(solver) => solver.solver(),
            Body::Solid(solver) => solver.solver(),
        }
    }

    /// The solver, to be stepped.
    pub fn solver_mut(&mut self) -> &mut dyn Solver {
        match &mut self.solver {
            Body::Plane(solver) => solver.solver_mut(),
            Body::Solid(solver) => solver.solver_mut(),
        }
    }

    /// Takes one step.
    ///
    /// # Errors
    /// As [`Solver::step`].
    pub fn step(&mut self) -> Result<StepReport, Error> {
        Ok(self.solver_mut().step()?)
    }

    /// x, one position a vertex: the state that is handed out.
    pub fn positions(&self) -> Vec<DVec3> {
        self.in_space(self.solver().positions())
    }

    /// x̄ of the paper, the state of GINI's primary solver: neither injective nor free of intersections.
    pub fn primary_positions(&self) -> Vec<DVec3> {
        match &self.solver {
            Body::Plane(solver) => self.in_space(&solver.gini().primary()),
            Body::Solid(solver) => self.in_space(&solver.gini().primary()),
        }
    }

    /// Keeps the states inside of every step from here on, or no more.
    pub fn set_trace(&mut self, on: bool) {
        match &mut self.solver {
            Body::Plane(solver) => solver.set_trace(on),
            Body::Solid(solver) => solver.set_trace(on),
        }
    }

    /// x̄ or x̂ of one of them, one position a vertex.
    pub fn trace_positions(&self, state: &TraceState) -> Vec<DVec3> {
        self.in_space(&state.positions)
    }

    /// The polisher's states in the newest step, if it was GINI's; see [`crate::gini::Gini::trace`].
    pub fn trace(&self) -> &[TraceState] {
        self.traces()[1]
    }

    /// The states of the quadratic problem in the newest step, if it was GINI's; see
    /// [`crate::gini::Gini::quadratic_trace`].
    pub fn quadratic_trace(&self) -> &[TraceState] {
        self.traces()[0]
    }

    fn traces(&self) -> [&[TraceState]; 2] {
        match &self.solver {
            Body::Plane(solver) => solver.traces(),
            Body::Solid(solver) => solver.traces(),
        }
    }

    /// What is known for certain of x, as a map of a solid; `None` for triangles.
    pub fn certificate(&self) -> Option<SolidCertificate> {
        match &self.rest {
            Rest::Solid(rest) => Some(SolidCertificate::of_solid(rest, &self.positions())),
            Rest::Plane(_) => None,
        }
    }

    /// The same of triangles in the plane; `None` for solids.
    pub fn certificate_in_plane(&self) -> Option<Certificate> {
        let Rest::Plane(rest) = &self.rest else {
            return None;
        };
        let points: Vec<DVec2> = self.positions().iter().map(|p| p.truncate()).collect();
        Some(Certificate::of_map(rest, &points))
    }

    fn in_space(&self, positions: &[f64]) -> Vec<DVec3> {
        match self.solver {
            Body::Plane(_) => {
                let points = positions.as_chunks::<2>().0.iter();
                points.map(|p| DVec3::new(p[0], p[1], self.level)).collect()
            }
            Body::Solid(_) => {
                let points = positions.as_chunks::<3>().0.iter();
                points.map(|&p| DVec3::from_array(p)).collect()
            }
        }
    }

    /// Seconds that building took.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }
}

fn in_plane(pins: &[(u32, [f64; 3])]) -> Vec<(u32, [f64; 2])> {
    pins.iter().map(|&(v, [x, y, _])| (v, [x, y])).collect()
}

/// Start, pins and springs as the solver wants them.
struct Prepared {
    start: Vec<f64>,
    pins: Vec<u32>,
    springs: Vec<crate::optim::Spring>,
    /// Where pins are yet to go.
    moves: Vec<(u32, [f64; 3])>,
}

impl Prepared {
    fn new<const K: usize>(
        rest: &SimplicialMesh<K>,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        (dimension, keep): (usize, bool),
        notes: &mut Vec<String>,
    ) -> Result<Self, BuildError> {
        let supports = Supports::new(rest, pins, notes)?;
        // relative stiffnesses: κ is the solver's option
        let (mut moves, springs) = supports.split_free(targets, &vec![1.0; start.len()])?;
        let mut positions = start.to_vec();
        if !keep {
            for (vertex, point) in moves.drain(..) {
                positions[vertex as usize] = DVec3::from_array(point);
            }
        }
        let points = positions.iter();
        Ok(Self {
            start: points
                .flat_map(|p| p.to_array().into_iter().take(dimension))
                .collect(),
            pins: supports.held(),
            springs,
            moves,
        })
    }

    fn problem<'a>(&'a self, shape: &'a RestShape) -> GiniProblem<'a> {
        GiniProblem {
            rest: shape,
            start: &self.start,
            primary: None,
            pins: &self.pins,
            springs: &self.springs,
        }
    }
}
