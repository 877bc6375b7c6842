//! What is different where the boundary must not pass through itself.

use super::{Gini, build};
use crate::gini::contacts::Contacts;
use crate::gini::problem::not_positive;
use crate::optim::{BuildError, GiniStep, Status, Stopwatch};

/// How often ways are halved until they are free, before vertices stay where they are, and how often that is tried.
const HALVINGS: usize = 6;
const MOST_RETREATS: usize = 30;

/// Failures in a row after which x̄ begins anew, with a shorter stride of pins, where x has not moved;
const PATIENCE: usize = 2;

/// where x has moved a part of its way, pins of x̄ go on from there, but not after every so many failures: x̄ is left to
/// itself, or begins anew if the other number divides theirs, too.
const MOST_ADVANCES: usize = 3;

/// Contacts make vertices jitter where they have settled; over so many steps they go nowhere.
const WINDOW: usize = 10;

/// Ways that are not worth it, in units of the body's size.
const LEAST_WAY: f64 = 1e-4;

/// The least part of their way that pins go at once.
const LEAST_STRIDE: f64 = 1.0 / 128.0;

/// How far vertices get in [`WINDOW`] steps.
pub(super) struct Window<const D: usize> {
    from: Vec<[f64; D]>,
    steps: usize,
    /// How far the vertex that got farthest in the last whole window got in a step on average, in units of the body's
    /// size.
    drift: f64,
}

impl<const D: usize> Window<D> {
    pub(super) fn new(x: &[[f64; D]]) -> Self {
        Self {
            from: x.to_vec(),
            steps: 0,
            drift: f64::INFINITY,
        }
    }

    fn enter(&mut self, x: &[[f64; D]], size: f64) {
        self.steps += 1;
        if self.steps == WINDOW {
            self.drift = way(&self.from, x) / (WINDOW as f64 * size);
            self.from.copy_from_slice(x);
            self.steps = 0;
        }
    }
}

/// The longest way of a vertex.
fn way<const D: usize>(from: &[[f64; D]], to: &[[f64; D]]) -> f64 {
    let change = |(a, b): (&[f64; D], &[f64; D])| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>()
    };
    from.iter().zip(to).map(change).fold(0.0, f64::max).sqrt()
}

impl<const D: usize> Gini<D> {
    /// How near parts of the boundary may come to each other from x on, as a length, so that this solver can go on from
    /// there; 0 where overlap does not count.
    pub(crate) fn gap(&mut self) -> f64 {
        let (x, movable) = (&self.x, &self.movable);
        self.contacts
            .as_mut()
            .map_or(0.0, |contacts| contacts.room(x, movable))
    }

    /// Is no element inverted or flat there, and does the boundary not meet itself where overlap counts? Exact.
    pub(crate) fn proves(&self, positions: &[f64]) -> bool {
        let is_clear = |contacts: &Contacts<D>| {
            let x = self.by_slot(positions);
            contacts.meeting(&x, 1).is_empty()
        };
        not_positive(D, &self.corners, positions).is_empty()
            && self.contacts.as_ref().is_none_or(is_clear)
    }

    /// Positions by vertex as positions by slot.
    pub(crate) fn by_slot(&self, positions: &[f64]) -> Vec<[f64; D]> {
        let mut x = vec![[0.0; D]; self.slot.len()];
        for (position, &slot) in positions.as_chunks::<D>().0.iter().zip(&self.slot) {
            x[slot as usize] = *position;
        }
        x
    }

    /// Goes on from these positions, vertices × dimension, which have to be as injective as x is; another solver found
    /// them, after so many seconds in all.
    pub(crate) fn restart(&mut self, positions: &[f64], seconds: f64) {
        self.trial = self.by_slot(positions);
        self.elements.values(&self.trial, &mut self.trial_values);
        self.accept(self.count_inverted());
        self.publish();
        self.begin_anew();
        self.look();
        self.report.seconds = seconds;
    }

