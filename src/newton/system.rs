//! The matrix of a step and its factor.

use super::NewtonOptions;
use super::curvature::{Curvature, Share, stride};
use crate::geometry::{Elimination, RestShape};
use crate::linalg::{BlockSum, NotPositiveDefinite, Supernodes};
use crate::optim::BuildError;
use crate::parallel;
use crate::quasi_newton::evaluation::Evaluation;
use crate::wrapd::External;
use crate::wrapd::block::{BLOCK, Row};

/// By how much a shift that was too small grows,
const GROWTH: f64 = 100.0;

/// and by how much one that was not shrinks for the next step.
const DECAY: f64 = 0.1;

/// Σ A GᵀHG over the elements, terms beside them, a proximal term, and a shift that makes it definite.
pub struct NewtonSystem {
    matrix: BlockSum,
    factor: Supernodes,
    /// The elements' blocks, see [`Curvature::fill`].
    blocks: Vec<f64>,
    /// Mean diagonal entry of each vertex, without shift.
    diagonal: Vec<f64>,
    /// The same of a linear elasticity at rest.
    rest_diagonal: Vec<f64>,
    /// Added to the diagonal of all vertices.
    proximal: f64,
    /// Relative to the diagonal: what it is, what is in the matrix, and the least.
    shift: f64,
    least_shift: f64,
}

impl NewtonSystem {
    /// Pattern and symbolic factor.
    pub fn new(
        rest: &RestShape,
        elimination: &Elimination,
        external: Option<&External>,
        evaluation: &Evaluation,
        proximal: f64,
        options: &NewtonOptions,
    ) -> Result<Self, BuildError> {
        let d = evaluation.shape.dimension;
        let corners = evaluation.shape.stretches + 1;
        let elements = evaluation.elements();
        let mut pairs = Vec::with_capacity(elements * corners * (corners + 1) / 2);
        for place in 0..elements {
            let slots = &evaluation.blocks[place / BLOCK].vertices;
            let slot = |v: usize| slots[v][place % BLOCK];
            pairs.extend((0..corners).flat_map(|u| (0..=u).map(move |v| (slot(u), slot(v)))));
        }
        let slot = &elimination.slot;
        let couplings = external.map_or(&[][..], |e| &e.stiffness).iter();
        let couplings = couplings.map(|&(a, b, k)| (slot[a as usize], slot[b as usize], k));
        let matrix = BlockSum::new(elimination.free, d, &pairs, couplings);
        let mut rest_diagonal = vec![0.0; elimination.free];
        let stiffness = evaluation.shape.constants.rest_stiffness;
        for e in 0..rest.len() {
            for (v, &vertex) in rest.simplex(e).iter().enumerate() {
                if let Some(entry) = rest_diagonal.get_mut(slot[vertex as usize] as usize) {
                    *entry += stiffness * rest.measure[e] * rest.hat_product(e, v, v);
                }
            }
        }
        // vertices of no element, which nothing moves
        let mean = rest_diagonal.iter().sum::<f64>() / rest_diagonal.len().max(1) as f64;
        rest_diagonal
            .iter_mut()
            .filter(|d| **d == 0.0)
            .for_each(|d| *d = mean);
        Ok(Self {
            factor: Supernodes::analyze(matrix.matrix())?,
            matrix,
            // written, so that the first step does not wait for its memory
            blocks: vec![1.0; evaluation.blocks.len() * BLOCK * stride(d)],
            diagonal: vec![0.0; elimination.free],
            rest_diagonal,
            proximal,
            shift: 0.0,
            least_shift: options.shift,
        })
    }

    /// Sets the values at the F of the last evaluation; `unbalanced`, where elements turn, is that of
    /// [`super::turns`].
    pub fn assemble(
        &mut self,
        evaluation: &Evaluation,
        curvature: &dyn Curvature,
        unbalanced: Option<&[Row]>,
        share: Share,
    ) {
        let d = evaluation.shape.dimension;
        let elements = evaluation.elements();
        let blocks = &evaluation.blocks;
        parallel::for_each_chunk(&mut self.blocks, BLOCK * stride(d), |i, out| {
            let count = BLOCK.min(elements - i * BLOCK);
            match unbalanced {
                Some(rows) => curvature.fill_turning(&blocks[i], &rows[i], count, share, out),
                None => curvature.fill(&blocks[i], count, share.negative, out),
            }
        });
        let springs = evaluation.terms.as_ref().map(|t| &t.spring_stiffness);
        let proximal = self.proximal;
        let diagonal = |v: usize| proximal + springs.map_or(0.0, |springs| springs[v]);
        self.matrix.fill(&self.blocks, diagonal);
        self.matrix.mean_diagonal(&mut self.diagonal);
        self.shift = 0.0;
    }

    /// Factors the matrix with a shift that is no less than `at_least`, and large enough. Returns how many
    /// were tried.
    ///
    /// # Errors
    /// The pivot, where no shift below the diagonal itself was: the values are not finite.
    pub fn factorize(&mut self, at_least: f64) -> Result<u32, NotPositiveDefinite> {
        let mut wanted = at_least.max(self.least_shift);
        let mut count = 0;
        loop {
            count += 1;
            let more = wanted - self.shift;
            let (diagonal, rest) = (&self.diagonal, &self.rest_diagonal);
            self.matrix
                .add_to_diagonal(|v| more * diagonal[v].max(rest[v]));
            self.shift = wanted;
            match self.factor.factorize(self.matrix.matrix()) {
                Ok(()) => return Ok(count),
                Err(error) if wanted >= 1.0 => return Err(error),
                Err(_) => wanted = (wanted * GROWTH).min(1.0),
            }
        }
    }

    /// Factors the matrix as it is, but for the least shift and, where the plane can turn about a vertex,
    /// for a stiffness against moving one vertex along the given vector. Succeeds only if the result is
    /// positive definite.
    pub fn factorize_as_is(
        &mut self,
        held: &[(usize, [f64; 2])],
    ) -> Result<(), NotPositiveDefinite> {
        let shift = self.least_shift;
        let (diagonal, rest) = (&self.diagonal, &self.rest_diagonal);
        self.matrix
            .add_to_diagonal(|v| shift * diagonal[v].abs().max(rest[v]));
        for &(vertex, along) in held {
            let stiffness = diagonal[vertex].abs().max(rest[vertex]);
            self.matrix.add_product(vertex, along, stiffness);
        }
        self.shift = shift;
        self.factor.factorize(self.matrix.matrix())
    }

    /// The shift of the last factor,
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// a larger one for another attempt,
    pub fn larger_shift(&self) -> f64 {
        self.shift * GROWTH
    }

    /// and where the next step may begin.
    pub fn next_shift(&self) -> f64 {
        self.shift * DECAY
    }

    /// Solves in place: free vertices × dimension.
    pub fn solve(&mut self, x: &mut [f64]) {
        self.factor.solve_in_place(x);
    }
}
