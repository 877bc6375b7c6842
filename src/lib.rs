//! foldfree: maps that do not fold.
//!
//! Geometry optimisation on triangle and tetrahedral meshes. Data passes through the rooms of this
//! crate in one direction:
//!
//! ```text
//! bytes → mesh → problem → solver ⟲ step → report/state → certificate
//! ```
//!
//! See `ARCHITECTURE.md` for what lives where and why.

mod boxes;
pub mod certificate;
pub mod collision;
pub mod deformation;
mod disjoint_sets;
pub mod embedding;
pub mod energy;
mod error;
pub mod geometry;
pub mod gini;
pub mod lim;
pub mod linalg;
pub mod local_global;
pub mod mesh;
pub mod mixed_integer;
pub mod newton;
pub mod optim;
mod parallel;
pub mod parameterization;
pub mod quasi_newton;
pub mod slim;
pub mod space;
mod total_order;
#[cfg(target_arch = "wasm32")]
pub mod wasm;
pub mod wrapd;

pub use error::Error;