    /// The errors of [`Self::move_pins`].
    pub(crate) fn check_pins(&self, pins: &[(u32, [f64; D])]) -> Result<(), BuildError> {
        let wrong = |what: String| {
            Err(BuildError::InvalidOption {
                option: "pins",
                what,
            })
        };
        if self.contacts.is_none() {
            return wrong("move only where overlap counts".into());
        }
        for &(vertex, position) in pins {
            let slot = self.slot.get(vertex as usize);
            if slot.is_none_or(|&s| self.movable[s as usize]) {
                return wrong(format!("vertex {vertex} is not pinned"));
            }
            if !position.iter().all(|x| x.is_finite()) {
                return wrong(format!("vertex {vertex} would not be finite"));
            }
        }
        Ok(())
    }

    /// Has pinned vertices move elsewhere, hard: x̄ has them there at once, x stays where it is until the way there is
    /// free. The run goes on, with all its steps anew.
    ///
    /// # Errors
    /// `InvalidOption` without [`crate::gini::GiniOptions::overlap`], for a vertex that is not pinned, and for a
    /// position that is not finite; nothing has changed then.
    pub fn move_pins(&mut self, pins: &[(u32, [f64; D])]) -> Result<(), BuildError> {
        self.check_pins(pins)?;
        for &(vertex, position) in pins {
            let slot = self.slot[vertex as usize];
            if let Ok(place) = self.goals.binary_search_by_key(&slot, |goal| goal.0) {
                self.goals[place].1 = position;
            }
        }
        self.stride = 1.0;
        self.failures = 0;
        self.place_pins();
        self.arrived = self.goals.iter().all(|&(s, p)| self.x[s as usize] == p);
        self.foresee();
        self.moved = f64::INFINITY;
        self.window = Window::new(&self.x);
        self.begins_anew = true;
        self.idle = 0;
        self.report.iteration = 0;
        self.report.status = match self.options.max_iterations {
            0 => Status::MaxIterations,
            _ => Status::Running,
        };
        Ok(())
    }

    /// Puts the pins of x̄ on their way from x.
    pub(super) fn place_pins(&mut self) {
        for &(slot, goal) in &self.goals {
            let slot = slot as usize;
            self.iterate[slot] = match self.stride {
                1.0 => goal,
                part => {
                    std::array::from_fn(|i| self.x[slot][i] + part * (goal[i] - self.x[slot][i]))
                }
            };
        }
    }

    /// After a step: x has `reached` x̂, or has `advanced` a part of the way, or has not moved. Pins go longer ways after
    /// the first, from x on; after failures they go shorter ones, and x̄ begins anew where x is.
    pub(super) fn lead_pins(&mut self, reached: bool, advanced: bool) {
        if self.contacts.is_none() {
            return;
        }
        if reached {
            self.stride = (2.0 * self.stride).min(1.0);
            if !self.arrived {
                self.place_pins();
            }
            return;
        }
        if advanced && !self.failures.is_multiple_of(MOST_ADVANCES) {
            self.place_pins();
        } else if self.failures.is_multiple_of(PATIENCE) {
            self.stride = (0.5 * self.stride).max(LEAST_STRIDE);
            self.begin_anew();
        }
    }

    /// Brings the contacts up to date; returns how many pairs collide between x and x̂.
    pub(super) fn update_contacts(&mut self, step: &mut GiniStep) -> usize {
        let Some(contacts) = &mut self.contacts else {
            return 0;
        };
        let clock = Stopwatch::start();
        let collisions = contacts.update(&mut self.set, &self.x, &self.trial, &self.movable);
        step.collision_milliseconds += clock.milliseconds();
        step.contacts = self.set.list.iter().filter(|c| c.key.is_contact()).count();
        collisions
    }

