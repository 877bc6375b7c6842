//! The constraint rows while they are being eliminated.

use super::integer_row::EXACT;
use super::order::Queue;
use crate::mixed_integer::{MixedIntegerError as Error, Problem};

/// A coefficient at least this large, relative to the row's largest, is stable enough to divide by.
const STABLE: f64 = 0.5;

/// What is left of two terms that cancel, relative to them, and counts as 0 unless they are whole numbers.
pub(super) const CANCELLED: f64 = 1e-11;

/// Sparse rows, and for each unknown the rows it may be in.
pub(super) struct Rows {
    /// Ascending; emptied when a row is closed.
    terms: Vec<Vec<(u32, f64)>>,
    open: Vec<bool>,
    /// Rows of each unknown, once each; rows that have lost it since are among them.
    rows_of: Vec<Vec<u32>>,
    is_integer: Vec<bool>,
    /// Open rows that hold each unknown.
    holders: Vec<u32>,
    /// Entries of A in the columns of each unknown and of those that are expressed by it: what solving for it
    /// would fill.
    weight: Vec<u32>,
    /// For merging.
    merged: Vec<(u32, f64)>,
}

impl Rows {
    pub fn new(problem: &Problem) -> Self {
        let n = problem.unknowns();
        let mut is_integer = vec![false; n];
        for &i in problem.integers() {
            is_integer[i as usize] = true;
        }
        let mut weight = vec![0; n];
        for (i, j, _) in problem.matrix().triplet_iter() {
            weight[i] += 1;
            weight[j] += 1;
        }
        let terms: Vec<Vec<(u32, f64)>> = (0..problem.rows())
            .map(|row| problem.row(row).to_vec())
            .collect();
        let mut rows_of = vec![Vec::new(); n];
        for (row, terms) in terms.iter().enumerate() {
            for &(unknown, _) in terms {
                rows_of[unknown as usize].push(row as u32);
            }
        }
        Self {
            open: vec![true; terms.len()],
            holders: rows_of.iter().map(|list| list.len() as u32).collect(),
            terms,
            rows_of,
            is_integer,
            weight,
            merged: Vec::new(),
        }
    }

    pub fn len(&self) -> usize {
        self.terms.len()
    }
    pub fn terms(&self, row: u32) -> &[(u32, f64)] {
        &self.terms[row as usize]
    }
    pub fn is_real(&self, unknown: u32) -> bool {
        !self.is_integer[unknown as usize]
    }
    pub fn is_open(&self, row: u32) -> bool {
        self.open[row as usize]
    }

    /// The largest coefficient of each row.
    pub fn scales(&self) -> Vec<f64> {
        let largest = |terms: &Vec<(u32, f64)>| terms.iter().map(|t| t.1.abs()).fold(0.0, f64::max);
        self.terms.iter().map(largest).collect()
    }

    /// The coefficient of an unknown, 0 where it is not in the row.
    pub fn coefficient(&self, row: u32, unknown: u32) -> f64 {
        let terms = self.terms(row);
        let place = terms.binary_search_by_key(&unknown, |t| t.0);
        place.map_or(0.0, |place| terms[place].1)
    }

    /// Drops coefficients that are nothing beside the row's largest.
    pub fn drop_noise(&mut self, row: u32, tolerance: f64) {
        let terms = &mut self.terms[row as usize];
        let largest = terms.iter().map(|t| t.1.abs()).fold(0.0, f64::max);
        terms.retain(|t| {
            let is_kept = t.1.abs() > 1e-3 * tolerance * largest;
            self.holders[t.0 as usize] -= u32::from(!is_kept);
            is_kept
        });
    }

    pub fn set_coefficients(&mut self, row: u32, coefficients: &[f64]) {
        for (term, &a) in self.terms[row as usize].iter_mut().zip(coefficients) {
            term.1 = a;
        }
    }

    /// Other terms (ascending) for an open row.
    pub fn replace(&mut self, row: u32, terms: Vec<(u32, f64)>) {
        let old = std::mem::take(&mut self.terms[row as usize]);
        for &(unknown, _) in &old {
            self.holders[unknown as usize] -= 1;
        }
        for &(unknown, _) in &terms {
            self.holders[unknown as usize] += 1;
            if old.binary_search_by_key(&unknown, |t| t.0).is_err() {
                self.rows_of[unknown as usize].push(row);
            }
        }
        self.terms[row as usize] = terms;
    }

    /// Takes a row out.
    pub fn close(&mut self, row: u32) -> Vec<(u32, f64)> {
        self.open[row as usize] = false;
        let terms = std::mem::take(&mut self.terms[row as usize]);
        for &(unknown, _) in &terms {
            self.holders[unknown as usize] -= 1;
        }
        terms
    }

