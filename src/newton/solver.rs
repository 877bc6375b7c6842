//! The iteration.

use super::NewtonOptions;
use super::bound::step_bound;
use super::curvature::{Curvature, Kind, OnCorners, Projected};
use super::majorization::CompositeMajorization;
use super::system::NewtonSystem;
use crate::energy::{Energy, SymmetricDirichlet};
use crate::geometry::Elimination;
use crate::optim::vectors::{dot, set_combination};
use crate::optim::{
    BuildError, Criterion, Deformer, Field, Inspection, Phase, PhaseKind, SolveError, Solver,
    Spring, Status, StepReport, Stopwatch,
};
use crate::parallel;
use crate::quasi_newton::evaluation::{Evaluation, Value};
use crate::space::{Plane, Space};
use crate::wrapd::Problem;
use crate::wrapd::external::Terms;
use core::marker::PhantomData;

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 60;

/// A change of the energy below this part of the numbers it is computed from is rounding error.
const ROUNDING: f64 = 1e-14;

/// Secant steps of a line search.
const MOST_SECANTS: u32 = 2;

/// They are worth their evaluation where the slope that is left is this part of the first,
const STEEP: f64 = 0.2;

/// or, of the other sign, this part,
const OVERSHOT: f64 = 0.5;

/// and go no further at once than this many times the step so far.
const MOST_STRETCH: f64 = 4.0;

/// The exact Hessian is tried from where a step changes the energy by less than this part,
const NEAR: f64 = 0.1;

/// and again after at most this many steps where it was not definite.
const LONGEST_WAIT: usize = 16;

/// Larger shifts tried where no step along a direction lowers the energy.
const MOST_SHIFTS: u32 = 5;

/// Newton's method with a positive semidefinite matrix in place of the Hessian, steps that invert nothing,
/// and a line search.
pub struct Newton {
    options: NewtonOptions,
    curvature: Box<dyn Curvature>,
    evaluation: Evaluation,
    system: NewtonSystem,
    /// Slot of each vertex: free ones in elimination order, then the pinned.
    slot: Vec<u32>,
    /// Number of unknowns, which come first in what is by slot.
    unknowns: usize,
    /// Positions by slot.
    x: Vec<f64>,
    /// Where the line search looks.
    trial: Vec<f64>,
    /// Positions by vertex.
    positions: Vec<f64>,
    gradient: Vec<f64>,
    trial_gradient: Vec<f64>,
    /// By slot, 0 for the pinned.
    direction: Vec<f64>,
    /// Step bounds, one a block.
    bounds: Vec<f64>,
    /// Below this a change of the energy is rounding error, if the energy itself is small.
    rounding: f64,
    /// Did the last step change the energy little?
    near: bool,
    /// The iteration from which the exact Hessian may be tried again, and how long to wait if it fails.
    exact_from: usize,
    wait: usize,
    report: StepReport,
    /// The iteration of the last change of handles, from which the most iterations are counted.
    counted_from: usize,
}

/// The phases of an iteration: matrices of the elements and their sum, factor, solve, line search.
const PHASES: [PhaseKind; 4] = [
    PhaseKind::Local,
    PhaseKind::Reweight,
    PhaseKind::Global,
    PhaseKind::Evaluate,
];

/// The end of a line search.
struct Found {
    step: f64,
    value: Value,
    /// Was the decrease demanded too small to be seen?
    by_rounding: bool,
}

impl Newton {
    /// Composite majorization of the symmetric Dirichlet energy of a planar map.
    ///
    /// # Errors
    /// Those of [`Self::projected`].
    pub fn composite_majorization(
        problem: Problem,
        options: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let curvature = Box::new(CompositeMajorization);
        Self::with_curvature::<Plane, _>(problem, SymmetricDirichlet, curvature, 0.0, options)?
            .checked()
    }

    /// Newton's method with the projected Hessian of any energy, in dimensions of d = k. The pins of the
    /// problem may be empty: rigid motions are then left where they are.
    ///
    /// # Errors
    /// Lengths that do not fit, options out of range, a start that is not finite;
    /// `NotInjectiveStart` where the energy has a barrier and the start breaks it.
    pub fn projected<S: Space, E: Energy<S>>(
        problem: Problem,
        energy: E,
        options: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let curvature = Box::new(OnCorners::<S, _>(Projected(energy), PhantomData));
        Self::with_curvature::<S, E>(problem, energy, curvature, 0.0, options)?.checked()
    }

