//! Which matrix a step is made with.

use super::Newton;
use super::search::Found;
use crate::newton::curvature::Share;
use crate::optim::vectors::{dot, set_combination};
use crate::optim::{Phase, SolveError, Stopwatch};

/// How much of what is negative in the elements' Hessians is tried in an iteration: a part, and less where the
/// sum was not definite. That shows early in the factorisation, mostly, and costs little.
const MOST_PARTS: u32 = 2;

/// The first, where the Hessian is first tried,
pub(super) const FIRST_PART: f64 = 0.25;

/// from one to the next,
const PARTS_RATIO: f64 = 0.25;

/// and, where the first was definite, for the next iteration.
const PARTS_GROWTH: f64 = 4.0;

/// The least part that is tried.
const LEAST_PART: f64 = 0.05;

/// Larger shifts tried where no step along a direction lowers the energy.
const MOST_SHIFTS: u32 = 5;

/// A matrix and a line search.
#[derive(Default)]
pub(super) struct Tried {
    /// What the search found, if it did.
    pub found: Option<Found>,
    /// The decrease that the quadratic model promised.
    pub decrement: f64,
}

impl Newton {
    /// −H⁻¹ g into `direction`; its slope along the reported energy.
    fn descend(&mut self) -> f64 {
        let direction = &mut self.direction[..self.unknowns];
        set_combination((-1.0, &self.gradient), core::iter::empty(), direction);
        self.system.solve(direction);
        self.evaluation.shape.constants.scale * dot(direction, &self.gradient)
    }

    /// The step with a part, the larger the better, of what is negative in the Hessians of the elements (where they
    /// turn, of all that resists it), as long as their sum is positive definite: all of it makes it Newton's.
    pub(super) fn indefinite(
        &mut self,
        iteration: usize,
        phases: &mut [Phase; 4],
    ) -> Result<Tried, SolveError> {
        for attempt in 0..MOST_PARTS {
            let share = match self.turns.is_some() {
                true => Share {
                    resistance: self.kept,
                    negative: 1.0,
                },
                false => Share {
                    resistance: 1.0,
                    negative: self.kept,
                },
            };
            let tried = self.attempt(share, 0.0, iteration, phases)?;
            if tried.found.is_some() {
                if attempt == 0 {
                    self.kept = (self.kept * PARTS_GROWTH).min(1.0);
                }
                return Ok(tried);
            }
            self.kept *= PARTS_RATIO;
            if self.kept < LEAST_PART {
                break;
            }
        }
        self.kept = self.kept.max(LEAST_PART);
        Ok(Tried::default())
    }

    /// The step with positive semidefinite matrices of the elements.
    pub(super) fn semidefinite(
        &mut self,
        iteration: usize,
        phases: &mut [Phase; 4],
    ) -> Result<Tried, SolveError> {
        let share = Share::semidefinite(self.resistance);
        let mut at_least = self.system.next_shift();
        let mut attempts = 0;
        loop {
            let tried = self.attempt(share, at_least, iteration, phases)?;
            attempts += 1;
            let visible = tried.decrement.abs() > self.resolution();
            let again = visible && attempts <= MOST_SHIFTS && self.system.shift() < 1.0;
            if tried.found.is_some() || !again {
                return Ok(tried);
            }
            // where the matrix is nearly singular the direction may be nothing but rounding error
            at_least = self.system.larger_shift();
        }
    }

    /// One matrix, its factor, and a line search; finds nothing if the sum is indefinite.
    pub(super) fn attempt(
        &mut self,
        share: Share,
        at_least: f64,
        iteration: usize,
        phases: &mut [Phase; 4],
    ) -> Result<Tried, SolveError> {
        let [local, factor, global, evaluate] = phases;
        let add = |phase: &mut Phase, count: u32, clock: Stopwatch| {
            phase.count += count;
            phase.milliseconds += clock.milliseconds();
        };
        let clock = Stopwatch::start();
        let unbalanced = self
            .turns
            .as_mut()
            .map(|turns| turns.unbalanced(&self.evaluation, &self.gradient));
        self.system
            .assemble(&self.evaluation, &*self.curvature, unbalanced, share);
        add(local, 1, clock);
        let clock = Stopwatch::start();
        let factored = match share.is_indefinite() {
            true => self.system.factorize_as_is(&self.turning()).map(|()| 1),
            false => self.system.factorize(at_least),
        };
        add(factor, factored.unwrap_or(1), clock);
        match factored {
            Err(_) if share.is_indefinite() => return Ok(Tried::default()),
            Err(error) => {
                let pivot = error.pivot;
                return Err(SolveError::NotPositiveDefinite { iteration, pivot });
            }
            Ok(_) => {}
        }
        let clock = Stopwatch::start();
        let slope = self.descend();
        add(global, 1, clock);
        let clock = Stopwatch::start();
        let (found, trials) = match slope < 0.0 {
            true => self.search_turning(slope),
            false => (None, 0),
        };
        add(evaluate, trials, clock);
        if found.is_none() {
            // the next matrix is that of the iterate, not of the last trial
            self.evaluation.at(&self.x, &mut self.trial_gradient);
        }
        let decrement = -0.5 * slope;
        Ok(Tried { found, decrement })
    }

    /// Where a piece of the plane can still turn about its only pin: its free vertex that is furthest from it, and
    /// the direction in which that would move. The Hessian says nothing of this turn but rounding errors.
    fn turning(&self) -> Vec<(usize, [f64; 2])> {
        let (free, pinned) = self.x.split_at(self.unknowns);
        let pins = pinned.as_chunks::<2>().0;
        let mut furthest = vec![(0, [0.0; 2], 0.0); self.only_pins.len()];
        if !self.only_pins.is_empty() {
            for (vertex, p) in free.as_chunks::<2>().0.iter().enumerate() {
                let piece = self.piece[vertex] as usize;
                let Some(&pin) = self.only_pins.get(piece) else {
                    continue;
                };
                let pin = pins[pin as usize];
                let arm = [p[0] - pin[0], p[1] - pin[1]];
                let length = (arm[0] * arm[0] + arm[1] * arm[1]).sqrt();
                if length > furthest[piece].2 {
                    furthest[piece] = (vertex, arm, length);
                }
            }
        }
        let far = furthest.into_iter().filter(|&(_, _, l)| l > 0.0);
        far.map(|(vertex, arm, l)| (vertex, [-arm[1] / l, arm[0] / l]))
            .collect()
    }
}
