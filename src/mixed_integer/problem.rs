//! The problem: minimise ½ xᵀA x − bᵀx subject to rows·x + constants = 0 and integers (equations 1–3
//! of Bommes, Zimmer & Kobbelt 2010).

use super::MixedIntegerError as Error;
use crate::linalg::SymmetricAssembly;
use nalgebra_sparse::CscMatrix;

/// An immutable mixed-integer quadratic problem on n real unknowns, some of which have to be integers.
#[derive(Debug, Clone)]
pub struct Problem {
    /// A, its lower triangle by columns, n×n.
    matrix: CscMatrix<f64>,
    /// b, length n.
    linear: Vec<f64>,
    /// Where each constraint row begins; length: rows + 1.
    begin: Vec<usize>,
    /// Unknown and coefficient, row by row, ascending, without zeros.
    terms: Vec<(u32, f64)>,
    /// The c of row·x + c = 0.
    constants: Vec<f64>,
    /// Ascending.
    integers: Vec<u32>,
}

impl Problem {
    /// Begins a problem on `unknowns` unknowns with A = 0, b = 0, no constraint and no integer.
    pub fn builder(unknowns: usize) -> ProblemBuilder {
        ProblemBuilder {
            unknowns,
            linear: vec![0.0; unknowns],
            begin: vec![0],
            ..ProblemBuilder::default()
        }
    }

    /// n.
    pub fn unknowns(&self) -> usize {
        self.linear.len()
    }
    /// A: its lower triangle by columns.
    pub fn matrix(&self) -> &CscMatrix<f64> {
        &self.matrix
    }
    /// b, length n.
    pub fn linear(&self) -> &[f64] {
        &self.linear
    }
    /// Number of constraint rows.
    pub fn rows(&self) -> usize {
        self.constants.len()
    }
    /// Unknown and coefficient of each term of a row, ascending, without zeros.
    pub fn row(&self, row: usize) -> &[(u32, f64)] {
        &self.terms[self.begin[row]..self.begin[row + 1]]
    }
    /// The c of row·x + c = 0, one a row.
    pub fn constants(&self) -> &[f64] {
        &self.constants
    }
    /// The unknowns that have to be integers, ascending.
    pub fn integers(&self) -> &[u32] {
        &self.integers
    }

    /// ½ xᵀA x − bᵀx for x of length n.
    pub fn energy(&self, x: &[f64]) -> f64 {
        let mut product = vec![0.0; x.len()];
        multiply(&self.matrix, x, &mut product);
        let each = x.iter().zip(&product).zip(&self.linear);
        each.map(|((x, ax), b)| x * (0.5 * ax - b)).sum()
    }

    /// The largest |row·x + c|, each relative to the largest of its terms and 1.
    pub fn violation(&self, x: &[f64]) -> f64 {
        let of_row = |row: usize| {
            let (mut sum, mut scale) = (self.constants[row], self.constants[row].abs().max(1.0));
            for &(unknown, coefficient) in self.row(row) {
                let term = coefficient * x[unknown as usize];
                sum += term;
                scale = scale.max(term.abs());
            }
            sum.abs() / scale
        };
        (0..self.rows()).map(of_row).fold(0.0, f64::max)
    }

    /// The same problem with other b and constants: what [`super::MixedInteger::resolve`] solves.
    ///
    /// # Errors
    /// `WrongLength`, `NonFinite`.
    pub fn replace(
        &mut self,
        linear: Option<&[f64]>,
        constants: Option<&[f64]>,
    ) -> Result<(), Error> {
        check("linear", linear, self.linear.len())?;
        check("constants", constants, self.constants.len())?;
        if let Some(linear) = linear {
            self.linear.copy_from_slice(linear);
        }
        if let Some(constants) = constants {
            self.constants.copy_from_slice(constants);
        }
        Ok(())
    }
}

fn check(argument: &'static str, values: Option<&[f64]>, expected: usize) -> Result<(), Error> {
    let Some(values) = values else { return Ok(()) };
    if values.len() != expected {
        let found = values.len();
        return Err(Error::WrongLength {
            argument,
            expected,
            found,
        });
    }
    finite(argument, values)
}

fn finite(item: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(position) => Err(Error::NonFinite { item, position }),
        None => Ok(()),
    }
}

/// product = A x, A given by its lower triangle.
pub(super) fn multiply(lower: &CscMatrix<f64>, x: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    let (offsets, rows, values) = lower.csc_data();
    for (j, ends) in offsets.windows(2).enumerate() {
        let mut sum = 0.0;
        for (&i, &a) in rows[ends[0]..ends[1]].iter().zip(&values[ends[0]..ends[1]]) {
            product[i] += a * x[j];
            if i != j {
                sum += a * x[i];
            }
        }
        product[j] += sum;
    }
}

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
}

impl ProblemBuilder {
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
    /// `WrongLength` (b), `IndexOutOfRange`, `NonFinite`, `NotSymmetric`, `IntegerTwice`.
    pub fn build(self) -> Result<Problem, Error> {
        let unknowns = self.unknowns;
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
