//! What the solver says: step by step, and in the end.

use super::elimination::RowOutcome;
use crate::optim::Status;

/// An integer that got a value. What the unknown stands for may be a combination of integers, where a
/// constraint row without a coefficient ±1 made new ones.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct Rounded {
    /// Its number in the problem.
    pub unknown: u32,
    /// The value before: its estimate, or the integer it was.
    pub from: f64,
    /// The integer it is now.
    pub to: f64,
}

/// What made the other unknowns follow a rounded integer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Local Gauss–Seidel.
    GaussSeidel,
    /// Conjugate gradients.
    ConjugateGradients,
    /// Sparse Cholesky.
    Cholesky,
    /// The exact update of the dense engine.
    Dense,
    /// None reached its tolerance, and Cholesky was not allowed.
    None,
}

/// What a step did.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Action {
    /// The minimum without integrality: the start.
    Relax,
    /// Integers were rounded.
    Round {
        /// Which, and to what.
        rounded: Vec<Rounded>,
        /// What made the others follow.
        level: Level,
        /// Unknowns that moved (dense: integers that did, by more than 1e-3).
        spread: usize,
    },
    /// One or two integers were changed by one, which lowers the energy.
    Improve {
        /// Which.
        changed: Vec<Rounded>,
    },
    /// The basis of the lattice was reduced.
    Reduce {
        /// Exchanges of basis vectors so far.
        exchanges: u64,
        /// Done?
        reduced: bool,
    },
    /// Lattice points were enumerated.
    Enumerate {
        /// Nodes visited so far.
        nodes: u64,
        /// Better points found so far, the first included.
        improvements: u32,
        /// All points that could be better have been excluded.
        proven: bool,
    },
}

/// What one step did and where it led.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct MixedIntegerStep {
    /// 0: the relaxed solution.
    pub iteration: usize,
    /// The status after the step.
    pub status: Status,
    /// What was done.
    pub action: Action,
    /// Greedy: the least energy with the integers rounded so far (with three levels: that of the iterate);
    /// afterwards that of the best point known.
    pub energy: f64,
    /// Integers without a value.
    pub remaining: usize,
    /// Seconds spent in steps so far.
    pub seconds: f64,
}

/// How often each level finished, and its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct LevelCounts {
    /// Roundings after which local Gauss–Seidel sufficed.
    pub gauss_seidel: usize,
    /// Roundings after which conjugate gradients did.
    pub conjugate_gradients: usize,
    /// Roundings that took a factorisation.
    pub cholesky: usize,
    /// Roundings with the exact update of the dense engine.
    pub dense: usize,
    /// Roundings after which no level reached its tolerance.
    pub none: usize,
    /// Unknowns that Gauss–Seidel looked at.
    pub pops: u64,
    /// Iterations of conjugate gradients.
    pub iterations: u64,
}

/// Where the solver stands.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct MixedIntegerReport {
    /// Energy of the solution (of the relaxed one as long as integers are missing).
    pub energy: f64,
    /// Least energy without integrality.
    pub relaxed_energy: f64,
    /// No feasible point has less energy than this: lattice only.
    pub lower_bound: Option<f64>,
    /// Was every point excluded that would be better by more than rounding errors (`energy` −
    /// `lower_bound`)?
    pub proven: bool,
    /// Are the integers integers and the constraints kept: has the search come to an end?
    pub feasible: bool,
    /// Unknowns, integers and entries of the lower triangle after elimination, and of its factor.
    pub reduced_unknowns: usize,
    /// Integers among them.
    pub reduced_integers: usize,
    /// Entries of the lower triangle of the reduced matrix.
    pub reduced_entries: usize,
    /// Entries of its factor.
    pub factor_entries: usize,
    /// Unimodular changes of integers that rows without a coefficient ±1 took.
    pub changes_of_integers: usize,
    /// What became of each constraint row.
    pub rows: Vec<RowOutcome>,
    /// Rows that the others imply.
    pub redundant_rows: Vec<u32>,
    /// Integers rounded by greedy or direct rounding.
    pub rounded: usize,
    /// How often each level finished.
    pub levels: LevelCounts,
    /// Improvements by two-opt.
    pub improvements: usize,
    /// Exchanges of basis vectors.
    pub exchanges: u64,
    /// Nodes of the enumeration.
    pub nodes: u64,
    /// Largest violation of a constraint row, relative to its largest term and 1.
    pub violation: f64,
    /// Seconds of elimination, ordering and factorisation.
    pub setup_seconds: f64,
    /// Seconds of steps.
    pub seconds: f64,
}