    /// With any matrix, and `proximal` on its diagonal. The start may break the energy's barrier: it has to
    /// be replaced then.
    pub(crate) fn with_curvature<S: Space, E: Energy<S>>(
        problem: Problem,
        energy: E,
        curvature: Box<dyn Curvature>,
        proximal: f64,
        options: NewtonOptions,
    ) -> Result<Self, BuildError> {
        options.validate()?;
        problem.validate_parts(S::DIM, S::STRETCHES)?;
        let n = problem.start.len() / S::DIM;
        let couplings = problem.external.map_or(&[][..], |e| &e.stiffness);
        let elimination = Elimination::with_couplings(problem.rest, n, problem.pins, couplings);
        let terms = problem.external.map(|external| {
            Terms::new(external, problem.start, &elimination.slot, elimination.free)
        });
        let evaluation = Evaluation::new::<S, E>(energy, problem.rest, &elimination, terms);
        parallel::in_pool(|| {
            Self::build(
                problem,
                elimination,
                evaluation,
                curvature,
                proximal,
                options,
            )
        })
    }

    fn build(
        problem: Problem,
        elimination: Elimination,
        evaluation: Evaluation,
        curvature: Box<dyn Curvature>,
        proximal: f64,
        options: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let system = NewtonSystem::new(
            problem.rest,
            &elimination,
            problem.external,
            &evaluation,
            proximal,
            &options,
        )?;
        let constants = &evaluation.shape.constants;
        let measure: f64 = problem.rest.measure.iter().sum();
        let unknowns = elimination.free * evaluation.shape.dimension;
        let length = problem.start.len();
        let mut this = Self {
            rounding: ROUNDING * (constants.scale * constants.isometry * measure).abs(),
            options,
            curvature,
            bounds: vec![1.0; evaluation.blocks.len()],
            evaluation,
            system,
            slot: elimination.slot,
            unknowns,
            x: vec![0.0; length],
            trial: vec![0.0; length],
            positions: problem.start.to_vec(),
            gradient: vec![0.0; unknowns],
            trial_gradient: vec![0.0; unknowns],
            direction: vec![0.0; length],
            near: false,
            exact_from: 0,
            wait: 1,
            report: StepReport::at_start(),
            counted_from: 0,
        };
        this.look();
        if options.max_iterations == 0 {
            this.report.status = Status::MaxIterations;
        }
        Ok(this)
    }

    /// Fails where the start breaks the energy's barrier.
    pub(crate) fn checked(self) -> Result<Self, BuildError> {
        match self.is_broken() {
            false => Ok(self),
            true => Err(BuildError::NotInjectiveStart {
                inverted: self.report.inverted.max(1),
            }),
        }
    }

    /// Is the energy infinite where it stands?
    pub(super) fn is_broken(&self) -> bool {
        self.evaluation.shape.barrier && self.report.energy == f64::INFINITY
    }

    /// Continues from these positions, by vertex.
    pub(super) fn restart(&mut self, positions: &[f64], report: &StepReport) {
        self.positions.copy_from_slice(positions);
        parallel::in_pool(|| self.look());
        self.report.iteration = report.iteration;
        self.report.seconds = report.seconds;
        self.report.status = Status::Running;
        self.counted_from = 0;
    }

    /// Evaluates `positions`, which were not found by a step.
    fn look(&mut self) {
        let dimension = self.evaluation.shape.dimension;
        for (position, &s) in self.positions.chunks_exact(dimension).zip(&self.slot) {
            self.x[s as usize * dimension..][..dimension].copy_from_slice(position);
        }
        self.trial.copy_from_slice(&self.x);
        self.near = false;
        let value = self.evaluation.at(&self.x, &mut self.gradient);
        self.take(value);
    }

    /// Fills the report from an evaluation whose gradient is in `gradient`.
    fn take(&mut self, value: Value) {
        let finite = value.energy.is_finite();
        self.report.energy = if finite { value.energy } else { f64::INFINITY };
        self.report.inverted = value.inverted;
        self.report.smallest_sigma = value.smallest;
        self.report.largest_sigma = value.largest;
        let scale = self.evaluation.shape.constants.scale;
        self.report.gradient_norm = match finite {
            true => scale * dot(&self.gradient, &self.gradient).sqrt(),
            false => f64::INFINITY,
        };
    }

    /// The least change of the energy that means anything.
    fn resolution(&self) -> f64 {
        let terms = self.evaluation.terms.as_ref();
        let terms = terms.map_or(0.0, |t| t.rounding * self.evaluation.shape.constants.scale);
        self.rounding + ROUNDING * self.report.energy.abs() + terms
    }

    /// −H⁻¹ g into `direction`; its slope along the reported energy.
    fn descend(&mut self) -> f64 {
        let direction = &mut self.direction[..self.unknowns];
        set_combination((-1.0, &self.gradient), core::iter::empty(), direction);
        self.system.solve(direction);
        self.evaluation.shape.constants.scale * dot(direction, &self.gradient)
    }

