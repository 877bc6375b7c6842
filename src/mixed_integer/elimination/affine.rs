//! x = T y + t: all unknowns from those that are left.

use super::integer_row::EXACT;
use super::{Elimination, Substitution};
use crate::mixed_integer::{MixedIntegerError as Error, Problem};

/// The largest coefficient of an integer in another: the reduced matrix holds its square, beside which the
/// other entries still have to be something.
const LARGEST: f64 = (1u64 << 20) as f64;

/// The solutions of the constraints, T by rows. What is left keeps the number of the unknown it is (or,
/// after a unimodular change, replaces).
#[derive(Debug, Clone)]
pub struct AffineMap {
    /// The unknowns that are left, ascending.
    pub kept: Vec<u32>,
    /// Where each row begins; length: n + 1.
    begin: Vec<usize>,
    /// Place in `kept` and coefficient, ascending.
    terms: Vec<(u32, f64)>,
    /// Which unknowns are integers, length n.
    is_integer: Vec<bool>,
    /// t, length n.
    pub offset: Vec<f64>,
}

impl AffineMap {
    /// Of all unknowns of the problem, for its constants.
    ///
    /// # Errors
    /// `Contradictory`, `Infeasible` (of other constants than the elimination has seen),
    /// `CoefficientsTooLarge`.
    pub fn new(problem: &Problem, elimination: &Elimination) -> Result<Self, Error> {
        let n = problem.unknowns();
        let mut is_kept = vec![true; n];
        for substitution in &elimination.substitutions {
            if substitution.constant.is_some() {
                is_kept[substitution.variable as usize] = false;
            }
        }
        let kept: Vec<u32> = (0..n as u32).filter(|&i| is_kept[i as usize]).collect();
        let mut place = vec![u32::MAX; n];
        for (k, &i) in kept.iter().enumerate() {
            place[i as usize] = k as u32;
        }
        let mut is_integer = vec![false; n];
        for &i in problem.integers() {
            is_integer[i as usize] = true;
        }
        // rows that are not those of the identity; from the last substitution to the first, whose terms
        // then are expressed in what is left already
        let mut expressed: Vec<Option<Vec<(u32, f64)>>> = vec![None; n];
        let mut sum = Accumulator::new(n);
        for Substitution {
            variable,
            terms,
            constant,
        } in elimination.substitutions.iter().rev()
        {
            for &(i, a) in terms {
                match &expressed[i as usize] {
                    Some(terms) => terms.iter().for_each(|&(k, b)| sum.add(k, a * b)),
                    None => sum.add(i, a),
                }
            }
            let (row, largest) = sum.take();
            if is_integer[*variable as usize] && largest >= LARGEST {
                let row = constant.map_or(0, |c| c.0) as usize;
                return Err(Error::CoefficientsTooLarge { row });
            }
            expressed[*variable as usize] = Some(row);
        }
        let mut this = Self {
            kept,
            begin: vec![0],
            terms: Vec::with_capacity(n),
            offset: vec![0.0; n],
            is_integer,
        };
        for i in 0..n {
            match &expressed[i] {
                Some(terms) => {
                    let placed = terms.iter().map(|&(k, a)| (place[k as usize], a));
                    this.terms.extend(placed);
                }
                None => this.terms.push((place[i], 1.0)),
            }
            this.begin.push(this.terms.len());
        }
        this.set_constants(elimination, problem.constants())?;
        Ok(this)
    }

    /// Sets t for these constants; T does not depend on them.
    ///
    /// # Errors
    /// `Contradictory`, `Infeasible`, `CoefficientsTooLarge`; t is then unchanged.
    pub fn set_constants(
        &mut self,
        elimination: &Elimination,
        constants: &[f64],
    ) -> Result<(), Error> {
        let constants = elimination.replay(constants)?;
        let mut offset = vec![0.0f64; self.offset.len()];
        for substitution in elimination.substitutions.iter().rev() {
            let (mut sum, mut largest) = (0.0f64, 0.0f64);
            for &(i, a) in &substitution.terms {
                let product = a * offset[i as usize];
                sum += product;
                largest = largest.max(product.abs()).max(sum.abs());
            }
            let own = substitution
                .constant
                .map_or(0.0, |(row, factor)| factor * constants[row as usize]);
            if self.is_integer[substitution.variable as usize] && largest.max(own.abs()) >= EXACT {
                let row = substitution.constant.map_or(0, |c| c.0) as usize;
                return Err(Error::CoefficientsTooLarge { row });
            }
            offset[substitution.variable as usize] = sum + own;
        }
        self.offset = offset;
        Ok(())
    }

    /// The row of an unknown: places in `kept` and coefficients, ascending.
    pub fn row(&self, unknown: usize) -> &[(u32, f64)] {
        &self.terms[self.begin[unknown]..self.begin[unknown + 1]]
    }

    /// x = T y + t.
    pub fn apply(&self, y: &[f64], x: &mut [f64]) {
        for (i, (x, offset)) in x.iter_mut().zip(&self.offset).enumerate() {
            let terms = self.row(i).iter();
            *x = offset + terms.map(|&(k, a)| a * y[k as usize]).sum::<f64>();
        }
    }

    /// y += Tᵀ g.
    pub fn add_transposed(&self, g: &[f64], y: &mut [f64]) {
        for (i, g) in g.iter().enumerate() {
            for &(k, a) in self.row(i) {
                y[k as usize] += a * g;
            }
        }
    }
}

/// A sparse sum.
struct Accumulator {
    values: Vec<f64>,
    is_touched: Vec<bool>,
    touched: Vec<u32>,
    /// The largest number that came up.
    largest: f64,
}

impl Accumulator {
    fn new(n: usize) -> Self {
        Self {
            values: vec![0.0; n],
            is_touched: vec![false; n],
            touched: Vec::new(),
            largest: 0.0,
        }
    }

    fn add(&mut self, index: u32, value: f64) {
        if !std::mem::replace(&mut self.is_touched[index as usize], true) {
            self.touched.push(index);
        }
        let sum = &mut self.values[index as usize];
        *sum += value;
        self.largest = self.largest.max(value.abs()).max(sum.abs());
    }

    /// The sum without zeros, ascending, and the largest number on the way; it begins anew.
    fn take(&mut self) -> (Vec<(u32, f64)>, f64) {
        self.touched.sort_unstable();
        let mut out = Vec::with_capacity(self.touched.len());
        for index in self.touched.drain(..) {
            let value = std::mem::take(&mut self.values[index as usize]);
            self.is_touched[index as usize] = false;
            if value != 0.0 {
                out.push((index, value));
            }
        }
        (out, std::mem::take(&mut self.largest))
    }
}
