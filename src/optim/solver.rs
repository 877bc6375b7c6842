//! The one object-safe interface of all iterative solvers.

use super::{GiniStep, LimStep, SolveError, Stopwatch, Yardstick};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What stopped a converged solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Criterion {
    /// The relative change of the energy fell below the tolerance.
    EnergyChange,
    /// The norm of the gradient fell below the tolerance.
    GradientNorm,
    /// The method is direct: one step is all of it.
    Direct,
    /// No element is inverted or degenerate, by exact predicates.
    Injective,
}

/// Where a solver stands. Not having converged is a status, never an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// More steps can be taken.
    Running,
    /// Done.
    Converged(Criterion),
    /// The iteration cap was reached.
    MaxIterations,
    /// No further progress is possible in floating point.
    Stalled,
    /// The caller cancelled.
    Cancelled,
}

impl Status {
    /// `"running"`, `"converged"`, `"max-iterations"`, `"stalled"` or `"cancelled"`.
    pub fn name(self) -> &'static str {
        match self {
            Status::Running => "running",
            Status::Converged(_) => "converged",
            Status::MaxIterations => "max-iterations",
            Status::Stalled => "stalled",
            Status::Cancelled => "cancelled",
        }
    }
}

/// The phases an iteration can consist of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum PhaseKind {
    /// The per-element step: the prox, or (second-order methods) the matrices of the elements and their sum.
    Local,
    /// The solve for the vertex positions.
    Global,
    /// New element weights and the numeric refactorisation they need; the factorisation of every step of
    /// a second-order method.
    Reweight,
    /// Energy, flips and termination; line searches.
    Evaluate,
}

/// One phase of one iteration: what it did and how long it took.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct Phase {
    /// Which phase.
    pub kind: PhaseKind,
    /// How often its inner loop ran (local: most prox iterations of any element; global: L-BFGS
    /// iterations; reweight: 1; evaluate: 1).
    pub count: u32,
    /// Wall time in milliseconds.
    pub milliseconds: f64,
}

impl Phase {
    /// A phase that began when `clock` was started and has just ended.
    pub fn new(kind: PhaseKind, count: u32, clock: Stopwatch) -> Self {
        Self {
            kind,
            count,
            milliseconds: clock.milliseconds(),
        }
    }
}

/// What one step did. Energies are relative to an isometry as each energy's docs say.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct StepReport {
    /// 0 is the start, before any step.
    pub iteration: usize,
    /// The solver's status after the step (`statusName` in JavaScript is its name).
    pub status: Status,
    /// The energy of the iterate; while it has inverted elements and the energy is infinite there,
    /// the energy of the local variables Z.
    pub energy: f64,
    /// Number of inverted or degenerate elements (signed measure ≤ 0, in floating point).
    pub inverted: usize,
    /// Norm of the energy's gradient at the iterate (infinite while inverted).
    pub gradient_norm: f64,
    /// Smallest signed singular value of any element.
    pub smallest_sigma: f64,
    /// Largest singular value of any element.
    pub largest_sigma: f64,
    /// L-BFGS iterations of the global step (0 where there are none).
    pub lbfgs_iterations: usize,
    /// Did the element weights change in this step?
    pub reweighted: bool,
    /// Of a method in two stages: the iteration with which the first ended.
    pub switched_at: Option<usize>,
    /// Of a locally injective map: what the step was made with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lim: Option<LimStep>,
    /// Of a globally injective map: its quadratic problem, and its polisher.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gini: Option<GiniStep>,
    /// Seconds spent in steps, setup and the time between steps apart.
    pub seconds: f64,
    /// The phases, in order.
    pub phases: Vec<Phase>,
}

impl StepReport {
    /// The report of a start that has not been evaluated yet.
    pub fn at_start() -> Self {
        Self {
            iteration: 0,
            status: Status::Running,
            energy: f64::INFINITY,
            inverted: 0,
            gradient_norm: f64::INFINITY,
            smallest_sigma: 0.0,
            largest_sigma: 0.0,
            lbfgs_iterations: 0,
            reweighted: false,
            switched_at: None,
            lim: None,
            gini: None,
            seconds: 0.0,
            phases: Vec::new(),
        }
    }

    /// Sets the status at the end of a step that began with the energy `before`, of a map of measure 1:
    /// converged, if it `may` be and |ΔE|/(|E| + floor) or |∇E| is below `tolerance`. For bodies of any
    /// size and stiffness there is [`Self::conclude`].
    pub fn settle(
        &mut self,
        (before, floor): (f64, f64),
        may: bool,
        tolerance: f64,
        max_iterations: usize,
    ) {
        let unit = Yardstick {
            floor,
            force: 1.0,
            rounding: 0.0,
        };
        let change = self.energy - before;
        let met = unit.criterion(change, self.energy, self.gradient_norm, tolerance);
        self.conclude(met.filter(|_| may), max_iterations);
    }

    /// Sets the status at the end of a step: converged if a criterion is met.
    pub fn conclude(&mut self, met: Option<Criterion>, max_iterations: usize) {
        self.status = match met {
            Some(criterion) => Status::Converged(criterion),
            None if self.iteration >= max_iterations => Status::MaxIterations,
            None => Status::Running,
        };
    }
}

/// Per-element fields a page draws.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Inspection {
    /// Symmetric Dirichlet density of each element relative to an isometry (1: isometric), signed
    /// infinity where inverted; length: elements.
    pub distortion: Vec<f32>,
    /// Current weight over rest weight of each element; empty where the method has no weights.
    pub weights: Vec<f32>,
}

/// One solver: `step` is one iteration of the paper's algorithm.
pub trait Solver: Send {
    /// Takes one step. After the status has left `Running` a further call takes another step all the
    /// same (a page may want to see it), unless the solver is direct.
    fn step(&mut self) -> Result<StepReport, SolveError>;
    /// Positions, vertices × dimension, interleaved, in the solver's own scale.
    fn positions(&self) -> &[f64];
    /// Dimension of `positions`.
    fn dimension(&self) -> usize;
    /// Where it stands.
    fn status(&self) -> Status;
    /// The newest report (iteration 0 before any step).
    fn report(&self) -> &StepReport;
    /// The per-element fields at the newest iterate.
    fn inspect(&self) -> Inspection;
}

/// Sees every step of [`run`].
pub trait Observer {
    /// Called after every step, and once before the first with the report of iteration 0.
    fn observe(&mut self, solver: &dyn Solver);
}

impl<F: FnMut(&dyn Solver)> Observer for F {
    fn observe(&mut self, solver: &dyn Solver) {
        self(solver)
    }
}

/// Cancels a running solver from another thread or from an observer.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks for the run to end after the current step.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
    /// Was `cancel` called?
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Steps until the solver is no longer running, or is cancelled.
pub fn run(
    solver: &mut dyn Solver,
    observer: &mut dyn Observer,
    cancel: &CancelToken,
) -> Result<Status, SolveError> {
    observer.observe(solver);
    while solver.status() == Status::Running {
        if cancel.is_cancelled() {
            return Ok(Status::Cancelled);
        }
        solver.step()?;
        observer.observe(solver);
    }
    Ok(solver.status())
}
