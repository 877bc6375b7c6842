//! The solver: elimination and factorisation once, then roundings step by step.

use super::dense::Dense;
use super::elimination::{Elimination, RowOutcome};
use super::options::{MixedIntegerOptions, Rounding};
use super::reduced::Reduced;
use super::relaxation::ThreeLevel;
use super::report::{Action, Level, LevelCounts, MixedIntegerReport, MixedIntegerStep};
use super::{MixedIntegerError as Error, Problem};
use crate::linalg::{Cholesky, NotPositiveDefinite};
use crate::optim::{CancelToken, Criterion, Status, Stopwatch};

/// A constraint row that is violated by more, relatively, is not kept: coefficients were so large that
/// double precision does not carry them.
const MOST_VIOLATION: f64 = 1e-6;

/// What the integers are found with.
enum Engine {
    Dense(Box<Dense>),
    ThreeLevel {
        rounding: Box<ThreeLevel>,
        /// For the matrix with fixed unknowns; the other factor stays that of the relaxed problem.
        masked: Option<Box<Cholesky>>,
    },
}

/// A mixed-integer problem being solved.
pub struct MixedInteger {
    problem: Problem,
    options: MixedIntegerOptions,
    elimination: Elimination,
    reduced: Reduced,
    cholesky: Cholesky,
    /// The relaxed solution, in elimination order.
    relaxed: Vec<f64>,
    engine: Engine,
    /// All unknowns.
    x: Vec<f64>,
    step: MixedIntegerStep,
    report: MixedIntegerReport,
}

