//! Triangular solves with a factor in panels, part by part.

use super::chains::{Chains, Gathered};
use super::panels::{Panel, Panels, Part, ROWS, WIDEST};
use crate::parallel;
use core::ops::Range;
use wide::f64x4;

/// L in panels.
#[derive(Clone, Copy)]
pub struct Factor<'a> {
    /// Which columns and rows.
    pub panels: &'a Panels,
    /// Their values.
    pub values: &'a [f64],
    /// 1/L_jj.
    pub inverse_diagonal: &'a [f64],
}

/// What is done with a part: its first column, the part, its unknowns, its workspace.
type EachPart<'a, const D: usize> =
    dyn Fn(usize, Part, &mut [[f64; D]], &mut [[f64; D]]) + Sync + 'a;

/// Runs each part with its own unknowns and its workspace, side by side where there are threads.
fn for_each_part<const D: usize>(
    first: usize,
    parts: &[Part],
    own: &mut [[f64; D]],
    work: &mut [[f64; D]],
    each: &EachPart<D>,
) {
    match parts {
        [] => {}
        [part] => each(first, *part, own, work),
        _ => {
            let half = parts.len() / 2;
            let middle = parts[half - 1].end;
            let each_work = work.len() / parts.len();
            let (own_a, own_b) = own.split_at_mut(middle - first);
            let (work_a, work_b) = work.split_at_mut(half * each_work);
            parallel::join(
                || for_each_part(first, &parts[..half], own_a, work_a, each),
                || for_each_part(middle, &parts[half..], own_b, work_b, each),
            );
        }
    }
}

impl Factor<'_> {
    /// Solves L Lᵀ X = B in place, X interleaved, level by level. Sums are taken in the order of the
    /// parts, whatever the number of threads. `work` has room for D × [`Panels::work`] numbers.
    pub fn solve<const D: usize>(&self, x: &mut [[f64; D]], work: &mut [f64]) {
        let work = work.as_chunks_mut::<D>().0;
        let mut begin = 0;
        for parts in &self.panels.levels {
            let end = parts.last().map_or(begin, |part| part.end);
            let (own, later) = x[begin..].split_at_mut(end - begin);
            let work = &mut work[..parts.len() * later.len()];
            for_each_part(begin, parts, own, work, &|first, part, own, later| {
                later.fill([0.0; D]);
                let panels = part.begin_panel..part.end_panel;
                Forward {
                    factor: self,
                    panels,
                    first,
                    own,
                    end,
                    later,
                }
                .run();
            });
            for add in work.chunks_exact(later.len().max(1)) {
                for (x, add) in later.iter_mut().zip(add) {
                    for d in 0..D {
                        x[d] += add[d];
                    }
                }
            }
            begin = end;
        }
        for (level, parts) in self.panels.levels.iter().enumerate().rev() {
            let before = level.checked_sub(1).map(|l| &self.panels.levels[l]);
            let begin = before
                .and_then(|parts| parts.last())
                .map_or(0, |part| part.end);
            let end = parts.last().map_or(begin, |part| part.end);
            let (own, later) = x[begin..].split_at_mut(end - begin);
            let later = &*later;
            for_each_part(begin, parts, own, &mut [], &|first, part, own, _| {
                let panels = part.begin_panel..part.end_panel;
                Backward {
                    factor: self,
                    panels,
                    first,
                    own,
                    end,
                    later,
                }
                .run();
            });
        }
    }
}

/// The columns of a panel's triangle at the diagonal, one after the other, without the diagonal:
/// where each begins.
#[inline(always)]
fn triangle_column(panel: &Panel, local: usize) -> Range<usize> {
    let width = panel.width as usize;
    let begin = panel.values as usize + local * width - local * local.saturating_sub(1) / 2 + 1;
    begin..begin + width - 1 - local
}

/// L y = b for some panels, the first of which belongs to the unknown `first`; rows from `end` on are
/// added up in `later`.
struct Forward<'a, const D: usize> {
    factor: &'a Factor<'a>,
    panels: Range<usize>,
    first: usize,
    own: &'a mut [[f64; D]],
    end: usize,
    later: &'a mut [[f64; D]],
}

