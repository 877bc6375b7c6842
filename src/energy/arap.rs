//! As rigid as possible: ψ(σ) = Σᵢ (σᵢ − 1)² (Sorkine & Alexa 2007; Liu et al. 2008).
//!
//! ψ' = 2(σᵢ − 1), ψ'' = 2; the prox is (18): z = (2 + k p)/(2 + k).

use super::{Constants, Energy};
use crate::space::{Components, Lane, Plane, Scalar};

/// As rigid as possible; an isometry has 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Arap;

/// One axis: (σ − 1)².
#[inline(always)]
fn term<T: Scalar>(s: T) -> T {
    let d = s - s.lift(1.0);
    d * d
}

impl Energy<Plane> for Arap {
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
    fn density<T: Scalar>(&self, sigma: [T; 2]) -> T {
        term(sigma[0]) + term(sigma[1])
    }
    #[inline(always)]
    fn gradient<T: Scalar>(&self, sigma: [T; 2]) -> [T; 2] {
        Components::from_fn(
            #[inline(always)]
            |i| sigma[i].lift(2.0) * (sigma[i] - sigma[i].lift(1.0)),
        )
    }
    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, sigma: [L; 2]) -> L {
        sigma[0].lift(2.0)
    }
    #[inline(always)]
    fn prox<L: Lane>(&self, p: [L; 2], k: L, _warm: [L; 2]) -> ([L; 2], u32) {
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
