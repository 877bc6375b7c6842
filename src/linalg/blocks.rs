//! Assembly of symmetric matrices of dense d×d blocks, one block row a vertex: the pattern once, the
//! values often.

use super::SymmetricAssembly;
use crate::parallel;
use nalgebra_sparse::CscMatrix;
use nalgebra_sparse::pattern::SparsityPattern;

/// Block columns that are one piece of work.
const COLUMNS: usize = 1024;

/// A symmetric matrix of d×d blocks as a sum of element blocks and of multiples of the identity.
///
/// The d rows of a vertex are next to each other, so that the scalar matrix inherits the order of
/// elimination of the vertices. Its lower triangle is stored. Every block knows its contributions:
/// refilling needs no search, goes in parallel, and adds in the same order always.
#[derive(Debug, Clone)]
pub struct BlockSum {
    dimension: usize,
    /// Lower triangle by columns, d·n × d·n.
    matrix: CscMatrix<f64>,
    /// Where each block column's blocks begin, the one at the diagonal first; length: n + 1.
    blocks: Vec<u32>,
    /// Where each block's contributions begin; length: blocks + 1.
    begin: Vec<u32>,
    /// Contributions: twice the number of an element block, plus 1 if it is to be transposed.
    contribution: Vec<u32>,
    /// Element blocks; contributions from there on are of `constants`.
    elements: u32,
    /// Multiples of the identity.
    constants: Vec<f64>,
}

impl BlockSum {
    /// The pattern on n vertices in dimension `d` (2 or 3): element block t is at (row, column)
    /// `pairs[t]`, `constants` add multiples of the identity (row, column, factor). A contribution of the
    /// upper triangle is transposed into the lower: give each pair of vertices once. Rows and columns ≥ n
    /// are left out. The diagonal is always stored.
    pub fn new(
        n: usize,
        d: usize,
        pairs: &[(u32, u32)],
        constants: impl Iterator<Item = (u32, u32, f64)> + Clone,
    ) -> Self {
        let elements = pairs.len() as u32;
        let all: Vec<(u32, u32)> = pairs
            .iter()
            .copied()
            .chain(constants.clone().map(|(i, j, _)| (i, j)))
            .collect();
        let vertices = SymmetricAssembly::new(n, all.iter().copied());
        let mark = |&t: &u32| {
            let (i, j) = all[t as usize];
            2 * t + u32::from(i < j)
        };
        let contribution = vertices.contribution.iter().map(mark).collect();
        let pattern = vertices.matrix.pattern();
        let mut offsets = Vec::with_capacity(d * n + 1);
        let mut rows = Vec::new();
        offsets.push(0);
        for column in 0..n {
            for j in 0..d {
                rows.extend((j..d).map(|i| column * d + i));
                for &row in &pattern.lane(column)[1..] {
                    rows.extend((0..d).map(|i| row * d + i));
                }
                offsets.push(rows.len());
            }
        }
        let entries = rows.len();
        let scalar = SparsityPattern::try_from_offsets_and_indices(d * n, d * n, offsets, rows)
            .expect("columns are sorted and within range by construction");
        Self {
            dimension: d,
            matrix: CscMatrix::try_from_pattern_and_values(scalar, vec![0.0; entries])
                .expect("one value an entry"),
            blocks: pattern.major_offsets().iter().map(|&o| o as u32).collect(),
            begin: vertices.begin,
            contribution,
            elements,
            constants: constants.map(|(_, _, k)| k).collect(),
        }
    }

    /// The matrix: its lower triangle by columns.
    pub fn matrix(&self) -> &CscMatrix<f64> {
        &self.matrix
    }

    /// Sets the values. Element block t is `values[d² t..]`, row by row; `diagonal(vertex)` is added on
    /// the diagonal.
    pub fn fill(&mut self, values: &[f64], diagonal: impl Fn(usize) -> f64 + Sync) {
        match self.dimension {
            2 => self.fill_in::<2, 4>(values.as_chunks().0, &diagonal),
            _ => self.fill_in::<3, 9>(values.as_chunks().0, &diagonal),
        }
    }

    fn fill_in<const D: usize, const DD: usize>(
        &mut self,
        values: &[[f64; DD]],
        diagonal: &(impl Fn(usize) -> f64 + Sync),
    ) {
        let (pattern, target) = {
            let (offsets, _, target) = self.matrix.csc_data_mut();
            (offsets, target)
        };
        let filler = Filler::<_, DD> {
            offsets: pattern,
            blocks: &self.blocks,
            begin: &self.begin,
            contribution: &self.contribution,
            elements: self.elements,
            constants: &self.constants,
            values,
            diagonal,
        };
        filler.split::<D>(0, self.blocks.len() - 1, target);
    }

