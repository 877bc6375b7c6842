//! Assembly of symmetric matrices: the pattern once, the values often.

use super::graph::starts;
use crate::parallel;
use nalgebra_sparse::CscMatrix;
use nalgebra_sparse::pattern::SparsityPattern;

/// A symmetric matrix as a sum of small element matrices on a fixed pattern, of which the lower
/// triangle is stored.
///
/// Each stored entry knows the contributions that make it up, so that refilling the values needs no
/// search, can be done in parallel and adds in the same order always.
#[derive(Debug, Clone)]
pub struct SymmetricAssembly {
    /// Lower triangle, diagonal first in each column.
    pub(super) matrix: CscMatrix<f64>,
    /// Where each entry's contributions begin; length: entries + 1.
    pub(super) begin: Vec<u32>,
    /// The contributions, as indices into the list handed to `new`.
    pub(super) contribution: Vec<u32>,
}

impl SymmetricAssembly {
    /// The pattern of `triplets` (row, column), either triangle, on n×n. A contribution with
    /// row < column is mirrored, so (i, j) and (j, i) add up in one entry: give each once.
    /// Entries of a row or column ≥ n are left out (fixed unknowns). The diagonal is always stored.
    pub fn new(n: usize, triplets: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let inside = |(i, j): (u32, u32)| (i.max(j) as usize) < n;
        // counting sort by row, then by column: linear and independent of any hash
        let [mut of_row, mut of_column] = [vec![0u32; n + 1], vec![0u32; n + 1]];
        triplets.clone().for_each(|(i, j)| {
            if inside((i, j)) {
                of_row[i.max(j) as usize] += 1;
                of_column[i.min(j) as usize] += 1;
            }
        });
        let kept = starts(&mut of_row);
        starts(&mut of_column);
        // column and contribution by row
        let mut by_row = vec![(0u32, 0u32); kept];
        let mut next = of_row.clone();
        triplets.zip(0..).for_each(|((i, j), t)| {
            if inside((i, j)) {
                let slot = &mut next[i.max(j) as usize];
                by_row[*slot as usize] = (i.min(j), t);
                *slot += 1;
            }
        });
        // row and contribution by column
        let mut by_column = vec![(0u32, 0u32); kept];
        next.copy_from_slice(&of_column);
        for row in 0..n {
            for &(column, t) in &by_row[of_row[row] as usize..of_row[row + 1] as usize] {
                let slot = &mut next[column as usize];
                by_column[*slot as usize] = (row as u32, t);
                *slot += 1;
            }
        }

        let mut offsets = Vec::with_capacity(n + 1);
        let mut rows: Vec<usize> = Vec::new();
        let mut begin = vec![0u32];
        let mut contribution = Vec::with_capacity(kept);
        offsets.push(0);
        for column in 0..n {
            let mut last = column;
            rows.push(column);
            for &(row, t) in &by_column[of_column[column] as usize..of_column[column + 1] as usize]
            {
                if row as usize != last {
                    last = row as usize;
                    begin.push(contribution.len() as u32);
                    rows.push(last);
                }
                contribution.push(t);
            }
            begin.push(contribution.len() as u32);
            offsets.push(rows.len());
        }
        let entries = rows.len();
        let pattern = SparsityPattern::try_from_offsets_and_indices(n, n, offsets, rows)
            .expect("columns are sorted and within range by construction");
        let matrix = CscMatrix::try_from_pattern_and_values(pattern, vec![0.0; entries])
            .expect("one value an entry");
        Self {
            matrix,
            begin,
            contribution,
        }
    }

    /// The matrix: its lower triangle by columns.
    pub fn matrix(&self) -> &CscMatrix<f64> {
        &self.matrix
    }

    /// Sets every entry to the sum of `value(contribution)` over its contributions, in the order in
    /// which they were given to `new`.
    pub fn fill(&mut self, value: impl Fn(usize) -> f64) {
        for (entry, target) in self.matrix.values_mut().iter_mut().enumerate() {
            let range = self.begin[entry] as usize..self.begin[entry + 1] as usize;
            *target = self.contribution[range]
                .iter()
                .fold(0.0, |sum, &c| sum + value(c as usize));
        }
    }
}

/// A matrix Σ_e w_e K_e with constant element matrices K_e and varying scalar weights w_e: the
/// system matrix (5a) of ADMM.
#[derive(Debug, Clone)]
pub struct WeightedSum {
    assembly: SymmetricAssembly,
    /// Coefficient and element of each contribution, in the assembly's order.
    coefficient: Vec<(f64, u32)>,
}

impl WeightedSum {
    /// From the contributions (row, column, element, coefficient); rules as in
    /// [`SymmetricAssembly::new`].
    pub fn new(n: usize, contributions: &[(u32, u32, u32, f64)]) -> Self {
        let mut assembly =
            SymmetricAssembly::new(n, contributions.iter().map(|&(i, j, _, _)| (i, j)));
        let coefficient = assembly
            .contribution
            .iter()
            .map(|&c| {
                let (_, _, element, k) = contributions[c as usize];
                (k, element)
            })
            .collect();
        // from here on contributions are numbered in the order in which they are read
        assembly.contribution = Vec::new();
        Self {
            assembly,
            coefficient,
        }
    }

    /// The matrix: its lower triangle by columns.
    pub fn matrix(&self) -> &CscMatrix<f64> {
        self.assembly.matrix()
    }

    /// Sets the values for these element weights.
    pub fn fill(&mut self, weights: impl Fn(usize) -> f64 + Sync + Send) {
        const CHUNK: usize = 4096;
        let (begin, coefficient) = (&self.assembly.begin, &self.coefficient);
        let values = self.assembly.matrix.values_mut();
        parallel::for_each_chunk(values, CHUNK, |chunk, values| {
            for (local, target) in values.iter_mut().enumerate() {
                let entry = chunk * CHUNK + local;
                let range = begin[entry] as usize..begin[entry + 1] as usize;
                *target = coefficient[range].iter().fold(0.0, |sum, &(k, element)| {
                    sum + k * weights(element as usize)
                });
            }
        });
    }
}
