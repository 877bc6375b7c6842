//! The system matrix: (5a), and the terms beside the elements.

use super::external::{External, Terms};
use crate::geometry::{Elimination, RestShape};
use crate::linalg::{Cholesky, NotPositiveDefinite, WeightedSum};
use crate::optim::BuildError;

/// Σ A k DᵀD over the elements, B, and the springs, with its factor.
pub struct System {
    elements: usize,
    matrix: WeightedSum,
    /// The factor of the last [`Self::factorize`].
    pub factor: Cholesky,
}

impl System {
    /// Pattern and symbolic factor; springs may come to any free vertex where there are external terms.
    pub fn new(
        rest: &RestShape,
        elimination: &Elimination,
        external: Option<&External>,
    ) -> Result<Self, BuildError> {
        let mut contributions = elimination.laplacian(rest);
        if let Some(external) = external {
            let constant = rest.len() as u32;
            let slot = |v: u32| elimination.slot[v as usize];
            let coupled = external.stiffness.iter();
            contributions.extend(coupled.map(|&(a, b, k)| (slot(a), slot(b), constant, k)));
            let free = 0..elimination.free as u32;
            contributions.extend(free.map(|s| (s, s, constant + 1 + s, 1.0)));
        }
        let matrix = WeightedSum::new(elimination.free, &contributions);
        Ok(Self {
            elements: rest.len(),
            factor: Cholesky::analyze(matrix.matrix(), &elimination.levels)?,
            matrix,
        })
    }

    /// The diagonal of the matrix.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> {
        // the first entry of each column of the lower triangle
        let columns = self.matrix.matrix().col_iter();
        columns.filter_map(|column| column.values().first().copied())
    }

    /// Fills and factors the matrix of these stiffnesses k, one an element.
    pub fn factorize(
        &mut self,
        terms: Option<&Terms>,
        stiffness: impl Fn(usize) -> f64 + Sync + Send,
    ) -> Result<(), NotPositiveDefinite> {
        let elements = self.elements;
        self.matrix.fill(|e| match (e < elements, terms) {
            (true, _) => stiffness(e),
            (false, Some(terms)) if e > elements => terms.spring_stiffness[e - elements - 1],
            _ => 1.0,
        });
        self.factor.factorize(self.matrix.matrix())
    }
}
