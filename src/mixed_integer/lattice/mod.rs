//! The nearest point of a lattice: reduction of the basis, enumeration, and what is proven by it.

mod enumeration;
mod proof;
mod reduction;

pub use enumeration::Enumeration;
pub use proof::Proof;
pub use reduction::Reduction;
