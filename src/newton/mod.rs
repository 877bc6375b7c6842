//! Second-order methods: composite majorization and projected Newton.
//!
//! One iteration: the matrices of the elements ([`curvature`]), positive semidefinite by construction, are
//! summed up in a pattern that was analysed once; a shift relative to the diagonal makes the sum definite,
//! since rigid motions change no energy; the step is bounded where the first element would degenerate
//! ([`bound`]) and halved until the energy falls as Armijo's rule demands. So the energy never rises and, if it
//! has a barrier, no accepted iterate has an inverted element.
//!
//! Elements are evaluated by the kernels of [`crate::wrapd`].

pub mod bound;
pub(crate) mod curvature;
mod hybrid;
mod majorization;
mod options;
mod solver;
mod system;

pub use hybrid::Hybrid;
pub use options::NewtonOptions;
pub use solver::Newton;
