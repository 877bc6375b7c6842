//! What a step's change of the energy, and the gradient after it, are measured against: in the body's own
//! units, so that neither its size nor its stiffness decides when an iteration ends.

use super::Criterion;

/// The units of a body, and what is lost to rounding in them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Yardstick {
    /// An energy: changes are measured against |E| + floor, E being 0 for an isometry.
    pub floor: f64,
    /// A force: what norms of gradients are measured against.
    pub force: f64,
    /// A change of the energy that is no more than this says nothing.
    pub rounding: f64,
}

impl Yardstick {
    /// Which criterion is met, if any: |ΔE| ≤ tolerance (|E| + floor), but for rounding, or |∇E| below
    /// tolerance × force. With tolerance 0 none ever is.
    pub fn criterion(
        &self,
        change: f64,
        energy: f64,
        gradient_norm: f64,
        tolerance: f64,
    ) -> Option<Criterion> {
        let against = tolerance * (energy.abs() + self.floor);
        if against > 0.0 && change.abs() < against + self.rounding {
            Some(Criterion::EnergyChange)
        } else if gradient_norm < tolerance * self.force {
            Some(Criterion::GradientNorm)
        } else {
            None
        }
    }
}
