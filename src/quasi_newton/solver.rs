//! The iteration.

use super::QuasiNewtonOptions;
use super::evaluation::{Evaluation, Value};
use super::noise::Noise;
use crate::energy::Energy;
use crate::geometry::Elimination;
use crate::optim::lbfgs::Lbfgs;
use crate::optim::vectors::{dot, set_combination};
use crate::optim::{
    BuildError, Criterion, Deformer, Field, Inspection, Phase, PhaseKind, SolveError, Solver,
    Spring, Status, StepReport, Stopwatch, Yardstick,
};
use crate::parallel;
use crate::space::Space;
use crate::wrapd::elements::{Elements, Model, Shape};
use crate::wrapd::external::Terms;
use crate::wrapd::system::System;
use crate::wrapd::{Linear, Problem};

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 60;

/// The same where slopes are asked: of shorter steps rounding would say nothing but what is already known.
const MOST_HALVINGS_BY_SLOPE: u32 = 10;

/// L-BFGS from a Laplacian, for any energy.
pub struct QuasiNewton {
    options: QuasiNewtonOptions,
    evaluation: Evaluation,
    /// Slot of each vertex: free ones in elimination order, then the pinned.
    slot: Vec<u32>,
    /// Positions by slot.
    x: Vec<f64>,
    /// Where the line search looks.
    trial: Vec<f64>,
    /// Positions by vertex.
    positions: Vec<f64>,
    gradient: Vec<f64>,
    trial_gradient: Vec<f64>,
    direction: Vec<f64>,
    system: System,
    history: Lbfgs,
    report: StepReport,
    /// The reported energy without its offset.
    energy: f64,
    yardstick: Yardstick,
    noise: Noise,
    /// The iteration of the last change of handles, from which the most iterations are counted.
    counted_from: usize,
}

impl QuasiNewton {
    /// Factors the Laplacian of the weights at rest and evaluates the start.
    ///
    /// # Errors
    /// As [`crate::wrapd::Wrapd::new`]; `NotInjectiveStart` where the energy is infinite.
    pub fn new<S: Space, E: Energy<S>>(
        problem: Problem,
        energy: E,
        options: QuasiNewtonOptions,
    ) -> Result<Self, BuildError> {
        options.validate()?;
        problem.validate(S::DIM, S::STRETCHES)?;
        let shape = Shape::of::<S, Linear, E>(&energy);
        let elements = Box::new(Model::<S, Linear>::new(energy));
        parallel::in_pool(|| Self::build(problem, shape, elements, options))
    }

    fn build(
        problem: Problem,
        shape: Shape,
        elements: Box<dyn Elements>,
        options: QuasiNewtonOptions,
    ) -> Result<Self, BuildError> {
        let n = problem.start.len() / shape.dimension;
        let couplings = problem.external.map_or(&[][..], |e| &e.stiffness);
        let elimination = Elimination::with_couplings(problem.rest, n, problem.pins, couplings);
        let terms = problem.external.map(|external| {
            Terms::new(external, problem.start, &elimination.slot, elimination.free)
        });
        let evaluation = Evaluation::new(shape, elements, problem.rest, &elimination, terms);
        let constants = shape.constants;
        let mut system = System::new(problem.rest, &elimination, problem.external)?;
        system
            .factorize(evaluation.terms.as_ref(), |_| constants.rest_stiffness)
            .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;

        let Elimination { slot, free, .. } = elimination;
        let dimension = shape.dimension;
        let mut x = vec![0.0; problem.start.len()];
        for (position, &s) in problem.start.chunks_exact(dimension).zip(&slot) {
            x[s as usize * dimension..][..dimension].copy_from_slice(position);
        }
        let yardstick = evaluation.yardstick();
        let noise = evaluation.noise(&system);
        let unknowns = || vec![0.0; free * dimension];
        let mut this = Self {
            options,
            evaluation,
            slot,
            trial: x.clone(),
            x,
            positions: problem.start.to_vec(),
            gradient: unknowns(),
            trial_gradient: unknowns(),
            direction: unknowns(),
            system,
            history: Lbfgs::new(options.history),
            report: StepReport::at_start(),
            energy: f64::INFINITY,
            yardstick,
            noise,
            counted_from: 0,
        };
        let start = this.evaluation.at(&this.x, &mut this.gradient);
        if start.energy == f64::INFINITY && this.evaluation.shape.barrier {
            let inverted = start.inverted;
            return Err(BuildError::NotInjectiveStart { inverted });
        }
        this.take(start);
        if options.max_iterations == 0 {
            this.report.status = Status::MaxIterations;
        }
        Ok(this)
    }

