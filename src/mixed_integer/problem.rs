//! The problem: minimise ½ xᵀA x − bᵀx subject to rows·x + constants = 0 and integers (equations 1–3
//! of Bommes, Zimmer & Kobbelt 2010).

use super::{MixedIntegerError as Error, ProblemBuilder};
use nalgebra_sparse::CscMatrix;

/// An immutable mixed-integer quadratic problem on n real unknowns, some of which have to be integers.
#[derive(Debug, Clone)]
pub struct Problem {
    /// A, its lower triangle by columns, n×n.
    pub(super) matrix: CscMatrix<f64>,
    /// b, length n.
    pub(super) linear: Vec<f64>,
    /// Where each constraint row begins; length: rows + 1.
    pub(super) begin: Vec<usize>,
    /// Unknown and coefficient, row by row, ascending, without zeros.
    pub(super) terms: Vec<(u32, f64)>,
    /// The c of row·x + c = 0.
    pub(super) constants: Vec<f64>,
    /// Ascending.
    pub(super) integers: Vec<u32>,
}

impl Problem {
    /// Begins a problem on `unknowns` unknowns with A = 0, b = 0, no constraint and no integer.
    pub fn builder(unknowns: usize) -> ProblemBuilder {
        ProblemBuilder::new(unknowns)
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

pub(super) fn check(
    argument: &'static str,
    values: Option<&[f64]>,
    expected: usize,
) -> Result<(), Error> {
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

pub(super) fn finite(item: &'static str, values: &[f64]) -> Result<(), Error> {
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
