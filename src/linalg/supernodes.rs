//! Sparse Cholesky by supernodes: faer behind one small type.
//!
//! The unknowns are expected in elimination order already ([`super::Order`] gives it), so that no
//! solve permutes. This is fastest to refactor; for many solves with one factor see [`super::Cholesky`].

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, supernodal,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Par, Side};
use nalgebra_sparse::CscMatrix;

use crate::optim::BuildError;

/// A pivot was not positive: the matrix is not positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotPositiveDefinite {
    /// The unknown (in elimination order) whose pivot failed.
    pub pivot: usize,
}

/// The factor L Lᵀ of a symmetric matrix with a fixed pattern, in supernodes.
pub struct Supernodes {
    symbolic: SymbolicCholesky<usize>,
    /// Values, and a zero.
    values: Vec<f64>,
    workspace: MemBuffer,
    /// What a supernode has to do with the rows below it.
    below: Vec<f64>,
}

/// The most bytes a factor may take: what a 32-bit address space can give.
const MEMORY_LIMIT: u64 = 1 << 31;

impl Supernodes {
    /// Analyses the pattern of `lower` (lower triangle, unknowns in elimination order).
    ///
    /// # Errors
    /// `TooLarge` before the factor is allocated, if a 32-bit memory cannot hold it.
    pub fn analyze(lower: &CscMatrix<f64>) -> Result<Self, BuildError> {
        // faer analyses upper triangles: the transpose of ours
        Self::of_upper(&lower.transpose())
    }

    /// The same of the upper triangle.
    ///
    /// # Errors
    /// As [`Self::analyze`].
    pub(super) fn of_upper(upper: &CscMatrix<f64>) -> Result<Self, BuildError> {
        let symbolic = faer::sparse::linalg::cholesky::factorize_symbolic_cholesky(
            symbolic_of(upper),
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
        let (scratch, rows) = match upper.ncols() {
            // without unknowns there are no supernodes (and nothing to do)
            0 => (StackReq::EMPTY, 0),
            _ => {
                let blocks = blocks_of(&symbolic);
                let rows = |node: usize| blocks.supernode(node).pattern().len();
                let scratch = supernodal::factorize_supernodal_numeric_llt_scratch::<usize, f64>(
                    blocks,
                    Par::Seq,
                    Default::default(),
                );
                (
                    scratch,
                    (0..blocks.n_supernodes()).map(rows).max().unwrap_or(0),
                )
            }
        };
        // anything but zeros is written now, and the first factorisation does not wait for its memory
        let mut values = vec![1.0; symbolic.len_val() + 1];
        values[symbolic.len_val()] = 0.0;
        Ok(Self {
            below: vec![0.0; rows],
            symbolic,
            values,
            workspace: MemBuffer::new(scratch),
        })
    }

    /// Number of unknowns.
    pub fn dimension(&self) -> usize {
        self.symbolic.nrows()
    }

    /// Factors `lower`, whose pattern must be the analysed one. Allocates nothing.
    ///
    /// # Errors
    /// The first pivot that is not positive; the factor is then unusable until the next success.
    pub fn factorize(&mut self, lower: &CscMatrix<f64>) -> Result<(), NotPositiveDefinite> {
        if self.dimension() == 0 {
            return Ok(());
        }
        supernodal::factorize_supernodal_numeric_llt::<usize, f64>(
            &mut self.values[..self.symbolic.len_val()],
            SparseColMatRef::new(symbolic_of(lower), lower.values()),
            LltRegularization::default(),
            blocks_of(&self.symbolic),
            Par::Seq,
            MemStack::new(&mut self.workspace),
            Default::default(),
        )
        .map(|_| ())
        .map_err(|LltError::NonPositivePivot { index }| NotPositiveDefinite { pivot: index })?;
        self.check_diagonal()
    }

    /// Fails where a pivot is not a positive number, which a comparison alone does not see of one that is none.
    fn check_diagonal(&self) -> Result<(), NotPositiveDefinite> {
        let blocks = blocks_of(&self.symbolic);
        let nodes = blocks.supernode_begin().iter().zip(blocks.supernode_end());
        for (node, (&begin, &end)) in nodes.enumerate() {
            let height = end - begin + blocks.supernode(node).pattern().len();
            let first = blocks.col_ptr_for_val()[node];
            let diagonal = |column: usize| self.values[first + column * (height + 1)];
            let bad = |&c: &usize| !(diagonal(c) > 0.0 && diagonal(c).is_finite());
            if let Some(column) = (0..end - begin).find(bad) {
                return Err(NotPositiveDefinite {
                    pivot: begin + column,
                });
            }
        }
        Ok(())
    }

    /// Solves A x = b in place. Allocates nothing.
    pub fn solve_in_place(&mut self, x: &mut [f64]) {
        let Self {
            symbolic,
            values,
            below,
            ..
        } = self;
        if symbolic.nrows() == 0 {
            return;
        }
        let blocks = blocks_of(symbolic);
        let node = |number: usize| {
            let first = blocks.supernode_begin()[number];
            Node {
                first,
                width: blocks.supernode_end()[number] - first,
                rows: blocks.supernode(number).pattern(),
                values: &values[blocks.col_ptr_for_val()[number]..],
            }
        };
        for number in 0..blocks.n_supernodes() {
            let node = node(number);
            node.forward(x, &mut below[..node.rows.len()]);
        }
        for number in (0..blocks.n_supernodes()).rev() {
            let node = node(number);
            node.backward(x, &mut below[..node.rows.len()]);
        }
    }

    /// The values, the last of which is a zero.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The symbolic factor.
    pub(super) fn blocks(&self) -> &supernodal::SymbolicSupernodalCholesky<usize> {
        blocks_of(&self.symbolic)
    }
}

/// A supernode: consecutive columns with the same rows below them.
struct Node<'a> {
    first: usize,
    width: usize,
    rows: &'a [usize],
    /// Column by column, its own rows first.
    values: &'a [f64],
}

