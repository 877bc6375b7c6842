//! Options and their defaults.

use super::MixedIntegerError as Error;

/// How integers are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Rounding {
    /// All at once from the relaxed solution (paper, §3.1).
    Direct,
    /// One after the other, or a few at a time, the nearest first (paper, §3.2).
    #[default]
    Greedy,
    /// Greedy, then ±1 on one integer or on two as long as that lowers the energy.
    TwoOpt,
    /// Lattice reduction, then the nearest lattice point by bounded enumeration, with a lower bound.
    Lattice,
}

impl Rounding {
    /// All names.
    pub const NAMES: [&'static str; 4] = ["direct", "greedy", "two-opt", "lattice"];
}

/// What the integers are found with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Engine {
    /// `Dense` up to a few hundred integers, and where the rounding needs it; else `ThreeLevel`.
    #[default]
    Automatic,
    /// The exact energy of the integers alone: the dense Schur complement of the other unknowns.
    Dense,
    /// Local Gauss–Seidel, then conjugate gradients, then sparse Cholesky on all unknowns (paper, §3.2);
    /// for `Direct` and `Greedy`.
    ThreeLevel,
}

/// Options of [`super::MixedInteger`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase", default)]
pub struct MixedIntegerOptions {
    /// How integers are found.
    pub rounding: Rounding,
    /// What they are found with.
    pub engine: Engine,
    /// Eliminate the row with the fewest terms first (paper, §2.2), rather than in the order given.
    pub reorder: bool,
    /// Relative size below which what remains of coefficients or constants that cancel counts as 0. The
    /// paper's 1e-6 would let constraints be violated by as much.
    pub tolerance: f64,
    /// Greedy rounds the nearest as long as the sum of their distances stays below this, at least one;
    /// 0: one at a time. `None`: ½ (the reference's default) with three levels; one at a time with the
    /// dense engine, whose updates cost nothing.
    pub budget: Option<f64>,
    /// Most unknowns that local Gauss–Seidel looks at after each rounding; 0: not used (paper, §4: 100000
    /// for orientation fields, 0 for parametrizations).
    pub gauss_seidel: u32,
    /// Most iterations of conjugate gradients; 0: not used (paper, §4: 50 and 20).
    pub conjugate_gradients: u32,
    /// Is sparse Cholesky the last resort?
    pub cholesky: bool,
    /// Residual relative to the diagonal at which an iterative level is done (paper, §4: 1e-3).
    pub residual: f64,
    /// Most nodes that the enumeration visits before it gives its best point and a gap.
    pub nodes: u64,
}

impl Default for MixedIntegerOptions {
    fn default() -> Self {
        Self {
            rounding: Rounding::Greedy,
            engine: Engine::Automatic,
            reorder: true,
            tolerance: 1e-9,
            budget: None,
            gauss_seidel: 100_000,
            conjugate_gradients: 50,
            cholesky: true,
            residual: 1e-3,
            nodes: 100_000_000,
        }
    }
}

/// Integers up to which the dense engine is chosen.
const DENSE: usize = 400;
/// Integers up to which it is allowed: its matrix then takes 32 MB.
const MOST_DENSE: usize = 2000;

impl MixedIntegerOptions {
    /// # Errors
    /// `InvalidOption`.
    pub fn validate(&self) -> Result<(), Error> {
        let wrong = |option, what: &str| {
            Err(Error::InvalidOption {
                option,
                what: what.to_owned(),
            })
        };
        if !(self.tolerance >= 0.0 && self.tolerance < 0.1) {
            return wrong("tolerance", "it must be at least 0 and less than 0.1");
        }
        if !(self.residual > 0.0 && self.residual.is_finite()) {
            return wrong("residual", "it must be positive and finite");
        }
        if !self.budget.is_none_or(|b| (0.0..=0.5).contains(&b)) {
            return wrong("budget", "it must be between 0 and 0.5");
        }
        if self.gauss_seidel == 0 && self.conjugate_gradients == 0 && !self.cholesky {
            return wrong("cholesky", "one of the three levels has to be used");
        }
        let dense = matches!(self.rounding, Rounding::TwoOpt | Rounding::Lattice);
        if dense && self.engine == Engine::ThreeLevel {
            return wrong("engine", "two-opt and lattice need the dense engine");
        }
        Ok(())
    }

    /// Is the dense engine used for so many integers?
    ///
    /// # Errors
    /// `TooManyIntegers`.
    pub(super) fn is_dense(&self, integers: usize) -> Result<bool, Error> {
        let needed = matches!(self.rounding, Rounding::TwoOpt | Rounding::Lattice);
        let dense = match self.engine {
            Engine::Dense => true,
            Engine::ThreeLevel => false,
            Engine::Automatic => needed || integers <= DENSE,
        };
        if dense && integers > MOST_DENSE {
            return Err(Error::TooManyIntegers {
                count: integers,
                limit: MOST_DENSE,
            });
        }
        Ok(dense)
    }
}
