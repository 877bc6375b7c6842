//! Options of the ADMM solvers.

use crate::optim::BuildError;

/// How element weights follow the local stiffness (paper §5).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reweighting {
    /// γ of (23): reweight when any weight is off by this factor.
    pub threshold: f64,
    /// β_min of (22), relative to the rest weight (24a).
    pub least: f64,
    /// β_max at the first iteration (24b).
    pub most: f64,
    /// Growth of β_max per iteration (24b).
    pub growth: f64,
    /// Cap of β_max (24b).
    pub cap: f64,
    /// Iterations that keep the rest weights before reweighting begins (§6.2: the first).
    pub delay: usize,
    /// The same for a start of which more than 1 % of the elements are inverted. Such a start says
    /// nothing of the stiffness near the optimum, and weights taken from it only grow; the paper's
    /// quasi-static problems wait as long (§6.1: k_rw = 50).
    pub delay_folded: usize,
}

impl Reweighting {
    /// The values for parameterization (§6.2).
    pub const PARAMETERIZATION: Self = Self {
        threshold: 1.5,
        least: 1.0,
        most: 10.0,
        growth: 1.5,
        cap: 1e9,
        delay: 1,
        delay_folded: 50,
    };

    /// The values for quasi-statics (§6.1).
    pub const QUASI_STATIC: Self = Self {
        threshold: 1.5,
        least: 0.1,
        most: 10.0,
        growth: 1.0,
        cap: 10.0,
        delay: 50,
        delay_folded: 50,
    };

    /// β_max(k) of (24b), k counted so that the first reweighting iteration of a start without delay is
    /// 1.
    pub fn most_at(&self, iteration: usize) -> f64 {
        // beyond 200 iterations the power has long passed the cap
        (self.most * self.growth.powi(iteration.min(200) as i32)).min(self.cap)
    }
}

/// Options of [`super::Wrapd`]. `Default` is the paper's choice for parameterization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WrapdOptions {
    /// Dynamic reweighting, or none for the rest weights throughout.
    pub reweighting: Option<Reweighting>,
    /// Pairs in the L-BFGS history (§4.1: l = 6).
    pub history: usize,
    /// Most L-BFGS iterations of one global step (§4.1: 100).
    pub max_global_iterations: usize,
    /// Stop when |ΔE|/(|E| + floor) or |∇E|/force is below this, see [`crate::optim::Yardstick`], with no
    /// flips in the last two iterates. Of a map of measure 1 and an energy of 1 at least, as those of
    /// parameterization, that is |ΔE|/E or |∇E|.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
    /// Z and U are set again from X at the second iteration: from a start with flips the first local
    /// step teaches U little (not in the paper; the authors' code does it, and its iteration counts
    /// depend on it).
    pub restart_duals: bool,
}

impl Default for WrapdOptions {
    fn default() -> Self {
        Self {
            reweighting: Some(Reweighting::PARAMETERIZATION),
            history: 6,
            max_global_iterations: 100,
            tolerance: 1e-6,
            max_iterations: 5000,
            restart_duals: true,
        }
    }
}

impl WrapdOptions {
    /// Checks the ranges.
    pub fn validate(&self) -> Result<(), BuildError> {
        let bad = |option, what: &str| {
            Err(BuildError::InvalidOption {
                option,
                what: what.into(),
            })
        };
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return bad("tolerance", "must be a finite number, at least 0");
        }
        if self.history == 0 {
            return bad("history", "must be at least 1");
        }
        if self.max_global_iterations == 0 {
            return bad("max_global_iterations", "must be at least 1");
        }
        if let Some(r) = self.reweighting {
            if !(r.threshold > 1.0) {
                return bad("reweighting.threshold", "must be above 1");
            }
            if !(r.least > 0.0 && r.least <= r.most && r.most <= r.cap) {
                return bad("reweighting", "needs 0 < least ≤ most ≤ cap");
            }
            if !(r.growth >= 1.0) {
                return bad("reweighting.growth", "must be at least 1");
            }
        }
        Ok(())
    }
}
