//! Sparse Cholesky: faer behind one small type.
//!
//! The unknowns are expected in elimination order already ([`Cholesky::order`] gives it), so that no
//! solve permutes. The factor is computed by supernodes, which is fastest to refactor, and copied
//! without their padding zeros into plain columns, which is fastest to solve with when, as on
//! surfaces, supernodes are small.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, supernodal,
};
use faer::sparse::linalg::{SupernodalThreshold, amd};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};
use nalgebra_sparse::CscMatrix;

use super::EliminationTree;
use super::triangular::ColumnsOfL;
use crate::optim::BuildError;

/// An order of elimination.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Order {
    /// `unknowns[k]` is eliminated k-th.
    pub unknowns: Vec<u32>,
    /// Ends of the parts that know nothing of each other; what comes after the last is their common
    /// top.
    pub parts: Vec<usize>,
}

/// Parts the elimination tree is split into: enough for the threads a browser gives.
const PARTS: usize = 8;

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
    /// L by columns, diagonal first, without the supernodes' zeros.
    column_begin: Vec<u32>,
    rows: Vec<u32>,
    /// Where the rows of the common top begin in each column of a part.
    inner_end: Vec<u32>,
    values: Vec<f64>,
    /// Reciprocal diagonal.
    inverse_diagonal: Vec<f64>,
    /// Ends of the independent parts.
    parts: Vec<usize>,
    /// What each part adds to the top in a solve: room for three right-hand sides.
    to_top: Vec<f64>,
}

/// The most bytes a factor may take: what a 32-bit address space can give.
const MEMORY_LIMIT: u64 = 1 << 31;

impl Cholesky {
    /// The fill-reducing elimination order (approximate minimum degree, Amestoy et al. 1996) of a
    /// symmetric pattern given by its edges, with independent parts first.
    pub fn order(n: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Order {
        let assembly = super::SymmetricAssembly::new(n, edges.clone());
        let pattern = assembly.matrix().pattern();
        let symbolic = SymbolicSparseColMatRef::new_checked(
            n,
            n,
            pattern.major_offsets(),
            None,
            pattern.minor_indices(),
        );
        let mut forward = vec![0usize; n];
        let mut inverse = vec![0usize; n];
        let scratch = amd::order_scratch::<usize>(n, pattern.nnz());
        let mut buffer = MemBuffer::new(scratch);
        let ordered = amd::order(
            &mut forward,
            &mut inverse,
            symbolic,
            amd::Control::default(),
            MemStack::new(&mut buffer),
        );
        // only an index overflow can fail here, and 32-bit meshes cannot cause one
        if ordered.is_err() {
            forward = (0..n).collect();
            inverse = forward.clone();
        }
        let relabelled = edges
            .filter(|&(i, j)| (i as usize) < n && (j as usize) < n)
            .map(|(i, j)| (inverse[i as usize] as u32, inverse[j as usize] as u32));
        let upper = super::SymmetricAssembly::new(n, relabelled)
            .matrix()
            .transpose();
        let (order, parts) = EliminationTree::new(&upper).split(&upper, PARTS);
        Order {
            unknowns: order.iter().map(|&k| forward[k as usize] as u32).collect(),
            parts,
        }
    }

    /// Analyses the pattern of `lower` (lower triangle, unknowns in elimination order).
    ///
    /// `parts` are those of the order (or empty).
    ///
    /// # Errors
    /// `TooLarge` before the factor is allocated, if a 32-bit memory cannot hold it.
    pub fn analyze(lower: &CscMatrix<f64>, parts: &[usize]) -> Result<Self, BuildError> {
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
        let blocks = vec![0.0; symbolic.len_val()];
        let mut this = Self {
            symbolic,
            blocks,
            workspace: MemBuffer::new(scratch),
            column_begin: Vec::new(),
            rows: Vec::new(),
            inner_end: Vec::new(),
            values: Vec::new(),
            inverse_diagonal: vec![0.0; n],
            parts: parts.to_vec(),
            to_top: vec![0.0; 3 * parts.len() * (n - parts.last().copied().unwrap_or(n))],
        };
        this.build_columns(&upper);
        Ok(this)
    }

    /// Number of unknowns.
    pub fn dimension(&self) -> usize {
        self.inverse_diagonal.len()
    }

    /// Number of stored entries of L.
    pub fn factor_entries(&self) -> usize {
        self.values.len()
    }

    /// The exact pattern of L, column by column.
    fn build_columns(&mut self, upper: &CscMatrix<f64>) {
        let n = upper.ncols();
        let tree = EliminationTree::new(upper);
        let mut count = vec![1u32; n];
        tree.for_each_entry(upper, |_, j| count[j] += 1);
        let mut begin = Vec::with_capacity(n + 1);
        begin.push(0u32);
        for &c in &count {
            begin.push(begin[begin.len() - 1] + c);
        }
        let mut rows = vec![0u32; begin[n] as usize];
        let mut next: Vec<u32> = begin[..n].to_vec();
        for (j, slot) in next.iter_mut().enumerate() {
            rows[*slot as usize] = j as u32;
            *slot += 1;
        }
        tree.for_each_entry(upper, |i, j| {
            rows[next[j] as usize] = i as u32;
            next[j] += 1;
        });
        let bottom = self.parts.last().copied().unwrap_or(0);
        self.inner_end = (0..n)
            .map(|j| {
                let column = &rows[begin[j] as usize..begin[j + 1] as usize];
                let own = |&r: &u32| j >= bottom || (r as usize) < bottom;
                begin[j] + column.partition_point(own) as u32
            })
            .collect();
        self.values = vec![0.0; rows.len()];
        self.rows = rows;
        self.column_begin = begin;
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
            &mut self.blocks,
            matrix,
            LltRegularization::default(),
            blocks,
            Par::Seq,
            MemStack::new(&mut self.workspace),
            Default::default(),
        )
        .map_err(|LltError::NonPositivePivot { index }| NotPositiveDefinite { pivot: index })?;
        self.copy_columns()
    }