/// Columns that are gone through together.
const TOGETHER: usize = 4;

impl Node<'_> {
    /// The columns from `column` on, below the diagonal block.
    #[inline(always)]
    fn columns<const C: usize>(&self, column: usize) -> [&[f64]; C] {
        let (width, count) = (self.width, self.rows.len());
        let height = width + count;
        core::array::from_fn(|c| &self.values[(column + c) * height + width..][..count])
    }

    /// A column of the diagonal block, from the diagonal on.
    #[inline(always)]
    fn column(&self, column: usize) -> (f64, &[f64]) {
        let height = self.width + self.rows.len();
        let begin = column * height + column;
        (
            self.values[begin],
            &self.values[begin + 1..begin + self.width - column],
        )
    }

    /// L y = b for its unknowns; the rest goes to the rows below.
    fn forward(&self, x: &mut [f64], below: &mut [f64]) {
        let own = &mut x[self.first..][..self.width];
        for j in 0..self.width {
            let (diagonal, column) = self.column(j);
            let y = own[j] / diagonal;
            own[j] = y;
            for (x, l) in own[j + 1..].iter_mut().zip(column) {
                *x -= l * y;
            }
        }
        below.fill(0.0);
        let mut j = 0;
        while j + TOGETHER <= self.width {
            let [a, b, c, d] = self.columns(j);
            let [p, q, r, s] = [own[j], own[j + 1], own[j + 2], own[j + 3]];
            let columns = a.iter().zip(b).zip(c.iter().zip(d));
            for (below, ((a, b), (c, d))) in below.iter_mut().zip(columns) {
                *below += (a * p + b * q) + (c * r + d * s);
            }
            j += TOGETHER;
        }
        for (j, &y) in own.iter().enumerate().skip(j) {
            let [column] = self.columns(j);
            for (below, l) in below.iter_mut().zip(column) {
                *below += l * y;
            }
        }
        for (&row, below) in self.rows.iter().zip(&*below) {
            x[row] -= below;
        }
    }

    /// Lᵀ x = y for its unknowns, those below being known.
    fn backward(&self, x: &mut [f64], below: &mut [f64]) {
        for (below, &row) in below.iter_mut().zip(self.rows) {
            *below = x[row];
        }
        let own = &mut x[self.first..][..self.width];
        let mut j = self.width;
        while j >= TOGETHER {
            j -= TOGETHER;
            let sums = products::<TOGETHER>(self.columns(j), below);
            own[j..].iter_mut().zip(sums).for_each(|(x, s)| *x -= s);
        }
        while j > 0 {
            j -= 1;
            let [sum] = products::<1>(self.columns(j), below);
            own[j] -= sum;
        }
        for j in (0..self.width).rev() {
            let (diagonal, column) = self.column(j);
            let known = column.iter().zip(&own[j + 1..]);
            let sum: f64 = known.map(|(l, x)| l * x).sum();
            own[j] = (own[j] - sum) / diagonal;
        }
    }
}

/// The products of columns with x, each in four sums that an instruction can take together.
#[inline(always)]
fn products<const C: usize>(columns: [&[f64]; C], x: &[f64]) -> [f64; C] {
    let mut sums = [[0.0; 4]; C];
    let (heads, tail) = x.as_chunks::<4>();
    let fours = heads.len();
    // told this, the compiler checks no index
    let columns_heads = columns.map(|column| &column.as_chunks::<4>().0[..fours]);
    for (i, x) in heads.iter().enumerate() {
        for c in 0..C {
            for k in 0..4 {
                sums[c][k] += columns_heads[c][i][k] * x[k];
            }
        }
    }
    core::array::from_fn(|c| {
        let rest = columns[c][4 * fours..].iter().zip(tail);
        let rest: f64 = rest.map(|(l, x)| l * x).sum();
        (sums[c][0] + sums[c][1]) + (sums[c][2] + sums[c][3]) + rest
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
