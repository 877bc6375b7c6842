//! Locally injective mappings: deformations whose elements never invert (Schüller, Kavan, Panozzo & Sorkine-Hornung
//! 2013).
//!
//! E(v) + α ‖Cv − t‖² + β Σ φ(det J) (5) is minimised by Newton's method with Levenberg and Marquardt's μ: a
//! [deformation energy](LimEnergy), positional constraints, and a [barrier](barrier) that is infinite where an element
//! would lose nearly all of its measure. An iteration:
//!
//! 1. α grows with the ratio of energy and positional error (7), (8);
//! 2. the matrix ∇² + μI, with the least of a series of μ for which Cholesky succeeds (0 mostly);
//! 3. handles are led the part 1/(1 + μ²) of the way (6): where the matrix is indefinite, all of the way may be
//!    too far;
//! 4. the step σ, bounded where the first element would meet its wall, halved until the objective falls and an
//!    exact predicate says that nothing is inverted, or doubled while that lowers it further.
//!
//! That is the paper's method, with [`LimHessian::Frozen`]. By default ([`LimHessian::Projected`]) what is negative in the
//! elements' second derivatives is left out, in part or wholly, instead of being outweighed by μ: handles arrive
//! in a few iterations, and the end is quadratic.
//!
//! A handle that is at its target to 1e-9 of the body's size is put there exactly, and held. All parameters are
//! those of a body scaled to a measure of 1, so that units do not matter.

pub mod barrier;
mod constraints;
mod curvature;
mod density;
#[cfg(test)]
mod derivative_tests;
mod elements;
mod inversion;
mod laplacian;
mod objective;
mod options;
mod problem;
mod solver;
mod system;

pub use options::{LimEnergy, LimHessian, LimOptions};
pub use problem::LimProblem;
pub use solver::Lim;
