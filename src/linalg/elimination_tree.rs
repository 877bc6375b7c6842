//! The elimination tree of a sparse symmetric matrix (Liu 1990): which columns of L add to which.
//!
//! Any order in which children come before their parents gives the same factor up to permutation.

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

    /// An equivalent order in levels: in each, a few sets of subtrees are contiguous parts of about equal
    /// work; what stands above them in the tree is left to later levels, the last of which is one part.
    /// `parts` says how many parts the levels have. `order[k]` is the column that becomes the k-th;
    /// also where each part of each level ends.
    pub fn split(&self, upper: &CscMatrix<f64>, parts: &[usize]) -> (Vec<u32>, Vec<Vec<usize>>) {
        let n = self.parent.len();
        // work of a column: its entries of L
        let mut own = vec![1u64; n];
        self.for_each_entry(upper, |_, j| own[j] += 1);
        // parts are numbered level by level
        let mut part_of = vec![NONE; n];
        let mut counts = Vec::new();
        let mut first = 0;
        for &parts in parts.iter().chain(&[1]) {
            self.split_level(&own, parts, first, &mut part_of);
            counts.push(parts);
            first += parts as u32;
        }
        let mut ends = vec![0usize; first as usize];
        part_of.iter().for_each(|&p| ends[p as usize] += 1);
        for p in 1..ends.len() {
            ends[p] += ends[p - 1];
        }
        let mut next: Vec<usize> = core::iter::once(0).chain(ends.iter().copied()).collect();
        let mut order = vec![0u32; n];
        for j in self.postorder() {
            let slot = &mut next[part_of[j as usize] as usize];
            order[*slot] = j;
            *slot += 1;
        }
        let mut ends = ends.into_iter();
        let levels = counts
            .into_iter()
            .map(|parts| ends.by_ref().take(parts).collect());
        (order, levels.collect())
    }

    /// Gives parts, numbered from `first` on, to the columns that have none yet, but for the top above
    /// them; with one part there is no top.
    fn split_level(&self, own: &[u64], parts: usize, first: u32, part_of: &mut [u32]) {
        let n = self.parent.len();
        let is_open = |part_of: &[u32], j: usize| part_of[j] == NONE;
        let mut work: Vec<u64> = (0..n)
            .map(|j| if is_open(part_of, j) { own[j] } else { 0 })
            .collect();
        let total: u64 = work.iter().sum();
        for j in 0..n {
            // parents come after their children
            if self.parent[j] != NONE {
                work[self.parent[j] as usize] += work[j];
            }
        }
        // a column is in the top if its subtree is more than a fraction of all
        let limit = if parts > 1 {
            total / (2 * parts as u64)
        } else {
            total
        };
        let is_top = |j: usize| work[j] > limit;
        let is_root =
            |j: usize| !is_top(j) && (self.parent[j] == NONE || is_top(self.parent[j] as usize));
        // largest first into the emptiest part; ties by number, so that the split is always the same
        let mut roots: Vec<usize> = (0..n)
            .filter(|&j| is_open(part_of, j) && is_root(j))
            .collect();
        roots.sort_by_key(|&j| (core::cmp::Reverse(work[j]), j));
        let mut load = vec![0u64; parts];
        let mut part = vec![0; n];
        for root in roots {
            let emptiest = (0..parts).min_by_key(|&p| (load[p], p)).unwrap_or(0);
            load[emptiest] += work[root];
            part[root] = emptiest as u32;
        }
        for j in (0..n).rev() {
            if !is_open(part_of, j) || is_top(j) {
                continue;
            }
            if !is_root(j) {
                part[j] = part[self.parent[j] as usize];
            }
            part_of[j] = first + part[j];
        }
    }

    /// Children before parents, subtrees contiguous.
    pub fn postorder(&self) -> Vec<u32> {
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