    /// Where the polisher has failed: vertices of pairs that still collide on the way from x to x̂, and of elements that
    /// would get worse, go less and less of their way, all others the whole of it, until the way is free. Returns whether
    /// any goes far enough to be worth it.
    pub(super) fn advance(&mut self, step: &mut GiniStep) -> bool {
        if self.contacts.is_none() {
            return false;
        }
        let to = self.trial.clone();
        let mut part = vec![1.0f64; to.len()];
        for round in 0..MOST_RETREATS {
            self.elements.values(&self.trial, &mut self.trial_values);
            let mut slots: Vec<u32> = Vec::new();
            if let Some(contacts) = &mut self.contacts {
                let clock = Stopwatch::start();
                let pairs = contacts.colliding(&self.x, &self.trial, &self.movable);
                slots.extend(pairs.as_flattened());
                step.collision_milliseconds += clock.milliseconds();
            }
            let values = self.trial_values.iter().zip(&self.values);
            for (e, (&new, &old)) in values.enumerate() {
                if self.elements.movable[e] && !(new >= old.min(0.5 * self.elements.offset(e))) {
                    slots.extend(self.elements.slots[e]);
                }
            }
            if slots.is_empty() {
                if self.way(&self.trial) < LEAST_WAY * self.size || !self.is_clear() {
                    return false;
                }
                self.accept(self.count_inverted());
                // more than this is not known of where it settles
                self.moved = f64::INFINITY;
                self.window.drift = f64::INFINITY;
                return true;
            }
            slots.sort_unstable();
            slots.dedup();
            let factor = if round < HALVINGS { 0.5 } else { 0.0 };
            for s in slots {
                let s = s as usize;
                part[s] *= factor;
                self.trial[s] =
                    std::array::from_fn(|i| self.x[s][i] + part[s] * (to[s][i] - self.x[s][i]));
            }
        }
        false
    }

    /// How far the vertex that is farthest from x is.
    fn way(&self, to: &[[f64; D]]) -> f64 {
        way(&self.x, to)
    }

    /// Is every element that is inverted at x̂ better there than at x?
    pub(super) fn all_better(&self) -> bool {
        let better = |(&new, &old): (&f64, &f64)| new > 0.0 || new > old;
        let values = self.trial_values.iter().zip(&self.values);
        let movable = self.elements.movable.iter();
        values.zip(movable).all(|(v, &m)| !m || better(v))
    }

    /// Does the boundary of x̂ not meet itself? Exact. True where overlap does not count.
    pub(super) fn is_clear(&mut self) -> bool {
        let contacts = self.contacts.as_mut();
        contacts.is_none_or(|contacts| contacts.intersections(&self.trial, 1).is_empty())
    }

    /// Moves x to x̂.
    pub(super) fn accept(&mut self, inverted: usize) {
        if self.contacts.is_some() {
            self.moved = self.way(&self.trial) / self.size;
            self.window.enter(&self.trial, self.size);
            let trial = &self.trial;
            self.arrived = self.goals.iter().all(|&(s, p)| trial[s as usize] == p);
            // contacts push what floats
            for (slots, centroid) in &mut self.floating {
                *centroid = build::centroid(slots, &self.trial);
            }
            self.best.inverted = inverted;
            self.best.smallest = self.smallest(&self.trial_values);
            self.best.x.copy_from_slice(&self.trial);
        }
        self.x.copy_from_slice(&self.trial);
        self.values.copy_from_slice(&self.trial_values);
    }

    /// May x be the last state, if it is injective?
    pub(super) fn is_final(&self) -> bool {
        self.arrived
            && (self.contacts.is_none()
                || self.moved.min(self.window.drift) <= self.options.settle
                || self.options.settle == 0.0)
    }

    /// Is the run over?
    pub(super) fn is_done(&self) -> bool {
        self.is_final() && self.is_injective() && self.is_disjoint()
    }

    /// No part of the boundary inside another body.
    fn is_disjoint(&self) -> bool {
        let contacts = self.contacts.as_ref();
        contacts.is_none_or(|contacts| contacts.overlaps(&self.x).is_empty())
    }
}
