//! The iteration.

mod apart;
mod attempts;
mod curve;
mod handles;
mod mending;
mod search;

use self::apart::Apart;
use self::attempts::{FIRST_PART, Tried};
use super::NewtonOptions;
use super::curvature::{Curvature, OnCorners, Projected};
use super::majorization::CompositeMajorization;
use super::pieces::only_pins;
use super::relaxation::Relaxation;
use super::system::NewtonSystem;
use super::turns::Turns;
use crate::energy::{Energy, SymmetricDirichlet};
use crate::geometry::Elimination;
use crate::optim::vectors::dot;
use crate::optim::{
    BuildError, Criterion, Deformer, Field, Inspection, Phase, PhaseKind, SolveError, Solver,
    Status, StepReport, Stopwatch, Yardstick,
};
use crate::parallel;
use crate::quasi_newton::evaluation::{Evaluation, Value};
use crate::space::{Plane, Space};
use crate::wrapd::elements::{Model, Shape};
use crate::wrapd::external::Terms;
use crate::wrapd::{Linear, Problem};
use core::marker::PhantomData;

/// A change of the energy below this part of the numbers it is computed from is rounding error.
const ROUNDING: f64 = 1e-14;

/// What is negative in the elements' Hessians is kept from where a step changes the energy by less than this
/// part.
const NEAR: f64 = 0.1;

/// Newton's method with a positive semidefinite matrix in place of the Hessian, steps that invert nothing,
/// and a line search.
pub struct Newton {
    options: NewtonOptions,
    curvature: Box<dyn Curvature>,
    evaluation: Evaluation,
    system: NewtonSystem,
    /// Where elements turn along a step.
    turns: Option<Turns>,
    /// Vertices one by one, after steps cut short.
    relaxation: Option<Relaxation>,
    /// What keeps the boundary from passing through itself.
    apart: Option<Apart>,
    /// Does no step invert an element, even where the energy would not mind?
    keeps_positive: bool,
    /// Slot of each vertex: free ones in elimination order, then the pinned.
    slot: Vec<u32>,
    /// Of a plane that nothing else holds: the piece of each slot, and the only pins of those that have one.
    piece: Vec<u32>,
    only_pins: Vec<u32>,
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
    /// The part of what is negative that the next matrix is to keep.
    kept: f64,
    /// The part of what resists turning in the next semidefinite matrix.
    resistance: f64,
    yardstick: Yardstick,
    /// The reported energy without its offset.
    energy: f64,
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
        let first = &problem.rest.vertices[..1];
        let floats = problem.pins.is_empty() && problem.external.is_none();
        let problem = Problem {
            // no energy knows where all of it is
            pins: if floats { first } else { problem.pins },
            ..problem
        };
        let couplings = problem.external.map_or(&[][..], |e| &e.stiffness);
        let elimination = Elimination::with_couplings(problem.rest, n, problem.pins, couplings);
        let terms = problem.external.map(|external| {
            Terms::new(external, problem.start, &elimination.slot, elimination.free)
        });
        let shape = Shape::of::<S, Linear, E>(&energy);
        let elements = Box::new(Model::<S, Linear>::new(energy));
        parallel::in_pool(|| {
            let evaluation = Evaluation::new(shape, elements, problem.rest, &elimination, terms);
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
        let planar = evaluation.shape.dimension == 2;
        let turns = match options.turning && planar {
            true => Some(Turns::new(&problem, &elimination, &evaluation)?),
            false => None,
        };
        let relaxes = turns.is_some() && evaluation.terms.is_none() && curvature.can_relax();
        let relaxation = relaxes
            .then(|| Relaxation::new(&evaluation.blocks, evaluation.elements(), elimination.free));
        let (piece, only_pins) = match planar && evaluation.terms.is_none() {
            true => only_pins(problem.rest, &elimination),
            false => Default::default(),
        };
        let yardstick = evaluation.yardstick();
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
            turns,
            relaxation,
            apart: None,
            keeps_positive: false,
            slot: elimination.slot,
            piece,
            only_pins,
            unknowns,
            x: vec![0.0; length],
            trial: vec![0.0; length],
            positions: problem.start.to_vec(),
            gradient: vec![0.0; unknowns],
            trial_gradient: vec![0.0; unknowns],
            direction: vec![0.0; length],
            near: false,
            kept: FIRST_PART,
            resistance: 1.0,
            yardstick,
            energy: f64::INFINITY,
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
        self.evaluation.shape.barrier && self.energy == f64::INFINITY
    }

    /// Continues from these positions, by vertex.
    pub(crate) fn restart(&mut self, positions: &[f64], report: &StepReport) {
        self.positions.copy_from_slice(positions);
        parallel::in_pool(|| self.look());
        self.take_over(report);
    }

    /// The most iterations count from here on.
    pub(super) fn count_from_here(&mut self) {
        self.counted_from = self.report.iteration;
    }

    /// Continues another solver's count from where it stands.
    pub(super) fn take_over(&mut self, report: &StepReport) {
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
        self.energy = if finite { value.energy } else { f64::INFINITY };
        self.report.energy = self.energy + self.evaluation.shape.constants.offset;
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
        self.rounding + ROUNDING * self.energy.abs() + terms
    }

    /// The vertex of the first unknown that is not finite.
    fn not_finite(&self, unknowns: &[f64]) -> Option<usize> {
        let bad = unknowns.iter().position(|g| !g.is_finite())?;
        let slot = (bad / self.evaluation.shape.dimension) as u32;
        self.slot.iter().position(|&s| s == slot)
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        let begun = Stopwatch::start();
        let before = self.energy;
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
        let tried = match self.near && self.curvature.has_negative() {
            true => self.indefinite(iteration, &mut phases)?,
            false => Tried::default(),
        };
        let Tried { found, decrement } = match tried.found {
            Some(_) => tried,
            None => self.semidefinite(iteration, &mut phases)?,
        };

        self.report.iteration = iteration;
        let floor = self.yardstick.floor;
        let tolerance = self.options.tolerance;
        match found {
            Some(found) => {
                let found = self.mend(found);
                core::mem::swap(&mut self.x, &mut self.trial);
                core::mem::swap(&mut self.gradient, &mut self.trial_gradient);
                self.take(found.value);
                self.publish();
                // a step cut short changes little, too, far from the minimum
                let change = before - self.energy;
                self.near = change < NEAR * (self.energy.abs() + floor);
                let near = decrement < 10.0 * tolerance * (self.energy.abs() + floor);
                // in contact steps get as short as numbers allow, far from the minimum
                let may = near || (found.by_rounding && !found.blocked);
                let most = self.counted_from + self.options.max_iterations;
                let met = self.yardstick.criterion(
                    change,
                    self.energy,
                    self.report.gradient_norm,
                    tolerance,
                );
                self.report.conclude(met.filter(|_| may), most);
                let stuck = match found.blocked {
                    true => met.is_some() && !may,
                    false => found.by_rounding && self.energy == before,
                };
                if stuck && self.report.status == Status::Running {
                    self.report.status = Status::Stalled;
                }
            }
            // also at a minimum to rounding, where no step is seen to lower the energy
            None => {
                let near = decrement.abs() < tolerance * (self.energy.abs() + floor);
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
