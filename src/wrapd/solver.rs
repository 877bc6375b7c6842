//! The iteration of algorithm 1.

mod global;
mod handles;

use super::block::{BLOCK, Block, BlockSums};
use super::elements::{Elements, Model, Shape};
use super::external::Terms;
use super::kernels::Pass;
use super::layout::element_order;
use super::setup::Setup;
use super::system::System;
use super::{Coupling, Problem, WrapdOptions};
use crate::energy::Energy;
use crate::geometry::Elimination;
use crate::optim::lbfgs::Lbfgs;
use crate::optim::{
    BuildError, Deformer, Field, Inspection, Phase, PhaseKind, SolveError, Solver, Status,
    StepReport, Stopwatch, Yardstick,
};
use crate::parallel;
use crate::space::Space;

/// Vertices that are gathered as one piece of work.
const VERTICES: usize = 1024;

/// By how much singular values may miss hard limits at convergence.
const LIMIT_SLACK: f64 = 1e-6;

/// ADMM on a splitting of F: WRAPD and its relatives, by coupling and energy.
pub struct Wrapd {
    options: WrapdOptions,
    shape: Shape,
    elements: Box<dyn Elements>,
    /// Σ A.
    measure: f64,
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
    /// Squares of the energy's gradient, summed a chunk of [`VERTICES`].
    squares: Vec<f64>,
    direction: Vec<f64>,
    /// Terms beside the elements.
    terms: Option<Terms>,
    system: System,
    history: Lbfgs,
    report: StepReport,
    /// The reported energy without its offset.
    energy: f64,
    yardstick: Yardstick,
    /// Iterations with the rest weights, for this start.
    delay: usize,
    /// No flips at the previous iterate?
    was_injective: bool,
    /// The iteration of the last change of handles, from which the most iterations are counted.
    counted_from: usize,
}

impl Wrapd {
    /// Analyses, factors and evaluates the start; all allocation happens here.
    ///
    /// # Errors
    /// Lengths that do not fit, options out of range, a start that is not finite, no pin.
    pub fn new<S: Space, C: Coupling<S>, E: Energy<S>>(
        problem: Problem,
        energy: E,
        options: WrapdOptions,
    ) -> Result<Self, BuildError> {
        let shape = Shape::of::<S, C, E>(&energy);
        let elements = Box::new(Model::<S, C>::new(energy));
        parallel::in_pool(|| Self::build(problem, shape, elements, options))
    }

    fn build(
        problem: Problem,
        shape: Shape,
        elements: Box<dyn Elements>,
        options: WrapdOptions,
    ) -> Result<Self, BuildError> {
        options.validate()?;
        let rest = problem.rest;
        let dimension = shape.dimension;
        let n = problem.start.len() / dimension;
        problem.validate(dimension, shape.stretches)?;

        let couplings = problem.external.map_or(&[][..], |e| &e.stiffness);
        let elimination = Elimination::with_couplings(rest, n, problem.pins, couplings);
        // from here on elements are in the order of their vertices' slots
        let order = element_order(rest, &elimination.slot);
        let rest = &rest.reordered(&order);
        let terms = problem.external.map(|external| {
            Terms::new(external, problem.start, &elimination.slot, elimination.free)
        });
        let Setup {
            system,
            blocks,
            corner_begin,
            corners,
        } = Setup::new(rest, &elimination, &shape, problem.external, terms.as_ref())?;
        let Elimination { slot, free, .. } = elimination;
        // forces of the coupling, then those of the energy
        let corners_per_block = 2 * (rest.stretches + 1) * dimension * BLOCK;
        let mut x = vec![0.0; problem.start.len()];
        for (v, &s) in slot.iter().enumerate() {
            let s = s as usize * dimension;
            x[s..s + dimension].copy_from_slice(&problem.start[v * dimension..(v + 1) * dimension]);
        }
        let unknowns = free * dimension;
        let measure: f64 = rest.measure.iter().sum();
        let yardstick = Yardstick {
            rounding: shape.constants.scale * terms.as_ref().map_or(0.0, |t| t.rounding),
            ..shape.constants.yardstick(measure, shape.stretches)
        };
        let mut this = Self {
            options,
            shape,
            elements,
            measure,
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
            squares: vec![0.0; free.div_ceil(VERTICES)],
            direction: vec![0.0; unknowns],
            terms,
            system,
            history: Lbfgs::new(options.history),
            report: StepReport::at_start(),
            energy: f64::INFINITY,
            yardstick,
            delay: 0,
            was_injective: false,
            counted_from: 0,
        };
        this.look();
        if let Some(r) = options.reweighting {
            let folded = 100 * this.report.inverted > rest.len();
            this.delay = if folded { r.delay_folded } else { r.delay };
        }
        if options.max_iterations == 0 {
            this.report.status = Status::MaxIterations;
        }
        Ok(this)
    }

