//! Options of the second-order solvers.

use crate::optim::BuildError;

/// Options of [`super::Newton`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NewtonOptions {
    /// How much of the way to the first degenerate element a step may go, in (0, 1) (Smith & Schaefer 2015:
    /// 0.8).
    pub fraction: f64,
    /// c of Armijo's rule E(x + t d) ≤ E(x) + c t ∇E·d, in (0, ½).
    pub decrease: f64,
    /// What is added to the diagonal at first, relative to it: rigid motions leave the matrix singular. It
    /// grows where it is too small. More than rounding slows down maps that have to unroll: how a long
    /// strip bends is as soft, beside how a triangle stretches, as the strip is long.
    pub shift: f64,
    /// The longest step, from 1: a majorizer is stiffer than what it majorizes, so that the energy often
    /// goes on falling beyond its minimum.
    pub longest: f64,
    /// In the plane: do triangles turn along a step? Then strips unroll in a few steps; each costs two or three
    /// solves with a Laplacian more.
    pub turning: bool,
    /// Stop when |ΔE|/(|E| + floor of the energy) or |∇E| is below this.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self {
            fraction: 0.8,
            decrease: 1e-4,
            longest: 8.0,
            shift: 1e-14,
            turning: false,
            tolerance: 1e-11,
            max_iterations: 5000,
        }
    }
}

impl NewtonOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn validate(&self) -> Result<(), BuildError> {
        let between = |x: f64, least: f64, most: f64| x > least && x < most;
        let checks = [
            (
                "fraction",
                between(self.fraction, 0.0, 1.0),
                "must be between 0 and 1",
            ),
            (
                "decrease",
                between(self.decrease, 0.0, 0.5),
                "must be between 0 and 0.5",
            ),
            (
                "shift",
                between(self.shift, 0.0, 1.0),
                "must be between 0 and 1",
            ),
            (
                "longest",
                self.longest >= 1.0 && self.longest.is_finite(),
                "must be a finite number, at least 1",
            ),
            (
                "tolerance",
                self.tolerance >= 0.0 && self.tolerance.is_finite(),
                "must be a finite number, at least 0",
            ),
        ];
        match checks.into_iter().find(|(_, fits, _)| !fits) {
            Some((option, _, what)) => Err(BuildError::InvalidOption {
                option,
                what: what.into(),
            }),
            None => Ok(()),
        }
    }
}
