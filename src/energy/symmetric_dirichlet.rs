//! Symmetric Dirichlet: ψ(σ) = Σᵢ σᵢ² + σᵢ⁻² (Schreiner et al. 2004; Smith & Schaefer 2015).
//!
//! It is a sum over the axes, so gradient, Hessian and prox are scalar problems:
//! ψ' = 2σ − 2σ⁻³, ψ'' = 2 + 6σ⁻⁴, and the prox minimises z² + z⁻² + k/2 (z − p)² over z > 0.

use super::Energy;
use crate::space::{Components, Lane, Plane, Scalar};

/// Symmetric Dirichlet energy; reported as ¼ Σ A (ψ − 2k) + 1, so that an isometry has 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SymmetricDirichlet;

/// The prox of one axis: the root of f(z) = (2+k) z − k p − 2 z⁻³.
///
/// f is increasing and concave on z > 0. From a point left of the root Newton's method climbs to it
/// monotonically, without overshooting; from a point right of it, it lands left of it. So the only
/// guard needed is against landing at z ≤ 0, or so far left that the climb, which where z⁻³ rules is
/// by a third a step, is long. With a = 2+k, q = max(−kp, 0) and x = 2/(2+q) ≤ 1 that guard is `floor`
/// = m/2 with m = min((2/a)^¼, x^⅜): there a z ≤ m⁻³ and q ≤ 2 x⁻¹ ≤ 2 m⁻³, but 2 z⁻³ = 16 m⁻³, so it
/// is left of the root; and since x^⅓ is about the root where q rules, it is not far.
#[inline(always)]
fn axis_prox<L: Lane>(p: L, k: L, warm: L) -> (L, u32) {
    let two = k.lift(2.0);
    let a = two + k;
    let b = k * p;
    let zero = k.lift(0.0);
    let mut floor = (two / a).sqrt().sqrt();
    let pulled = b.lt(zero);
    if b.any(pulled) {
        // x^⅜ = x^¼ x^⅛; where nothing pulls x is 1, and the minimum what it was
        let pull = (two / (two + (-b).max(zero))).sqrt().sqrt();
        floor = floor.min(pull * pull.sqrt());
    }
    floor = k.lift(0.5) * floor;
    let mut z = warm.max(floor);
    // the error after a relative step of 1e-8 is of the order of its square
    let tolerance = k.lift(1e-8);
    let (six, eight) = (k.lift(6.0), k.lift(8.0));
    let mut count = 0;
    // Quadratic convergence from the left: 60 is never reached, it only bounds the loop.
    while count < 60 {
        count += 1;
        // z − f(z)/f'(z), both multiplied by z⁴: one division. Near the root b z³ = a z⁴ − 2 > −2, so
        // the sum with 8 does not cancel
        let z2 = z * z;
        let z4 = z2 * z2;
        let next = ((b * z4 + eight * z) / (a * z4 + six)).max(floor);
        let moving = (tolerance * z).lt((next - z).abs());
        if !z.any(moving) {
            z = next;
            break;
        }
        // elements that have arrived wait for the others with their last step undone, so that they
        // take the same steps in any company
        z = z.select(moving, next, z);
    }
    (z, count)
}

/// One axis: σ² + σ⁻².
#[inline(always)]
fn term<T: Scalar>(s: T) -> T {
    let squared = s * s;
    squared + squared.recip()
}

impl Energy<Plane> for SymmetricDirichlet {
    const BARRIER: bool = true;
    const ISOMETRY: f64 = 4.0;
    const REST_STIFFNESS: f64 = 8.0;
    const SCALE: f64 = 0.25;
    const OFFSET: f64 = 1.0;

    #[inline(always)]
    fn density<T: Scalar>(&self, sigma: [T; 2]) -> T {
        term(sigma[0]) + term(sigma[1])
    }
    #[inline(always)]
    fn gradient<T: Scalar>(&self, sigma: [T; 2]) -> [T; 2] {
        Components::from_fn(
            #[inline(always)]
            |i| {
                let s = sigma[i];
                s.lift(2.0) * (s - (s * s * s).recip())
            },
        )
    }
    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, sigma: [L; 2]) -> L {
        let least = sigma[0].min(sigma[1]);
        let squared = least * least;
        least.lift(2.0) + least.lift(6.0) / (squared * squared)
    }
    #[inline(always)]
    fn prox<L: Lane>(&self, p: [L; 2], k: L, warm: [L; 2]) -> ([L; 2], u32) {
        let (first, n) = axis_prox(p[0], k, warm.at(0));
        let (second, m) = axis_prox(p[1], k, warm.at(1));
        ([first, second], n.max(m))
    }
}