    /// Evaluates positions that were not found by a step.
    fn look(&mut self) {
        let sums = self.pass(Pass::Last);
        self.gather(Pass::Last);
        self.evaluate(sums);
        if self.shape.barrier && self.report.inverted > 0 {
            // no Z belongs to these positions, whose energy could stand in
            (self.energy, self.report.energy) = (f64::INFINITY, f64::INFINITY);
        }
        self.was_injective = self.report.inverted == 0;
    }

    /// Runs one element pass over all blocks and adds up, in the blocks' order.
    fn pass(&mut self, pass: Pass) -> BlockSums {
        let chunk = self.block_forces(pass);
        if let (Some(terms), Pass::Forces | Pass::Last) = (&mut self.terms, pass) {
            terms.evaluate(&self.x);
        }
        let (x, elements, blocks) = (&self.x, &*self.elements, self.blocks.len());
        parallel::for_each_block(
            &mut self.blocks,
            &mut self.forces[..chunk * blocks],
            chunk,
            |_, block, forces| {
                block.sums = elements.pass(pass, block, x, forces);
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

    /// Length of a block's part of the force array in a pass.
    fn block_forces(&self, pass: Pass) -> usize {
        (self.shape.stretches + 1) * BLOCK * pass.stride(self.shape.dimension)
    }

    /// Adds the corner forces of the last pass up at the free vertices, into `next_gradient`. After a
    /// `Last` pass the norm of the energy's gradient goes into the report.
    fn gather(&mut self, pass: Pass) {
        match (self.shape.dimension, pass) {
            (2, Pass::Last) => self.gather_in::<2, 4>(),
            (2, _) => self.gather_in::<2, 2>(),
            (_, Pass::Last) => self.gather_in::<3, 6>(),
            (..) => self.gather_in::<3, 3>(),
        }
    }

    fn gather_in<const DIM: usize, const STRIDE: usize>(&mut self) {
        let forces = self.forces.as_chunks::<STRIDE>().0;
        let (begin, corners) = (&self.corner_begin, &self.corners);
        let external = self.terms.as_ref().map(|t| t.gradient.as_chunks::<DIM>().0);
        parallel::for_each_block(
            &mut self.squares,
            &mut self.next_gradient,
            VERTICES * DIM,
            |chunk, squares, out| {
                *squares = 0.0;
                for (local, g) in out.as_chunks_mut::<DIM>().0.iter_mut().enumerate() {
                    let v = chunk * VERTICES + local;
                    let mut sum = [0.0; STRIDE];
                    if let Some(external) = external {
                        sum[..DIM].copy_from_slice(&external[v]);
                        if STRIDE > DIM {
                            sum[DIM..].copy_from_slice(&external[v]);
                        }
                    }
                    for &corner in &corners[begin[v] as usize..begin[v + 1] as usize] {
                        for (sum, force) in sum.iter_mut().zip(&forces[corner as usize]) {
                            *sum += force;
                        }
                    }
                    g.copy_from_slice(&sum[..DIM]);
                    for energy in &sum[DIM..] {
                        *squares += energy * energy;
                    }
                }
            },
        );
        if STRIDE > DIM {
            let squared: f64 = self.squares.iter().sum();
            self.report.gradient_norm = self.shape.constants.scale * squared.sqrt();
        }
    }

    /// Fills the report from the sums of an evaluation.
    fn evaluate(&mut self, sums: BlockSums) {
        self.report.inverted = sums.inverted;
        self.report.smallest_sigma = sums.smallest;
        self.report.largest_sigma = sums.largest;
        let barrier_broken = self.shape.barrier && sums.inverted > 0;
        let sum = if barrier_broken {
            sums.z_energy
        } else {
            sums.f_energy
        };
        let external = self.terms.as_ref().map_or(0.0, |t| t.energy);
        let constants = &self.shape.constants;
        self.energy = constants.relative(sum + external, self.measure);
        self.report.energy = self.energy + constants.offset;
        if barrier_broken {
            self.report.gradient_norm = f64::INFINITY;
        }
    }

    /// Copies the positions by slot to those by vertex.
    fn publish(&mut self) {
        match self.shape.dimension {
            2 => self.copy_positions::<2>(),
            _ => self.copy_positions::<3>(),
        }
    }

    fn copy_positions<const DIM: usize>(&mut self) {
        let (slots, x) = (&self.slot, self.x.as_chunks::<DIM>().0);
        let positions = self.positions.as_chunks_mut::<DIM>().0;
        parallel::for_each_chunk(positions, VERTICES, |chunk, positions| {
            for (out, &slot) in positions.iter_mut().zip(&slots[chunk * VERTICES..]) {
                *out = x[slot as usize];
            }
        });
    }

    /// Takes over the candidate weights: U is scaled by w²/w_cand², A refactored, the history cleared.
    fn reweight(&mut self, iteration: usize) -> Result<(), SolveError> {
        parallel::for_each_chunk(&mut self.blocks, 1, |_, block| block[0].take_candidates());
        self.refactor(iteration)
    }

    /// Factors the matrix of the current weights and springs.
    fn refactor(&mut self, iteration: usize) -> Result<(), SolveError> {
        let blocks = &self.blocks;
        self.history.clear();
        self.system
            .factorize(self.terms.as_ref(), |e| {
                blocks[e / BLOCK].stiffness[0][e % BLOCK]
            })
            .map_err(|e| SolveError::NotPositiveDefinite {
                iteration,
                pivot: e.pivot,
            })
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        let begun = Stopwatch::start();
        let dimension = self.shape.dimension;
        let k = self.report.iteration;
        let before = self.energy;

        let clock = Stopwatch::start();
        let clamp = match self.options.reweighting {
            Some(r) if k >= self.delay => [r.least, r.most_at(k + 1 - self.delay)],
            _ => [1.0, 1.0],
        }
        .map(|beta| beta * self.shape.constants.rest_stiffness);
        let reset = k == 0 || (k == 1 && self.options.restart_duals);
        let threshold = self
            .options
            .reweighting
            .map_or(f64::INFINITY, |r| r.threshold);
        let pass = Pass::Local {
            clamp,
            threshold,
            reset,
        };
        let local = self.pass(pass);
        let local_phase = Phase::new(PhaseKind::Local, local.prox_iterations, clock);

        let clock = Stopwatch::start();
        let (count, mut sums) = self.global_step(pass, &local);
        let global_phase = Phase::new(PhaseKind::Global, count as u32, clock);

        let clock = Stopwatch::start();
        let reweighted = local.reweight;
        if reweighted {
            self.reweight(k + 1)?;
        }
        let reweight_phase = Phase::new(PhaseKind::Reweight, u32::from(reweighted), clock);

        let clock = Stopwatch::start();
        sums.z_energy = local.z_energy;
        // a vertex that is not finite makes the gradient so; only then is it looked for
        if !self.squares.iter().all(|s| s.is_finite()) {
            let bad = |&slot: &u32| {
                let slot = slot as usize * dimension;
                !self.x[slot..slot + dimension].iter().all(|x| x.is_finite())
            };
            if let Some(vertex) = self.slot.iter().position(bad) {
                return Err(SolveError::NonFinite {
                    iteration: k + 1,
                    vertex,
                });
            }
        }
        self.publish();
        self.evaluate(sums);
        let injective = self.report.inverted == 0;
        self.report.iteration = k + 1;
        self.report.lbfgs_iterations = if self.shape.linear { 0 } else { count };
        self.report.reweighted = reweighted;
        let [least, most] = self.shape.limits;
        let kept = self.report.smallest_sigma >= least - LIMIT_SLACK
            && self.report.largest_sigma <= most + LIMIT_SLACK;
        let met = self.yardstick.criterion(
            self.energy - before,
            self.energy,
            self.report.gradient_norm,
            self.options.tolerance,
        );
        let may = injective && self.was_injective && kept;
        let most = self.counted_from + self.options.max_iterations;
        self.report.conclude(met.filter(|_| may), most);
        self.was_injective = injective;
        self.report.seconds += begun.seconds();
        let evaluate_phase = Phase::new(PhaseKind::Evaluate, 1, clock);
        self.report.phases.clear();
        self.report
            .phases
            .extend([local_phase, global_phase, reweight_phase, evaluate_phase]);
        Ok(())
    }

    /// Entries of the Cholesky factor.
    pub fn factor_entries(&self) -> usize {
        self.system.factor.factor_entries()
    }
}

impl Solver for Wrapd {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        parallel::in_pool(|| self.iterate())?;
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.positions
    }
    fn dimension(&self) -> usize {
        self.shape.dimension
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        let rest = self.shape.constants.rest_stiffness;
        Inspection {
            distortion: self.field(Field::Distortion),
            weights: self.by_element(|block, e| (block.stiffness[0][e] / rest) as f32),
        }
    }
}
