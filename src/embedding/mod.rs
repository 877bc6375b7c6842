//! Starts: maps of a disk that need one linear solve, and of bodies whose boundary meets itself, which is made to flow.

mod circle;
mod direct;
mod flow;
mod harmonic;
mod inside;
mod lscm;

pub use circle::boundary_to_circle;
pub use direct::DirectMap;
pub use flow::{Flowed, flow_apart};
pub use harmonic::{harmonic, harmonic_around, harmonic_extension, tutte, tutte_around};
pub use inside::harmonic_inside;
pub use lscm::lscm;
