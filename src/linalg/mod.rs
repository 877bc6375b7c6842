//! Sparse symmetric systems: assembly with a fixed pattern, ordering, Cholesky.

mod assembly;
mod cholesky;

pub use assembly::{SymmetricAssembly, WeightedSum};
pub use cholesky::{Cholesky, NotPositiveDefinite};
