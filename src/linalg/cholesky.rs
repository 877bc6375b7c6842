//! Sparse Cholesky: faer behind one small type.
//!
//! The unknowns are expected in elimination order already ([`super::Order`] gives it), so that no
//! solve permutes. The factor is computed by supernodes, which is fastest to refactor, and copied
//! without their padding zeros into plain columns, which is fastest to solve with when, as on
//! surfaces, supernodes are small.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, supernodal,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};
use nalgebra_sparse::CscMatrix;

use super::panels::Panels;
use super::triangular::Factor;
use crate::optim::BuildError;
use crate::parallel;

/// A pivot was not positive: the matrix is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotPositiveDefinite {
    /// The unknown (in elimination order) whose pivot failed.
    pub pivot: usize,
}

/// The factor L Lᵀ of a symmetric matrix with a fixed pattern.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    /// Supernodal values.
    blocks: Vec<f64>,
    workspace: MemBuffer,
    /// L for the solves, without the supernodes' zeros.
    panels: Panels,
    values: Vec<f64>,
    /// For each of these values where it is in `blocks`, the last of which is a zero.
    source: Vec<u32>,
    /// Reciprocal diagonal, and where it is in `values`.
    inverse_diagonal: Vec<f64>,
    diagonal: Vec<u32>,
    /// What the parts add to later levels in a solve: room for three right-hand sides.
    work: Vec<f64>,
}

/// The most bytes a factor may take: what a 32-bit address space can give.
const MEMORY_LIMIT: u64 = 1 << 31;

impl Cholesky {
    /// Analyses the pattern of `lower` (lower triangle, unknowns in elimination order).
    ///
    /// `levels` are those of the order (or empty).
    ///
    /// # Errors
    /// `TooLarge` before the factor is allocated, if a 32-bit memory cannot hold it.
    pub fn analyze(lower: &CscMatrix<f64>, levels: &[Vec<usize>]) -> Result<Self, BuildError> {
        let n = lower.ncols();
        // faer analyses upper triangles: the transpose of ours
        let upper = lower.transpose();
        let symbolic = faer::sparse::linalg::cholesky::factorize_symbolic_cholesky(
            symbolic_of(&upper),
            Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .map_err(|_| BuildError::TooLarge {
            bytes: u64::MAX,
            limit: MEMORY_LIMIT,
        })?;
        let bytes = 2 * 8 * symbolic.len_val() as u64;
        if bytes > MEMORY_LIMIT {
            return Err(BuildError::TooLarge {
                bytes,
                limit: MEMORY_LIMIT,
            });
        }
        let scratch = match n {
            // without unknowns there are no supernodes (and nothing to do)
            0 => StackReq::EMPTY,
            _ => supernodal::factorize_supernodal_numeric_llt_scratch::<usize, f64>(
                blocks_of(&symbolic),
                Par::Seq,
                Default::default(),
            ),
        };
        // anything but zeros is written now, and the first factorisation does not wait for its memory
        let mut blocks = vec![1.0; symbolic.len_val() + 1];
        blocks[symbolic.len_val()] = 0.0;
        let panels = Panels::new(&upper, levels);
        let source = sources(&symbolic, &panels);
        let diagonal = panels.diagonal();
        Ok(Self {
            symbolic,
            blocks,
            workspace: MemBuffer::new(scratch),
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
        if self.dimension() == 0 {
            return Ok(());
        }
        let blocks = blocks_of(&self.symbolic);
        let matrix = SparseColMatRef::new(symbolic_of(lower), lower.values());
        supernodal::factorize_supernodal_numeric_llt::<usize, f64>(
            &mut self.blocks[..self.symbolic.len_val()],
            matrix,
            LltRegularization::default(),
            blocks,
            Par::Seq,
            MemStack::new(&mut self.workspace),
            Default::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| NotPositiveDefinite { pivot: index })?;
        self.copy_panels()
    }

    /// Copies the supernodes into panels, dropping their padding.
    fn copy_panels(&mut self) -> Result<(), NotPositiveDefinite> {
        const CHUNK: usize = 1 << 15;
        let (blocks, source) = (&self.blocks[..], &self.source[..]);
        parallel::for_each_chunk(&mut self.values, CHUNK, |chunk, values| {
            let source = &source[chunk * CHUNK..][..values.len()];
            for (value, &at) in values.iter_mut().zip(source) {
                *value = blocks[at as usize];
            }
        });
        for (pivot, inverse) in self.inverse_diagonal.iter_mut().enumerate() {
            let diagonal = self.values[self.diagonal[pivot] as usize];
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return Err(NotPositiveDefinite { pivot });
            }
            *inverse = diagonal.recip();
        }
        Ok(())
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
fn sources(symbolic: &SymbolicCholesky<usize>, panels: &Panels) -> Vec<u32> {
    if symbolic.nrows() == 0 {
        return Vec::new();
    }
    let fill = symbolic.len_val() as u32;
    let blocks = blocks_of(symbolic);
    // of the supernode `node`, whose columns end at `end`: where each row is in them
    let mut place = vec![0u32; symbolic.nrows()];
    let (mut node, mut end, mut height) = (0, 0, 0);
    panels.map(fill, |i, j| {
        let j = j as usize;
        let begin = blocks.supernode_begin();
        if j >= end {
            node = begin.partition_point(|&b| b <= j) - 1;
            end = blocks.supernode_end()[node];
            let pattern = blocks.supernode(node).pattern();
            for (k, row) in (begin[node]..end)
                .chain(pattern.iter().copied())
                .enumerate()
            {
                place[row] = k as u32;
            }
            height = end - begin[node] + pattern.len();
        }
        (blocks.col_ptr_for_val()[node] + (j - begin[node]) * height) as u32 + place[i as usize]
    })
}

fn blocks_of(symbolic: &SymbolicCholesky<usize>) -> &supernodal::SymbolicSupernodalCholesky<usize> {
    match symbolic.raw() {
        SymbolicCholeskyRaw::Supernodal(blocks) => blocks,
        SymbolicCholeskyRaw::Simplicial(_) => unreachable!("supernodes were asked for"),
    }
}

fn symbolic_of(matrix: &CscMatrix<f64>) -> SymbolicSparseColMatRef<'_, usize> {
    let pattern = matrix.pattern();
    SymbolicSparseColMatRef::new_checked(
        matrix.nrows(),
        matrix.ncols(),
        pattern.major_offsets(),
        None,
        pattern.minor_indices(),
    )
}
