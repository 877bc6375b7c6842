//! Search among the integers alone: integer least squares on the dense Schur complement.

mod form;
mod greedy;
mod nearest;
mod two_opt;

pub use form::IntegerForm;
pub use greedy::ExactGreedy;
pub use nearest::{nearest, preference};
pub use two_opt::TwoOpt;