impl MixedInteger {
    /// Eliminates the constraints, orders and factors what is left, and solves the relaxed problem.
    ///
    /// # Errors
    /// `InvalidOption`; `Contradictory`, `Infeasible`, `NotRational`, `CoefficientsTooLarge` with the
    /// constraint row; `NotPositiveDefinite` with the unknown; `TooManyIntegers`; `TooLarge`.
    pub fn new(problem: Problem, options: MixedIntegerOptions) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        options.validate()?;
        let elimination = Elimination::new(&problem, options.reorder, options.tolerance)?;
        let taken = elimination.eliminated_integers(&problem);
        let dense = options.is_dense(problem.integers().len() - taken)?;
        let reduced = Reduced::new(&problem, &elimination, dense)?;
        let mut cholesky = Cholesky::analyze(reduced.matrix(), &reduced.order().levels)?;
        factorize(&mut cholesky, &reduced)?;
        let engine = match dense {
            true => Engine::Dense(Box::new(Dense::new(&reduced, &cholesky))),
            false => Engine::ThreeLevel {
                rounding: Box::new(ThreeLevel::new(&reduced)),
                masked: None,
            },
        };
        let rows = elimination.outcomes().to_vec();
        let is_redundant = |&(_, outcome): &(u32, &RowOutcome)| *outcome == RowOutcome::Redundant;
        let redundant = (0..).zip(&rows).filter(is_redundant);
        let report = MixedIntegerReport {
            energy: 0.0,
            relaxed_energy: 0.0,
            lower_bound: None,
            proven: false,
            feasible: false,
            reduced_unknowns: reduced.dimension(),
            reduced_integers: reduced.integers().len(),
            reduced_entries: reduced.matrix().nnz(),
            factor_entries: cholesky.factor_entries(),
            changes_of_integers: elimination.changes_of_integers(),
            redundant_rows: redundant.map(|(row, _)| row).collect(),
            rows,
            rounded: 0,
            levels: LevelCounts::default(),
            improvements: 0,
            exchanges: 0,
            nodes: 0,
            violation: 0.0,
            setup_seconds: 0.0,
            seconds: 0.0,
        };
        let mut this = Self {
            relaxed: vec![0.0; reduced.dimension()],
            x: vec![0.0; problem.unknowns()],
            problem,
            options,
            elimination,
            reduced,
            cholesky,
            engine,
            step: relax_step(),
            report,
        };
        this.start()?;
        this.report.setup_seconds = clock.seconds();
        Ok(this)
    }

    /// The same matrix and constraint coefficients with another b (length n), other constants (one a
    /// row), or both: nothing is eliminated or factored again, and a reduced basis stays. Afterwards the
    /// solver stands at the new relaxed solution.
    ///
    /// # Errors
    /// `WrongLength`, `NonFinite`, `Contradictory`, `Infeasible`; the solver then stands where it stood.
    pub fn resolve(
        &mut self,
        linear: Option<&[f64]>,
        constants: Option<&[f64]>,
    ) -> Result<(), Error> {
        let clock = Stopwatch::start();
        let mut problem = self.problem.clone();
        problem.replace(linear, constants)?;
        self.reduced.update(&problem, &self.elimination)?;
        self.problem = problem;
        self.start()?;
        self.report.setup_seconds = clock.seconds();
        Ok(())
    }

    /// The relaxed solution, from which steps begin.
    fn start(&mut self) -> Result<(), Error> {
        self.relaxed.copy_from_slice(self.reduced.linear());
        self.cholesky.solve_in_place(&mut self.relaxed, 1);
        match &mut self.engine {
            Engine::Dense(dense) => dense.start(&self.relaxed, self.options.rounding),
            Engine::ThreeLevel { rounding, .. } => rounding.start(&self.reduced, &self.relaxed),
        }
        self.reduced.expand(&self.relaxed, &mut self.x);
        let energy = self.problem.energy(&self.x);
        self.step = relax_step();
        self.step.energy = energy;
        self.step.remaining = self.remaining();
        self.report.energy = energy;
        self.report.relaxed_energy = energy;
        self.report.lower_bound = None;
        (self.report.proven, self.report.feasible) = (false, false);
        self.report.seconds = 0.0;
        self.count();
        if self.is_done() {
            self.finish()?;
        }
        Ok(())
    }

    /// One step (`Stalled` at the end: double precision does not carry the problem): a rounding, an improvement, a part of the reduction or of the enumeration. Nothing happens
    /// once the status is not `Running`.
    ///
    /// # Errors
    /// `NotPositiveDefinite`.
    pub fn step(&mut self) -> Result<&MixedIntegerStep, Error> {
        if self.step.status != Status::Running {
            return Ok(&self.step);
        }
        let clock = Stopwatch::start();
        let (reduced, options) = (&self.reduced, &self.options);
        let (action, energy) = match &mut self.engine {
            Engine::Dense(dense) => {
                let action = dense.step(reduced, &mut self.cholesky, &self.relaxed, options);
                (action, self.report.relaxed_energy + dense.energy())
            }
            Engine::ThreeLevel { rounding, masked } => {
                let action = match options.rounding {
                    Rounding::Direct => Action::Round {
                        rounded: rounding.direct(reduced),
                        level: Level::Cholesky,
                        spread: 0,
                    },
                    _ => {
                        let masked = analyzed(masked, reduced)?;
                        let budget = options.budget.unwrap_or(0.5);
                        let (rounded, level, spread) = rounding
                            .step(reduced, masked, options, budget)
                            .map_err(|e| not_positive(reduced, e))?;
                        Action::Round {
                            rounded,
                            level,
                            spread,
                        }
                    }
                };
                (action, rounding.energy())
            }
        };
        if let Action::Round { rounded, .. } = &action {
            self.report.rounded += rounded.len();
        }
        self.step.iteration += 1;
        self.step.action = action;
        self.step.energy = energy;
        self.step.remaining = self.remaining();
        self.count();
        if self.is_done() {
            self.finish()?;
        }
        self.step.seconds += clock.seconds();
        self.report.seconds = self.step.seconds;
        Ok(&self.step)
    }

    /// Steps until it is done or cancelled, and shows every step.
    ///
    /// # Errors
    /// Those of [`Self::step`].
    pub fn run(
        &mut self,
        mut observe: impl FnMut(&MixedIntegerStep),
        cancel: &CancelToken,
    ) -> Result<Status, Error> {
        while self.step.status == Status::Running {
            if cancel.is_cancelled() {
                return Ok(Status::Cancelled);
            }
            observe(self.step()?);
        }
        Ok(self.step.status)
    }

    fn is_done(&self) -> bool {
        match &self.engine {
            Engine::Dense(dense) => dense.is_done(),
            Engine::ThreeLevel { rounding, .. } => rounding.remaining() == 0,
        }
    }

    fn remaining(&self) -> usize {
        match &self.engine {
            Engine::Dense(dense) => dense.remaining(),
            Engine::ThreeLevel { rounding, .. } => rounding.remaining(),
        }
    }

    fn count(&mut self) {
        match &self.engine {
            Engine::Dense(dense) => {
                self.report.rounded = dense.rounded;
                self.report.levels.dense = dense.rounded;
                self.report.improvements = dense.improvements;
                self.report.exchanges = dense.exchanges();
                self.report.nodes = dense.nodes;
            }
            Engine::ThreeLevel { rounding, .. } => {
                self.report.levels = rounding.counts();
                if self.step.iteration == 0 {
                    self.report.rounded = 0;
                }
            }
        }
    }

    /// All integers have values: the reals, the report, the status.
    fn finish(&mut self) -> Result<(), Error> {
        self.step.status = Status::Converged(Criterion::Direct);
        if let Engine::ThreeLevel { rounding, masked } = &mut self.engine {
            rounding
                .finish(&self.reduced, analyzed(masked, &self.reduced)?)
                .map_err(|e| not_positive(&self.reduced, e))?;
        }
        self.expand();
        let x = &mut self.x;
        for &i in self.problem.integers() {
            x[i as usize] = x[i as usize].round();
        }
        self.report.energy = self.problem.energy(x);
        self.report.violation = self.problem.violation(x);
        self.report.feasible = self.report.violation <= MOST_VIOLATION;
        self.step.energy = self.report.energy;
        let (energy, relaxed) = (self.report.energy, self.report.relaxed_energy);
        // less than the least energy: the relaxed solution is nothing but rounding errors
        let is_wrong = energy < relaxed - 1e-6 * (energy.abs() + relaxed.abs());
        if !self.report.feasible || is_wrong {
            self.step.status = Status::Stalled;
            return Ok(());
        }
        if let Engine::Dense(dense) = &self.engine
            && let Some(bound) = dense.bound
        {
            // both energies are sums of n terms
            let size: f64 = x
                .iter()
                .zip(self.problem.linear())
                .map(|(x, b)| (x * b).abs())
                .sum();
            let size = size + self.report.energy.abs() + self.report.relaxed_energy.abs();
            let rounding = 4.0 * x.len() as f64 * f64::EPSILON * size;
            self.report.lower_bound = Some(self.report.relaxed_energy + bound - rounding);
            self.report.proven = dense.proven;
            if !dense.proven {
                self.step.status = Status::MaxIterations;
            }
        }
        Ok(())
    }

    /// x of the present iterate: what is rounded, and everything else at its best for that.
    fn expand(&mut self) {
        match &mut self.engine {
            Engine::Dense(dense) => {
                let mut y = vec![0.0; self.relaxed.len()];
                dense.solve(&mut self.cholesky, &self.relaxed, &mut y);
                self.reduced.expand(&y, &mut self.x);
            }
            Engine::ThreeLevel { rounding, .. } => {
                self.reduced.expand(rounding.iterate(), &mut self.x);
            }
        }
    }

    /// All unknowns (length n) at the present step: integers that have no value yet at their estimates.
    /// The dense engine takes a triangular solve for this, unless it is done.
    pub fn iterate(&mut self) -> &[f64] {
        if self.step.status == Status::Running {
            self.expand();
        }
        &self.x
    }

    /// The solution (length n) once the status is not `Running`; before, what was computed last.
    pub fn solution(&self) -> &[f64] {
        &self.x
    }
    /// Where it stands.
    pub fn status(&self) -> Status {
        self.step.status
    }
    /// The newest step.
    pub fn last_step(&self) -> &MixedIntegerStep {
        &self.step
    }
    /// The report.
    pub fn report(&self) -> &MixedIntegerReport {
        &self.report
    }
    /// The problem.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }
}

