//! Collecting a problem, and what is checked of it.

use super::problem::{check, finite};
use super::{MixedIntegerError as Error, Problem};
use crate::linalg::SymmetricAssembly;
use nalgebra_sparse::CscMatrix;

/// Collects a [`Problem`]; what is wrong is said by [`ProblemBuilder::build`].
#[derive(Debug, Clone, Default)]
pub struct ProblemBuilder {
    unknowns: usize,
    rows: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
    linear: Vec<f64>,
    begin: Vec<usize>,
    terms: Vec<(u32, f64)>,
    constants: Vec<f64>,
    integers: Vec<u32>,
    /// The first coefficient whose row does not exist: its place, that row, and how many there are.
    stray: Option<(usize, u32, usize)>,
}

impl ProblemBuilder {
    pub(super) fn new(unknowns: usize) -> Self {
        Self {
            unknowns,
            linear: vec![0.0; unknowns],
            begin: vec![0],
            ..Self::default()
        }
    }

    /// Adds `value` to A at (row, column). Both triangles of A are to be given; what is given for the same
    /// place adds up.
    pub fn quadratic(mut self, row: u32, column: u32, value: f64) -> Self {
        self.push_quadratic(row, column, value);
        self
    }

    /// [`Self::quadratic`] for whole lists of equal length (of which the shortest counts).
    pub fn quadratics(mut self, rows: &[u32], columns: &[u32], values: &[f64]) -> Self {
        for ((&row, &column), &value) in rows.iter().zip(columns).zip(values) {
            self.push_quadratic(row, column, value);
        }
        self
    }

    /// [`Self::quadratic`] in a loop.
    pub fn push_quadratic(&mut self, row: u32, column: u32, value: f64) {
        self.rows.push(row);
        self.columns.push(column);
        self.values.push(value);
    }

    /// Sets b (length n).
    pub fn linear(mut self, linear: &[f64]) -> Self {
        self.linear = linear.to_vec();
        self
    }

    /// Adds the row Σ coefficient · x + constant = 0. Terms of the same unknown add up.
    pub fn constraint(mut self, terms: &[(u32, f64)], constant: f64) -> Self {
        self.push_constraint(terms, constant);
        self
    }

    /// [`Self::constraint`] in a loop.
    pub fn push_constraint(&mut self, terms: &[(u32, f64)], constant: f64) {
        let begin = self.terms.len();
        self.terms.extend_from_slice(terms);
        self.terms[begin..].sort_by_key(|&(unknown, _)| unknown);
        self.begin.push(self.terms.len());
        self.constants.push(constant);
    }

    /// Adds as many rows as there are constants, from triplets: `coefficients[t]` stands in row `rows[t]`
    /// (0 is the first of these rows) at unknown `unknowns[t]`. Of lists of different lengths the shortest
    /// counts.
    pub fn constraints(
        mut self,
        rows: &[u32],
        unknowns: &[u32],
        coefficients: &[f64],
        constants: &[f64],
    ) -> Self {
        let mut begin = vec![0; constants.len() + 1];
        for (position, &row) in rows.iter().enumerate() {
            match begin.get_mut(row as usize + 1) {
                Some(count) => *count += 1,
                None => {
                    self.stray.get_or_insert((position, row, constants.len()));
                    return self;
                }
            }
        }
        for row in 0..constants.len() {
            begin[row + 1] += begin[row];
        }
        let mut next = begin.clone();
        let mut terms = vec![(0, 0.0); rows.len()];
        let places = rows.iter().zip(unknowns).zip(coefficients);
        for ((&row, &unknown), &coefficient) in places {
            let place = &mut next[row as usize];
            terms[*place] = (unknown, coefficient);
            *place += 1;
        }
        for (row, &constant) in constants.iter().enumerate() {
            self.push_constraint(&terms[begin[row]..next[row]], constant);
        }
        self
    }

    /// Makes an unknown an integer.
    pub fn integer(mut self, unknown: u32) -> Self {
        self.integers.push(unknown);
        self
    }

    /// Makes unknowns integers.
    pub fn integers(mut self, unknowns: &[u32]) -> Self {
        self.integers.extend_from_slice(unknowns);
        self
    }

