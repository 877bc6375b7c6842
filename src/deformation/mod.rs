//! Quasi-static deformation of elastic solids: the minimum of an energy under pins (paper §6.1).

mod options;
mod problem;
mod supports;

pub use options::{DeformationMethod, DeformationOptions, Material};
pub use problem::{Deformation, Target};
pub(crate) use supports::Supports;
