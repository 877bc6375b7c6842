//! Options of the solver.

use crate::optim::BuildError;

/// Options of [`super::Gini`]. `Default` is the paper's choice (table 1), of which nothing is to be tuned for a
/// problem.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "camelCase")]
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
}

impl Default for GiniOptions {
    fn default() -> Self {
        Self {
            max_qp_iterations: 50,
            max_polish_iterations: 30,
            offset: 0.1,
            target_stiffness: 1.0,
            max_iterations: 100,
        }
    }
}

impl GiniOptions {
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
        if self.max_polish_iterations == 0 {
            return bad("maxPolishIterations", "must be at least 1");
        }
        Ok(())
    }
}
