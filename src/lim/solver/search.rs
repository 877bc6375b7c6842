//! How far to go along a direction: the search for σ.

use super::Lim;
use crate::lim::problem::inverted;
use crate::optim::vectors::set_combination;

/// Most halvings of a step (the official code's least step is 1e-21).
const MOST_HALVINGS: u32 = 70;

/// How much of the way to the first wall a step may go.
const FRACTION: f64 = 0.9;

/// c of Armijo's rule.
const DECREASE: f64 = 1e-4;

impl Lim {
    /// Is nothing inverted here, exactly? Without barrier that does not matter.
    fn is_injective(&self, x: &[f64]) -> bool {
        let corners = self.objective.elements.corners();
        !self.options.barrier || inverted(self.dimension, corners, x).0 == 0
    }

    /// The longest of the steps σ, σ/2, σ/4, …, from 1 or from near the first wall, that lowers the
    /// objective and inverts nothing; 0 where none does. The positions there are in `trial`; the number of trials.
    pub(super) fn search(&mut self, slope: f64) -> (f64, u32) {
        if !(slope < 0.0) {
            return (0.0, 0);
        }
        let before = self.whole(&self.sums, &self.x);
        let mut sigma = match self.options.barrier {
            true => {
                let elements = &mut self.objective.elements;
                let bound = elements.bound(&self.x, &self.direction, 1.0 / FRACTION);
                (FRACTION * bound).min(1.0)
            }
            false => 1.0,
        };
        let resolution = self.resolution();
        for trials in 1..=MOST_HALVINGS {
            self.go(sigma);
            let sums = self.objective.value(&self.trial);
            let after = self.whole(&sums, &self.trial);
            let falls = after <= before + DECREASE * sigma * slope;
            // what is demanded cannot be seen any more
            let same = -sigma * slope < resolution && after <= before;
            if (falls || same) && after.is_finite() && self.is_injective(&self.trial) {
                return (sigma, trials);
            }
            if -sigma * slope < 1e-3 * resolution {
                return (0.0, trials);
            }
            sigma *= 0.5;
        }
        (0.0, MOST_HALVINGS)
    }

    /// x + σ p into `trial`.
    fn go(&mut self, sigma: f64) {
        let along = core::iter::once((sigma, &self.direction[..]));
        set_combination((1.0, &self.x), along, &mut self.trial);
    }

    /// Puts handles that are nearly there at their targets and holds them, if that inverts nothing.
    pub(super) fn settle_handles(&mut self) {
        self.trial.copy_from_slice(&self.x);
        if self.constraints.arriving(&mut self.trial) == 0 {
            return;
        }
        let sums = self.objective.value(&self.trial);
        if sums.energy.is_finite() && sums.barrier.is_finite() && self.is_injective(&self.trial) {
            core::mem::swap(&mut self.x, &mut self.trial);
            self.constraints.hold_arrived(&self.x);
        }
    }
}
