//! The iteration.

mod build;
mod handles;
mod search;

use super::constraints::Constraints;
use super::elements::Sums;
use super::objective::Objective;
use super::system::LimSystem;
use super::{LimHessian, LimOptions};
use crate::optim::vectors::{dot, set_combination};
use crate::optim::{
    Criterion, Deformer, Field, Inspection, LimStep, Phase, PhaseKind, SolveError, Solver, Status,
    StepReport, Stopwatch, Yardstick,
};
use crate::parallel;

/// Iterations in a row that change nearly nothing, after which it ends in any case.
const MOST_QUIET: u32 = 5;

/// Larger μ that are tried where no step along a direction lowers the objective.
const MOST_RETRIES: u32 = 5;

/// Parts of what is negative that are tried in an iteration.
const PARTS: u32 = 2;

/// The least of them.
const LEAST_PART: f64 = 0.1;

/// Locally injective mappings.
pub struct Lim {
    options: LimOptions,
    dimension: usize,
    objective: Objective,
    constraints: Constraints,
    system: LimSystem,
    /// Slot of each vertex: its place in the elimination order.
    slot: Vec<u32>,
    /// Positions by slot.
    x: Vec<f64>,
    trial: Vec<f64>,
    /// Positions by vertex.
    positions: Vec<f64>,
    /// Of the body with its barrier,
    gradient: Vec<f64>,
    /// and with the constraints.
    whole_gradient: Vec<f64>,
    direction: Vec<f64>,
    /// The diagonal of the body's second derivatives at rest, by vertex.
    rest_diagonal: Vec<f64>,
    /// At x.
    sums: Sums,
    yardstick: Yardstick,
    /// Iterations in a row that changed nearly nothing.
    quiet: u32,
    /// The part of what is negative in the elements' second derivatives that the next matrix is to keep.
    kept: f64,
    report: StepReport,
    /// The iteration of the last change of handles, from which the most iterations are counted.
    counted_from: usize,
}

/// The phases of an iteration: matrix, factor, solve, line search.
const PHASES: [PhaseKind; 4] = [
    PhaseKind::Local,
    PhaseKind::Reweight,
    PhaseKind::Global,
    PhaseKind::Evaluate,
];

impl Lim {
    /// Evaluates x and fills the report.
    fn look(&mut self) {
        self.sums = self.objective.gradient(&self.x, &mut self.gradient);
        self.constraints.set_sub_targets(&self.x, 0.0);
        self.assemble_gradient();
        let scale = self.constraints.scale;
        self.report.energy = self.sums.energy;
        self.report.inverted = self.sums.inverted;
        self.report.smallest_sigma = self.sums.smallest;
        self.report.largest_sigma = self.sums.largest;
        let square = dot(&self.whole_gradient, &self.whole_gradient);
        self.report.gradient_norm = square.sqrt() / scale;
    }

    /// The gradient of the whole objective, with the sub-targets as they are.
    fn assemble_gradient(&mut self) {
        self.whole_gradient.copy_from_slice(&self.gradient);
        self.constraints
            .add_gradient(&self.x, &mut self.whole_gradient);
    }

    /// The parameters of a step, for the report.
    fn parameters(&self, mu: f64, sigma: f64) -> LimStep {
        let constraints = &self.constraints;
        LimStep {
            alpha: constraints.alpha,
            mu,
            sigma,
            sub_step: (1.0 + mu * mu).recip(),
            barrier: self.sums.barrier,
            positional_error: constraints.scale * constraints.error(&self.x),
            arrived: constraints.handles.iter().filter(|h| h.arrived).count(),
            handles: constraints.handles.len(),
        }
    }

    /// E + βΣφ + constraints, of these sums at x.
    fn whole(&self, sums: &Sums, x: &[f64]) -> f64 {
        sums.energy + sums.barrier + self.constraints.value(x)
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        let begun = Stopwatch::start();
        let iteration = self.report.iteration + 1;
        let mut phases = PHASES.map(|kind| Phase {
            kind,
            count: 0,
            milliseconds: 0.0,
        });
        if let Some(bad) = self.gradient.iter().position(|g| !g.is_finite()) {
            let slot = (bad / self.dimension) as u32;
            let vertex = self.slot.iter().position(|&s| s == slot).unwrap_or(0);
            return Err(SolveError::NonFinite { iteration, vertex });
        }
        let energy = self.sums.energy + self.sums.barrier;
        let error = self.constraints.error(&self.x);
        self.constraints.update_alpha(energy, &self.x);

        let (mut at_least, mut retries) = (0.0, 0);
        let (mu, sigma, promised) = loop {
            let (mu, slope) = self.descend(at_least, &mut phases);
            let clock = Stopwatch::start();
            let (sigma, trials) = self.search(slope);
            phases[3].count += trials;
            phases[3].milliseconds += clock.milliseconds();
            retries += 1;
            let visible = -slope > self.resolution();
            if sigma > 0.0 || !visible || retries > MOST_RETRIES {
                break (mu, sigma, -0.5 * slope);
            }
            at_least = self.system.larger(mu);
        };

        let clock = Stopwatch::start();
        self.constraints.remember_sub_targets();
        if sigma > 0.0 {
            core::mem::swap(&mut self.x, &mut self.trial);
            self.settle_handles();
            self.publish();
        }
        self.look();
        phases[3].milliseconds += clock.milliseconds();
        self.report.iteration = iteration;
        self.report.lim = Some(self.parameters(mu, sigma));
        self.report.phases.clear();
        self.report.phases.extend(phases);
        self.conclude(sigma, promised, energy, error);
        self.report.seconds += begun.seconds();
        Ok(())
    }

