//! Do four points that move linearly meet? Decided in rational and algebraic numbers, beside the solver's answer.
#![allow(dead_code)]

pub mod motion;
pub mod polynomial;
pub mod queries;
