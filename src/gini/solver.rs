//! Algorithm 1.

mod build;

use super::GiniOptions;
use super::admm::Admm;
use super::constraint::Key;
use super::dual::global_step;
use super::elements::Elements;
use super::polisher::polish;
use super::problem::not_positive;
use super::set::ConstraintSet;
use super::trace::PolishState;
use super::zones::Zones;
use crate::optim::{
    Criterion, GiniStep, Inspection, Phase, PhaseKind, PolishStep, SolveError, Solver, Status,
    StepReport, Stopwatch,
};
use crate::parallel;

/// How a run ended, or stands.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct Outcome {
    /// Elements of the positions that are inverted or degenerate, by exact predicates.
    pub not_positive: Vec<u32>,
    /// Those of them all of whose vertices are pinned: no map of these pins is injective.
    pub hopeless: Vec<u32>,
    /// Signed measure of the whole image, where pins determine it and it is not positive: no map of these pins is
    /// injective.
    pub hopeless_measure: Option<f64>,
    /// The smallest signed measure of an element relative to its rest measure.
    pub smallest_measure: f64,
}

impl Outcome {
    /// Why no map of these pins can be injective, and which elements are not positive, in plain sentences.
    pub fn obstacles(&self) -> Vec<String> {
        let listed = |list: &[u32]| {
            let first: Vec<String> = list.iter().take(10).map(u32::to_string).collect();
            let more = if list.len() > 10 { ", …" } else { "" };
            format!("{}{more}", first.join(", "))
        };
        let mut words = Vec::new();
        if !self.hopeless.is_empty() {
            words.push(format!(
                "All vertices of these inverted elements are pinned, so that no map is injective: {}.",
                listed(&self.hopeless)
            ));
        }
        if let Some(measure) = self.hopeless_measure {
            words.push(format!(
                "The pinned boundary encloses a signed measure of {measure:.3e}, so that no map is injective."
            ));
        }
        if !self.not_positive.is_empty() {
            words.push(format!(
                "Inverted or degenerate elements: {}.",
                listed(&self.not_positive)
            ));
        }
        words
    }
}

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
    corners: Vec<u32>,
    /// Slot of each vertex.
    pub(super) slot: Vec<u32>,
    /// By slot: may the polisher move it?
    movable: Vec<bool>,
    /// Components that nothing holds, by slot, and their centroids.
    floating: Vec<(Vec<u32>, [f64; D])>,
    pub(super) set: ConstraintSet,
    pub(super) zones: Zones,
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
    /// The polisher's states of the newest step, where they are wanted.
    pub(super) trace: Option<Vec<PolishState>>,
    positions: Vec<f64>,
    hopeless: Vec<u32>,
    hopeless_measure: Option<f64>,
    /// η relative to the rest measure, where it has not been reduced.
    first_offset: f64,
    /// Are Z and U to be set from x̄?
    begins_anew: bool,
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
        step.constraints = self.set.list.len();
        step.qp_iterations = self.primary_step();
        if !self.iterate.as_flattened().iter().all(|x| x.is_finite()) {
            self.begin_anew();
        }
        self.set.remove_inactive();
        step.active = self.set.list.len();
        let global = Phase::new(PhaseKind::Global, step.qp_iterations as u32, clock);

        let clock = Stopwatch::start();
        self.polish(&mut step);
        let polished = step.polish.len() as u32;
        step.polish_milliseconds = clock.milliseconds();
        self.publish();
        let done = self.is_injective();
        self.report.iteration = iteration;
        self.look();
        step.smallest_measure = self.smallest(&self.values);
        let offsets = &self.elements.relative_offset;
        step.least_offset = offsets.iter().copied().fold(f64::INFINITY, f64::min);
        let first = self.first_offset;
        step.reduced_offsets = offsets.iter().filter(|&&o| o < first).count();
        self.report.gini = Some(step);
        self.report.conclude(
            done.then_some(Criterion::Injective),
            self.options.max_iterations,
        );
        if self.report.status == Status::Running {
            self.idle = if self.best.inverted < before {
                0
            } else {
                self.idle + 1
            };
            if self.idle >= MOST_IDLE {
                self.report.status = Status::Stalled;
            } else if iteration.is_power_of_two() {
                self.relax((RELAXATION * iteration).min(MOST_RELAXATION));
            }
        }
        if matches!(self.report.status, Status::MaxIterations | Status::Stalled) {
            self.hand_out_best();
        }
        self.report.seconds += begun.seconds();
        let evaluate = Phase::new(PhaseKind::Evaluate, polished, clock);
        self.report.phases = vec![local, global, evaluate];
        Ok(())
    }

    /// Lets the primary solver begin at the best state, without what it has learned.
    fn begin_anew(&mut self) {
        self.iterate.copy_from_slice(&self.best.x);
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
        );
        for (x, s) in self.iterate.iter_mut().zip(&self.step) {
            (0..D).for_each(|i| x[i] += s[i]);
        }
        self.keep_centroids();
        iterations
    }

    /// Iterations of the polisher from x̄ on, until x̂ may be the next x (§5.1).
    fn polish(&mut self, step: &mut GiniStep) {
        self.trial.copy_from_slice(&self.iterate);
        self.begin_trace();
        let (mut fewest, mut vain) = (usize::MAX, 0);
        for count in 0..=self.options.max_polish_iterations {
            self.elements.values(&self.trial, &mut self.trial_values);
            let violated = self.set.add_elements(&self.elements, &self.trial_values);
            let inverted = self.count_inverted();
            if count == 0 {
                step.inverted_iterate = inverted;
            }
            self.remember(inverted);
            self.trace_state(inverted, violated);
            let better = |(&new, &old): (&f64, &f64)| new > 0.0 || new > old;
            let values = self.trial_values.iter().zip(&self.values);
            let movable = self.elements.movable.iter();
            if values.zip(movable).all(|(v, &m)| !m || better(v)) {
                self.x.copy_from_slice(&self.trial);
                self.values.copy_from_slice(&self.trial_values);
                step.accepted = true;
                return;
            }
            (fewest, vain) = match inverted < fewest {
                true => (inverted, 0),
                false => (fewest, vain + 1),
            };
            if count == self.options.max_polish_iterations || vain > MOST_VAIN {
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
            });
        }
        self.back_off();
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
        let mut chosen = Vec::new();
        for z in 0..self.zones.len() {
            let members = self.zones.constraints(z).iter();
            let places = members.map(|&c| {
                let Key::Element(e) = self.set.list[c as usize].key;
                e as usize
            });
            if places.clone().any(|e| !(self.trial_values[e] > 0.0)) {
                chosen.extend(places);
            }
        }
        self.elements.back_off(chosen.into_iter());
        self.set.set_offsets(&self.elements);
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
    fn smallest(&self, values: &[f64]) -> f64 {
        let relative = values.iter().zip(&self.elements.rest).map(|(c, r)| c / r);
        relative.fold(f64::INFINITY, f64::min)
    }

    /// Moves components that nothing holds back to where their centroids were: the Laplacian does not know.
    fn keep_centroids(&mut self) {
        for (slots, centroid) in &self.floating {
            let now = build::centroid(slots, &self.iterate);
            for &s in slots {
                for i in 0..D {
                    self.iterate[s as usize][i] += centroid[i] - now[i];
                }
            }
        }
    }

    /// No element of the positions inverted or degenerate, exactly.
    fn is_injective(&self) -> bool {
        self.hopeless.is_empty()
            && self.values.iter().all(|&c| c > 0.0)
            && not_positive(D, &self.corners, &self.positions).is_empty()
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

    /// What is known of the positions.
    pub fn outcome(&self) -> Outcome {
        Outcome {
            not_positive: not_positive(D, &self.corners, &self.positions),
            hopeless: self.hopeless.clone(),
            hopeless_measure: self.hopeless_measure,
            smallest_measure: self.smallest(&self.values),
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
