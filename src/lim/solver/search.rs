//! How far to go along a direction: the search for σ.

use super::Lim;
use crate::lim::problem::inverted;
use crate::optim::vectors::set_combination;

/// Most halvings of a step (the official code's least step is 1e-21).
const MOST_HALVINGS: u32 = 70;

/// How much of the way to the first wall a step may go.
const FRACTION: f64 = 0.9;

/// The longest step.
const LONGEST: f64 = 8.0;

/// c of Armijo's rule.
const DECREASE: f64 = 1e-4;

impl Lim {
    /// Is nothing inverted here, exactly? Without barrier that does not matter.
    fn is_injective(&self, x: &[f64]) -> bool {
        let corners = self.objective.elements.corners();
        !self.options.barrier || inverted(self.dimension, corners, x).0 == 0
    }

    /// The longest of the steps σ, σ/2, σ/4, …, from 1 or from near the first wall, that lowers the
    /// objective and inverts nothing, or, if the first of them does, the last of 2σ, 4σ, … that lowers it further;
    /// 0 where none does. The positions there are in `trial`; the number of trials.
    pub(super) fn search(&mut self, slope: f64) -> (f64, u32) {
        if !(slope < 0.0) {
            return (0.0, 0);
        }
        let before = self.whole(&self.sums, &self.x);
        let longest = match self.options.barrier {
            true => {
                let elements = &mut self.objective.elements;
                FRACTION * elements.bound(&self.x, &self.direction, LONGEST / FRACTION)
            }
            false => LONGEST,
        };
        let mut sigma = longest.min(1.0);
        let resolution = self.resolution();
        for trials in 1..=MOST_HALVINGS {
            let after = self.try_step(sigma);
            let falls = after <= before + DECREASE * sigma * slope;
            // what is demanded cannot be seen any more
            let same = -sigma * slope < resolution && after <= before;
            if (falls || same) && self.is_injective(&self.trial) {
                return match trials {
                    1 if falls => self.look_on(sigma, after, longest),
                    _ => (sigma, trials),
                };
            }
            if -sigma * slope < 1e-3 * resolution {
                return (0.0, trials);
            }
            sigma *= 0.5;
        }
        (0.0, MOST_HALVINGS)
    }

    /// Doubles a step as long as that lowers the objective: a convex part of the second derivatives is stiffer
    /// than they are.
    fn look_on(&mut self, mut sigma: f64, mut value: f64, longest: f64) -> (f64, u32) {
        let mut trials = 1;
        while 2.0 * sigma <= longest {
            trials += 1;
            let after = self.try_step(2.0 * sigma);
            if !(after < value && self.is_injective(&self.trial)) {
                self.go(sigma);
                break;
            }
            sigma *= 2.0;
            value = after;
        }
        (sigma, trials)
    }

    /// The objective after a step, whose end is in `trial`; infinite or NaN where it has none.
    fn try_step(&mut self, sigma: f64) -> f64 {
        self.go(sigma);
        let sums = self.objective.value(&self.trial);
        self.whole(&sums, &self.trial)
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
