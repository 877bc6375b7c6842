//! GINI: injective maps by steps that need not be injective (Overby, Kaufman & Narain 2021, algorithm 1).
//!
//! Two states evolve together: x̄ of the primary solver, which may fold, and x, which is handed out. A step:
//!
//! 1. local step (5a), (5b) at x̄: ADMM with Z = F, on the element loops of `wrapd`;
//! 2. global step: the quadratic problem (6) with the constraint set 𝒞 linearised at x̄, by L-BFGS-B on its
//!    dual (10); an iteration is one solve with the factor of the Laplacian;
//! 3. constraints whose multiplier is 0 leave 𝒞 (§6.2);
//! 4. the polisher (§5): from x̂ = x̄ on, 𝒞 grows by every element below its least measure η, falls into zones that
//!    share no vertex, and each zone takes a step of Levenberg and Marquardt's method (12), (13);
//! 5. once all elements that are still inverted at x̂ are better than at x, x moves to x̂ (§5.1).
//!
//! It ends when no element is inverted or degenerate by exact predicates, or, with the best state, after 15 steps without
//! a better one. Not in the paper: after the first, second, fourth, … step the primary solver takes some steps without
//! constraints and begins anew. Constraints keep elements in place that have wound around an edge twice, where no
//! polishing helps; without them less energy unwinds these.
//!
//! **η** is a tenth of an element's rest measure (less in proportion where pins leave less room than there is at rest),
//! and falls by itself in the zones in which the polisher ends with inverted elements: those ask for more measure than
//! there is. The report says how far it fell.
//!
//! **Contacts** ([`GiniOptions::overlap`]): the boundary of x never meets itself. Before every iteration of the polisher
//! continuous collision detection from x to x̂ adds the first contacts of vertices, faces and edges to 𝒞 (§6.1); x moves
//! to x̂ only along a path on which nothing collides, and only if an exact test finds that the boundary of x̂ does not
//! meet itself. Not in the paper: pairs that collide on the way, but are on the right side of each other again at its end,
//! are held apart along the normal of their impact; where the polisher fails, x goes the part of the way that is free;
//! and pins that move elsewhere then take a shorter stride. Constraints are about at most four vertices and know what they are about ([`Key`]).

mod admm;
mod constraint;
mod contact;
mod contacts;
mod dual;
mod elements;
mod offsets;
mod options;
mod outcome;
mod polisher;
mod problem;
mod set;
mod simplex;
mod solver;
#[cfg(test)]
mod tests;
mod trace;
mod winding;
mod zones;

pub use constraint::{Constraint, Key, Law};
pub use options::GiniOptions;
pub(crate) use outcome::MOST_PAIRS;
pub use outcome::Outcome;
pub use problem::GiniProblem;
pub use solver::Gini;
pub use trace::{TraceContact, TraceState};