impl<const D: usize> Forward<'_, D> {
    fn run(self) {
        let Self {
            factor,
            panels,
            first,
            own,
            end,
            later,
        } = self;
        for panel in &factor.panels.panels[panels] {
            let (start, width) = (panel.first as usize, panel.width as usize);
            let x = start - first;
            for local in 0..width {
                let inverse = factor.inverse_diagonal[start + local];
                let mut xj = own[x + local];
                for d in 0..D {
                    xj[d] *= inverse;
                }
                own[x + local] = xj;
                let column = &factor.values[triangle_column(panel, local)];
                for (target, l) in own[x + local + 1..].iter_mut().zip(column) {
                    for d in 0..D {
                        target[d] -= l * xj[d];
                    }
                }
            }
            let below = panel.values as usize + panel.triangle();
            let fours = factor.panels.rows[panel.rows()].iter();
            let blocks = factor.values[below..].chunks_exact(width * ROWS);
            for (number, (rows, block)) in fours.zip(blocks).enumerate() {
                // by right-hand side: four rows are one register of AVX, or two of the others
                let mut sum = [f64x4::ZERO; D];
                for (l, x) in block.as_chunks::<ROWS>().0.iter().zip(&own[x..]) {
                    let l = f64x4::new(*l);
                    for d in 0..D {
                        sum[d] += l * f64x4::splat(x[d]);
                    }
                }
                let sum = sum.map(f64x4::to_array);
                let (target, base) = match number < panel.inner as usize {
                    true => (&mut *own, first),
                    false => (&mut *later, end),
                };
                for k in 0..ROWS {
                    let target = &mut target[rows[k] as usize - base];
                    for d in 0..D {
                        target[d] -= sum[d][k];
                    }
                }
            }
        }
    }
}

/// Rows, in fours, that are gathered at a time.
const GATHERED: usize = 32;

/// sums_c += Σ l_c x over the rows, for C columns from `column` on, in two chains each.
#[inline(always)]
fn add_products<const C: usize, const D: usize>(
    sums: &mut [[f64; D]],
    values: &[[f64; ROWS]],
    width: usize,
    column: usize,
    gathered: &[Gathered<D>],
) {
    let mut chains = [Chains::<D>::ZERO; C];
    for (l, x) in values.chunks_exact(width).zip(gathered).rev() {
        for (chains, l) in chains.iter_mut().zip(&l[column..column + C]) {
            chains.add_products(l, x);
        }
    }
    for (sums, chains) in sums.iter_mut().zip(chains) {
        let chains = chains.sums();
        for d in 0..D {
            sums[d] += chains[d];
        }
    }
}

/// Lᵀ x = y for some panels, from the last to the first; rows from `end` on are read from
/// `later`.
struct Backward<'a, const D: usize> {
    factor: &'a Factor<'a>,
    panels: Range<usize>,
    first: usize,
    own: &'a mut [[f64; D]],
    end: usize,
    later: &'a [[f64; D]],
}

impl<const D: usize> Backward<'_, D> {
    fn run(self) {
        let Self {
            factor,
            panels,
            first,
            own,
            end,
            later,
        } = self;
        let mut gathered = [Chains::<D>::NOTHING; GATHERED];
        for panel in factor.panels.panels[panels].iter().rev() {
            let (start, width) = (panel.first as usize, panel.width as usize);
            let x = start - first;
            let mut sums = [[0.0; D]; WIDEST];
            let below = panel.values as usize + panel.triangle();
            let (rows, inner) = (panel.rows(), panel.inner as usize);
            let rows = &factor.panels.rows[rows];
            let values = &factor.values[below..below + rows.len() * width * ROWS];
            let values = values.as_chunks::<ROWS>().0;
            // from the last row to the first: L is read against its direction throughout, so that the
            // processor can see what will be needed
            for begin in (0..rows.len()).step_by(GATHERED).rev() {
                let rows = &rows[begin..(begin + GATHERED).min(rows.len())];
                let gathered = &mut gathered[..rows.len()];
                let own_rows = inner.saturating_sub(begin).min(rows.len());
                for (x, rows) in gathered.iter_mut().zip(&rows[..own_rows]) {
                    *x = Chains::gather(rows.map(|row| own[row as usize - first]));
                }
                for (x, rows) in gathered[own_rows..].iter_mut().zip(&rows[own_rows..]) {
                    *x = Chains::gather(rows.map(|row| later[row as usize - end]));
                }
                let values = &values[begin * width..(begin + rows.len()) * width];
                let mut column = 0;
                for sums in sums[..width].chunks_mut(4) {
                    match sums.len() {
                        1 => add_products::<1, D>(sums, values, width, column, gathered),
                        2 => add_products::<2, D>(sums, values, width, column, gathered),
                        3 => add_products::<3, D>(sums, values, width, column, gathered),
                        _ => add_products::<4, D>(sums, values, width, column, gathered),
                    }
                    column += sums.len();
                }
            }
            for local in (0..width).rev() {
                let mut xj = own[x + local];
                for d in 0..D {
                    xj[d] -= sums[local][d];
                }
                let column = &factor.values[triangle_column(panel, local)];
                for (other, l) in own[x + local + 1..].iter().zip(column) {
                    for d in 0..D {
                        xj[d] -= l * other[d];
                    }
                }
                let inverse = factor.inverse_diagonal[start + local];
                for d in 0..D {
                    xj[d] *= inverse;
                }
                own[x + local] = xj;
            }
        }
    }
}
