//! Algorithm 1.

mod build;
mod overlap;

use super::GiniOptions;
use super::admm::Admm;
use super::constraint::Key;
use super::contacts::Contacts;
use super::dual::global_step;
use super::elements::Elements;
use super::polisher::polish;
use super::problem::not_positive;
use super::set::ConstraintSet;
use super::trace::Trace;
use super::winding::winds;
use super::zones::Zones;
use crate::optim::{
    Criterion, GiniStep, Inspection, Phase, PhaseKind, PolishStep, SolveError, Solver, Status,
    StepReport, Stopwatch,
};
use crate::parallel;
use overlap::Window;

/// The state with the fewest inverted elements that has been met.
struct Best<const D: usize> {
    inverted: usize,
    smallest: f64,
    x: Vec<[f64; D]>,
}

/// The solver, for triangles in the plane (D = 2) or tetrahedra (D = 3).
pub struct Gini<const D: usize> {
    options: GiniOptions,
    admm: Admm,
    pub(super) elements: Elements<D>,
    /// Element at each place.
    pub(super) order: Vec<u32>,
    /// Corners of the elements as they came.
    pub(super) corners: Vec<u32>,
    /// Slot of each vertex.
    pub(super) slot: Vec<u32>,
    /// By slot: may the polisher move it?
    movable: Vec<bool>,
    /// Components that nothing holds, by slot, and their centroids.
    floating: Vec<(Vec<u32>, [f64; D])>,
    pub(super) set: ConstraintSet,
    pub(super) zones: Zones,
    /// Where overlap counts.
    pub(super) contacts: Option<Contacts<D>>,
    /// Held slots, and where they are to be.
    goals: Vec<(u32, [f64; D])>,
    /// Are they there, at x?
    arrived: bool,
    /// Steps in a row in which the polisher has not reached a state that x could move to.
    failures: usize,
    /// What part of the rest of their way x̄ has them go at once.
    stride: f64,
    /// How far the last accepted step has moved a vertex at most, in units of the body's size.
    moved: f64,
    /// How far the last few have.
    window: Window<D>,
    /// The body's size: the D-th root of its rest measure.
    size: f64,
    /// x̄ of the paper, by slot,
    iterate: Vec<[f64; D]>,
    /// x,
    x: Vec<[f64; D]>,
    /// x̂.
    pub(super) trial: Vec<[f64; D]>,
    /// c of every element at x and at x̂.
    values: Vec<f64>,
    pub(super) trial_values: Vec<f64>,
    step: Vec<[f64; D]>,
    best: Best<D>,
    /// The states inside of the newest step, where they are wanted.
    pub(super) trace: Option<Trace<D>>,
    positions: Vec<f64>,
    pub(super) hopeless: Vec<u32>,
    pub(super) hopeless_measure: Option<f64>,
    /// Do pins hold all of the boundary?
    is_enclosed: bool,
    /// η relative to the rest measure, where it has not been reduced.
    first_offset: f64,
    /// Are Z and U to be set from x̄?
    begins_anew: bool,
    /// Has it gone on because elements wound around a vertex? Once is all that helps.
    has_unwound: bool,
    /// Steps in a row that have not lessened the number of inverted elements.
    idle: usize,
    report: StepReport,
}

/// Steps without a better state after which it ends.
const MOST_IDLE: usize = 15;

/// Steps without constraints after the first step that has not ended the run; after the second, the fourth, … twice as
/// many, up to the most.
const RELAXATION: usize = 8;
const MOST_RELAXATION: usize = 64;

/// Below this η of an element does not fall where overlap counts: contacts with facets that collapse say nothing.
const LEAST_WITH_CONTACTS: f64 = 1e-3;

/// Iterations of the polisher in a row that do not lessen the number of inverted elements, after which it ends.
const MOST_VAIN: usize = 12;

