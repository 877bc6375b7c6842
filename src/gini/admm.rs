//! The primary solver (§4): local steps, the Laplacian, and energies, on the element loops of `wrapd` with a linear
//! coupling.

use super::dual::Primal;
use crate::energy::Energy;
use crate::geometry::{Elimination, RestShape};
use crate::optim::{BuildError, Field};
use crate::parallel;
use crate::space::Space;
use crate::wrapd::Linear;
use crate::wrapd::block::{BLOCK, Block, BlockSums};
use crate::wrapd::elements::{Elements, Model, Shape};
use crate::wrapd::external::{External, Terms};
use crate::wrapd::kernels::Pass;
use crate::wrapd::setup::Setup;
use crate::wrapd::system::System;

/// Vertices that are gathered as one piece of work.
const VERTICES: usize = 1024;

/// The energy of a body, as far as the solver knows its type.
pub struct Body {
    /// Numbers of space and energy.
    pub shape: Shape,
    elements: Box<dyn Elements>,
}

impl Body {
    /// Of this energy.
    pub fn new<S: Space, E: Energy<S>>(energy: E) -> Self {
        Self {
            shape: Shape::of::<S, Linear, E>(&energy),
            elements: Box::new(Model::<S, Linear>::new(energy)),
        }
    }
}

/// What an evaluation finds.
#[derive(Debug, Clone, Copy)]
pub struct Value {
    /// The reported energy; infinite where a barrier is broken.
    pub energy: f64,
    /// Norm of its gradient.
    pub gradient_norm: f64,
    /// Smallest signed singular value.
    pub smallest: f64,
    /// Largest singular value.
    pub largest: f64,
    /// Elements with σ_last ≤ 0.
    pub inverted: usize,
}

/// Z, U and the prefactored system.
pub struct Admm {
    body: Body,
    measure: f64,
    /// The element at each place.
    order: Vec<u32>,
    blocks: Vec<Block>,
    forces: Vec<f64>,
    corner_begin: Vec<u32>,
    corners: Vec<u32>,
    terms: Terms,
    /// A (7a) and its factor.
    system: System,
    /// Mean of 1/Aᵢᵢ.
    compliance: f64,
    gradient: Vec<f64>,
}

impl Admm {
    /// Analyses and factors. `rest` is in the order of memory, `order` says which elements those are.
    pub fn new(
        body: Body,
        rest: &RestShape,
        order: Vec<u32>,
        elimination: &Elimination,
        start: &[f64],
        external: &External,
    ) -> Result<Self, BuildError> {
        let shape = body.shape;
        let terms = Terms::new(external, start, &elimination.slot, elimination.free);
        let Setup {
            system,
            blocks,
            corner_begin,
            corners,
        } = Setup::new(rest, elimination, &shape, Some(external), Some(&terms))?;
        let stride = Pass::Last.stride(shape.dimension);
        let diagonal = system.diagonal();
        let compliance = diagonal.map(f64::recip).sum::<f64>() / elimination.free.max(1) as f64;
        Ok(Self {
            compliance,
            measure: rest.measure.iter().sum(),
            order,
            forces: vec![0.0; (rest.stretches + 1) * BLOCK * stride * blocks.len()],
            blocks,
            corner_begin,
            corners,
            terms,
            system,
            gradient: vec![0.0; elimination.free * shape.dimension],
            body,
        })
    }

    /// The local step (5a), (5b) at these positions by slot, and b − A x̄ into `out`; with `reset` U is 0 before.
    /// Returns the most prox iterations.
    pub fn local_step<const D: usize>(
        &mut self,
        x: &[[f64; D]],
        reset: bool,
        out: &mut [[f64; D]],
    ) -> u32 {
        let k = self.body.shape.constants.rest_stiffness;
        self.pass(Pass::Forces, x.as_flattened());
        let sums = self.pass(
            Pass::Local {
                clamp: [k, k],
                threshold: f64::INFINITY,
                reset,
            },
            x.as_flattened(),
        );
        self.terms.evaluate(x.as_flattened());
        self.gather::<D, D>();
        for (out, g) in out.as_flattened_mut().iter_mut().zip(&self.gradient) {
            *out = -g;
        }
        sums.prox_iterations
    }

