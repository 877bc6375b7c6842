//! Cloth that resists stretch, up to hard limits: ψ(σ) = s/2 Σᵢ (σᵢ − 1)², and +∞ outside
//! least ≤ σᵢ ≤ most.
//!
//! The prox is separable and convex: that of each σ is the unconstrained one, clamped. So the local
//! variables Z keep the limits always, F only in the limit of the iteration. What is reported is the
//! finite part at F; how far F is from its limits a report says by its smallest and largest σ.

use super::{Constants, Energy};
use crate::optim::BuildError;
use crate::space::{Components, Lane, Space};

/// As rigid as possible within limits of the stretch. In a stretch along one axis the tension is
/// s (σ − 1): s is Young's modulus times thickness, in newtons a metre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimitedArap {
    /// s > 0, force a length.
    stiffness: f64,
    /// Least stretch, in 0..=1.
    least: f64,
    /// Most, at least 1; may be infinite.
    most: f64,
}

impl LimitedArap {
    /// Of this stiffness and these limits [least, most].
    ///
    /// # Errors
    /// `InvalidOption` unless stiffness > 0 and 0 ≤ least ≤ 1 ≤ most, least < most.
    pub fn new(stiffness: f64, limits: [f64; 2]) -> Result<Self, BuildError> {
        let wrong = |option, what: &str| {
            let what = what.into();
            Err(BuildError::InvalidOption { option, what })
        };
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return wrong("stretch", "must be positive and finite");
        }
        let [least, most] = limits;
        if !((0.0..=1.0).contains(&least) && most >= 1.0 && least < most) {
            return wrong(
                "limits",
                "must be a stretch from 0 to 1 and one from 1 on, not both 1",
            );
        }
        Ok(Self {
            stiffness,
            least,
            most,
        })
    }
}

impl<S: Space> Energy<S> for LimitedArap {
    const BARRIER: bool = false;

    fn limits(&self) -> [f64; 2] {
        [self.least, self.most]
    }
    fn constants(&self) -> Constants {
        Constants {
            rest_stiffness: self.stiffness,
            isometry: 0.0,
            scale: 1.0,
            offset: 0.0,
        }
    }
    /// The finite part.
    #[inline(always)]
    fn density<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        let one = sigma.at(0).lift(1.0);
        let mut sum = one.lift(0.0);
        for i in 0..S::STRETCHES {
            let d = sigma.at(i) - one;
            sum = sum + d * d;
        }
        one.lift(0.5 * self.stiffness) * sum
    }
    #[inline(always)]
    fn gradient<L: Lane>(&self, sigma: S::Sigma<L>) -> S::Sigma<L> {
        Components::from_fn(
            #[inline(always)]
            |i| {
                let s = sigma.at(i);
                s.lift(self.stiffness) * (s - s.lift(1.0))
            },
        )
    }
    fn hessian(&self, _: S::Sigma<f64>) -> [[f64; 3]; 3] {
        super::hessian::diagonal::<S>(|_| self.stiffness)
    }
    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        sigma.at(0).lift(self.stiffness)
    }
    #[inline(always)]
    fn prox<L: Lane>(&self, p: S::Sigma<L>, k: L, _: S::Sigma<L>) -> (S::Sigma<L>, u32) {
        let stiffness = k.lift(self.stiffness);
        let (least, most) = (k.lift(self.least), k.lift(self.most));
        let inverse = (stiffness + k).recip();
        (
            Components::from_fn(
                #[inline(always)]
                |i| ((stiffness + k * p.at(i)) * inverse).max(least).min(most),
            ),
            1,
        )
    }
}
