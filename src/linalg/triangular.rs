//! Triangular solves with a factor stored by columns, part by part.

use crate::parallel;
use core::ops::Range;

/// L by columns, diagonal first, with the independent parts of its elimination tree.
#[derive(Clone, Copy)]
pub struct ColumnsOfL<'a> {
    /// Where each column begins; length: n + 1.
    pub begin: &'a [u32],
    /// Row of each entry, ascending in a column.
    pub rows: &'a [u32],
    /// Value of each entry.
    pub values: &'a [f64],
    /// 1/L_jj.
    pub inverse_diagonal: &'a [f64],
    /// In each column, where the rows of the top begin (an index into `rows`).
    pub inner_end: &'a [u32],
    /// Ends of the parts; the columns after the last are their common top.
    pub parts: &'a [usize],
}

/// What is done with a part: its columns, its unknowns, its room for the top.
type EachPart<'a, const D: usize> =
    dyn Fn(Range<usize>, &mut [[f64; D]], &mut [[f64; D]]) + Sync + 'a;

/// Runs each part with its own unknowns and its room for the top, side by side where there are
/// threads.
fn for_each_part<const D: usize>(
    parts: &[usize],
    mut own: &mut [[f64; D]],
    first: usize,
    mut tops: &mut [[f64; D]],
    top: usize,
    each: &EachPart<D>,
) {
    match parts {
        [] => {}
        &[end] => each(first..end, own, tops),
        _ => {
            let half = parts.len() / 2;
            let middle = parts[half - 1];
            let (own_a, own_b) = own.split_at_mut(middle - first);
            let (tops_a, tops_b) = tops.split_at_mut(half * top);
            (own, tops) = (own_a, tops_a);
            parallel::join(
                || for_each_part(&parts[..half], own, first, tops, top, each),
                || for_each_part(&parts[half..], own_b, middle, tops_b, top, each),
            );
        }
    }
}

impl ColumnsOfL<'_> {
    /// Solves L Lᵀ X = B in place, X interleaved. Sums are taken in the order of the parts, whatever
    /// the number of threads. `to_top` has room for D numbers a part and unknown of the top.
    pub fn solve<const D: usize>(&self, x: &mut [[f64; D]], to_top: &mut [f64]) {
        let n = x.len();
        let bottom = self.parts.last().copied().unwrap_or(0);
        let (own, top) = x.split_at_mut(bottom);
        let tops = &mut to_top.as_chunks_mut::<D>().0[..self.parts.len() * top.len()];
        for_each_part(
            self.parts,
            own,
            0,
            tops,
            top.len(),
            &|range, own, to_top| {
                to_top.fill([0.0; D]);
                self.forward(range, bottom, own, to_top);
            },
        );
        for add in tops.chunks_exact(top.len().max(1)) {
            for (x, add) in top.iter_mut().zip(add) {
                for d in 0..D {
                    x[d] += add[d];
                }
            }
        }
        self.forward(bottom..n, n, top, &mut []);
        self.backward(bottom..n, n, top, &[]);
        let top = &*top;
        for_each_part(self.parts, own, 0, &mut [], 0, &|range, own, _| {
            self.backward(range, bottom, own, top);
        });
    }

    /// The rows and values below the diagonal of column j, and how many of them come before the top's
    /// (all, in the top itself).
    #[inline(always)]
    fn below(&self, j: usize) -> (&[u32], &[f64], usize) {
        let range = self.begin[j] as usize + 1..self.begin[j + 1] as usize;
        let inner = self.inner_end[j] as usize - range.start;
        (&self.rows[range.clone()], &self.values[range], inner)
    }

    /// L y = b for the columns in `range`, whose unknowns are `own`; rows from `bottom` on go to `top`.
    fn forward<const D: usize>(
        &self,
        range: Range<usize>,
        bottom: usize,
        own: &mut [[f64; D]],
        top: &mut [[f64; D]],
    ) {
        let first = range.start;
        for j in range {
            let (rows, values, inner) = self.below(j);
            let inverse = self.inverse_diagonal[j];
            let xj = own[j - first].map(|v| v * inverse);
            own[j - first] = xj;
            for (&row, &l) in rows[..inner].iter().zip(&values[..inner]) {
                let target = &mut own[row as usize - first];
                for d in 0..D {
                    target[d] -= l * xj[d];
                }
            }
            for (&row, &l) in rows[inner..].iter().zip(&values[inner..]) {
                let target = &mut top[row as usize - bottom];
                for d in 0..D {
                    target[d] -= l * xj[d];
                }
            }
        }
    }

    /// Lᵀ x = y for the columns in `range`; rows from `bottom` on are read from `top`.
    fn backward<const D: usize>(
        &self,
        range: Range<usize>,
        bottom: usize,
        own: &mut [[f64; D]],
        top: &[[f64; D]],
    ) {
        let first = range.start;
        for j in range.rev() {
            let (rows, values, inner) = self.below(j);
            let mut sum = own[j - first];
            subtract_products(&mut sum, &rows[..inner], &values[..inner], own, first);
            subtract_products(&mut sum, &rows[inner..], &values[inner..], top, bottom);
            let inverse = self.inverse_diagonal[j];
            own[j - first] = sum.map(|v| v * inverse);
        }
    }
}

/// sum −= Σ l x_row, in two interleaved chains.
#[inline(always)]
fn subtract_products<const D: usize>(
    sum: &mut [f64; D],
    rows: &[u32],
    values: &[f64],
    x: &[[f64; D]],
    first: usize,
) {
    let mut odd = [0.0; D];
    let (row_pairs, last_row) = rows.as_chunks::<2>();
    let (value_pairs, last_value) = values.as_chunks::<2>();
    for (row, l) in row_pairs.iter().zip(value_pairs) {
        let (a, b) = (&x[row[0] as usize - first], &x[row[1] as usize - first]);
        for d in 0..D {
            sum[d] -= l[0] * a[d];
            odd[d] -= l[1] * b[d];
        }
    }
    if let (Some(&row), Some(&l)) = (last_row.first(), last_value.first()) {
        for d in 0..D {
            sum[d] -= l * x[row as usize - first][d];
        }
    }
    for d in 0..D {
        sum[d] += odd[d];
    }
}