    /// Energy and gradient at these positions.
    pub fn evaluate<const D: usize>(&mut self, x: &[[f64; D]]) -> Value {
        let sums = self.pass(Pass::Last, x.as_flattened());
        self.terms.evaluate(x.as_flattened());
        let squares = match D {
            2 => self.gather::<2, 4>(),
            _ => self.gather::<3, 6>(),
        };
        let constants = &self.body.shape.constants;
        let broken = self.body.shape.barrier && sums.inverted > 0;
        let energy = constants.reported(sums.f_energy + self.terms.energy, self.measure);
        let norm = constants.scale * squares.sqrt();
        Value {
            energy: if broken { f64::INFINITY } else { energy },
            gradient_norm: if broken { f64::INFINITY } else { norm },
            smallest: sums.smallest,
            largest: sums.largest,
            inverted: sums.inverted,
        }
    }

    /// What the global step solves with.
    pub fn primal(&mut self) -> Primal<'_> {
        Primal {
            factor: &mut self.system.factor,
            compliance: self.compliance,
        }
    }

    /// A field at the positions of the last evaluation, in the input's order.
    pub fn field(&self, field: Field) -> Vec<f32> {
        let mut out = vec![0.0; self.order.len()];
        for (place, &element) in self.order.iter().enumerate() {
            let (block, e) = (&self.blocks[place / BLOCK], place % BLOCK);
            out[element as usize] = self.body.elements.field(block, e, field);
        }
        out
    }

    fn pass(&mut self, pass: Pass, x: &[f64]) -> BlockSums {
        let shape = &self.body.shape;
        let chunk = (shape.stretches + 1) * BLOCK * pass.stride(shape.dimension);
        let (elements, blocks) = (&*self.body.elements, self.blocks.len());
        parallel::for_each_block(
            &mut self.blocks,
            &mut self.forces[..chunk * blocks],
            chunk,
            |_, block, forces| block.sums = elements.pass(pass, block, x, forces),
        );
        let mut total = BlockSums {
            smallest: f64::INFINITY,
            ..Default::default()
        };
        for s in self.blocks.iter().map(|b| &b.sums) {
            total.f_energy += s.f_energy;
            total.inverted += s.inverted;
            total.smallest = total.smallest.min(s.smallest);
            total.largest = total.largest.max(s.largest);
            total.prox_iterations = total.prox_iterations.max(s.prox_iterations);
        }
        total
    }

    /// Adds the corner forces of the last pass and the springs' up at the free vertices: those of the coupling, or,
    /// where a corner has both, those of the energy. Returns the sum of their squares.
    fn gather<const D: usize, const STRIDE: usize>(&mut self) -> f64 {
        let forces = self.forces.as_chunks::<STRIDE>().0;
        let (begin, corners) = (&self.corner_begin, &self.corners);
        let external = self.terms.gradient.as_chunks::<D>().0;
        let mut squares = vec![0.0; (self.gradient.len() / D).div_ceil(VERTICES)];
        parallel::for_each_block(
            &mut squares,
            &mut self.gradient,
            VERTICES * D,
            |chunk, square, out| {
                for (local, sum) in out.as_chunks_mut::<D>().0.iter_mut().enumerate() {
                    let v = chunk * VERTICES + local;
                    *sum = external[v];
                    for &corner in &corners[begin[v] as usize..begin[v + 1] as usize] {
                        let force = &forces[corner as usize][STRIDE - D..];
                        for (sum, force) in sum.iter_mut().zip(force) {
                            *sum += force;
                        }
                    }
                    *square += sum.iter().map(|g| g * g).sum::<f64>();
                }
            },
        );
        squares.iter().sum()
    }
}