impl<const D: usize> Gini<D> {
    fn iterate(&mut self) -> Result<(), SolveError> {
        let begun = Stopwatch::start();
        let iteration = self.report.iteration + 1;
        let before = self.best.inverted;
        let mut step = GiniStep {
            first_offset: self.first_offset,
            ..Default::default()
        };

        let clock = Stopwatch::start();
        let prox = self
            .admm
            .local_step(&self.iterate, self.begins_anew, &mut self.step);
        self.begins_anew = false;
        let local = Phase::new(PhaseKind::Local, prox, clock);

        let clock = Stopwatch::start();
        if let Some(contacts) = &self.contacts {
            contacts.skip(&mut self.set, &self.iterate);
        }
        step.constraints = self.set.list.len();
        self.begin_trace();
        step.qp_iterations = self.primary_step();
        self.trace_quadratic();
        if !self.iterate.as_flattened().iter().all(|x| x.is_finite()) {
            self.begin_anew();
        }
        self.set.remove_inactive();
        if let Some(contacts) = &self.contacts {
            contacts.remove(&mut self.set, &self.x, &self.iterate);
        }
        step.active = self.set.list.len();
        let global = Phase::new(PhaseKind::Global, step.qp_iterations as u32, clock);
        let global = self.without_trace(global);

        let clock = Stopwatch::start();
        let reached = self.polish(&mut step);
        step.reached = reached;
        self.lead_pins(reached, step.accepted);
        let polished = step.polish.len() as u32;
        step.polish_milliseconds = clock.milliseconds() - self.trace_milliseconds();
        self.publish();
        let done = self.is_done();
        let unwinds = done && iteration < self.options.max_iterations && self.is_to_unwind();
        let done = done && !unwinds;
        self.report.iteration = iteration;
        self.look();
        step.smallest_measure = self.smallest(&self.values);
        let offsets = &self.elements.relative_offset;
        step.least_offset = offsets.iter().copied().fold(f64::INFINITY, f64::min);
        let first = self.first_offset;
        step.reduced_offsets = offsets.iter().filter(|&&o| o < first).count();
        let accepted = step.accepted;
        self.report.gini = Some(step);
        self.report.conclude(
            done.then_some(Criterion::Injective),
            self.options.max_iterations,
        );
        if self.report.status == Status::Running {
            let moves = self.contacts.is_some() && (reached || accepted);
            self.idle = if self.best.inverted < before || moves {
                0
            } else {
                self.idle + 1
            };
            // where no element is inverted energy alone cannot help
            let helps = self.contacts.is_none() || self.best.inverted > 0;
            if unwinds {
                self.has_unwound = true;
                self.relax(RELAXATION);
            } else if self.idle >= MOST_IDLE {
                self.report.status = Status::Stalled;
            } else if iteration.is_power_of_two() && helps {
                self.relax((RELAXATION * iteration).min(MOST_RELAXATION));
            }
        }
        if matches!(self.report.status, Status::MaxIterations | Status::Stalled) {
            self.hand_out_best();
        }
        self.report.seconds += begun.seconds();
        let evaluate = Phase::new(PhaseKind::Evaluate, polished, clock);
        self.report.phases = vec![local, global, self.without_trace(evaluate)];
        Ok(())
    }

    /// Lets the primary solver begin at the best state, without what it has learned.
    fn begin_anew(&mut self) {
        self.iterate.copy_from_slice(&self.best.x);
        self.place_pins();
        self.begins_anew = true;
        self.set.clear();
    }

    /// Steps of the primary solver without constraints. Elements can be positive all of them but one or two, and
    /// wind around an edge twice: from there no polishing helps, but less energy does.
    fn relax(&mut self, count: usize) {
        self.set.clear();
        for k in 0..count {
            self.admm.local_step(&self.iterate, k == 0, &mut self.step);
            self.primary_step();
        }
        self.elements.values(&self.iterate, &mut self.trial_values);
        self.set.add_elements(&self.elements, &self.trial_values);
        self.begins_anew = true;
    }

    /// Solves the quadratic problem at x̄ and moves it there. Returns the iterations.
    fn primary_step(&mut self) -> usize {
        let iterations = global_step(
            &mut self.set.list,
            &self.iterate,
            self.admm.primal(),
            &mut self.step,
            self.options.max_qp_iterations,
            self.trace.as_mut().and_then(Trace::path),
        );
        for (x, s) in self.iterate.iter_mut().zip(&self.step) {
            (0..D).for_each(|i| x[i] += s[i]);
        }
        self.keep_centroids();
        iterations
    }

    /// Iterations of the polisher from x̄ on, until x̂ may be the next x (§5.1). Returns whether it is.
    fn polish(&mut self, step: &mut GiniStep) -> bool {
        self.trial.copy_from_slice(&self.iterate);
        if let Some(contacts) = &mut self.contacts {
            contacts.forget();
        }
        let (mut fewest, mut vain) = (usize::MAX, 0);
        let mut count = 0;
        let most = self.options.max_polish_iterations;
        loop {
            self.elements.values(&self.trial, &mut self.trial_values);
            let violated = self.set.add_elements(&self.elements, &self.trial_values);
            let inverted = self.count_inverted();
            if count == 0 {
                step.inverted_iterate = inverted;
            }
            let collisions = self.update_contacts(step);
            if self.contacts.is_none() {
                self.remember(inverted);
            }
            self.trace_state(inverted, violated);
            let acceptable = collisions == 0 && self.all_better() && self.is_clear();
            if acceptable {
                self.accept(inverted);
                step.accepted = true;
                self.failures = 0;
            }
            // what is left and goes quickly would take a step of the whole body
            let goes_on = self.contacts.is_none() && inverted <= fewest / 2;
            if step.accepted && (inverted == 0 || !goes_on || count == most) {
                return true;
            }
            let bad = inverted + collisions;
            (fewest, vain) = match bad < fewest {
                true => (bad, 0),
                false => (fewest, vain + 1),
            };
            if count == most || vain > MOST_VAIN {
                break;
            }
            let polished = polish(
                &mut self.set.list,
                &mut self.zones,
                &self.movable,
                &mut self.trial,
            );
            self.trace_zones();
            step.polish.push(PolishStep {
                inverted,
                violated,
                zones: polished.zones,
                collisions,
            });
            count += 1;
        }
        self.back_off();
        self.failures += 1;
        step.accepted = self.advance(step);
        false
    }

