//! As rigid as possible: ψ(σ) = Σᵢ (σᵢ − 1)² (Sorkine & Alexa 2007; Liu et al. 2008).
//!
//! ψ' = 2(σᵢ − 1), ψ'' = 2; the prox is (18): z = (2 + k p)/(2 + k).

use super::{Constants, Energy};
use crate::space::{Components, Lane, Space};

/// As rigid as possible; an isometry has 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Arap;

/// One axis: (σ − 1)².
#[inline(always)]
fn term<L: Lane>(s: L) -> L {
    let d = s - s.lift(1.0);
    d * d
}

impl<S: Space> Energy<S> for Arap {
    const BARRIER: bool = false;

    fn constants(&self) -> Constants {
        Constants {
            rest_stiffness: 2.0,
            isometry: 0.0,
            scale: 1.0,
            offset: 0.0,
        }
    }
    #[inline(always)]
    fn density<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        let mut sum = term(sigma.at(0));
        for i in 1..S::STRETCHES {
            sum = sum + term(sigma.at(i));
        }
        sum
    }
    #[inline(always)]
    fn gradient<L: Lane>(&self, sigma: S::Sigma<L>) -> S::Sigma<L> {
        Components::from_fn(
            #[inline(always)]
            |i| sigma.at(i).lift(2.0) * (sigma.at(i) - sigma.at(i).lift(1.0)),
        )
    }
    fn hessian(&self, _: S::Sigma<f64>) -> [[f64; 3]; 3] {
        super::hessian::diagonal::<S>(|_| 2.0)
    }
    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        sigma.at(0).lift(2.0)
    }
    #[inline(always)]
    fn prox<L: Lane>(&self, p: S::Sigma<L>, k: L, _: S::Sigma<L>) -> (S::Sigma<L>, u32) {
        let two = k.lift(2.0);
        (
            Components::from_fn(
                #[inline(always)]
                |i| (two + k * p.at(i)) / (two + k),
            ),
            1,
        )
    }
}
