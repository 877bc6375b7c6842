//! Energy and gradient of a map, block by block.

use crate::energy::Energy;
use crate::geometry::{Elimination, RestShape};
use crate::optim::Field;
use crate::parallel;
use crate::space::Space;
use crate::wrapd::Linear;
use crate::wrapd::block::{BLOCK, Block, BlockSums};
use crate::wrapd::elements::{Elements, Model, Shape};
use crate::wrapd::external::Terms;
use crate::wrapd::kernels::Pass;
use crate::wrapd::layout::{build_blocks, corner_lists, element_order};

/// Vertices that are gathered as one piece of work.
const VERTICES: usize = 1024;

/// The elements of a map with what evaluating them needs: the kernels of ADMM-PD, of whose last pass
/// only the energy's part is used, so that no others need be compiled.
pub struct Evaluation {
    pub shape: Shape,
    elements: Box<dyn Elements>,
    /// Σ A.
    measure: f64,
    /// The element at each place of the blocks.
    order: Vec<u32>,
    /// The elements; F and its singular values are those of the last evaluation.
    pub blocks: Vec<Block>,
    forces: Vec<f64>,
    corner_begin: Vec<u32>,
    corners: Vec<u32>,
    /// Terms beside the elements.
    pub terms: Option<Terms>,
}

/// What an evaluation finds beside the gradient.
#[derive(Debug, Clone, Copy)]
pub struct Value {
    /// Reported energy; infinite where a barrier is broken.
    pub energy: f64,
    /// Elements with σ_last ≤ 0.
    pub inverted: usize,
    /// Smallest signed singular value.
    pub smallest: f64,
    /// Largest singular value.
    pub largest: f64,
}

impl Evaluation {
    /// Of this energy on these rest shapes.
    pub fn new<S: Space, E: Energy<S>>(
        energy: E,
        rest: &RestShape,
        elimination: &Elimination,
        terms: Option<Terms>,
    ) -> Self {
        let shape = Shape::of::<S, Linear, E>(&energy);
        let order = element_order(rest, &elimination.slot);
        let rest = &rest.reordered(&order);
        let blocks = build_blocks(rest, &elimination.slot, &shape);
        let (corner_begin, corners) = corner_lists(rest, &elimination.slot, elimination.free);
        let stride = Pass::Last.stride(shape.dimension);
        Self {
            shape,
            elements: Box::new(Model::<S, Linear>::new(energy)),
            measure: rest.measure.iter().sum(),
            order,
            forces: vec![0.0; (rest.stretches + 1) * BLOCK * stride * blocks.len()],
            blocks,
            corner_begin,
            corners,
            terms,
        }
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.order.len()
    }

    /// At positions by slot; the raw energy's gradient goes to `gradient` (free vertices × dimension).
    pub fn at(&mut self, x: &[f64], gradient: &mut [f64]) -> Value {
        let chunk = self.forces.len() / self.blocks.len();
        if let Some(terms) = &mut self.terms {
            terms.evaluate(x);
        }
        let elements = &*self.elements;
        parallel::for_each_block(
            &mut self.blocks,
            &mut self.forces,
            chunk,
            |_, block, forces| {
                block.sums = elements.pass(Pass::Last, block, x, forces);
            },
        );
        match self.shape.dimension {
            2 => self.gather::<2, 4>(gradient),
            _ => self.gather::<3, 6>(gradient),
        }
        let sums = || {
            self.blocks
                .iter()
                .map(|b: &Block| -> &BlockSums { &b.sums })
        };
        let constants = &self.shape.constants;
        let inverted = sums().map(|s| s.inverted).sum();
        Value {
            energy: match self.shape.barrier && inverted > 0 {
                true => f64::INFINITY,
                false => {
                    let external = self.terms.as_ref().map_or(0.0, |t| t.energy);
                    let elements: f64 = sums().map(|s| s.f_energy).sum();
                    constants.reported(elements + external, self.measure)
                }
            },
            inverted,
            smallest: sums().map(|s| s.smallest).fold(f64::INFINITY, f64::min),
            largest: sums().map(|s| s.largest).fold(0.0, f64::max),
        }
    }

    /// Adds the energy's corner forces, which follow those of the coupling, up at the free vertices.
    fn gather<const DIM: usize, const STRIDE: usize>(&self, gradient: &mut [f64]) {
        let forces = self.forces.as_chunks::<STRIDE>().0;
        let (begin, corners) = (&self.corner_begin, &self.corners);
        let external = self.terms.as_ref().map(|t| t.gradient.as_chunks::<DIM>().0);
        parallel::for_each_chunk(gradient, VERTICES * DIM, |chunk, out| {
            for (local, g) in out.as_chunks_mut::<DIM>().0.iter_mut().enumerate() {
                let v = chunk * VERTICES + local;
                *g = external.map_or([0.0; DIM], |external| external[v]);
                for &corner in &corners[begin[v] as usize..begin[v + 1] as usize] {
                    for (g, force) in g.iter_mut().zip(&forces[corner as usize][DIM..]) {
                        *g += force;
                    }
                }
            }
        });
    }

    /// The value of a field at each element at the last evaluation.
    pub fn field(&self, field: Field) -> Vec<f32> {
        let mut out = vec![0.0; self.order.len()];
        for (place, &element) in self.order.iter().enumerate() {
            let (block, e) = (&self.blocks[place / BLOCK], place % BLOCK);
            out[element as usize] = self.elements.field(block, e, field);
        }
        out
    }
}