    /// Checks everything.
    ///
    /// # Errors
    /// `WrongLength` (b), `IndexOutOfRange`, `RowOutOfRange`, `NonFinite`, `NotSymmetric`, `IntegerTwice`.
    pub fn build(self) -> Result<Problem, Error> {
        let unknowns = self.unknowns;
        if let Some((position, row, rows)) = self.stray {
            return Err(Error::RowOutOfRange {
                position,
                row,
                rows,
            });
        }
        check("linear", Some(&self.linear), unknowns)?;
        let in_range = |item, position, index: u32| match (index as usize) < unknowns {
            true => Ok(()),
            false => Err(Error::IndexOutOfRange {
                item,
                position,
                index: u64::from(index),
                unknowns,
            }),
        };
        let places = self.rows.iter().zip(&self.columns).enumerate();
        for (position, (&row, &column)) in places {
            in_range("matrix entry", position, row)?;
            in_range("matrix entry", position, column)?;
        }
        finite("matrix entry", &self.values)?;
        finite("the constant of constraint row", &self.constants)?;
        for row in 0..self.constants.len() {
            for &(unknown, coefficient) in &self.terms[self.begin[row]..self.begin[row + 1]] {
                in_range("constraint row", row, unknown)?;
                if !coefficient.is_finite() {
                    return Err(Error::NonFinite {
                        item: "a coefficient of constraint row",
                        position: row,
                    });
                }
            }
        }
        for (position, &index) in self.integers.iter().enumerate() {
            in_range("integer", position, index)?;
        }
        let mut integers = self.integers.clone();
        integers.sort_unstable();
        if let Some(twice) = integers.windows(2).find(|pair| pair[0] == pair[1]) {
            let index = twice[0] as usize;
            return Err(Error::IntegerTwice { index });
        }
        let matrix = self.symmetric(unknowns)?;
        let (begin, terms) = self.merged();
        Ok(Problem {
            matrix,
            linear: self.linear,
            begin,
            terms,
            constants: self.constants,
            integers,
        })
    }

    /// The lower triangle, once it mirrors the upper to 1e-9 of the diagonal or of itself.
    fn symmetric(&self, unknowns: usize) -> Result<CscMatrix<f64>, Error> {
        const TOLERANCE: f64 = 1e-9;
        let places = self
            .rows
            .iter()
            .zip(&self.columns)
            .map(|(&row, &column)| (row, column));
        let mut assembly = SymmetricAssembly::new(unknowns, places);
        let (rows, columns, values) = (&self.rows, &self.columns, &self.values);
        assembly.fill(|t| {
            if rows[t] <= columns[t] {
                values[t]
            } else {
                0.0
            }
        });
        let upper = assembly.matrix().clone();
        assembly.fill(|t| {
            if rows[t] >= columns[t] {
                values[t]
            } else {
                0.0
            }
        });
        let mut matrix = assembly.matrix().clone();
        let diagonal: Vec<f64> = (0..unknowns)
            .map(|j| matrix.values()[matrix.pattern().major_offsets()[j]])
            .collect();
        for ((row, column, &value), &mirrored) in matrix.triplet_iter().zip(upper.values()) {
            let scale = (diagonal[row] * diagonal[column]).abs().sqrt();
            let scale = scale.max(value.abs()).max(mirrored.abs());
            if (value - mirrored).abs() > TOLERANCE * scale {
                return Err(Error::NotSymmetric {
                    row,
                    column,
                    value,
                    mirrored,
                });
            }
        }
        for (value, mirrored) in matrix.values_mut().iter_mut().zip(upper.values()) {
            *value = value.midpoint(*mirrored);
        }
        Ok(matrix)
    }

    /// Rows with one term an unknown and without zeros.
    fn merged(&self) -> (Vec<usize>, Vec<(u32, f64)>) {
        let mut begin = vec![0];
        let mut terms: Vec<(u32, f64)> = Vec::with_capacity(self.terms.len());
        for ends in self.begin.windows(2) {
            let first = terms.len();
            for &(unknown, coefficient) in &self.terms[ends[0]..ends[1]] {
                match terms[first..].last_mut() {
                    Some(last) if last.0 == unknown => last.1 += coefficient,
                    _ => terms.push((unknown, coefficient)),
                }
            }
            let kept: Vec<_> = terms.drain(first..).filter(|&(_, a)| a != 0.0).collect();
            terms.extend(kept);
            begin.push(terms.len());
        }
        (begin, terms)
    }
}
