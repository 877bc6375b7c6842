//! WRAPD: rotation-aware ADMM with dynamic reweighting (Brown & Narain 2021), and by leaving out one
//! or both of its ideas the other three curves of the paper's figures 4 and 5: R-ADMM (no
//! reweighting), W-ADMM (no rotation awareness) and ADMM-PD (neither; Overby et al. 2017).
//!
//! One iteration is algorithm 1 of the paper:
//!
//! 1. local step (10b): per element, Z ← prox at sym(F) + U; the candidate weight (22);
//!    the dual update (10c);
//! 2. global step (10a): L-BFGS on the positions, with H₀ = A⁻¹ (5a), until (17);
//! 3. reweighting (23), refactorisation.

pub(crate) mod block;
mod coupling;
mod densities;
pub(crate) mod elements;
pub(crate) mod external;
pub(crate) mod kernels;
pub(crate) mod layout;
mod options;
mod problem;
pub(crate) mod setup;
mod solver;
pub(crate) mod system;

pub use coupling::{Coupling, Linear, RotationAware};
pub use external::External;
pub use options::{Reweighting, WrapdOptions};
pub use problem::Problem;
pub use solver::Wrapd;
