//! What elimination does to the constants of the rows, so that it can be done again to others.

use crate::mixed_integer::MixedIntegerError as Error;

/// One operation on the constants.
#[derive(Debug, Clone, Copy)]
pub(super) enum ConstantStep {
    /// A row was multiplied.
    Scale { row: u32, factor: f64 },
    /// A multiple of another row was subtracted.
    Subtract { row: u32, source: u32, factor: f64 },
    /// A row of integers, without a common divisor: its constant has to be whole.
    Whole { row: u32 },
    /// A row has no terms left: its constant has to vanish beside `scale`, the size of the coefficients
    /// that cancelled.
    Vanish { row: u32, scale: f64 },
}

/// The constants, and how large the numbers were that made them.
pub(super) struct Constants {
    values: Vec<f64>,
    magnitude: Vec<f64>,
}

impl Constants {
    pub fn new(constants: &[f64]) -> Self {
        Self {
            values: constants.to_vec(),
            magnitude: constants.iter().map(|c| c.abs()).collect(),
        }
    }

    pub fn into_values(self) -> Vec<f64> {
        self.values
    }

    pub fn apply(&mut self, step: ConstantStep, tolerance: f64) -> Result<(), Error> {
        match step {
            ConstantStep::Scale { row, factor } => {
                self.values[row as usize] *= factor;
                self.magnitude[row as usize] *= factor.abs();
            }
            ConstantStep::Subtract {
                row,
                source,
                factor,
            } => {
                self.values[row as usize] -= factor * self.values[source as usize];
                let size = self.magnitude[source as usize] * factor.abs();
                let magnitude = &mut self.magnitude[row as usize];
                *magnitude = magnitude.max(size);
            }
            ConstantStep::Whole { row } => {
                let row = row as usize;
                let constant = self.values[row];
                // what rounding can have done to numbers of this size, if that is more
                let noise = tolerance.max(64.0 * f64::EPSILON * self.magnitude[row]);
                if noise > 0.1 {
                    return Err(Error::CoefficientsTooLarge { row });
                }
                if (constant - constant.round()).abs() > noise {
                    return Err(Error::Infeasible { row, constant });
                }
                self.values[row] = constant.round();
            }
            ConstantStep::Vanish { row, scale } => {
                let row = row as usize;
                let residual = self.values[row];
                if residual.abs() > tolerance * self.magnitude[row].max(scale) {
                    return Err(Error::Contradictory { row, residual });
                }
            }
        }
        Ok(())
    }
}
