//! From a mesh to a flattening: the problem (a disk, scaled to unit area), its starts, and the
//! choice of a solver.

mod atlas;
mod bijective;
mod landmarks;
mod options;
mod problem;
mod shelves;
mod starts;

pub use landmarks::Landmark;
pub use options::{CutPolicy, EnergyKind, Method, ParameterizationOptions, Start};
pub use problem::Parameterization;