    /// Fills the report from an evaluation whose gradient is in `gradient`.
    fn take(&mut self, value: Value) {
        self.energy = value.energy;
        self.report.energy = value.energy + self.evaluation.shape.constants.offset;
        self.report.inverted = value.inverted;
        self.report.smallest_sigma = value.smallest;
        self.report.largest_sigma = value.largest;
        let scale = self.evaluation.shape.constants.scale;
        self.report.gradient_norm = match value.energy < f64::INFINITY {
            true => scale * dot(&self.gradient, &self.gradient).sqrt(),
            false => f64::INFINITY,
        };
    }

    /// The direction −H g into `direction`, and its slope: without a history where that is not downhill.
    fn descend(&mut self) -> f64 {
        let dimension = self.evaluation.shape.dimension;
        let mut slope = f64::NAN;
        for _ in 0..2 {
            slope = self.history.direction(
                &mut self.system.factor,
                dimension,
                &self.gradient,
                &mut self.direction,
            );
            if slope < 0.0 {
                break;
            }
            self.history.clear();
        }
        slope
    }

    /// The longest of the steps 1, ½, ¼, … that satisfies Armijo's rule, or, where the energy is the same
    /// but for rounding, what that rule says of a parabola's slopes; and the evaluation there, which is in
    /// `trial` and `trial_gradient`; the number of trials.
    fn search(&mut self, slope: f64) -> (Option<(f64, Value)>, u32) {
        let unknowns = self.direction.len();
        let demanded = self.options.decrease * self.evaluation.shape.constants.scale * slope;
        let noise = self.noise.of_energy(self.energy);
        // φ(t) ≤ φ(0) + c t φ'(0) of a parabola φ, whose φ(t) − φ(0) is t (φ'(0) + φ'(t))/2
        let steepest = (1.0 - 2.0 * self.options.decrease) * -slope;
        let mut t = 1.0;
        for trials in 1..=MOST_HALVINGS {
            let along = core::iter::once((t, &self.direction[..]));
            set_combination(
                (1.0, &self.x[..unknowns]),
                along,
                &mut self.trial[..unknowns],
            );
            let value = self.evaluation.at(&self.trial, &mut self.trial_gradient);
            let falls = value.energy <= self.energy + t * demanded;
            let same = trials <= MOST_HALVINGS_BY_SLOPE && value.energy <= self.energy + noise;
            if value.energy < f64::INFINITY
                && (falls || same && dot(&self.trial_gradient, &self.direction) <= steepest)
            {
                return (Some((t, value)), trials);
            }
            t *= 0.5;
        }
        (None, MOST_HALVINGS)
    }