    /// Adds `shift(vertex)` to the d diagonal entries of each vertex.
    pub fn add_to_diagonal(&mut self, shift: impl Fn(usize) -> f64) {
        let d = self.dimension;
        let (offsets, _, values) = self.matrix.csc_data_mut();
        for (unknown, &begin) in offsets[..offsets.len() - 1].iter().enumerate() {
            values[begin] += shift(unknown / d);
        }
    }

    /// Puts rows and columns of the identity in place of those of held vertices (one entry a vertex).
    pub fn hold(&mut self, held: &[bool]) {
        if !held.contains(&true) {
            return;
        }
        let d = self.dimension;
        let (offsets, rows, values) = self.matrix.csc_data_mut();
        for (column, ends) in offsets.windows(2).enumerate() {
            let entries = ends[0]..ends[1];
            let whole = held[column / d];
            for (&row, value) in rows[entries.clone()].iter().zip(&mut values[entries]) {
                if whole || held[row / d] {
                    *value = f64::from(u8::from(row == column));
                }
            }
        }
    }

    /// Adds `factor` · a aᵀ at a vertex, in dimension 2.
    pub fn add_product(&mut self, vertex: usize, a: [f64; 2], factor: f64) {
        let (offsets, _, values) = self.matrix.csc_data_mut();
        let (first, second) = (offsets[2 * vertex], offsets[2 * vertex + 1]);
        values[first] += factor * a[0] * a[0];
        values[first + 1] += factor * a[0] * a[1];
        values[second] += factor * a[1] * a[1];
    }

    /// The mean of the d diagonal entries of each vertex.
    pub fn mean_diagonal(&self, mean: &mut [f64]) {
        let d = self.dimension;
        let values = self.matrix.values();
        let offsets = self.matrix.pattern().major_offsets();
        for (v, mean) in mean.iter_mut().enumerate() {
            let sum: f64 = offsets[v * d..(v + 1) * d].iter().map(|&o| values[o]).sum();
            *mean = sum / d as f64;
        }
    }
}

/// Fills runs of block columns.
struct Filler<'a, F, const DD: usize> {
    /// Where each scalar column begins.
    offsets: &'a [usize],
    blocks: &'a [u32],
    begin: &'a [u32],
    contribution: &'a [u32],
    elements: u32,
    constants: &'a [f64],
    values: &'a [[f64; DD]],
    diagonal: &'a F,
}

impl<F: Fn(usize) -> f64 + Sync, const DD: usize> Filler<'_, F, DD> {
    /// Columns `first..end`, whose values are `target`, side by side where there are threads.
    fn split<const D: usize>(&self, first: usize, end: usize, target: &mut [f64]) {
        if end - first <= COLUMNS || parallel::threads() == 1 {
            return self.run::<D>(first, end, target);
        }
        let middle = first.midpoint(end);
        let (left, right) = target.split_at_mut(self.offsets[middle * D] - self.offsets[first * D]);
        parallel::join(
            || self.split::<D>(first, middle, left),
            || self.split::<D>(middle, end, right),
        );
    }

    fn run<const D: usize>(&self, first: usize, end: usize, target: &mut [f64]) {
        let origin = self.offsets[first * D];
        for column in first..end {
            let at: [usize; D] = core::array::from_fn(|j| self.offsets[column * D + j] - origin);
            let blocks = self.blocks[column] as usize..self.blocks[column + 1] as usize;
            for (place, block) in blocks.enumerate() {
                let mut sum = self.block::<D>(block);
                if place == 0 {
                    for i in 0..D {
                        sum[i * D + i] += (self.diagonal)(column);
                        for j in 0..=i {
                            target[at[j] + i - j] = sum[i * D + j];
                        }
                    }
                } else {
                    for j in 0..D {
                        let begin = at[j] + place * D - j;
                        for (i, target) in target[begin..begin + D].iter_mut().enumerate() {
                            *target = sum[i * D + j];
                        }
                    }
                }
            }
        }
    }

    /// The sum of a block's contributions, row by row.
    #[inline(always)]
    fn block<const D: usize>(&self, block: usize) -> [f64; DD] {
        let mut sum = [0.0; DD];
        let range = self.begin[block] as usize..self.begin[block + 1] as usize;
        for &contribution in &self.contribution[range] {
            let t = contribution / 2;
            if t >= self.elements {
                let k = self.constants[(t - self.elements) as usize];
                (0..D).for_each(|i| sum[i * D + i] += k);
            } else if contribution % 2 == 0 {
                let block = &self.values[t as usize];
                (0..DD).for_each(|c| sum[c] += block[c]);
            } else {
                let block = &self.values[t as usize];
                for i in 0..D {
                    for j in 0..D {
                        sum[i * D + j] += block[j * D + i];
                    }
                }
            }
        }
        sum
    }
}