    /// The open rows that may hold an unknown, ascending.
    pub fn open_rows_of(&mut self, unknown: u32) -> Vec<u32> {
        let mut list = std::mem::take(&mut self.rows_of[unknown as usize]);
        list.retain(|&row| self.open[row as usize]);
        list.sort_unstable();
        list.dedup();
        list
    }

    /// `pivot` is expressed by the other unknowns of its row from now on, which inherit its weight.
    pub fn inherit(&mut self, pivot: u32, solved: &[(u32, f64)]) {
        let weight = self.weight[pivot as usize];
        for &(unknown, _) in solved {
            let own = &mut self.weight[unknown as usize];
            *own = own.saturating_add(weight);
        }
    }

    /// A real unknown to solve the row for: one of the largest coefficients, in fewest open rows, then of the least
    /// weight, then first.
    pub fn real_pivot(&self, row: u32) -> Option<u32> {
        let reals = self.terms(row).iter();
        let reals = reals.filter(|t| !self.is_integer[t.0 as usize]);
        let largest = reals.clone().map(|t| t.1.abs()).fold(0.0, f64::max);
        let stable = reals.filter(|t| t.1.abs() >= STABLE * largest);
        let stable = stable.map(|t| t.0 as usize);
        let cheapest = stable.min_by_key(|&i| (self.holders[i], self.weight[i], i));
        cheapest.map(|i| i as u32)
    }

    /// An integer with the coefficient ±1: of the least weight, then in fewest open rows, then first. What few integers
    /// express many unknowns by is what fills the reduced matrix, more than anything in between.
    pub fn unit_pivot(&self, row: u32) -> Option<u32> {
        let units = self.terms(row).iter().filter(|t| t.1.abs() == 1.0);
        let units = units.map(|t| t.0 as usize);
        let lightest = units.min_by_key(|&i| (self.weight[i], self.holders[i], i));
        lightest.map(|i| i as u32)
    }

    /// Row `target` −= factor · `solved`, which takes `pivot` out of it.
    pub fn subtract(&mut self, target: u32, factor: f64, solved: &[(u32, f64)], pivot: u32) {
        self.merge(target, factor, solved, Some(pivot));
    }

    /// Puts z_variable = z_variable' − Σ quotient · z into the open rows and into `row`.
    pub fn substitute(
        &mut self,
        variable: u32,
        quotients: &[(u32, f64)],
        queue: &mut Queue,
        row: u32,
    ) -> Result<(), Error> {
        let list = self.open_rows_of(variable);
        for &target in &list {
            let a = self.coefficient(target, variable);
            if a == 0.0 {
                continue;
            }
            self.merge(target, a, quotients, None);
            queue.changed(target, self);
            if self.terms(target).iter().any(|t| t.1.abs() >= EXACT) {
                return Err(Error::CoefficientsTooLarge { row: row as usize });
            }
        }
        self.rows_of[variable as usize] = list;
        Ok(())
    }

    /// Row `target` −= factor · `other`, both ascending; what cancels is dropped.
    fn merge(&mut self, target: u32, factor: f64, other: &[(u32, f64)], pivot: Option<u32>) {
        let mut merged = std::mem::take(&mut self.merged);
        merged.clear();
        let own = &self.terms[target as usize];
        let (mut a, mut b) = (own.iter().peekable(), other.iter().peekable());
        loop {
            let (i, value) = match (a.peek(), b.peek()) {
                (None, None) => break,
                (Some(&&(i, x)), Some(&&(j, y))) if i == j => {
                    a.next();
                    b.next();
                    let product = factor * y;
                    let (value, size) = (x - product, x.abs().max(product.abs()));
                    // integers are exact: only a real cancellation leaves rounding errors
                    let exact = x.fract() == 0.0 && product.fract() == 0.0 && size < EXACT;
                    if value.abs() <= if exact { 0.0 } else { CANCELLED * size } || Some(i) == pivot
                    {
                        self.holders[i as usize] -= 1;
                        continue;
                    }
                    (i, value)
                }
                (Some(&&(i, x)), next) if next.is_none_or(|t| i < t.0) => {
                    a.next();
                    (i, x)
                }
                (_, Some(&&(j, y))) => {
                    b.next();
                    self.rows_of[j as usize].push(target);
                    self.holders[j as usize] += 1;
                    (j, -factor * y)
                }
                (Some(_), None) => unreachable!("the arm before takes it"),
            };
            merged.push((i, value));
        }
        self.merged = std::mem::replace(&mut self.terms[target as usize], merged);
    }
}
