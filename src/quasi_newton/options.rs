//! Options of the quasi-Newton solver.

use crate::optim::BuildError;

/// Options of [`super::QuasiNewton`]. `Default` has the window of the paper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QuasiNewtonOptions {
    /// Pairs in the L-BFGS history (m = 5).
    pub history: usize,
    /// c of Armijo's rule E(x + t d) ≤ E(x) + c t ∇E·d, in (0, 1).
    pub decrease: f64,
    /// Stop when |ΔE|/(|E| + floor) or |∇E|/force is below this, see [`crate::optim::Yardstick`].
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
}

impl Default for QuasiNewtonOptions {
    fn default() -> Self {
        Self {
            history: 5,
            decrease: 1e-4,
            tolerance: 1e-11,
            max_iterations: 5000,
        }
    }
}

impl QuasiNewtonOptions {
    /// Checks the ranges.
    pub fn validate(&self) -> Result<(), BuildError> {
        let bad = |option, what: &str| {
            let what = what.into();
            Err(BuildError::InvalidOption { option, what })
        };
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return bad("tolerance", "must be a finite number, at least 0");
        }
        if self.history == 0 {
            return bad("history", "must be at least 1");
        }
        if !(self.decrease > 0.0 && self.decrease < 1.0) {
            return bad("decrease", "must be between 0 and 1");
        }
        Ok(())
    }
}
