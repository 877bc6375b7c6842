//! The iteration of algorithm 1.

use super::block::{BLOCK, Block, BlockSums};
use super::kernels::{Kernel, Pass};
use super::layout::{build_blocks, corner_lists, element_order};
use super::{Coupling, Elimination, Problem, WrapdOptions};
use crate::energy::Energy;
use crate::energy::total::relative_distortion;
use crate::linalg::{Cholesky, WeightedSum};
use crate::optim::lbfgs::Lbfgs;
use crate::optim::vectors::{add_combination, dot};
use crate::optim::{
    BuildError, Criterion, Inspection, Phase, PhaseKind, SolveError, Solver, Status, StepReport,
    Stopwatch,
};
use crate::parallel;
use crate::space::{Space, dispatch};
use core::marker::PhantomData;

/// Which corner forces to add up.
#[derive(Clone, Copy)]
enum Forces {
    /// The gradient of (11), into `gradient`.
    Coupling,
    /// The same, into `next_gradient`.
    NextCoupling,
    /// The gradient of the energy, into `direction`.
    Energy,
}

/// ADMM on a splitting of F: WRAPD and its relatives, by coupling `C` and energy `E`.
pub struct Wrapd<S: Space, C, E> {
    options: WrapdOptions,
    energy: E,
    /// Slot of each vertex: free ones in elimination order, then the pinned.
    slot: Vec<u32>,
    /// The element at each place of the blocks.
    order: Vec<u32>,
    blocks: Vec<Block>,
    forces: Vec<f64>,
    corner_begin: Vec<u32>,
    corners: Vec<u32>,
    /// Positions by slot.
    x: Vec<f64>,
    /// Positions by vertex.
    positions: Vec<f64>,
    gradient: Vec<f64>,
    next_gradient: Vec<f64>,
    direction: Vec<f64>,
    matrix: WeightedSum,
    factor: Cholesky,
    history: Lbfgs,
    report: StepReport,
    /// Iterations with the rest weights, for this start.
    delay: usize,
    /// No flips at the previous iterate?
    was_injective: bool,
    started: Option<Stopwatch>,
    types: PhantomData<(S, C)>,
}

impl<S: Space, C: Coupling<S>, E: Energy<S>> Wrapd<S, C, E> {
    /// Analyses, factors and evaluates the start; all allocation happens here.
    ///
    /// # Errors
    /// Lengths that do not fit, options out of range, a start that is not finite, no pin.
    pub fn new(problem: Problem, energy: E, options: WrapdOptions) -> Result<Self, BuildError> {
        options.validate()?;
        let rest = problem.rest;
        let n = problem.start.len() / S::DIM;
        problem.validate::<S>()?;

        let elimination = Elimination::new(rest, n, problem.pins);
        // from here on elements are in the order of their vertices' slots
        let order = element_order(rest, &elimination.slot);
        let rest = &rest.reordered(&order);
        let mut matrix = WeightedSum::new(elimination.free, &elimination.laplacian(rest));
        matrix.fill(|_| E::REST_STIFFNESS);
        let mut factor = Cholesky::analyze(matrix.matrix(), &elimination.parts)?;
        factor
            .factorize(matrix.matrix())
            .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;

        let Elimination { slot, free, .. } = elimination;
        let blocks = build_blocks::<S, C, E>(rest, &slot);
        // forces of the coupling, then those of the energy
        let corners_per_block = 2 * (rest.stretches + 1) * S::DIM * BLOCK;
        let (corner_begin, corners) = corner_lists::<S>(rest, &slot, free);
        let mut x = vec![0.0; problem.start.len()];
        for (v, &s) in slot.iter().enumerate() {
            let s = s as usize * S::DIM;
            x[s..s + S::DIM].copy_from_slice(&problem.start[v * S::DIM..(v + 1) * S::DIM]);
        }
        let unknowns = free * S::DIM;
        let mut this = Self {
            options,
            energy,
            slot,
            order,
            forces: vec![0.0; corners_per_block * blocks.len()],
            blocks,
            corner_begin,
            corners,
            x,
            positions: problem.start.to_vec(),
            gradient: vec![0.0; unknowns],
            next_gradient: vec![0.0; unknowns],
            direction: vec![0.0; unknowns],
            matrix,
            factor,
            history: Lbfgs::new(options.history),
            report: StepReport::at_start(),
            delay: 0,
            was_injective: false,
            started: None,
            types: PhantomData,
        };
        let sums = this.pass(Pass::Last);
        this.gather_gradient_norm();
        this.evaluate(sums);
        if E::BARRIER && this.report.inverted > 0 {
            // there is no Z yet whose energy could stand in
            this.report.energy = f64::INFINITY;
        }
        this.was_injective = this.report.inverted == 0;
        if let Some(r) = options.reweighting {
            let folded = 100 * this.report.inverted > rest.len();
            this.delay = if folded { r.delay_folded } else { r.delay };
        }
        if options.max_iterations == 0 {
            this.report.status = Status::MaxIterations;
        }
        Ok(this)
    }

