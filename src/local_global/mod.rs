//! Local/global solvers with a constant system matrix.
//!
//! ADMM-PD (Overby et al. 2017) is the iteration of [`crate::wrapd`] with Z coupled to F itself
//! ([`crate::wrapd::Linear`]), whose global step is one solve. [`ArapLocalGlobal`] is the classical
//! pair of steps of Sorkine & Alexa (2007) and Liu et al. (2008).

mod arap;

pub use arap::ArapLocalGlobal;
