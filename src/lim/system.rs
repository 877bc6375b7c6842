//! The matrix of a step and the search for μ (paper, 4 and its appendix).

use super::constraints::Constraints;
use super::objective::Objective;
use crate::geometry::Elimination;
use crate::linalg::{BlockSum, Supernodes};
use crate::newton::curvature::stride;
use crate::optim::BuildError;

/// The first μ that is tried, of a body scaled to a measure of 1, where the matrix is not positive definite.
const MU: f64 = 0.1;

/// From one to the next; and back, for the next step, after one that served at once.
const GROWTH: f64 = 10.0;

/// The least and the largest.
const LIMITS: [f64; 2] = [1e-5, 1e17];

/// ∇² of the objective + μ I, and its factor.
pub struct LimSystem {
    matrix: BlockSum,
    factor: Supernodes,
    blocks: Vec<f64>,
    diagonal: Vec<f64>,
    /// The μ to begin with where one is needed.
    remembered: f64,
}

impl LimSystem {
    /// Pattern and symbolic factor. `form` are the entries of a quadratic form.
    pub fn new(
        objective: &Objective,
        dimension: usize,
        elimination: &Elimination,
        form: &[(u32, u32, f64)],
    ) -> Result<Self, BuildError> {
        let corners = dimension + 1;
        let elements = objective.elements.corners().chunks_exact(corners);
        let count = elements.len();
        let pairs: Vec<(u32, u32)> = elements
            .flat_map(|slots| {
                (0..corners).flat_map(move |u| (0..=u).map(move |v| (slots[u], slots[v])))
            })
            .collect();
        let slot = &elimination.slot;
        let form = form.iter();
        let form = form.map(|&(a, b, k)| (slot[a as usize], slot[b as usize], k));
        let matrix = BlockSum::new(elimination.free, dimension, &pairs, form);
        Ok(Self {
            factor: Supernodes::analyze(matrix.matrix())?,
            matrix,
            blocks: vec![0.0; count * stride(dimension)],
            diagonal: vec![0.0; elimination.free],
            remembered: MU,
        })
    }

    /// Sets the values at x, with rows and columns of the identity where vertices are held.
    pub fn assemble(
        &mut self,
        objective: &Objective,
        constraints: &Constraints,
        x: &[f64],
        kept: f64,
    ) {
        objective
            .elements
            .hessian(objective.law, x, kept, &mut self.blocks);
        constraints.diagonal(&mut self.diagonal);
        let diagonal = &self.diagonal;
        self.matrix.fill(&self.blocks, |v| diagonal[v]);
        self.matrix.hold(&constraints.held);
    }

    /// The mean diagonal entry of each slot.
    pub fn mean_diagonal(&self, out: &mut [f64]) {
        self.matrix.mean_diagonal(out);
    }

    /// Factors the matrix as it is; does that succeed?
    pub fn factorize_as_is(&mut self) -> bool {
        self.factor.factorize(self.matrix.matrix()).is_ok()
    }

    /// Factors the matrix, adding μ I until it is positive definite, at first nothing, unless `at_least` is
    /// above 0. `unit` is 1 in the units of the matrix. Returns μ, or none where the largest does not serve; and
    /// how many were tried.
    pub fn factorize(&mut self, at_least: f64, unit: f64) -> (Option<f64>, u32) {
        let (mut mu, mut tries) = (at_least, 1);
        let mut added = 0.0;
        loop {
            if mu > added {
                let more = (mu - added) * unit;
                self.matrix.add_to_diagonal(|_| more);
                added = mu;
            }
            if self.factor.factorize(self.matrix.matrix()).is_ok() {
                if tries == 1 || tries == 2 && at_least == 0.0 {
                    self.remembered = (self.remembered / GROWTH).max(LIMITS[0]);
                }
                return (Some(mu), tries);
            }
            if mu >= LIMITS[1] {
                return (None, tries);
            }
            mu = match mu > 0.0 {
                true => mu * GROWTH,
                false => self.remembered,
            };
            self.remembered = mu.min(LIMITS[1]);
            tries += 1;
        }
    }

    /// A larger μ than one that led nowhere,
    pub fn larger(&self, mu: f64) -> f64 {
        (mu * GROWTH).max(self.remembered)
    }

    /// and the largest.
    pub fn most(&self) -> f64 {
        LIMITS[1]
    }

    /// Solves in place.
    pub fn solve(&mut self, x: &mut [f64]) {
        self.factor.solve_in_place(x);
    }
}
