//! Symmetric Dirichlet: ψ(σ) = Σᵢ σᵢ² + σᵢ⁻² (Schreiner et al. 2004; Smith & Schaefer 2015).
//!
//! It is a sum over the axes, so gradient, Hessian and prox are scalar problems:
//! ψ' = 2σ − 2σ⁻³, ψ'' = 2 + 6σ⁻⁴, and the prox minimises z² + z⁻² + k/2 (z − p)² over z > 0.

use super::{Constants, Energy};
use crate::space::{Components, Lane, Space};

/// Symmetric Dirichlet energy; reported as Σ A (ψ − 2k)/2k + 1, so that an isometry has 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SymmetricDirichlet;

/// The prox of one axis: the root of f(z) = (2+k) z − k p − 2 z⁻³.
///
/// f is increasing and concave on z > 0. From a point left of the root Newton's method climbs to it
/// monotonically, without overshooting; from a point right of it, it lands left of it. So the only
/// guard needed is against landing at z ≤ 0, or so far left that the climb, which where z⁻³ rules is
/// by a third a step, is long. A first step of less than a quarter needs none; an element
/// that steps further begins again from [`floor`].
#[inline(always)]
fn axis_prox<L: Lane>(p: L, k: L, warm: L) -> (L, u32) {
    let a = k.lift(2.0) + k;
    let b = k * p;
    let zero = k.lift(0.0);
    let mut z = warm;
    let mut next = newton(a, b, z);
    let near = (next - z).abs().lt(k.lift(0.25) * z);
    // not near: far, or not a number
    if k.any(zero.lt(k.select(near, zero, k))) {
        let floor = floor(a, b);
        let begin = warm.max(floor);
        z = z.select(near, z, begin);
        next = next.select(near, next, newton(a, b, begin).max(floor));
    }
    // the error after a relative step of 1e-8 is of the order of its square
    let tolerance = k.lift(1e-8);
    let mut count = 1;
    // Quadratic convergence from the left: 60 is never reached, it only bounds the loop.
    loop {
        let moving = (tolerance * z).lt((next - z).abs());
        if !z.any(moving) || count == 60 {
            return (next, count);
        }
        // elements that have arrived wait for the others with their last step undone, so that they
        // take the same steps in any company
        z = z.select(moving, next, z);
        next = newton(a, b, z);
        count += 1;
    }
}

/// z − f(z)/f'(z) of [`axis_prox`], with b = k p.
#[inline(always)]
fn newton<L: Lane>(a: L, b: L, z: L) -> L {
    // both multiplied by z⁴: one division. Near the root b z³ = a z⁴ − 2 > −2, so the sum with 8 does
    // not cancel
    let z2 = z * z;
    let z4 = z2 * z2;
    (b * z4 + a.lift(8.0) * z) / (a * z4 + a.lift(6.0))
}

/// A point left of the root of f in [`axis_prox`], and not far. With q = max(−kp, 0) and
/// x = 2/(2+q) ≤ 1 it is m/2 for m = min((2/a)^¼, x^⅜): there a z ≤ m⁻³ and q ≤ 2 x⁻¹ ≤ 2 m⁻³, but
/// 2 z⁻³ = 16 m⁻³, so f < 0; and x^⅓ is about the root where q rules.
#[inline(always)]
fn floor<L: Lane>(a: L, b: L) -> L {
    let two = a.lift(2.0);
    let zero = a.lift(0.0);
    let mut least = (two / a).sqrt().sqrt();
    let pulled = b.lt(zero);
    if b.any(pulled) {
        // x^⅜ = x^¼ x^⅛; where nothing pulls x is 1, and the minimum what it was
        let pull = (two / (two + (-b).max(zero))).sqrt().sqrt();
        least = least.min(pull * pull.sqrt());
    }
    a.lift(0.5) * least
}

/// One axis: σ² + σ⁻².
#[inline(always)]
fn term<L: Lane>(s: L) -> L {
    let squared = s * s;
    squared + squared.recip()
}

impl<S: Space> Energy<S> for SymmetricDirichlet {
    const BARRIER: bool = true;

    fn constants(&self) -> Constants {
        Constants {
            rest_stiffness: 8.0,
            isometry: 2.0 * S::STRETCHES as f64,
            scale: 0.5 / S::STRETCHES as f64,
            offset: 1.0,
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
            |i| {
                let s = sigma.at(i);
                s.lift(2.0) * (s - (s * s * s).recip())
            },
        )
    }
    fn hessian(&self, sigma: S::Sigma<f64>) -> [[f64; 3]; 3] {
        super::hessian::diagonal::<S>(|i| 2.0 + 6.0 * sigma.at(i).powi(-4))
    }
    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, sigma: S::Sigma<L>) -> L {
        let mut least = sigma.at(0);
        for i in 1..S::STRETCHES {
            least = least.min(sigma.at(i));
        }
        let squared = least * least;
        least.lift(2.0) + least.lift(6.0) / (squared * squared)
    }
    #[inline(always)]
    fn prox<L: Lane>(&self, p: S::Sigma<L>, k: L, warm: S::Sigma<L>) -> (S::Sigma<L>, u32) {
        let mut most = 0;
        let sigma = Components::from_fn(
            #[inline(always)]
            |i| {
                let (z, count) = axis_prox(p.at(i), k, warm.at(i));
                most = most.max(count);
                z
            },
        );
        (sigma, most)
    }
}
