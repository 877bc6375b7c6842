//! Energy and gradient of a map, block by block.

use super::noise::Noise;
use crate::geometry::{Elimination, RestShape};
use crate::optim::{Field, Yardstick};
use crate::parallel;
use crate::wrapd::block::{BLOCK, Block, BlockSums};
use crate::wrapd::elements::{Elements, Shape};
use crate::wrapd::external::Terms;
use crate::wrapd::kernels::Pass;
use crate::wrapd::layout::{build_blocks, corner_lists, element_order};
use crate::wrapd::system::System;

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
    /// Reported energy without its offset; infinite where a barrier is broken.
    pub energy: f64,
    /// Elements with σ_last ≤ 0.
    pub inverted: usize,
    /// Smallest signed singular value.
    pub smallest: f64,
    /// Largest singular value.
    pub largest: f64,
}

impl Evaluation {
    /// Of these loops over the elements, whose coupling is linear, on these rest shapes.
    pub fn new(
        shape: Shape,
        elements: Box<dyn Elements>,
        rest: &RestShape,
        elimination: &Elimination,
        terms: Option<Terms>,
    ) -> Self {
        let order = element_order(rest, &elimination.slot);
        let rest = &rest.reordered(&order);
        let blocks = build_blocks(rest, &elimination.slot, &shape);
        let (corner_begin, corners) = corner_lists(rest, &elimination.slot, elimination.free);
        let stride = Pass::Last.stride(shape.dimension);
        Self {
            shape,
            elements,
            measure: rest.measure.iter().sum(),
            order,
            forces: vec![0.0; (rest.stretches + 1) * BLOCK * stride * blocks.len()],
            blocks,
            corner_begin,
            corners,
            terms,
        }
    }

    /// What its energies and gradients are measured against.
    pub fn yardstick(&self) -> Yardstick {
        Yardstick {
            rounding: self.rounding_of_terms(),
            ..self
                .shape
                .constants
                .yardstick(self.measure, self.shape.stretches)
        }
    }

    /// What rounding leaves of its energies and gradients; the matrix is that of the weights at rest.
    pub fn noise(&self, system: &System) -> Noise {
        let constants = &self.shape.constants;
        Noise::new(
            self.order.len(),
            constants.scale * constants.rest_stiffness * self.measure,
            system.diagonal(),
            self.rounding_of_terms(),
        )
    }

    fn rounding_of_terms(&self) -> f64 {
        let rounding = self.terms.as_ref().map_or(0.0, |t| t.rounding);
        self.shape.constants.scale * rounding
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
                    constants.relative(elements + external, self.measure)
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
        let external = self.terms.as_ref().map(|t| t.gradient.as_chunks::<DIM>().0);
        self.add_corners::<DIM>(
            |v| external.map_or([0.0; DIM], |external| external[v]),
            |corner| &forces[corner][DIM..],
            gradient,
        );
    }

    /// Adds planar corner forces up at the free vertices.
    pub fn gather_planar(&self, forces: &[f64], out: &mut [f64]) {
        let forces = forces.as_chunks::<2>().0;
        self.add_corners::<2>(|_| [0.0; 2], |corner| &forces[corner], out);
    }

    /// Adds what corners have to what free vertices begin with.
    fn add_corners<'a, const DIM: usize>(
        &self,
        first: impl Fn(usize) -> [f64; DIM] + Sync + Send,
        of: impl Fn(usize) -> &'a [f64] + Sync + Send,
        out: &mut [f64],
    ) {
        let (begin, corners) = (&self.corner_begin, &self.corners);
        parallel::for_each_chunk(out, VERTICES * DIM, |chunk, out| {
            for (local, sum) in out.as_chunks_mut::<DIM>().0.iter_mut().enumerate() {
                let v = chunk * VERTICES + local;
                *sum = first(v);
                for &corner in &corners[begin[v] as usize..begin[v + 1] as usize] {
                    for (sum, force) in sum.iter_mut().zip(of(corner as usize)) {
                        *sum += force;
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