fn relax_step() -> MixedIntegerStep {
    MixedIntegerStep {
        iteration: 0,
        status: Status::Running,
        action: Action::Relax,
        energy: 0.0,
        remaining: 0,
        seconds: 0.0,
    }
}

/// The factor for matrices with fixed unknowns, analysed when it is needed first.
fn analyzed<'a>(
    masked: &'a mut Option<Box<Cholesky>>,
    reduced: &Reduced,
) -> Result<&'a mut Cholesky, Error> {
    if masked.is_none() {
        let analyzed = Cholesky::analyze(reduced.matrix(), &reduced.order().levels)?;
        *masked = Some(Box::new(analyzed));
    }
    match masked {
        Some(cholesky) => Ok(cholesky),
        None => unreachable!("it was made above"),
    }
}

fn not_positive(reduced: &Reduced, error: NotPositiveDefinite) -> Error {
    Error::NotPositiveDefinite {
        pivot: reduced.unknown(error.pivot as u32) as usize,
    }
}

/// Factors the reduced matrix. A pivot that is nothing but rounding counts as 0.
fn factorize(cholesky: &mut Cholesky, reduced: &Reduced) -> Result<(), Error> {
    cholesky
        .factorize(reduced.matrix())
        .map_err(|e| not_positive(reduced, e))?;
    let (offsets, _, values) = reduced.matrix().csc_data();
    let noise = f64::EPSILON * (16.0 + (reduced.dimension() as f64).sqrt());
    let pivots = cholesky.inverse_diagonal().iter().zip(offsets);
    for (pivot, (inverse, &begin)) in pivots.enumerate() {
        if !((inverse * inverse).recip() > noise * values[begin]) {
            return Err(not_positive(reduced, NotPositiveDefinite { pivot }));
        }
    }
    Ok(())
}
