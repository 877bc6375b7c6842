//! Dirichlet: ψ(σ) = ½ Σᵢ σᵢ² = ½ ‖F‖² (Pinkall & Polthier 1993).
//!
//! ψ' = σᵢ, ψ'' = 1, and the prox is z = k p/(1 + k). Its minimum under pins is the harmonic map.

use super::{Constants, Energy};
use crate::space::{Components, Lane, Space};

/// Dirichlet energy, reported as it is: an isometry of measure A has ½ k A, and only what is collapsed
/// to a point 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dirichlet;

impl<S: Space> Energy<S> for Dirichlet {
    const BARRIER: bool = false;

    fn constants(&self) -> Constants {
        Constants {
            rest_stiffness: 1.0,
            isometry: 0.0,
            scale: 1.0,
            offset: 0.0,
        }
    }
    #[inline(always)]
    fn density<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        let mut sum = sigma.at(0) * sigma.at(0);
        for i in 1..S::STRETCHES {
            sum = sum + sigma.at(i) * sigma.at(i);
        }
        sum.lift(0.5) * sum
    }
    #[inline(always)]
    fn gradient<L: Lane>(&self, sigma: S::Sigma<L>) -> S::Sigma<L> {
        sigma
    }
    fn hessian(&self, _: S::Sigma<f64>) -> [[f64; 3]; 3] {
        super::hessian::diagonal::<S>(|_| 1.0)
    }
    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        sigma.at(0).lift(1.0)
    }
    #[inline(always)]
    fn prox<L: Lane>(&self, p: S::Sigma<L>, k: L, _: S::Sigma<L>) -> (S::Sigma<L>, u32) {
        let part = k / (k + k.lift(1.0));
        (
            Components::from_fn(
                #[inline(always)]
                |i| part * p.at(i),
            ),
            1,
        )
    }
}