    /// Copies the supernodes into columns, dropping their padding.
    fn copy_columns(&mut self) -> Result<(), NotPositiveDefinite> {
        let symbolic = blocks_of(&self.symbolic);
        let factor = supernodal::SupernodalLltRef::new(symbolic, &self.blocks[..]);
        for s in 0..symbolic.n_supernodes() {
            let node = factor.supernode(s);
            let (start, pattern, block) = (node.start(), node.pattern(), node.val());
            let width = block.ncols();
            for local in 0..width {
                let j = start + local;
                let range = self.column_begin[j] as usize..self.column_begin[j + 1] as usize;
                let rows = &self.rows[range.clone()];
                let values = &mut self.values[range];
                let column = block.col(local);
                let column = column
                    .try_as_col_major()
                    .map(|c| c.as_slice())
                    .unwrap_or(&[]);
                if column.is_empty() {
                    return Err(NotPositiveDefinite { pivot: j });
                }
                // both lists are sorted; the supernode's may have more
                let mut at = 0;
                for (&row, value) in rows.iter().zip(values.iter_mut()) {
                    let row = row as usize;
                    if row < start + width {
                        *value = column[row - start];
                    } else {
                        while pattern[at] < row {
                            at += 1;
                        }
                        *value = column[width + at];
                    }
                }
                let diagonal = values[0];
                if !(diagonal > 0.0 && diagonal.is_finite()) {
                    return Err(NotPositiveDefinite { pivot: j });
                }
                self.inverse_diagonal[j] = diagonal.recip();
            }
        }
        Ok(())
    }

    /// Solves A X = B in place for `columns` right-hand sides (1, 2 or 3), interleaved: n × columns,
    /// row by row.
    pub fn solve_in_place(&mut self, x: &mut [f64], columns: usize) {
        let columns_of_l = ColumnsOfL {
            begin: &self.column_begin,
            rows: &self.rows,
            values: &self.values,
            inverse_diagonal: &self.inverse_diagonal,
            inner_end: &self.inner_end,
            parts: &self.parts,
        };
        match columns {
            1 => columns_of_l.solve::<1>(x.as_chunks_mut().0, &mut self.to_top),
            2 => columns_of_l.solve::<2>(x.as_chunks_mut().0, &mut self.to_top),
            3 => columns_of_l.solve::<3>(x.as_chunks_mut().0, &mut self.to_top),
            _ => unreachable!("one to three right-hand sides, not {columns}"),
        }
    }
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