    /// Runs one element pass over all blocks and adds up, in the blocks' order.
    fn pass(&mut self, pass: Pass) -> BlockSums {
        let chunk = self.forces.len() / self.blocks.len().max(1);
        let (x, energy) = (&self.x, self.energy);
        parallel::for_each_block(
            &mut self.blocks,
            &mut self.forces,
            chunk,
            |_, block, forces| {
                block.sums = dispatch(Kernel::<S, C, E> {
                    pass,
                    block,
                    positions: x,
                    forces,
                    energy,
                    types: PhantomData,
                });
            },
        );
        let mut total = BlockSums {
            smallest: f64::INFINITY,
            ..Default::default()
        };
        for s in self.blocks.iter().map(|b| &b.sums) {
            total.lagrangian_change += s.lagrangian_change;
            total.z_energy += s.z_energy;
            total.f_energy += s.f_energy;
            total.inverted += s.inverted;
            total.smallest = total.smallest.min(s.smallest);
            total.largest = total.largest.max(s.largest);
            total.reweight |= s.reweight;
            total.prox_iterations = total.prox_iterations.max(s.prox_iterations);
        }
        total
    }

    /// Adds the corner forces up at the free vertices.
    fn gather(&mut self, what: Forces) {
        const VERTICES: usize = 1024;
        let (offset, gradient) = match what {
            Forces::Coupling => (0, &mut self.gradient),
            Forces::NextCoupling => (0, &mut self.next_gradient),
            // the direction has served its purpose by then
            Forces::Energy => (
                self.forces.len() / self.blocks.len() / 2,
                &mut self.direction,
            ),
        };
        let (forces, begin, corners) = (&self.forces, &self.corner_begin, &self.corners);
        parallel::for_each_chunk(gradient, VERTICES * S::DIM, |chunk, out| {
            for (local, g) in out.chunks_exact_mut(S::DIM).enumerate() {
                let v = chunk * VERTICES + local;
                let range = begin[v] as usize..begin[v + 1] as usize;
                let mut sum = [0.0; 3];
                for &corner in &corners[range] {
                    let force = &forces[corner as usize + offset..][..S::DIM];
                    for i in 0..S::DIM {
                        sum[i] += force[i];
                    }
                }
                g.copy_from_slice(&sum[..S::DIM]);
            }
        });
    }

    /// After a `Last` pass: the norm of the reported energy's gradient.
    fn gather_gradient_norm(&mut self) {
        self.gather(Forces::Energy);
        let squared = dot(&self.direction, &self.direction);
        self.report.gradient_norm = E::SCALE * squared.sqrt();
    }

    /// Fills the report from the sums of an evaluation.
    fn evaluate(&mut self, sums: BlockSums) {
        let measure: f64 = self
            .blocks
            .iter()
            .map(|b| b.measure[0][..b.len].iter().sum::<f64>())
            .sum();
        let reported = |sum: f64| E::SCALE * (sum - E::ISOMETRY * measure) + E::OFFSET;
        self.report.inverted = sums.inverted;
        self.report.smallest_sigma = sums.smallest;
        self.report.largest_sigma = sums.largest;
        let barrier_broken = E::BARRIER && sums.inverted > 0;
        self.report.energy = reported(if barrier_broken {
            sums.z_energy
        } else {
            sums.f_energy
        });
        if barrier_broken {
            self.report.gradient_norm = f64::INFINITY;
        }
    }

    /// The global step: L-BFGS on (11) until (17). Returns its iterations and the final evaluation.
    fn global_step(&mut self, local: &BlockSums) -> (usize, BlockSums) {
        // below the rounding error of the Lagrangian there is nothing to be gained
        let rounding = f64::EPSILON * local.z_energy.abs();
        let bound = (S::KAPPA * local.lagrangian_change.abs()).max(rounding);
        self.gather(Forces::Coupling);
        self.history.new_objective();
        let mut count = 0;
        loop {
            let mut slope = self.history.direction(
                &mut self.factor,
                S::DIM,
                &self.gradient,
                &mut self.direction,
            );
            let uphill = !(slope < 0.0);
            if uphill {
                self.history.clear();
                self.direction
                    .iter_mut()
                    .zip(&self.gradient)
                    .for_each(|(d, g)| *d = -g);
                slope = -dot(&self.gradient, &self.gradient);
            }
            let unknowns = self.direction.len();
            add_combination(
                core::iter::once((1.0, &self.direction[..])),
                &mut self.x[..unknowns],
            );
            count += 1;
            let last =
                C::LINEAR || !(-slope > bound) || count >= self.options.max_global_iterations;
            let sums = self.pass(if last { Pass::Last } else { Pass::Forces });
            if !C::LINEAR {
                self.gather(Forces::NextCoupling);
                if !uphill {
                    self.history
                        .push(&self.direction, &self.gradient, &self.next_gradient);
                }
                core::mem::swap(&mut self.gradient, &mut self.next_gradient);
            }
            if last {
                return (count, sums);
            }
        }
    }

