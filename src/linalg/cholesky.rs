//! Sparse Cholesky for many solves with one factor.
//!
//! The factor is computed by [`Supernodes`], and copied without their padding zeros into panels, which are
//! fastest to solve with when, as on surfaces, supernodes are small.

use nalgebra_sparse::CscMatrix;

use super::panels::{Panels, ROWS};
use super::supernodes::{NotPositiveDefinite, Supernodes};
use super::triangular::Factor;
use crate::optim::BuildError;
use crate::parallel;

/// The factor L Lᵀ of a symmetric matrix with a fixed pattern.
pub struct Cholesky {
    supernodes: Supernodes,
    /// L for the solves, without the supernodes' zeros.
    panels: Panels,
    values: Vec<f64>,
    /// For each of these values where it is in the supernodes, the last of which is a zero.
    source: Vec<u32>,
    /// Reciprocal diagonal, and where it is in `values`.
    inverse_diagonal: Vec<f64>,
    diagonal: Vec<u32>,
    /// What the parts add to later levels in a solve: room for three right-hand sides.
    work: Vec<f64>,
}

impl Cholesky {
    /// Analyses the pattern of `lower` (lower triangle, unknowns in elimination order).
    ///
    /// `levels` are those of the order (or empty).
    ///
    /// # Errors
    /// `TooLarge` before the factor is allocated, if a 32-bit memory cannot hold it.
    pub fn analyze(lower: &CscMatrix<f64>, levels: &[Vec<usize>]) -> Result<Self, BuildError> {
        let n = lower.ncols();
        let upper = lower.transpose();
        let (supernodes, panels) = parallel::join(
            || Supernodes::of_upper(&upper),
            || Panels::new(&upper, levels),
        );
        let supernodes = supernodes?;
        let source = sources(&supernodes, &panels);
        let diagonal = panels.diagonal();
        Ok(Self {
            supernodes,
            values: vec![1.0; panels.values],
            source,
            inverse_diagonal: vec![0.0; n],
            diagonal,
            work: vec![0.0; 3 * panels.work()],
            panels,
        })
    }

    /// Number of unknowns.
    pub fn dimension(&self) -> usize {
        self.inverse_diagonal.len()
    }

    /// Number of stored entries of L.
    pub fn factor_entries(&self) -> usize {
        self.panels.entries
    }

    /// Factors `lower`, whose pattern must be the analysed one. Allocates nothing.
    ///
    /// # Errors
    /// The first pivot that is not positive; the factor is then unusable until the next success.
    pub fn factorize(&mut self, lower: &CscMatrix<f64>) -> Result<(), NotPositiveDefinite> {
        self.supernodes.factorize(lower)?;
        self.copy_panels();
        Ok(())
    }

    /// Copies the supernodes into panels, dropping their padding.
    fn copy_panels(&mut self) {
        const CHUNK: usize = 1 << 15;
        let (blocks, source) = (self.supernodes.values(), &self.source[..]);
        parallel::for_each_chunk(&mut self.values, CHUNK, |chunk, values| {
            let source = &source[chunk * CHUNK..][..values.len()];
            for (value, &at) in values.iter_mut().zip(source) {
                *value = blocks[at as usize];
            }
        });
        for (inverse, &at) in self.inverse_diagonal.iter_mut().zip(&self.diagonal) {
            *inverse = self.values[at as usize].recip();
        }
    }

    /// The reciprocal diagonal of L.
    pub fn inverse_diagonal(&self) -> &[f64] {
        &self.inverse_diagonal
    }

    /// The most entries that a row of L has, and all entries of L.
    pub fn row_entries(&self) -> (usize, usize) {
        let mut count = vec![0usize; self.dimension()];
        self.panels.for_each_entry(0, |row, _, _| count[row] += 1);
        let widest = count.iter().copied().max().unwrap_or(0);
        (widest, self.factor_entries())
    }

    /// The last `k` rows and columns of L, row by row (k×k, zeros above the diagonal): the factor of the
    /// Schur complement of the unknowns before them.
    pub fn trailing(&self, k: usize) -> Vec<f64> {
        let first = self.dimension() - k;
        let mut dense = vec![0.0; k * k];
        self.panels.for_each_entry(first, |row, column, place| {
            dense[(row - first) * k + column - first] = self.values[place];
        });
        dense
    }

    /// Solves A X = B in place for `columns` right-hand sides (1, 2 or 3), interleaved: n × columns,
    /// row by row.
    pub fn solve_in_place(&mut self, x: &mut [f64], columns: usize) {
        let factor = Factor {
            panels: &self.panels,
            values: &self.values,
            inverse_diagonal: &self.inverse_diagonal,
        };
        match columns {
            1 => factor.solve::<1>(x.as_chunks_mut().0, &mut self.work),
            2 => factor.solve::<2>(x.as_chunks_mut().0, &mut self.work),
            3 => factor.solve::<3>(x.as_chunks_mut().0, &mut self.work),
            _ => unreachable!("one to three right-hand sides, not {columns}"),
        }
    }
}

/// Where each value of the panels is in faer's supernodes; the zeros that fill up are at the end.
fn sources(supernodes: &Supernodes, panels: &Panels) -> Vec<u32> {
    let n = supernodes.dimension();
    if n == 0 {
        return Vec::new();
    }
    let fill = supernodes.values().len() as u32 - 1;
    let blocks = supernodes.blocks();
    let begin = blocks.supernode_begin();
    // of the supernode `node`, whose columns end at `end`: where each row is in them
    let mut place = vec![0u32; n];
    let (mut node, mut end, mut height) = (0, 0, 0);
    let mut sources = Vec::with_capacity(panels.values);
    for panel in &panels.panels {
        // a panel is within a supernode
        let first = panel.first as usize;
        if first >= end {
            node = begin.partition_point(|&b| b <= first) - 1;
            end = blocks.supernode_end()[node];
            let pattern = blocks.supernode(node).pattern();
            for (row, k) in (begin[node]..end).chain(pattern.iter().copied()).zip(0..) {
                place[row] = k;
            }
            height = (end - begin[node] + pattern.len()) as u32;
        }
        let column = place[first];
        let top = blocks.col_ptr_for_val()[node] as u32 + column * height;
        for j in 0..panel.width {
            sources.extend((j..panel.width).map(|i| top + j * height + column + i));
        }
        for four in &panels.rows[panel.rows()] {
            let [mut at, mut step] = [[fill; ROWS], [0; ROWS]];
            for k in 0..ROWS {
                // rows that fill up are those before them
                if k == 0 || four[k] != four[k - 1] {
                    at[k] = top + place[four[k] as usize];
                    step[k] = height;
                }
            }
            for _ in 0..panel.width {
                sources.extend_from_slice(&at);
                (0..ROWS).for_each(|k| at[k] += step[k]);
            }
        }
    }
    sources
}
