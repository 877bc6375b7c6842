//! Mixed-integer quadratic problems: minimise ½ xᵀA x − bᵀx where rows·x + constants = 0 and some
//! unknowns are integers (Bommes, Zimmer & Kobbelt, *Practical Mixed-Integer Optimization for Geometry
//! Processing*, 2010, called the paper here). Nothing in this room knows of meshes.
//!
//! ```
//! use foldfree::mixed_integer::{MixedInteger, MixedIntegerOptions, Problem};
//! use foldfree::optim::CancelToken;
//!
//! // the integers nearest to (0.3, 0.4) with 2 x + 3 y = 1
//! let problem = Problem::builder(2)
//!     .quadratic(0, 0, 1.0)
//!     .quadratic(1, 1, 1.0)
//!     .linear(&[0.3, 0.4])
//!     .constraint(&[(0, 2.0), (1, 3.0)], -1.0)
//!     .integers(&[0, 1])
//!     .build()?;
//! let mut solver = MixedInteger::new(problem, MixedIntegerOptions::default())?;
//! solver.run(|_| {}, &CancelToken::default())?;
//! assert_eq!(solver.solution(), [-1.0, 1.0]);
//! # Ok::<(), foldfree::mixed_integer::MixedIntegerError>(())
//! ```
//!
//! [`MixedInteger::new`] eliminates the constraints, orders the unknowns and factors; [`MixedInteger::step`]
//! then rounds. Few integers are found on the dense Schur complement of all other unknowns, which is the
//! exact energy of the integers; many by the paper's three levels.

mod builder;
mod dense;
mod elimination;
mod error;
mod lattice;
mod options;
mod problem;
mod reduced;
mod relaxation;
mod report;
mod rounding_error;
mod search;
mod solver;
mod sys;

pub use builder::ProblemBuilder;
pub use elimination::RowOutcome;
pub use error::MixedIntegerError;
pub use options::{Engine, MixedIntegerOptions, Rounding};
pub use problem::Problem;
pub use report::{Action, Level, LevelCounts, MixedIntegerReport, MixedIntegerStep, Rounded};
pub use solver::MixedInteger;
