//! Quasi-static deformation of elastic solids and of cloth: the minimum of an energy under pins (paper §6.1).

mod body;
mod cloth;
mod engine;
mod flowed;
mod injective;
mod options;
mod problem;
mod supports;
mod untangling;

pub use cloth::ClothOptions;
pub use engine::UntanglingOptions;
pub use options::{DeformationMethod, DeformationOptions, Material};
pub use problem::Deformation;
pub(crate) use supports::Supports;
pub use supports::Target;
pub use untangling::Untangling;
