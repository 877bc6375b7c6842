//! SLIM: scalable locally injective mappings (Rabinovich, Poranne, Panozzo & Sorkine-Hornung 2017).
//!
//! Near an iterate the energy is replaced by Σ A ‖W (F − R)‖², R the nearest rotation and W symmetric, such
//! that the gradients agree there: with F = U Σ Vᵀ, W = U diag(√(ψ'(σ)/(2(σ − 1)))) Uᵀ. A proximal term keeps the
//! minimum of this proxy near and unique. The step to it, −(2 Σ A GᵀW²G + λ)⁻¹ ∇E, goes through the
//! step bound and the line search of [`crate::newton`], which needs nothing else to be changed.

use crate::energy::hessian::{MOST, Square};
use crate::energy::{Arap, Energy, SymmetricDirichlet};
use crate::newton::curvature::{OfGradient, OnCorners};
use crate::newton::{Newton, NewtonOptions};
use crate::optim::BuildError;
use crate::space::{Components, Space};
use crate::wrapd::Problem;
use core::marker::PhantomData;

/// Weight of the proximal term in the authors' code, for maps of unit area and symmetric Dirichlet.
const PROXIMAL: f64 = 1e-4;

/// An energy that is a sum over the axes, ψ = Σ φ(σᵢ), with its minimum at σ = 1: only then does
/// exact reweighting give weights.
pub trait Reweightable<S: Space>: Energy<S> {
    /// w² = φ'(σ)/(2(σ − 1)), and its limit φ''(1)/2 at σ = 1.
    fn weight_squared(&self, sigma: f64) -> f64;
}

impl<S: Space> Reweightable<S> for SymmetricDirichlet {
    /// 2(σ − σ⁻³) = 2(σ − 1)(σ + 1)(σ² + 1)σ⁻³.
    fn weight_squared(&self, sigma: f64) -> f64 {
        (sigma + 1.0) * (sigma * sigma + 1.0) / (sigma * sigma * sigma)
    }
}

impl<S: Space> Reweightable<S> for Arap {
    fn weight_squared(&self, _: f64) -> f64 {
        1.0
    }
}

/// 2 W² on each column of F.
struct Proxy<E>(E);

impl<S: Space, E: Reweightable<S>> OfGradient<S> for Proxy<E> {
    const NEGATIVE: bool = false;

    fn at(&self, f: S::Gradient<f64>, _: f64) -> Square {
        let d = S::DIM;
        let (sigma, frame) = S::svd(f);
        let weight = |i| 2.0 * self.0.weight_squared(sigma.at(i));
        // 2 W² = (U Σ_w Vᵀ)(U Vᵀ)ᵀ
        let stretched = S::from_svd(S::Sigma::from_fn(weight), frame);
        let rotation = S::from_svd(S::Sigma::from_fn(|_| 1.0), frame);
        let mut out = [[0.0; MOST]; MOST];
        for i in 0..d {
            for j in 0..d {
                let sum = (0..d).map(|c| stretched.at(c * d + i) * rotation.at(c * d + j));
                let sum: f64 = sum.sum();
                (0..d).for_each(|c| out[c * d + i][c * d + j] = sum);
            }
        }
        out
    }
}

/// SLIM in dimensions of d = k.
///
/// The proximal weight is the authors' for a map of unit area and symmetric Dirichlet; for others it is scaled
/// with the stiffness at rest and the size of the elements, so that units do not matter.
///
/// # Errors
/// As [`Newton::projected`]: `NotInjectiveStart` where the energy has a barrier and the start breaks it.
pub fn slim<S: Space, E: Reweightable<S>>(
    problem: Problem,
    energy: E,
    options: NewtonOptions,
) -> Result<Newton, BuildError> {
    let measure: f64 = problem.rest.measure.iter().sum();
    let element = measure / problem.rest.len().max(1) as f64;
    // A ‖∇x‖² scales as length^(d−2)
    let length = element.powf((S::DIM as f64 - 2.0) / S::DIM as f64);
    let stiffness = energy.constants().rest_stiffness / 8.0;
    let curvature = Box::new(OnCorners::<S, _>(Proxy(energy), PhantomData));
    let proximal = 2.0 * PROXIMAL * stiffness * length;
    Newton::with_curvature::<S, E>(problem, energy, curvature, proximal, options)?.checked()
}
