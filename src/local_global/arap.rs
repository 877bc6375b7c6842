//! ARAP by local/global steps (Liu et al. 2008, "A Local/Global Approach to Mesh Parameterization").
//!
//! Local: R = the rotation of F (per element). Global: min_X Σ A ‖F − R‖², a solve with the constant
//! Laplacian. The residual F − R is [`Space::stretch_residual`] at P = I, so one step is
//! X ← X − L⁻¹ Σ A Dᵀ(F − R)ᵀ.

use crate::energy::Arap;
use crate::energy::Energy;
use crate::energy::total::{deformation_gradient, distortion, spread, total};
use crate::geometry::{Elimination, RestShape};
use crate::linalg::{Cholesky, WeightedSum};
use crate::optim::{
    BuildError, Inspection, Phase, PhaseKind, SolveError, Solver, Status, StepReport, Stopwatch,
};
use crate::space::{Components, Space};
use crate::wrapd::Problem;
use core::marker::PhantomData;

/// ARAP local/global.
pub struct ArapLocalGlobal<S> {
    rest: RestShape,
    elimination: Elimination,
    factor: Cholesky,
    x: Vec<f64>,
    force: Vec<f64>,
    step: Vec<f64>,
    report: StepReport,
    /// Changes of the energy are measured against |E| + floor: the minimum may be 0.
    floor: f64,
    tolerance: f64,
    max_iterations: usize,
    types: PhantomData<S>,
}

impl<S: Space> ArapLocalGlobal<S>
where
    Arap: Energy<S>,
{
    /// Factors the Laplacian and evaluates the start. Stops when |ΔE|/(E + floor) or |∇E| is below
    /// `tolerance`.
    ///
    /// # Errors
    /// As [`crate::wrapd::Wrapd::new`].
    pub fn new(
        problem: Problem,
        tolerance: f64,
        max_iterations: usize,
    ) -> Result<Self, BuildError> {
        problem.validate(S::DIM, S::STRETCHES)?;
        let rest = problem.rest;
        let elimination = Elimination::new(rest, problem.start.len() / S::DIM, problem.pins);
        let mut matrix = WeightedSum::new(elimination.free, &elimination.laplacian(rest));
        matrix.fill(|_| 1.0);
        let mut factor = Cholesky::analyze(matrix.matrix(), &elimination.levels)?;
        factor
            .factorize(matrix.matrix())
            .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
        let mut this = Self {
            rest: rest.clone(),
            force: vec![0.0; problem.start.len()],
            step: vec![0.0; elimination.free * S::DIM],
            elimination,
            factor,
            x: problem.start.to_vec(),
            report: StepReport::at_start(),
            floor: Energy::<S>::constants(&Arap)
                .yardstick(rest.measure.iter().sum(), S::STRETCHES)
                .floor,
            tolerance,
            max_iterations,
            types: PhantomData,
        };
        this.evaluate();
        if max_iterations == 0 {
            this.report.status = Status::MaxIterations;
        }
        Ok(this)
    }

    fn evaluate(&mut self) {
        let total = total::<S, Arap>(Arap, &self.rest, &self.x);
        let squared: f64 = total
            .gradient
            .chunks_exact(S::DIM)
            .zip(&self.elimination.slot)
            .filter(|&(_, &slot)| (slot as usize) < self.elimination.free)
            .flat_map(|(g, _)| g)
            .map(|g| g * g)
            .sum();
        self.report.energy = total.energy;
        self.report.gradient_norm = squared.sqrt();
        self.report.inverted = total.inverted;
        self.report.smallest_sigma = total.smallest_sigma;
        self.report.largest_sigma = total.largest_sigma;
    }
}

impl<S: Space> Solver for ArapLocalGlobal<S>
where
    Arap: Energy<S>,
{
    fn step(&mut self) -> Result<StepReport, SolveError> {
        let begun = Stopwatch::start();
        let before = self.report.energy;
        let clock = Stopwatch::start();
        let identity = S::from_eigen(
            S::Sigma::from_fn(|_| 1.0),
            S::eigen(S::Symmetric::from_fn(|_| 0.0)).1,
        );
        self.force.iter_mut().for_each(|f| *f = 0.0);
        for e in 0..self.rest.len() {
            let f = deformation_gradient::<S>(&self.rest, &self.x, e);
            let (_, polar) = S::polar(f);
            let residual = S::stretch_residual(f, polar, identity);
            spread::<S>(
                &self.rest,
                e,
                residual,
                self.rest.measure[e],
                &mut self.force,
            );
        }
        let local = Phase::new(PhaseKind::Local, 1, clock);

        let clock = Stopwatch::start();
        let Elimination { slot, free, .. } = &self.elimination;
        let free_of = |slot: u32| (slot as usize) < *free;
        for (v, &s) in slot.iter().enumerate().filter(|&(_, &s)| free_of(s)) {
            let s = s as usize * S::DIM;
            self.step[s..s + S::DIM].copy_from_slice(&self.force[v * S::DIM..(v + 1) * S::DIM]);
        }
        self.factor.solve_in_place(&mut self.step, S::DIM);
        for (v, &s) in slot.iter().enumerate().filter(|&(_, &s)| free_of(s)) {
            for i in 0..S::DIM {
                self.x[v * S::DIM + i] -= self.step[s as usize * S::DIM + i];
            }
        }
        let global = Phase::new(PhaseKind::Global, 1, clock);

        let clock = Stopwatch::start();
        self.evaluate();
        self.report.iteration += 1;
        let iteration = self.report.iteration;
        if let Some(bad) = self.x.iter().position(|x| !x.is_finite()) {
            let vertex = bad / S::DIM;
            return Err(SolveError::NonFinite { iteration, vertex });
        }
        let before = (before, self.floor);
        self.report
            .settle(before, true, self.tolerance, self.max_iterations);
        let evaluate = Phase::new(PhaseKind::Evaluate, 1, clock);
        self.report.seconds += begun.seconds();
        self.report.phases = vec![local, global, evaluate];
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.x
    }
    fn dimension(&self) -> usize {
        S::DIM
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        Inspection {
            distortion: distortion::<S>(&self.rest, &self.x),
            weights: Vec::new(),
        }
    }
}
