//! Starts: maps of a disk that need one linear solve.

mod circle;
mod harmonic;

pub use circle::boundary_to_circle;
pub use harmonic::{harmonic, tutte};
