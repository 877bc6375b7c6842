//! Second-order methods: composite majorization and projected Newton.
//!
//! One iteration: the matrices of the elements (`curvature`), positive semidefinite by construction, are
//! summed up in a pattern that was analysed once; a shift relative to the diagonal makes the sum definite,
//! since rigid motions change no energy; the step is bounded where the first element would degenerate
//! ([`bound`]), halved until the energy falls as Armijo's rule demands, and brought nearer to the minimum along
//! the direction while that is worth its evaluation (often twice as far: a majorizer is stiff). So the energy never rises and, if it
//! has a barrier, no accepted iterate has an inverted element.
//!
//! Near the minimum the Hessian itself is tried, too: where the sum is positive definite, though matrices of
//! elements are not, it converges quadratically, which no convex part of it does.
//!
//! Elements are evaluated by the kernels of [`crate::wrapd`].

mod after_gini;
pub mod bound;
pub(crate) mod corners;
pub(crate) mod curvature;
mod hybrid;
mod majorization;
#[cfg(test)]
mod majorization_tests;
mod options;
mod pieces;
mod relaxation;
#[cfg(test)]
mod relaxation_tests;
mod solver;
mod system;
mod turns;
#[cfg(test)]
mod turns_tests;

pub use after_gini::GiniThenNewton;
pub use hybrid::Hybrid;
pub use options::NewtonOptions;
pub use solver::Newton;
