//! Sparse symmetric systems: assembly with a fixed pattern, ordering, Cholesky.

mod assembly;
mod blocks;
mod chains;
mod cholesky;
mod cut;
mod dissection;
mod elimination_tree;
mod graph;
mod minimum_degree;
mod order;
mod panels;
mod supernodes;
mod triangular;

pub use assembly::{SymmetricAssembly, WeightedSum};
pub use blocks::BlockSum;
pub use cholesky::Cholesky;
pub use dissection::{Bisection, bisect};
pub use elimination_tree::EliminationTree;
pub use graph::Graph;
pub use order::Order;
pub use supernodes::{NotPositiveDefinite, Supernodes};
