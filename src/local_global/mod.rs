//! Local/global solvers with a constant system matrix.
//!
//! ADMM-PD (Overby et al. 2017) is [`AdmmPd`]: the iteration of [`crate::wrapd`] with Z coupled to F
//! itself, whose global step is one solve. [`ArapLocalGlobal`] is the classical pair of steps of
//! Sorkine & Alexa (2007) and Liu et al. (2008).

mod arap;

pub use arap::ArapLocalGlobal;

/// ADMM-PD: Z = F. Without reweighting in its options it is Overby et al.'s, with it the paper's
/// W-ADMM.
pub type AdmmPd<S, E> = crate::wrapd::Wrapd<S, crate::wrapd::Linear, E>;
