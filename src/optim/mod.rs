//! What every iterative solver shares: status, reports, cancellation, errors.

mod compact;
mod error;
mod gini_step;
mod handles;
pub mod lbfgs;
pub mod lbfgsb;
mod lim_step;
mod solver;
mod stopwatch;
pub mod vectors;
mod yardstick;

pub use error::{BuildError, SolveError};
pub use gini_step::{GiniStep, PolishStep};
pub use handles::{Deformer, Field, Spring};
pub use lim_step::LimStep;
pub use solver::{
    CancelToken, Criterion, Inspection, Observer, Phase, PhaseKind, Solver, Status, StepReport, run,
};
pub use stopwatch::Stopwatch;
pub use yardstick::Yardstick;
