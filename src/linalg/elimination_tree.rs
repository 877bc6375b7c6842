//! The elimination tree of a sparse symmetric matrix (Liu 1990), and an order of elimination that
//! splits it into independent parts.
//!
//! Any order in which children come before their parents gives the same factor up to permutation. So
//! the tree can be cut below its top into subtrees of about equal work that know nothing of each
//! other: triangular solves go through them side by side. The parts depend on the matrix alone, never
//! on the number of threads, and so do all results.

use nalgebra_sparse::CscMatrix;

/// No parent: a root.
pub const NONE: u32 = u32::MAX;

/// Parents in the elimination tree.
#[derive(Debug, Clone)]
pub struct EliminationTree {
    /// Parent of each column, `u32::MAX` for roots.
    pub parent: Vec<u32>,
}

impl EliminationTree {
    /// The tree of a matrix given by its *upper* triangle.
    pub fn new(upper: &CscMatrix<f64>) -> Self {
        let n = upper.ncols();
        let mut parent = vec![NONE; n];
        let mut ancestor = vec![NONE; n];
        for i in 0..n {
            for &start in upper.col(i).row_indices() {
                let mut j = start as u32;
                while (j as usize) < i {
                    let next = ancestor[j as usize];
                    ancestor[j as usize] = i as u32;
                    if next == NONE {
                        parent[j as usize] = i as u32;
                        break;
                    }
                    j = next;
                }
            }
        }
        Self { parent }
    }

    /// Calls `each(i, j)` for every entry i > j of L, row by row: row i is the union of the tree paths
    /// from the entries of row i of A up to i.
    pub fn for_each_entry(&self, upper: &CscMatrix<f64>, mut each: impl FnMut(usize, usize)) {
        let n = self.parent.len();
        let mut mark = vec![NONE; n];
        for i in 0..n {
            mark[i] = i as u32;
            for &start in upper.col(i).row_indices() {
                let mut j = start;
                while j < i && mark[j] != i as u32 {
                    mark[j] = i as u32;
                    each(i, j);
                    j = self.parent[j] as usize;
                }
            }
        }
    }

    /// The rows of each column of L below the diagonal, ascending, column by column: where each begins,
    /// and the rows.
    pub fn columns(&self, upper: &CscMatrix<f64>) -> (Vec<u32>, Vec<u32>) {
        let n = self.parent.len();
        let mut begin = vec![0u32; n + 1];
        self.for_each_entry(upper, |_, j| begin[j + 1] += 1);
        for j in 0..n {
            begin[j + 1] += begin[j];
        }
        let mut next = begin.clone();
        let mut rows = vec![0u32; begin[n] as usize];
        self.for_each_entry(upper, |i, j| {
            rows[next[j] as usize] = i as u32;
            next[j] += 1;
        });
        (begin, rows)
    }

    /// An equivalent order in which each of a few subtrees is contiguous, the rest of the tree (its
    /// top) at the end: `order[k]` is the column that becomes the k-th. Also where each part ends.
    pub fn split(&self, upper: &CscMatrix<f64>, parts: usize) -> (Vec<u32>, Vec<usize>) {
        let parts = parts.max(1);
        let n = self.parent.len();
        // work of a subtree: entries of L in its columns
        let mut work = vec![1u64; n];
        self.for_each_entry(upper, |_, j| work[j] += 1);
        let total: u64 = work.iter().sum();
        for j in 0..n {
            // parents come after their children
            if self.parent[j] != NONE {
                work[self.parent[j] as usize] += work[j];
            }
        }
        // a column is in the top if its subtree is more than a fraction of all
        let limit = total / (2 * parts as u64) + 1;
        let is_top = |j: usize| work[j] > limit;
        let is_root =
            |j: usize| !is_top(j) && (self.parent[j] == NONE || is_top(self.parent[j] as usize));
        // largest first into the emptiest part; ties by number, so that the split is always the same
        let mut roots: Vec<usize> = (0..n).filter(|&j| is_root(j)).collect();
        roots.sort_by_key(|&j| (core::cmp::Reverse(work[j]), j));
        let mut load = vec![0u64; parts];
        let mut part = vec![parts as u32; n];
        for root in roots {
            let emptiest = (0..parts).min_by_key(|&p| (load[p], p)).unwrap_or(0);
            load[emptiest] += work[root];
            part[root] = emptiest as u32;
        }
        for j in (0..n).rev() {
            if !is_top(j) && !is_root(j) {
                part[j] = part[self.parent[j] as usize];
            }
        }
        let mut ends = vec![0usize; parts + 1];
        part.iter().for_each(|&p| ends[p as usize] += 1);
        for p in 1..=parts {
            ends[p] += ends[p - 1];
        }
        let mut next: Vec<usize> = core::iter::once(0)
            .chain(ends[..parts].iter().copied())
            .collect();
        let postorder = self.postorder();
        let mut order = vec![0u32; n];
        for &j in &postorder {
            let slot = &mut next[part[j as usize] as usize];
            order[*slot] = j;
            *slot += 1;
        }
        ends.pop();
        (order, ends)
    }

    /// Children before parents, subtrees contiguous.
    fn postorder(&self) -> Vec<u32> {
        let n = self.parent.len();
        let mut first_child = vec![NONE; n];
        let mut sibling = vec![NONE; n];
        for j in (0..n).rev() {
            let p = self.parent[j];
            if p != NONE {
                sibling[j] = first_child[p as usize];
                first_child[p as usize] = j as u32;
            }
        }
        let mut order = Vec::with_capacity(n);
        let mut stack = Vec::new();
        for root in (0..n).filter(|&j| self.parent[j] == NONE) {
            stack.push(root as u32);
            while let Some(&j) = stack.last() {
                let child = first_child[j as usize];
                if child == NONE {
                    order.push(j);
                    stack.pop();
                } else {
                    first_child[j as usize] = sibling[child as usize];
                    stack.push(child);
                }
            }
        }
        order
    }
}
