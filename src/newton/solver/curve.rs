//! How far to go along a curve on which elements turn.

use super::Newton;
use super::search::Found;
use crate::quasi_newton::evaluation::Value;

/// Below this turn, in radians, a curve is its tangent.
const SLIGHT: f64 = 0.01;

/// Most evaluations along a curve.
const MOST_TRIALS: u32 = 3;

/// The longest and the shortest of the next trial, relative to the last.
const MOST_STRETCH: f64 = 3.0;
const MOST_SHRINKING: f64 = 0.2;

/// Steps as near as this to the minimum of the parabola are near enough.
const NEAR_ENOUGH: [f64; 2] = [0.6, 1.5];

/// A matrix is too stiff if the minimum is this many steps away, and too soft if this part of one.
const TOO_STIFF: f64 = 1.5;
const TOO_SOFT: f64 = 0.6;

/// By how much a triangle's resistance to turns is then made less, or more;
const LESS: f64 = 0.25;

/// less than this is none,
const LEAST_RESISTANCE: f64 = 0.02;

/// and more than none is this.
const SOME_RESISTANCE: f64 = 0.05;

impl Newton {
    /// As [`Self::search`], along the curve if elements turn far, and if that finds anything.
    pub(super) fn search_turning(&mut self, slope: f64) -> (Option<Found>, u32) {
        // where a triangle is near its end, straight steps know how near
        if self.turns.is_none() || self.longest_step().0 < 1.0 {
            return self.search(slope);
        }
        let Some(mut turns) = self.turns.take() else {
            return self.search(slope);
        };
        let mut go = |this: &mut Self, t: f64| {
            let trial = &mut this.trial[..this.unknowns];
            turns.go(&this.evaluation, &this.x, &this.direction, t, trial)
        };
        let mut best: Option<Found> = None;
        let mut last = 0.0;
        let mut t = 1.0;
        let mut trials = 0;
        while trials < MOST_TRIALS {
            let turned = go(self, t);
            if turned < SLIGHT && trials == 0 {
                break;
            }
            trials += 1;
            last = t;
            let value = self.evaluation.at(&self.trial, &mut self.trial_gradient);
            let demanded = self.options.decrease * t * slope;
            let wanted = best
                .as_ref()
                .map_or(self.energy + demanded, |b| b.value.energy);
            let better = value.energy <= wanted;
            if better {
                let by_rounding = -t * slope < self.resolution();
                best = Some(Found {
                    step: t,
                    value,
                    by_rounding,
                    blocked: false,
                });
                if by_rounding {
                    break;
                }
            }
            let ratio = self.vertex_of_parabola(t, slope, value) / t;
            if trials == 1 {
                self.adapt(ratio);
            }
            let near = (NEAR_ENOUGH[0]..NEAR_ENOUGH[1]).contains(&ratio);
            if best.is_some() && (near || !better) {
                break;
            }
            t *= ratio.clamp(MOST_SHRINKING, MOST_STRETCH);
        }
        // the evaluation, whose F the next matrix needs, is to be that of the step found
        if let Some(found) = best.as_mut().filter(|found| found.step != last) {
            go(self, found.step);
            found.value = self.evaluation.at(&self.trial, &mut self.trial_gradient);
        }
        self.turns = Some(turns);
        match best {
            Some(_) => (best, trials),
            None => {
                let (found, more) = self.search(slope);
                (found, trials + more)
            }
        }
    }

    /// Lets triangles turn more freely, or less so, in the next semidefinite matrix, from how long the last step should
    /// have been.
    fn adapt(&mut self, ratio: f64) {
        let resistance = self.resistance;
        self.resistance = match ratio {
            r if r > TOO_STIFF && resistance * LESS < LEAST_RESISTANCE => 0.0,
            r if r > TOO_STIFF => resistance * LESS,
            r if r < TOO_SOFT => (resistance / LESS).clamp(SOME_RESISTANCE, 1.0),
            _ => resistance,
        };
    }

    /// Where the parabola with the energy and this slope at 0 and that value at t is least; infinite where it
    /// bends down, 0 where the value is not finite.
    fn vertex_of_parabola(&self, t: f64, slope: f64, value: Value) -> f64 {
        if !value.energy.is_finite() {
            return 0.0;
        }
        let bend = (value.energy - self.energy) / t - slope;
        match bend > 0.0 {
            true => -0.5 * slope * t / bend,
            false => f64::INFINITY,
        }
    }
}