    /// Is the gradient no more than rounding?
    fn is_at_rest(&self) -> bool {
        let scale = self.evaluation.shape.constants.scale;
        self.report.gradient_norm <= scale * self.noise.of_gradient(&self.x)
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        let begun = Stopwatch::start();
        let dimension = self.evaluation.shape.dimension;
        let before = self.energy;
        let iteration = self.report.iteration + 1;
        if let Some(bad) = self.gradient.iter().position(|g| !g.is_finite()) {
            let slot = (bad / dimension) as u32;
            let vertex = self.slot.iter().position(|&s| s == slot).unwrap_or(0);
            return Err(SolveError::NonFinite { iteration, vertex });
        }

        let clock = Stopwatch::start();
        let mut slope = self.descend();
        let mut global = Phase::new(PhaseKind::Global, 1, clock);

        let clock = Stopwatch::start();
        let (mut found, mut trials) = self.search(slope);
        if found.is_none() && !self.history.is_empty() {
            // the history misleads: once more without it
            self.history.clear();
            slope = self.descend();
            global.count += 1;
            let (again, more) = self.search(slope);
            found = again;
            trials += more;
        }
        self.report.iteration = iteration;
        self.report.lbfgs_iterations = 1;
        match found {
            Some((t, value)) => {
                if t < 1.0 {
                    self.direction.iter_mut().for_each(|d| *d *= t);
                    self.history.shorten(t);
                }
                self.history
                    .push(&self.direction, &self.gradient, &self.trial_gradient);
                core::mem::swap(&mut self.x, &mut self.trial);
                core::mem::swap(&mut self.gradient, &mut self.trial_gradient);
                self.take(value);
                for (position, &s) in self.positions.chunks_exact_mut(dimension).zip(&self.slot) {
                    position.copy_from_slice(&self.x[s as usize * dimension..][..dimension]);
                }
                let met = self.yardstick.criterion(
                    self.energy - before,
                    self.energy,
                    self.report.gradient_norm,
                    self.options.tolerance,
                );
                // where only slopes are left to go by, the end is where they are rounding, too
                let ends = self.options.tolerance > 0.0
                    && (self.energy - before).abs() <= self.noise.of_energy(before)
                    && self.is_at_rest();
                let met = met.or(ends.then_some(Criterion::GradientNorm));
                let most = self.counted_from + self.options.max_iterations;
                self.report.conclude(met, most);
            }
            // no step is seen to lower the energy: as it should be at a minimum
            None => {
                // what is inspected is the iterate, not the last trial
                self.evaluation.at(&self.x, &mut self.trial_gradient);
                self.report.status = match self.is_at_rest() {
                    true => Status::Converged(Criterion::GradientNorm),
                    false => Status::Stalled,
                };
            }
        }
        let evaluate = Phase::new(PhaseKind::Evaluate, trials, clock);
        self.report.seconds += begun.seconds();
        self.report.phases.clear();
        self.report.phases.extend([global, evaluate]);
        Ok(())
    }
}

impl Solver for QuasiNewton {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        parallel::in_pool(|| self.iterate())?;
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.positions
    }
    fn dimension(&self) -> usize {
        self.evaluation.shape.dimension
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        Inspection {
            distortion: self.field(Field::Distortion),
            weights: Vec::new(),
        }
    }
}

impl Deformer for QuasiNewton {
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError> {
        let (dimension, unknowns) = (self.evaluation.shape.dimension, self.gradient.len());
        for (vertex, point) in positions {
            let at = self.slot[*vertex as usize] as usize * dimension;
            assert!(at >= unknowns, "vertex {vertex} is not pinned");
            for x in [&mut self.x, &mut self.trial] {
                x[at..at + dimension].copy_from_slice(&point[..dimension]);
            }
            let at = *vertex as usize * dimension;
            self.positions[at..at + dimension].copy_from_slice(&point[..dimension]);
        }
        parallel::in_pool(|| {
            let terms = self.evaluation.terms.as_mut();
            assert!(terms.is_some() || springs.is_empty(), "no external terms");
            if terms.is_some_and(|terms| terms.set_springs(springs, &self.slot)) {
                let stiffness = self.evaluation.shape.constants.rest_stiffness;
                self.system
                    .factorize(self.evaluation.terms.as_ref(), |_| stiffness)
                    .map_err(|e| SolveError::NotPositiveDefinite {
                        iteration: self.report.iteration,
                        pivot: e.pivot,
                    })?;
                self.noise = self.evaluation.noise(&self.system);
            }
            // the objective is another one, and its gradient at the same point, too
            self.history.clear();
            let value = self.evaluation.at(&self.x, &mut self.gradient);
            self.take(value);
            self.counted_from = self.report.iteration;
            self.report.status = Status::Running;
            Ok(())
        })
    }

    fn field(&self, field: Field) -> Vec<f32> {
        self.evaluation.field(field)
    }
}
