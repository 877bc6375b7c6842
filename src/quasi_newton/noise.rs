//! What rounding leaves of energies and gradients, so that a line search knows when to stop asking the
//! energy, and an iteration that cannot go on whether it has arrived.

/// By how much a stiffness may exceed that at rest where an element is strained, and several rounding
/// errors one.
const SPARE: f64 = 16.0;

/// Rounding errors of a body's evaluations.
#[derive(Debug, Clone, Copy)]
pub struct Noise {
    /// Of the energy beside what is relative to it: that of the sum over n elements, each of which may be a
    /// difference of terms of its stiffness times measure and errs on its own, and that of other terms.
    energy: f64,
    /// Norm of the diagonal of the system matrix: its product with an error of the positions is one of the
    /// gradient.
    diagonal: f64,
}

impl Noise {
    /// Of so many elements of this stiffness × measure all together, a system matrix of this diagonal, and
    /// terms beside the elements that err by `terms`.
    pub fn new(
        elements: usize,
        stiffness: f64,
        diagonal: impl Iterator<Item = f64>,
        terms: f64,
    ) -> Self {
        Self {
            energy: SPARE * f64::EPSILON * stiffness / (elements as f64).sqrt() + terms,
            diagonal: diagonal.map(|d| d * d).sum::<f64>().sqrt(),
        }
    }

    /// Energies that differ by no more than this are the same.
    pub fn of_energy(&self, energy: f64) -> f64 {
        self.energy + SPARE * f64::EPSILON * energy.abs()
    }

    /// The gradient at a minimum, but for rounding: coordinates are a grid of ε times their size.
    pub fn of_gradient(&self, positions: &[f64]) -> f64 {
        let farthest = positions.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        SPARE * f64::EPSILON * self.diagonal * farthest
    }
}
