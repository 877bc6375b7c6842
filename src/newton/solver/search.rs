//! How far to go along a direction.

use super::Newton;
use crate::newton::NewtonOptions;
use crate::newton::bound::step_bound;
use crate::optim::vectors::{dot, set_combination};
use crate::quasi_newton::evaluation::Value;

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 60;

/// Secant steps of a line search.
const MOST_SECANTS: u32 = 2;

/// They are worth their evaluation where the slope that is left is this part of the first,
const STEEP: f64 = 0.2;

/// or, of the other sign, this part,
const OVERSHOT: f64 = 0.5;

/// and go no further at once than this many times the step so far.
const MOST_STRETCH: f64 = 4.0;

/// The end of a line search.
pub(super) struct Found {
    pub step: f64,
    pub value: Value,
    /// Was the decrease demanded too small to be seen?
    pub by_rounding: bool,
    /// Has a contact cut the step short?
    pub blocked: bool,
}

impl Newton {
    /// The longest step that inverts nothing, if inverting costs, and on which the boundary does not pass through
    /// itself, if it must not; whether it is a contact that bounds it.
    pub(super) fn longest_step(&mut self) -> (f64, bool) {
        let NewtonOptions {
            fraction, longest, ..
        } = self.options;
        let positive = match self.evaluation.shape.barrier || self.keeps_positive {
            true => step_bound(
                &self.evaluation.blocks,
                self.evaluation.elements(),
                &self.x,
                &self.direction,
                fraction,
                longest,
                &mut self.bounds,
            ),
            false => longest,
        };
        self.longest_apart(positive)
    }

    /// May positions with this value be taken?
    fn is_allowed(&self, value: &Value) -> bool {
        value.energy.is_finite() && !(self.keeps_positive && value.inverted > 0)
    }

    /// Evaluates a step along the direction, into `trial` and `trial_gradient`.
    pub(super) fn try_step(&mut self, step: f64) -> Value {
        let along = core::iter::once((step, &self.direction[..self.unknowns]));
        set_combination(
            (1.0, &self.x[..self.unknowns]),
            along,
            &mut self.trial[..self.unknowns],
        );
        self.evaluation.at(&self.trial, &mut self.trial_gradient)
    }

    /// From the full step, if nothing is inverted so far, by halves to the first that satisfies Armijo's
    /// rule, or, where what the rule demands is rounding error, that does not raise the energy; then by
    /// secants on the slope nearer to the minimum along the direction. The evaluation there is in `trial` and
    /// `trial_gradient`; the number of trials.
    pub(super) fn search(&mut self, slope: f64) -> (Option<Found>, u32) {
        let (bound, blocked) = self.longest_step();
        let mut step = bound.min(1.0);
        let resolution = self.resolution();
        for trials in 1..=MOST_HALVINGS {
            let value = self.try_step(step);
            let by_rounding = -step * slope < resolution;
            let enough = match by_rounding {
                true => self.energy,
                false => self.energy + self.options.decrease * step * slope,
            };
            if self.is_allowed(&value) && value.energy <= enough {
                let mut found = Found {
                    step,
                    value,
                    by_rounding,
                    blocked,
                };
                let more = match by_rounding {
                    true => 0,
                    false => self.refine(&mut found, slope, bound),
                };
                return (Some(found), trials + more);
            }
            if by_rounding && -step * slope < 1e-3 * resolution {
                return (None, trials);
            }
            step *= 0.5;
        }
        (None, MOST_HALVINGS)
    }

    /// Goes from an accepted step on, or back, to where the slope along the direction vanishes, by secants, as
    /// long as that lowers the energy; the number of trials.
    fn refine(&mut self, found: &mut Found, slope: f64, bound: f64) -> u32 {
        let scale = self.evaluation.shape.constants.scale;
        let (mut last, mut last_slope) = (0.0, slope);
        for trials in 0..MOST_SECANTS {
            let direction = &self.direction[..self.unknowns];
            let here = scale * dot(direction, &self.trial_gradient);
            let secant = found.step - here * (found.step - last) / (here - last_slope);
            let next = match () {
                _ if here > OVERSHOT * -slope => secant,
                _ if here < STEEP * slope && bound > 1.01 * found.step => {
                    let far = if secant > found.step { secant } else { bound };
                    far.min(bound).min(MOST_STRETCH * found.step)
                }
                () => return trials,
            };
            let value = self.try_step(next);
            if !(next > 0.0 && self.is_allowed(&value) && value.energy < found.value.energy) {
                // back to where it was: the evaluation, too, whose F the next matrix needs
                found.value = self.try_step(found.step);
                return trials + 2;
            }
            (last, last_slope) = (found.step, here);
            found.step = next;
            found.value = value;
        }
        MOST_SECANTS
    }
}
