//! A solid, made ready, and the solver that deforms it.

use super::{DeformationMethod, DeformationOptions, Material};
use crate::Error;
use crate::energy::{
    Arap, Dirichlet, Energy, NeoHookean, StVenantKirchhoff, StableNeoHookean, SymmetricDirichlet,
};
use crate::geometry::RestShape;
use crate::mesh::{MeshError, SolidMesh, counted};
use crate::optim::{BuildError, Solver, StepReport, Stopwatch};
use crate::quasi_newton::{QuasiNewton, QuasiNewtonOptions};
use crate::space::Solid;
use crate::wrapd::{Linear, Problem, Reweighting, RotationAware, Wrapd, WrapdOptions};
use glam::DVec3;

/// A deformation in progress.
pub struct Deformation {
    notes: Vec<String>,
    setup_seconds: f64,
    solver: Box<dyn Solver>,
}

impl Deformation {
    /// Checks rest shape, start (one position a vertex, may be inverted) and pins (vertices held where
    /// they start), and builds the solver.
    ///
    /// # Errors
    /// [`MeshError`] for a rest shape that is none, [`BuildError`] for pins, starts or options that do
    /// not fit it.
    pub fn new(
        rest: &SolidMesh,
        start: &[DVec3],
        pins: &[u32],
        options: &DeformationOptions,
    ) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        options.validate()?;
        let mut notes = Vec::new();
        check_indices(rest)?;
        if start.len() != rest.positions.len() {
            return Err(BuildError::WrongLength {
                argument: "start",
                expected: rest.positions.len(),
                found: start.len(),
            }
            .into());
        }
        if let Some(vertex) = start.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NonFinitePosition { vertex }.into());
        }
        let (shape, turned) = RestShape::of_solid(rest)?;
        if turned {
            notes.push("the mesh was inside out: all tetrahedra were turned".into());
        }
        let held = held(rest, pins, &mut notes)?;
        let positions: Vec<f64> = start.iter().flat_map(|p| p.to_array()).collect();
        let problem = Problem {
            rest: &shape,
            start: &positions,
            pins: &held,
        };
        let solver = match options.material {
            Material::NeoHookean { young, poisson } => {
                build(problem, NeoHookean::new(young, poisson)?, options)
            }
            Material::StableNeoHookean { young, poisson } => {
                build(problem, StableNeoHookean::new(young, poisson)?, options)
            }
            Material::StVenantKirchhoff { young, poisson } => {
                build(problem, StVenantKirchhoff::new(young, poisson)?, options)
            }
            Material::Arap => build(problem, Arap, options),
            Material::SymmetricDirichlet => build(problem, SymmetricDirichlet, options),
            Material::Dirichlet => build(problem, Dirichlet, options),
        }?;
        Ok(Self {
            notes,
            setup_seconds: clock.seconds(),
            solver,
        })
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
    ///
    /// # Errors
    /// As [`Solver::step`].
    pub fn step(&mut self) -> Result<StepReport, Error> {
        Ok(self.solver.step()?)
    }
    /// Positions, one a vertex, in the input's units.
    pub fn positions(&self) -> Vec<DVec3> {
        let positions = self.solver.positions().as_chunks::<3>().0;
        positions.iter().map(|&p| DVec3::from_array(p)).collect()
    }
    /// Seconds that [`Self::new`] took.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }
}

fn check_indices(rest: &SolidMesh) -> Result<(), MeshError> {
    let vertices = rest.positions.len();
    if rest.simplices.is_empty() {
        return Err(MeshError::Empty);
    }
    if let Some(vertex) = rest.positions.iter().position(|p| !p.is_finite()) {
        return Err(MeshError::NonFinitePosition { vertex });
    }
    for (face, tetrahedron) in rest.simplices.iter().enumerate() {
        if let Some(&index) = tetrahedron.iter().find(|&&v| v as usize >= vertices) {
            let index = u64::from(index);
            return Err(MeshError::IndexOutOfRange {
                face,
                index,
                vertices,
            });
        }
    }
    Ok(())
}

/// The vertices that are held: the pins, and vertices that belong to no tetrahedron. Every component
/// needs a pin.
fn held(rest: &SolidMesh, pins: &[u32], notes: &mut Vec<String>) -> Result<Vec<u32>, BuildError> {
    let n = rest.positions.len();
    let wrong = |what: String| {
        Err(BuildError::InvalidOption {
            option: "pins",
            what,
        })
    };
    if let Some(&bad) = pins.iter().find(|&&v| v as usize >= n) {
        return wrong(format!("vertex {bad} of {n} (the first is 0)"));
    }
    let mut is_held = vec![false; n];
    pins.iter().for_each(|&v| is_held[v as usize] = true);
    let mut root: Vec<u32> = (0..n as u32).collect();
    let mut used = vec![false; n];
    for tetrahedron in &rest.simplices {
        for &v in tetrahedron {
            used[v as usize] = true;
            let (a, b) = (find(&mut root, tetrahedron[0]), find(&mut root, v));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    let mut has_pin = vec![false; n];
    for v in 0..n as u32 {
        let root = find(&mut root, v) as usize;
        has_pin[root] |= is_held[v as usize];
    }
    for v in 0..n as u32 {
        if used[v as usize] && !has_pin[find(&mut root, v) as usize] {
            return wrong(format!(
                "the component of vertex {v} has no pin: it could float away"
            ));
        }
    }
    let unused = used.iter().filter(|used| !**used).count();
    if unused > 0 {
        notes.push(format!(
            "{} in no tetrahedron: left where they start",
            counted(unused, "vertex")
        ));
    }
    let held: Vec<u32> = (0..n as u32)
        .filter(|&v| is_held[v as usize] || !used[v as usize])
        .collect();
    if held.len() == n {
        return wrong("hold all vertices: there is nothing to solve for".into());
    }
    Ok(held)
}

/// The representative of a vertex's component.
fn find(root: &mut [u32], v: u32) -> u32 {
    let mut v = v;
    while root[v as usize] != v {
        root[v as usize] = root[root[v as usize] as usize];
        v = root[v as usize];
    }
    v
}

fn build<E: Energy<Solid>>(
    problem: Problem,
    energy: E,
    options: &DeformationOptions,
) -> Result<Box<dyn Solver>, BuildError> {
    use DeformationMethod::{AdmmPd, Lbfgs, RAdmm, WAdmm, Wrapd as Both};
    let reweighting = matches!(options.method, Both | WAdmm).then_some(Reweighting::QUASI_STATIC);
    let settings = WrapdOptions {
        reweighting,
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        restart_duals: true,
        ..Default::default()
    };
    Ok(Box::new(match options.method {
        Both | RAdmm => Wrapd::new::<Solid, RotationAware, E>(problem, energy, settings)?,
        Lbfgs => {
            let settings = QuasiNewtonOptions {
                tolerance: options.tolerance,
                max_iterations: options.max_iterations,
                ..Default::default()
            };
            return Ok(Box::new(QuasiNewton::new::<Solid, E>(
                problem, energy, settings,
            )?));
        }
        WAdmm | AdmmPd => Wrapd::new::<Solid, Linear, E>(problem, energy, settings)?,
    }))
}
