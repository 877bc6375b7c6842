//! Sparse symmetric systems: assembly with a fixed pattern, ordering, Cholesky.

mod assembly;
mod cholesky;
mod elimination_tree;
mod panels;
mod triangular;

pub use assembly::{SymmetricAssembly, WeightedSum};
pub use cholesky::{Cholesky, NotPositiveDefinite, Order};
pub use elimination_tree::EliminationTree;
