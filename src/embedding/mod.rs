//! Starts: maps of a disk that need one linear solve.

mod circle;
mod direct;
mod harmonic;
mod lscm;

pub use circle::boundary_to_circle;
pub use direct::DirectMap;
pub use harmonic::{harmonic, harmonic_around, harmonic_extension, tutte, tutte_around};
pub use lscm::lscm;