    /// The longest step that inverts nothing, if inverting costs.
    fn longest_step(&mut self) -> f64 {
        let longest = self.options.longest;
        if !self.evaluation.shape.barrier {
            return longest;
        }
        step_bound(
            &self.evaluation.blocks,
            self.evaluation.elements(),
            &self.x,
            &self.direction,
            self.options.fraction,
            longest,
            &mut self.bounds,
        )
    }

    /// Evaluates a step along the direction, into `trial` and `trial_gradient`.
    fn try_step(&mut self, step: f64) -> Value {
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
    fn search(&mut self, slope: f64) -> (Option<Found>, u32) {
        let bound = self.longest_step();
        let mut step = bound.min(1.0);
        let resolution = self.resolution();
        for trials in 1..=MOST_HALVINGS {
            let value = self.try_step(step);
            let by_rounding = -step * slope < resolution;
            let enough = match by_rounding {
                true => self.report.energy,
                false => self.report.energy + self.options.decrease * step * slope,
            };
            if value.energy.is_finite() && value.energy <= enough {
                let mut found = Found {
                    step,
                    value,
                    by_rounding,
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
            if !(value.energy < found.value.energy) {
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

    /// The vertex of the first unknown that is not finite.
    fn not_finite(&self, unknowns: &[f64]) -> Option<usize> {
        let bad = unknowns.iter().position(|g| !g.is_finite())?;
        let slot = (bad / self.evaluation.shape.dimension) as u32;
        self.slot.iter().position(|&s| s == slot)
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        let begun = Stopwatch::start();
        let before = self.report.energy;
        let iteration = self.report.iteration + 1;
        if self.is_broken() {
            let inverted = self.report.inverted;
            return Err(SolveError::NotInjective {
                iteration,
                inverted,
            });
        }
        if let Some(vertex) = self.not_finite(&self.gradient) {
            return Err(SolveError::NonFinite { iteration, vertex });
        }

        let mut phases = PHASES.map(|kind| Phase {
            kind,
            count: 0,
            milliseconds: 0.0,
        });
        let tried = match self.wants_exact(iteration) {
            true => self.attempt(Kind::Exact, 0.0, iteration, &mut phases)?,
            false => None,
        };
        let (found, decrement) = match tried {
            Some(tried) => tried,
            None => self.semidefinite(iteration, &mut phases)?,
        };

        self.report.iteration = iteration;
        let floor = self.evaluation.shape.constants.floor;
        let tolerance = self.options.tolerance;
        match found {
            Some(found) => {
                core::mem::swap(&mut self.x, &mut self.trial);
                core::mem::swap(&mut self.gradient, &mut self.trial_gradient);
                self.take(found.value);
                self.publish();
                // a step cut short changes little, too, far from the minimum
                let change = before - self.report.energy;
                self.near = change < NEAR * (self.report.energy.abs() + floor);
                let near = decrement < 10.0 * tolerance * (self.report.energy.abs() + floor);
                let may = near || found.by_rounding;
                let most = self.counted_from + self.options.max_iterations;
                self.report.settle((before, floor), may, tolerance, most);
                let stuck = found.by_rounding && self.report.energy == before;
                if stuck && self.report.status == Status::Running {
                    self.report.status = Status::Stalled;
                }
            }
            // also at a minimum to rounding, where no step is seen to lower the energy
            None => {
                // what is inspected is the iterate, not the last trial
                self.evaluation.at(&self.x, &mut self.trial_gradient);
                let near = decrement.abs() < tolerance * (self.report.energy.abs() + floor);
                self.report.status = match near && tolerance > 0.0 {
                    true => Status::Converged(Criterion::EnergyChange),
                    false => Status::Stalled,
                };
            }
        }
        self.report.seconds += begun.seconds();
        self.report.phases.clear();
        self.report.phases.extend(phases);
        Ok(())
    }

    /// Is the exact Hessian worth an attempt?
    fn wants_exact(&self, iteration: usize) -> bool {
        self.near && iteration >= self.exact_from && self.curvature.has_exact()
    }

    /// The step with positive semidefinite matrices of the elements: what a line search found, and the
    /// decrease that the quadratic model promised.
    fn semidefinite(
        &mut self,
        iteration: usize,
        phases: &mut [Phase; 4],
    ) -> Result<(Option<Found>, f64), SolveError> {
        let mut at_least = self.system.next_shift();
        for attempts in 1.. {
            let tried = self.attempt(Kind::Semidefinite, at_least, iteration, phases)?;
            let Some((found, decrement)) = tried else {
                break;
            };
            let hopeless = self.report.gradient_norm == 0.0 || decrement.abs() < self.resolution();
            let last = hopeless || attempts > MOST_SHIFTS || self.system.shift() >= 1.0;
            if found.is_some() || last {
                return Ok((found, decrement));
            }
            // where the matrix is nearly singular the direction may be nothing but rounding error
            at_least = self.system.larger_shift();
        }
        Ok((None, f64::INFINITY))
    }

    /// One matrix, its factor, and a line search; nothing if the exact Hessian is not definite.
    #[allow(clippy::type_complexity)]
    fn attempt(
        &mut self,
        kind: Kind,
        at_least: f64,
        iteration: usize,
        phases: &mut [Phase; 4],
    ) -> Result<Option<(Option<Found>, f64)>, SolveError> {
        let [local, factor, global, evaluate] = phases;
        let add = |phase: &mut Phase, count: u32, clock: Stopwatch| {
            phase.count += count;
            phase.milliseconds += clock.milliseconds();
        };
        let clock = Stopwatch::start();
        self.system
            .assemble(&self.evaluation, &*self.curvature, kind);
        add(local, 1, clock);
        let clock = Stopwatch::start();
        let factored = match kind {
            Kind::Exact => self.system.factorize_exact(self.turning()).map(|()| 1),
            Kind::Semidefinite => self.system.factorize(at_least),
        };
        add(factor, factored.unwrap_or(1), clock);
        match (factored, kind) {
            (Ok(_), Kind::Exact) => self.wait = 1,
            (Ok(_), Kind::Semidefinite) => {}
            (Err(_), Kind::Exact) => {
                self.exact_from = iteration + self.wait;
                self.wait = (2 * self.wait).min(LONGEST_WAIT);
                return Ok(None);
            }
            (Err(error), _) => {
                let pivot = error.pivot;
                return Err(SolveError::NotPositiveDefinite { iteration, pivot });
            }
        }
        let clock = Stopwatch::start();
        let slope = self.descend();
        add(global, 1, clock);
        let clock = Stopwatch::start();
        let (found, trials) = match slope < 0.0 {
            true => self.search(slope),
            false => (None, 0),
        };
        add(evaluate, trials, clock);
        Ok(match (found, kind) {
            (None, Kind::Exact) => None,
            (found, _) => Some((found, -0.5 * slope)),
        })
    }

    /// Where the plane can still turn about its only pin: the free vertex that is furthest from it, and the
    /// direction in which it would move. The Hessian says nothing of this turn but rounding errors.
    fn turning(&self) -> Option<(usize, [f64; 2])> {
        let (free, pins) = self.x.split_at(self.unknowns);
        if self.evaluation.shape.dimension != 2
            || pins.len() != 2
            || self.evaluation.terms.is_some()
        {
            return None;
        }
        let away = |p: &[f64; 2]| [p[0] - pins[0], p[1] - pins[1]];
        let length = |a: [f64; 2]| (a[0] * a[0] + a[1] * a[1]).sqrt();
        let mut furthest = (0, [0.0; 2]);
        for (vertex, p) in free.as_chunks::<2>().0.iter().enumerate() {
            if length(away(p)) > length(furthest.1) {
                furthest = (vertex, away(p));
            }
        }
        let (vertex, arm) = furthest;
        let l = length(arm);
        (l > 0.0).then(|| (vertex, [-arm[1] / l, arm[0] / l]))
    }

    /// Copies the positions by slot to those by vertex.
    fn publish(&mut self) {
        let dimension = self.evaluation.shape.dimension;
        for (position, &s) in self.positions.chunks_exact_mut(dimension).zip(&self.slot) {
            position.copy_from_slice(&self.x[s as usize * dimension..][..dimension]);
        }
    }
}

impl Solver for Newton {
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

impl Deformer for Newton {
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError> {
        let dimension = self.evaluation.shape.dimension;
        for (vertex, point) in positions {
            let at = self.slot[*vertex as usize] as usize * dimension;
            assert!(at >= self.unknowns, "vertex {vertex} is not pinned");
            let at = *vertex as usize * dimension;
            self.positions[at..at + dimension].copy_from_slice(&point[..dimension]);
        }
        let terms = self.evaluation.terms.as_mut();
        assert!(terms.is_some() || springs.is_empty(), "no external terms");
        // the matrix is filled anew in every step
        if let Some(terms) = terms {
            terms.set_springs(springs, &self.slot);
        }
        parallel::in_pool(|| self.look());
        self.counted_from = self.report.iteration;
        self.report.status = Status::Running;
        Ok(())
    }

    fn field(&self, field: Field) -> Vec<f32> {
        self.evaluation.field(field)
    }
}