    /// Elements of x̂ that are inverted or flat, in floating point.
    fn count_inverted(&self) -> usize {
        let movable = self.elements.movable.iter();
        let values = self.trial_values.iter().zip(movable);
        values.filter(|&(&c, &m)| m && !(c > 0.0)).count()
    }

    /// Reduces η in the zones where the polisher did not succeed.
    fn back_off(&mut self) {
        self.zones.build(&self.set.list, &self.movable);
        self.trace_zones();
        let (mut elements, mut slots) = (Vec::new(), Vec::new());
        for z in 0..self.zones.len() {
            let members = self.zones.constraints(z).iter();
            let members = members.map(|&c| &self.set.list[c as usize]);
            let inverts = members.clone().any(|c| match c.key {
                Key::Element(e) => !(self.trial_values[e as usize] > 0.0),
                _ => false,
            });
            for c in members {
                match c.key {
                    Key::Element(e) if inverts => elements.push(e as usize),
                    Key::Element(_) => {}
                    _ if c.proximal => {}
                    _ => slots.extend(c.slots),
                }
            }
        }
        let least = match self.contacts {
            Some(_) => LEAST_WITH_CONTACTS,
            None => 0.0,
        };
        self.elements.back_off(elements.into_iter(), least);
        self.set.set_offsets(&self.elements);
        if let Some(contacts) = &mut self.contacts {
            contacts.back_off(slots.into_iter());
            contacts.set_offsets(&mut self.set);
        }
    }

    /// Keeps x̂ if none before had fewer inverted elements.
    fn remember(&mut self, inverted: usize) {
        if inverted > self.best.inverted {
            return;
        }
        let smallest = self.smallest(&self.trial_values);
        if inverted < self.best.inverted || smallest > self.best.smallest {
            self.best.inverted = inverted;
            self.best.smallest = smallest;
            self.best.x.copy_from_slice(&self.trial);
        }
    }

    /// The smallest c relative to that at rest.
    pub(super) fn smallest(&self, values: &[f64]) -> f64 {
        let relative = values.iter().zip(&self.elements.rest).map(|(c, r)| c / r);
        relative.fold(f64::INFINITY, f64::min)
    }

    /// Moves components that nothing holds back to where their centroids were: the Laplacian does not know.
    fn keep_centroids(&mut self) {
        let mut x = std::mem::take(&mut self.iterate);
        self.keep_centroids_of(&mut x);
        self.iterate = x;
    }

    pub(super) fn keep_centroids_of(&self, x: &mut [[f64; D]]) {
        for (slots, centroid) in &self.floating {
            let now = build::centroid(slots, x);
            for &s in slots {
                for i in 0..D {
                    x[s as usize][i] += centroid[i] - now[i];
                }
            }
        }
    }

    /// No element of the positions inverted or degenerate, exactly.
    fn is_injective(&self) -> bool {
        self.values.iter().all(|&c| c > 0.0)
            && not_positive(D, &self.corners, &self.positions).is_empty()
    }

    /// Do elements, all of them positive, go around a vertex more than once, and is there hope for less? Such a state is
    /// free of inversions, not injective.
    fn is_to_unwind(&self) -> bool {
        self.contacts.is_none()
            && !self.has_unwound
            && winds::<D>(&self.corners, self.positions.as_chunks::<D>().0)
    }

    /// Makes the best state x.
    fn hand_out_best(&mut self) {
        self.x.copy_from_slice(&self.best.x);
        self.elements.values(&self.x, &mut self.values);
        self.publish();
        self.look();
    }

    /// Evaluates x.
    fn look(&mut self) {
        let value = self.admm.evaluate(&self.x);
        self.report.energy = value.energy;
        self.report.gradient_norm = value.gradient_norm;
        self.report.inverted = value.inverted;
        self.report.smallest_sigma = value.smallest;
        self.report.largest_sigma = value.largest;
    }

    fn publish(&mut self) {
        let positions = self.positions.as_chunks_mut::<D>().0;
        for (position, &slot) in positions.iter_mut().zip(&self.slot) {
            *position = self.x[slot as usize];
        }
    }

    /// x̄ of the paper, the primary solver's state, vertices × dimension: neither injective nor free of intersections.
    pub fn primary(&self) -> Vec<f64> {
        let at = |&slot: &u32| self.iterate[slot as usize];
        self.slot.iter().flat_map(at).collect()
    }
}

impl<const D: usize> Solver for Gini<D> {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        parallel::in_pool(|| self.iterate())?;
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.positions
    }
    fn dimension(&self) -> usize {
        D
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        Inspection {
            distortion: self.admm.field(crate::optim::Field::Distortion),
            weights: Vec::new(),
        }
    }
}
