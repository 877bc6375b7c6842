//! What untangles: GINI, alone or with Newton's method after it.

use super::Material;
use crate::energy::{Arap, Dirichlet, Energy, NeoHookean, StableNeoHookean, SymmetricDirichlet};
use crate::gini::{Gini, GiniOptions, GiniProblem, Outcome, TraceState};
use crate::newton::{GiniThenNewton, NewtonOptions};
use crate::optim::{BuildError, Solver};
use crate::space::{Plane, Solid, Space};

/// Options of an untangling.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct UntanglingOptions {
    /// Those of GINI.
    pub gini: GiniOptions,
    /// Once GINI has converged: go on with Newton's method to low distortion, keeping the map as injective as it is
    /// (§8.2 of the paper). `None`: the run ends there.
    pub minimize: Option<NewtonOptions>,
}

impl From<&GiniOptions> for UntanglingOptions {
    fn from(gini: &GiniOptions) -> Self {
        Self {
            gini: *gini,
            minimize: None,
        }
    }
}

/// A solver in D dimensions.
pub(super) enum Engine<const D: usize> {
    Gini(Box<Gini<D>>),
    Then(Box<GiniThenNewton<D>>),
}

impl<const D: usize> Engine<D> {
    /// Of energies whose minima fold.
    fn alone<S: Space, E: Energy<S>>(
        problem: GiniProblem,
        energy: E,
        options: &UntanglingOptions,
    ) -> Result<Self, BuildError> {
        if options.minimize.is_some() {
            return Err(BuildError::InvalidOption {
                option: "minimize",
                what: "is not for arap and dirichlet, whose minima fold: symmetric-dirichlet, neo-hookean or stable-neo-hookean are"
                    .into(),
            });
        }
        Ok(Self::Gini(Box::new(Gini::new::<S, E>(
            problem,
            energy,
            options.gini,
        )?)))
    }

    fn new<S: Space, E: Energy<S>>(
        problem: GiniProblem,
        energy: E,
        options: &UntanglingOptions,
    ) -> Result<Self, BuildError> {
        Ok(match options.minimize {
            None => Self::Gini(Box::new(Gini::new::<S, E>(problem, energy, options.gini)?)),
            Some(newton) => Self::Then(Box::new(GiniThenNewton::projected::<S, E>(
                problem,
                energy,
                options.gini,
                newton,
            )?)),
        })
    }

    pub fn gini(&self) -> &Gini<D> {
        match self {
            Self::Gini(gini) => gini,
            Self::Then(both) => both.first(),
        }
    }

    /// The states of the quadratic problem, then the polisher's, in the newest step: none if it was Newton's.
    pub fn traces(&self) -> [&[TraceState]; 2] {
        match self.solver().report().gini {
            Some(_) => [self.gini().quadratic_trace(), self.gini().trace()],
            None => [&[]; 2],
        }
    }

    pub fn set_trace(&mut self, on: bool) {
        match self {
            Self::Gini(gini) => gini.set_trace(on),
            Self::Then(both) => both.set_trace(on),
        }
    }

    pub fn move_pins(&mut self, pins: &[(u32, [f64; D])]) -> Result<(), BuildError> {
        match self {
            Self::Gini(gini) => gini.move_pins(pins),
            Self::Then(both) => both.move_pins(pins),
        }
    }

    pub fn outcome(&self) -> Outcome {
        self.gini().outcome_of(self.solver().positions())
    }

    pub fn solver(&self) -> &dyn Solver {
        match self {
            Self::Gini(gini) => &**gini,
            Self::Then(both) => &**both,
        }
    }

    pub fn solver_mut(&mut self) -> &mut dyn Solver {
        match self {
            Self::Gini(gini) => &mut **gini,
            Self::Then(both) => &mut **both,
        }
    }
}

impl Engine<3> {
    /// Of a solid of this material.
    ///
    /// # Errors
    /// As [`Gini::new`]; `InvalidOption` for St. Venant–Kirchhoff, and for ARAP and Dirichlet that are to be minimised;
    /// moduli out of range.
    pub fn of_solid(
        problem: GiniProblem,
        material: Material,
        options: &UntanglingOptions,
    ) -> Result<Self, BuildError> {
        match material {
            Material::NeoHookean { young, poisson } => {
                Self::new::<Solid, _>(problem, NeoHookean::new(young, poisson)?, options)
            }
            Material::StableNeoHookean { young, poisson } => {
                Self::new::<Solid, _>(problem, StableNeoHookean::new(young, poisson)?, options)
            }
            Material::Arap => Self::alone::<Solid, _>(problem, Arap, options),
            Material::SymmetricDirichlet => {
                Self::new::<Solid, _>(problem, SymmetricDirichlet, options)
            }
            Material::Dirichlet => Self::alone::<Solid, _>(problem, Dirichlet, options),
            Material::StVenantKirchhoff { .. } => Err(unknown_energy("solids")),
        }
    }
}

impl Engine<2> {
    /// Of triangles in the plane.
    ///
    /// # Errors
    /// As [`Gini::new`]; `InvalidOption` for materials of solids, and for ARAP and Dirichlet that are to be minimised.
    pub fn of_plane(
        problem: GiniProblem,
        material: Material,
        options: &UntanglingOptions,
    ) -> Result<Self, BuildError> {
        match material {
            Material::SymmetricDirichlet => match options.minimize {
                Some(newton) => Ok(Self::Then(Box::new(
                    GiniThenNewton::composite_majorization(problem, options.gini, newton)?,
                ))),
                None => Self::alone::<Plane, _>(problem, SymmetricDirichlet, options),
            },
            Material::Arap => Self::alone::<Plane, _>(problem, Arap, options),
            Material::Dirichlet => Self::alone::<Plane, _>(problem, Dirichlet, options),
            _ => Err(unknown_energy("triangles in a plane")),
        }
    }
}

fn unknown_energy(body: &str) -> BuildError {
    BuildError::InvalidOption {
        option: "energy",
        what: format!("is not known for untangling {body}"),
    }
}
