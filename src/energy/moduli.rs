//! From the moduli of engineers to those of the energies.

use crate::optim::BuildError;

/// The Lamé parameters [μ, λ] of Young's modulus (> 0, any unit of pressure) and Poisson's ratio (in
/// (−1, 0.5)): μ = E/2(1+ν), λ = Eν/(1+ν)(1−2ν).
///
/// # Errors
/// `InvalidOption` names the one out of its range.
pub(super) fn lame(young: f64, poisson: f64) -> Result<[f64; 2], BuildError> {
    let wrong = |option, what: &str| {
        let what = what.into();
        Err(BuildError::InvalidOption { option, what })
    };
    if !(young > 0.0 && young.is_finite()) {
        return wrong("young", "must be positive and finite");
    }
    if !(poisson > -1.0 && poisson < 0.5) {
        return wrong("poisson", "must be above −1 and below 0.5");
    }
    let mu = young / (2.0 * (1.0 + poisson));
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    Ok([mu, lambda])
}

/// How far from rest [`uniaxial_stiffness`] looks.
const RANGE: f64 = 0.081;

/// The weight of an element at rest: the slope of the secant of the stress ∂ψ/∂σ₁ at (σ₁, 1, 1) between
/// σ₁ = 1 − a and 1 + a with a = 0.081, which for the neo-Hookean energy gives 2.0066 μ +
/// 1.0122 λ. At a → 0 it is 2μ + λ, what a wave along one axis feels. The largest eigenvalue of the
/// Hessian at rest, 2μ + 3λ, is that of a change of volume only.
pub(super) fn uniaxial_stiffness(stress: impl Fn(f64) -> f64) -> f64 {
    (stress(1.0 + RANGE) - stress(1.0 - RANGE)) / (2.0 * RANGE)
}