    /// Takes over the candidate weights: U is scaled by w²/w_cand², A refactored, the history cleared.
    fn reweight(&mut self, iteration: usize) -> Result<(), SolveError> {
        parallel::for_each_chunk(&mut self.blocks, 1, |_, block| block[0].take_candidates());
        let blocks = &self.blocks;
        self.matrix
            .fill(|e| blocks[e / BLOCK].stiffness[0][e % BLOCK]);
        self.history.clear();
        self.factor
            .factorize(self.matrix.matrix())
            .map_err(|e| SolveError::NotPositiveDefinite {
                iteration,
                pivot: e.pivot,
            })
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        let started = *self.started.get_or_insert_with(Stopwatch::start);
        let k = self.report.iteration;
        let before = self.report.energy;

        let clock = Stopwatch::start();
        let clamp = match self.options.reweighting {
            Some(r) if k >= self.delay => [r.least, r.most_at(k + 1 - self.delay)],
            _ => [1.0, 1.0],
        }
        .map(|beta| beta * E::REST_STIFFNESS);
        let reset = k == 0 || (k == 1 && self.options.restart_duals);
        let threshold = self
            .options
            .reweighting
            .map_or(f64::INFINITY, |r| r.threshold);
        let local = self.pass(Pass::Local {
            clamp,
            threshold,
            reset,
        });
        let local_phase = Phase {
            kind: PhaseKind::Local,
            count: local.prox_iterations,
            milliseconds: clock.milliseconds(),
        };

        let clock = Stopwatch::start();
        let (count, mut sums) = self.global_step(&local);
        let global_phase = Phase {
            kind: PhaseKind::Global,
            count: count as u32,
            milliseconds: clock.milliseconds(),
        };

        let clock = Stopwatch::start();
        let reweighted = local.reweight;
        if reweighted {
            self.reweight(k + 1)?;
        }
        let reweight_phase = Phase {
            kind: PhaseKind::Reweight,
            count: u32::from(reweighted),
            milliseconds: clock.milliseconds(),
        };

        let clock = Stopwatch::start();
        sums.z_energy = local.z_energy;
        if let Some(slot) = self.x.iter().position(|x| !x.is_finite()) {
            let vertex = self
                .slot
                .iter()
                .position(|&s| s as usize == slot / S::DIM)
                .unwrap_or(0);
            return Err(SolveError::NonFinite {
                iteration: k + 1,
                vertex,
            });
        }
        for (v, &s) in self.slot.iter().enumerate() {
            let s = s as usize * S::DIM;
            self.positions[v * S::DIM..(v + 1) * S::DIM].copy_from_slice(&self.x[s..s + S::DIM]);
        }
        self.gather_gradient_norm();
        self.evaluate(sums);
        let injective = self.report.inverted == 0;
        let change = (self.report.energy - before).abs();
        let tolerance = self.options.tolerance;
        self.report.iteration = k + 1;
        self.report.lbfgs_iterations = if C::LINEAR { 0 } else { count };
        self.report.reweighted = reweighted;
        self.report.status =
            if injective && self.was_injective && change < tolerance * self.report.energy.abs() {
                Status::Converged(Criterion::EnergyChange)
            } else if injective && self.was_injective && self.report.gradient_norm < tolerance {
                Status::Converged(Criterion::GradientNorm)
            } else if self.report.iteration >= self.options.max_iterations {
                Status::MaxIterations
            } else {
                Status::Running
            };
        self.was_injective = injective;
        self.report.seconds = started.seconds();
        let evaluate_phase = Phase {
            kind: PhaseKind::Evaluate,
            count: 1,
            milliseconds: clock.milliseconds(),
        };
        self.report.phases.clear();
        self.report
            .phases
            .extend([local_phase, global_phase, reweight_phase, evaluate_phase]);
        Ok(())
    }

    /// Entries of the Cholesky factor.
    pub fn factor_entries(&self) -> usize {
        self.factor.factor_entries()
    }
}

impl<S: Space, C: Coupling<S>, E: Energy<S>> Solver for Wrapd<S, C, E> {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        self.iterate()?;
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.positions
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
        let elements = self.order.len();
        let mut inspection = Inspection {
            distortion: vec![0.0; elements],
            weights: vec![0.0; elements],
        };
        for (place, &element) in self.order.iter().enumerate() {
            let (block, e) = (&self.blocks[place / BLOCK], place % BLOCK);
            let (largest, smallest) = (block.stretch[0][e], block.stretch[1][e]);
            inspection.distortion[element as usize] = relative_distortion(&[largest, smallest]);
            inspection.weights[element as usize] =
                (block.stiffness[0][e] / E::REST_STIFFNESS) as f32;
        }
        inspection
    }
}
