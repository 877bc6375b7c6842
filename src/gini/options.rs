//! Options of the solver.

use crate::optim::BuildError;

/// Options of [`super::Gini`]. `Default` is the paper's choice (table 1), of which nothing is to be tuned for a
/// problem.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct GiniOptions {
    /// Most iterations of L-BFGS-B on the dual problem (10) in one step.
    pub max_qp_iterations: usize,
    /// Most iterations of the polisher in one step.
    pub max_polish_iterations: usize,
    /// η of an element in units of its rest measure, where none has been reduced yet.
    pub offset: f64,
    /// Stiffness κ of targets that pull, in units of the largest diagonal entry of the Laplacian.
    pub target_stiffness: f64,
    /// Stop after this many steps.
    pub max_iterations: usize,
    /// Keep the boundary from passing through itself (§6, §8.3)? The start's must not meet itself. Pins with targets
    /// then move there along a path that is free, and the run is not over before they have arrived.
    pub overlap: bool,
    /// η of contacts, in units of the body's size (the D-th root of its rest measure) or of 100 elements of mean size,
    /// whichever is less, so that results do not depend on the unit of length.
    pub contact_offset: f64,
    /// With `overlap`: an injective state is final when no vertex has moved by more than this in the last step, or in a
    /// step on average over ten, in units of the body's size. 0: the first injective state is.
    pub settle: f64,
}

impl Default for GiniOptions {
    fn default() -> Self {
        Self {
            max_qp_iterations: 50,
            max_polish_iterations: 30,
            offset: 0.1,
            target_stiffness: 1.0,
            max_iterations: 100,
            overlap: false,
            contact_offset: 1e-4,
            settle: 0.0,
        }
    }
}

impl GiniOptions {
    /// For bodies whose boundary must not pass through itself while targets pull at it: soft targets (κ of §8.3), and
    /// a state that has settled.
    pub fn overlap() -> Self {
        Self {
            overlap: true,
            target_stiffness: 1e-5,
            settle: 1e-3,
            ..Self::default()
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// `InvalidOption` names the option.
    pub fn validate(&self) -> Result<(), BuildError> {
        let bad = |option, what: &str| {
            Err(BuildError::InvalidOption {
                option,
                what: what.into(),
            })
        };
        if !(self.offset > 0.0 && self.offset < 1.0) {
            return bad("offset", "must be between 0 and 1");
        }
        if !(self.target_stiffness > 0.0 && self.target_stiffness.is_finite()) {
            return bad("targetStiffness", "must be finite and positive");
        }
        if !(self.contact_offset > 0.0 && self.contact_offset < 0.1) {
            return bad("contactOffset", "must be between 0 and 0.1");
        }
        if !(self.settle >= 0.0 && self.settle.is_finite()) {
            return bad("settle", "must be finite and not negative");
        }
        if self.max_polish_iterations == 0 {
            return bad("maxPolishIterations", "must be at least 1");
        }
        Ok(())
    }
}