    /// A change of the objective that rounding could make.
    fn resolution(&self) -> f64 {
        1e-14 * (self.whole(&self.sums, &self.x).abs() + self.yardstick.floor)
    }

    /// Sets the values of the matrix, with the part `kept` of what is negative in those of the elements.
    fn assemble(&mut self, kept: f64, local: &mut Phase) {
        let clock = Stopwatch::start();
        self.system
            .assemble(&self.objective, &self.constraints, &self.x, kept);
        local.count += 1;
        local.milliseconds += clock.milliseconds();
    }

    /// Matrix and factor; μ, or none where the largest does not serve. Unless rotations are frozen, or a μ is
    /// asked for, the second derivatives are tried with all or a part of what is negative in them, and then
    /// without, which needs no μ.
    fn factor(&mut self, at_least: f64, local: &mut Phase, factor: &mut Phase) -> Option<f64> {
        let is_frozen = self.options.hessian == LimHessian::Frozen;
        let parts = match is_frozen || at_least > 0.0 {
            true => 0,
            false => PARTS,
        };
        for part in 0..parts {
            self.assemble(self.kept, local);
            let clock = Stopwatch::start();
            let definite = self.system.factorize_as_is();
            factor.count += 1;
            factor.milliseconds += clock.milliseconds();
            if definite {
                if part == 0 {
                    self.kept = (2.0 * self.kept).min(1.0);
                }
                return Some(0.0);
            }
            self.kept = (0.5 * self.kept).max(LEAST_PART);
        }
        self.assemble(if is_frozen { 1.0 } else { 0.0 }, local);
        let clock = Stopwatch::start();
        let unit = self.constraints.scale * self.constraints.scale;
        let (mu, tries) = self.system.factorize(at_least, unit);
        factor.count += tries;
        factor.milliseconds += clock.milliseconds();
        mu
    }

    /// The direction −(∇² + μI)⁻¹ ∇ into `direction`; μ and the slope.
    fn descend(&mut self, at_least: f64, phases: &mut [Phase; 4]) -> (f64, f64) {
        let [local, factor, global, _] = phases;
        let mu = self.factor(at_least, local, factor);
        let unit = self.constraints.scale * self.constraints.scale;
        let clock = Stopwatch::start();
        let used = mu.unwrap_or(self.system.most());
        self.constraints.set_sub_targets(&self.x, used);
        self.assemble_gradient();
        let minus = (-1.0, &self.whole_gradient[..]);
        set_combination(minus, core::iter::empty(), &mut self.direction);
        match mu {
            Some(_) => self.system.solve(&mut self.direction),
            // gradient descent
            None => self.direction.iter_mut().for_each(|p| *p /= used * unit),
        }
        global.count += 1;
        global.milliseconds += clock.milliseconds();
        (used, dot(&self.direction, &self.whole_gradient))
    }

    /// Converged, stalled, or neither.
    fn conclude(&mut self, sigma: f64, promised: f64, energy: f64, error: f64) {
        let tolerance = self.options.tolerance;
        let now = self.sums.energy + self.sums.barrier;
        let against = tolerance * (now + self.yardstick.floor);
        let arrived = self.constraints.all_arrived();
        let mu = self.report.lim.map_or(0.0, |lim| lim.mu);
        let moved = self.constraints.scale * (error - self.constraints.error(&self.x)).abs();
        let still = (now - energy).abs() <= against && moved <= tolerance;
        self.quiet = if still { self.quiet + 1 } else { 0 };
        let met = match () {
            _ if !arrived || !(tolerance > 0.0) => None,
            _ if mu == 0.0 && promised <= against => Some(Criterion::EnergyChange),
            _ if self.report.gradient_norm <= tolerance * self.yardstick.force => {
                Some(Criterion::GradientNorm)
            }
            _ if self.quiet >= MOST_QUIET => Some(Criterion::EnergyChange),
            () => None,
        };
        let most = self.counted_from + self.options.max_iterations;
        self.report.conclude(met, most);
        let stuck = sigma == 0.0 || tolerance > 0.0 && self.quiet >= MOST_QUIET;
        if stuck && self.report.status == Status::Running {
            self.report.status = Status::Stalled;
        }
    }

    /// Copies the positions by slot to those by vertex.
    fn publish(&mut self) {
        let d = self.dimension;
        for (position, &s) in self.positions.chunks_exact_mut(d).zip(&self.slot) {
            position.copy_from_slice(&self.x[s as usize * d..][..d]);
        }
    }
}

impl Solver for Lim {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        parallel::in_pool(|| self.iterate())?;
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.positions
    }
    fn dimension(&self) -> usize {
        self.dimension
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
