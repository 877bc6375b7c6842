//! A body of any kind, checked, and on its way to a solver.

use super::{Deformation, DeformationMethod, Supports, Target};
use crate::Error;
use crate::energy::Energy;
use crate::geometry::RestShape;
use crate::mesh::{MeshError, SimplicialMesh};
use crate::newton::{Hybrid, Newton, NewtonOptions};
use crate::optim::{BuildError, Deformer, Stopwatch};
use crate::quasi_newton::{QuasiNewton, QuasiNewtonOptions};
use crate::space::{Solid, Space};
use crate::wrapd::{External, Linear, Problem, Reweighting, RotationAware, Wrapd, WrapdOptions};
use glam::DVec3;

/// Checks that indices are in range, positions finite, and that the start has one a vertex.
pub fn check<const K: usize>(rest: &SimplicialMesh<K>, start: &[DVec3]) -> Result<(), Error> {
    let vertices = rest.positions.len();
    if rest.simplices.is_empty() {
        return Err(MeshError::Empty.into());
    }
    if let Some(vertex) = rest.positions.iter().position(|p| !p.is_finite()) {
        return Err(MeshError::NonFinitePosition { vertex }.into());
    }
    for (element, simplex) in rest.simplices.iter().enumerate() {
        if let Some(&index) = simplex.iter().find(|&&v| v as usize >= vertices) {
            let index = u64::from(index);
            return Err(MeshError::IndexOutOfRange {
                face: element,
                index,
                vertices,
            }
            .into());
        }
    }
    if start.len() != vertices {
        return Err(BuildError::WrongLength {
            argument: "start",
            expected: vertices,
            found: start.len(),
        }
        .into());
    }
    match start.iter().position(|p| !p.is_finite()) {
        Some(vertex) => Err(MeshError::NonFinitePosition { vertex }.into()),
        None => Ok(()),
    }
}

/// A body, what holds it, and how it is to be solved.
pub struct Body<'a> {
    /// Rest shapes.
    pub shape: &'a RestShape,
    /// One position a vertex.
    pub start: &'a [DVec3],
    /// What holds it.
    pub supports: Supports,
    /// Where vertices are wanted.
    pub targets: &'a [Target],
    /// How hard targets pull, see [`super::DeformationOptions`].
    pub target_stiffness: f64,
    /// Terms beside the elements, springs not among them.
    pub external: External,
    /// The solver.
    pub method: DeformationMethod,
    /// When to stop.
    pub tolerance: f64,
    /// When to stop in any case.
    pub max_iterations: usize,
    /// What was mended.
    pub notes: Vec<String>,
    /// Started with the work.
    pub clock: Stopwatch,
}

/// From a problem to its solver.
type NewSolver<'a> = dyn Fn(Problem) -> Result<Box<dyn Deformer>, BuildError> + 'a;

impl Body<'_> {
    /// The solver for an energy.
    pub fn solver<S: Space, E: Energy<S>>(self, energy: E) -> Result<Deformation, Error> {
        use DeformationMethod::{
            AdmmPd, Lbfgs, Lim, Newton, RAdmm, WAdmm, Wrapd as Both, WrapdNewton,
        };
        let (method, tolerance) = (self.method, self.tolerance);
        let max_iterations = self.max_iterations;
        let settings = self.wrapd_options();
        self.build(energy.constants().rest_stiffness, &|problem| {
            Ok(match method {
                Both | RAdmm => Box::new(Wrapd::new::<S, RotationAware, E>(
                    problem, energy, settings,
                )?),
                WAdmm | AdmmPd => Box::new(Wrapd::new::<S, Linear, E>(problem, energy, settings)?),
                Lbfgs => {
                    let settings = QuasiNewtonOptions {
                        tolerance,
                        max_iterations,
                        ..Default::default()
                    };
                    Box::new(QuasiNewton::new::<S, E>(problem, energy, settings)?)
                }
                Newton | WrapdNewton => {
                    let what = "second-order methods are for solids".into();
                    let option = "method";
                    return Err(BuildError::InvalidOption { option, what });
                }
                Lim => {
                    let what = "lim is for solids, and triangles in the plane".into();
                    let option = "method";
                    return Err(BuildError::InvalidOption { option, what });
                }
            })
        })
    }

    /// The solver for an energy of solids, second-order methods among them.
    pub fn solver_of_solid<E: Energy<Solid>>(self, energy: E) -> Result<Deformation, Error> {
        use DeformationMethod::{Newton as Alone, WrapdNewton};
        let (method, wrapd) = (self.method, self.wrapd_options());
        if !matches!(method, Alone | WrapdNewton) {
            return self.solver::<Solid, E>(energy);
        }
        let newton = NewtonOptions {
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..Default::default()
        };
        self.build(energy.constants().rest_stiffness, &|problem| {
            Ok(match method {
                Alone => Box::new(Newton::projected::<Solid, E>(problem, energy, newton)?),
                _ => Box::new(Hybrid::projected::<Solid, E>(
                    problem, energy, wrapd, newton,
                )?),
            })
        })
    }

    fn wrapd_options(&self) -> WrapdOptions {
        use DeformationMethod::{WAdmm, Wrapd as Both, WrapdNewton};
        let reweighting = matches!(self.method, Both | WAdmm | WrapdNewton);
        WrapdOptions {
            reweighting: reweighting.then_some(Reweighting::QUASI_STATIC),
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            restart_duals: true,
            ..Default::default()
        }
    }

    /// What does not depend on the energy's type.
    fn build(mut self, rest_stiffness: f64, new: &NewSolver) -> Result<Deformation, Error> {
        let spring_stiffness = self.spring_stiffness(rest_stiffness);
        let fits = |k: f64| k > 0.0 && k.is_finite();
        let used = self.shape.vertices.iter();
        if !used.copied().all(|v| fits(spring_stiffness[v as usize])) {
            return Err(BuildError::InvalidOption {
                option: "targetStiffness",
                what: "times the stiffness of the body is beyond the range of numbers".into(),
            }
            .into());
        }
        let mut positions = self.start.to_vec();
        let (moved, springs) = self.supports.split(self.targets, &spring_stiffness)?;
        for (vertex, point) in moved {
            positions[vertex as usize] = DVec3::from_array(point);
        }
        let positions: Vec<f64> = positions.iter().flat_map(|p| p.to_array()).collect();
        self.external.springs = springs;
        let problem = Problem {
            rest: self.shape,
            start: &positions,
            pins: &self.supports.held(),
            external: Some(&self.external),
        };
        let solver = new(problem)?;
        Ok(Deformation {
            rest: None,
            flat: None,
            level: 0.0,
            notes: self.notes,
            setup_seconds: self.clock.seconds(),
            supports: self.supports,
            spring_stiffness,
            solver,
        })
    }

    /// The stiffness of a target's spring at each vertex: in proportion to the diagonal of the body's
    /// stiffness matrix at rest.
    fn spring_stiffness(&self, rest_stiffness: f64) -> Vec<f64> {
        let weight = self.target_stiffness * rest_stiffness;
        let mut stiffness = self.shape.laplacian_diagonal(self.start.len());
        stiffness.iter_mut().for_each(|k| *k *= weight);
        stiffness
    }
}
