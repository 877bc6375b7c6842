//! Rows of one or two unknowns, of which alignments and seams make thousands: they come first in the order of
//! elimination, and are solved without touching longer rows, in which every unknown is replaced once, when all of these
//! have been solved. Replacing in long rows what each short row is solved for takes, for a chain of k equal unknowns, k
//! passes over them.

use super::constants::Constants;
use super::integer_row::EXACT;
use super::rows::{CANCELLED, Rows};
use super::{Elimination, Error};

/// A solved row a · x + b · other + constant = 0.
#[derive(Clone, Copy)]
struct Link {
    row: u32,
    a: f64,
    /// `None`: the unknown is a constant.
    other: Option<(u32, f64)>,
    /// Its place among the substitutions.
    substitution: usize,
}

/// What each unknown was solved for by a row of one or two unknowns.
pub(super) struct Pairs {
    link: Vec<Option<Link>>,
    /// Unknowns on the way to the end of a chain.
    way: Vec<u32>,
    /// Coefficients of a row being rewritten.
    terms: Vec<(u32, f64)>,
}

impl Pairs {
    pub fn new(unknowns: usize) -> Self {
        Self {
            link: vec![None; unknowns],
            way: Vec::new(),
            terms: Vec::new(),
        }
    }

    /// Can the row be solved here: at most two unknowns, one of them real, or both with the same coefficient but for
    /// its sign?
    pub fn takes(rows: &Rows, row: u32) -> bool {
        match rows.terms(row) {
            [] | [_] => true,
            [x, y] => rows.is_real(x.0) || rows.is_real(y.0) || x.1.abs() == y.1.abs(),
            _ => false,
        }
    }

    /// Remembers that `row` (whose terms these are) was solved for `pivot`.
    pub fn solved(&mut self, row: u32, pivot: u32, solved: &[(u32, f64)], substitution: usize) {
        let mut link = Link {
            row,
            a: 1.0,
            other: None,
            substitution,
        };
        for &(unknown, coefficient) in solved {
            match unknown == pivot {
                true => link.a = coefficient,
                false => link.other = Some((unknown, coefficient)),
            }
        }
        self.link[pivot as usize] = Some(link);
    }

    /// The link of an unknown that was solved for, to one that was not.
    fn end_of(
        &mut self,
        unknown: u32,
        elimination: &mut Elimination,
        constants: &mut Constants,
    ) -> Result<Option<Link>, Error> {
        let mut way = std::mem::take(&mut self.way);
        way.clear();
        let mut end = unknown;
        while let Some(link) = self.link[end as usize] {
            way.push(end);
            match link.other {
                Some((other, _)) => end = other,
                None => break,
            }
        }
        // from the end: every link leads there directly afterwards
        for k in (0..way.len().saturating_sub(1)).rev() {
            let (Some(first), Some(next)) =
                (self.link[way[k] as usize], self.link[way[k + 1] as usize])
            else {
                unreachable!("links were followed");
            };
            let Some((_, b)) = first.other else {
                unreachable!("links were followed");
            };
            let factor = b / next.a;
            elimination.subtract(constants, first.row, next.row, factor)?;
            let other = next.other.map(|(other, c)| (other, -factor * c));
            let terms = &mut elimination.substitutions[first.substitution].terms;
            terms.clear();
            terms.extend(other.map(|(other, c)| (other, -c / first.a)));
            self.link[way[k] as usize] = Some(Link { other, ..first });
        }
        self.way = way;
        Ok(self.link[unknown as usize])
    }

    /// Replaces in an open row what was solved for.
    pub fn rewrite(
        &mut self,
        rows: &mut Rows,
        row: u32,
        elimination: &mut Elimination,
        constants: &mut Constants,
    ) -> Result<(), Error> {
        let old = rows.terms(row);
        if old.iter().all(|t| self.link[t.0 as usize].is_none()) {
            return Ok(());
        }
        let old = old.to_vec();
        let mut terms = std::mem::take(&mut self.terms);
        terms.clear();
        for (unknown, coefficient) in old {
            let Some(link) = self.end_of(unknown, elimination, constants)? else {
                terms.push((unknown, coefficient));
                continue;
            };
            let factor = coefficient / link.a;
            elimination.subtract(constants, row, link.row, factor)?;
            terms.extend(link.other.map(|(other, b)| (other, -factor * b)));
        }
        terms.sort_by_key(|t| t.0);
        let summed = terms.chunk_by(|s, t| s.0 == t.0).filter_map(|same| {
            let sum: f64 = same.iter().map(|t| t.1).sum();
            let size: f64 = same.iter().map(|t| t.1.abs()).sum();
            // integers are exact: only a real cancellation leaves rounding errors
            let exact = size < EXACT && same.iter().all(|t| t.1.fract() == 0.0);
            let noise = if exact { 0.0 } else { CANCELLED * size };
            (sum.abs() > noise).then_some((same[0].0, sum))
        });
        rows.replace(row, summed.collect());
        self.terms = terms;
        Ok(())
    }
}
