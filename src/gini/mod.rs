//! Globally injective maps by steps that need not be injective (Overby, Kaufman & Narain 2021).

mod admm;
mod constraint;
mod dual;
mod elements;
mod offsets;
mod options;
mod polisher;
mod problem;
mod set;
mod simplex;
mod solver;
#[cfg(test)]
mod tests;
mod zones;

pub use constraint::{Constraint, Key, Law};
pub use options::GiniOptions;
pub use problem::GiniProblem;
pub use solver::{Gini, Outcome};
