//! Triangles in the plane.
//!
//! A 2×2 matrix is a pair of complex numbers: F z = α z + β z̄, with the similarity part
//! α = ((F₁₁+F₂₂) + i(F₂₁−F₁₂))/2 and the anti-similarity part β = ((F₁₁−F₂₂) + i(F₂₁+F₁₂))/2. Then
//!
//! - σ₁ = |α| + |β|, σ₂ = |α| − |β| (signed: negative for an inverted triangle), det F = σ₁σ₂;
//! - F = R S with R = u = α/|α| and S = ū F = (|α|, ūβ);
//! - a symmetric matrix is t + (c + i s) z̄, stored as (t, c, s): eigenvalues t ± |c + i s|.
//!
//! Nothing here takes an angle or divides by a difference of singular values, so that F ≈ I, tiny F
//! and reflected F are all exact to rounding. The one singular case is α = 0 (σ₁ = −σ₂), where the
//! rotation is not defined: it is then taken as the identity.

use super::{Components, Lane, Space};

/// Triangles (k = 2) in the plane (d = 2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Plane;

/// Below this modulus (absolute; far below any meaningful stretch) a direction is not defined.
pub(super) const TINY: f64 = 1e-150;

/// Modulus, its inverse and the direction of the complex number (re, im); the direction of 0 is (1, 0),
/// its inverse modulus 0.
#[inline(always)]
fn polar_form<L: Lane>(re: L, im: L) -> (L, L, [L; 2]) {
    let modulus = (re * re + im * im).sqrt();
    let vanishes = modulus.lt(modulus.lift(TINY));
    let (zero, one) = (modulus.lift(0.0), modulus.lift(1.0));
    let inverse = modulus.select(vanishes, zero, modulus.recip());
    (
        modulus,
        inverse,
        [modulus.select(vanishes, one, re * inverse), im * inverse],
    )
}

/// (α, β) of a matrix stored by columns.
#[inline(always)]
pub(crate) fn split<L: Lane>([a, c, b, d]: [L; 4]) -> ([L; 2], [L; 2]) {
    let half = a.lift(0.5);
    (
        [half * (a + d), half * (c - b)],
        [half * (a - d), half * (c + b)],
    )
}

/// The matrix of (α, β), by columns.
#[inline(always)]
pub(crate) fn join<L: Lane>(alpha: [L; 2], beta: [L; 2]) -> [L; 4] {
    [
        alpha[0] + beta[0],
        alpha[1] + beta[1],
        beta[1] - alpha[1],
        alpha[0] - beta[0],
    ]
}

/// Complex product.
#[inline(always)]
pub(crate) fn mul<L: Lane>(x: [L; 2], y: [L; 2]) -> [L; 2] {
    [x[0] * y[0] - x[1] * y[1], x[0] * y[1] + x[1] * y[0]]
}

/// Complex product x̄ y.
#[inline(always)]
pub(crate) fn conj_mul<L: Lane>(x: [L; 2], y: [L; 2]) -> [L; 2] {
    [x[0] * y[0] + x[1] * y[1], x[0] * y[1] - x[1] * y[0]]
}

/// The polar decomposition of a 2×2 matrix.
#[derive(Debug, Clone, Copy)]
pub struct PlanePolar<T> {
    /// 1/|α| = 2/(σ₁+σ₂), 0 where the rotation is not defined.
    inverse_modulus: T,
    /// The rotation as a unit complex number.
    rotation: [T; 2],
    /// ūβ.
    beta: [T; 2],
}

/// Singular vectors of a 2×2 matrix, as the directions of α and β.
#[derive(Debug, Clone, Copy)]
pub struct PlaneSvd<T> {
    alpha: [T; 2],
    beta: [T; 2],
}

impl Space for Plane {
    const DIM: usize = 2;
    const STRETCHES: usize = 2;
    const KAPPA: f64 = 2.0;

    type Gradient<T: Copy> = [T; 4];
    type Symmetric<T: Copy> = [T; 3];
    type Sigma<T: Copy> = [T; 2];
    type Polar<T: Copy> = PlanePolar<T>;
    type Eigenframe<T: Copy> = [T; 2];
    type Singularframe<T: Copy> = PlaneSvd<T>;

    type Guess<T: Copy> = [T; 0];

    fn no_guess() -> [f64; 0] {
        []
    }
    #[inline(always)]
    fn guess<L: Lane>(_: Self::Polar<L>) -> [L; 0] {
        []
    }
    #[inline(always)]
    fn polar_near<L: Lane>(
        f: Self::Gradient<L>,
        _: [L; 0],
    ) -> (Self::Symmetric<L>, Self::Polar<L>) {
        Self::polar(f)
    }
    type Kept<T: Copy> = [T; 0];

    #[inline(always)]
    fn keep<L: Lane>(_: Self::Polar<L>) -> [L; 0] {
        []
    }
    #[inline(always)]
    fn polar_again<L: Lane>(
        f: Self::Gradient<L>,
        _: [L; 0],
        _: [L; 0],
    ) -> (Self::Symmetric<L>, Self::Polar<L>) {
        Self::polar(f)
    }
    #[inline(always)]
    fn eigen_near<L: Lane>(
        s: Self::Symmetric<L>,
        _: Self::Polar<L>,
    ) -> (Self::Sigma<L>, Self::Eigenframe<L>) {
        Self::eigen(s)
    }

    #[inline(always)]
    fn polar<L: Lane>(f: [L; 4]) -> ([L; 3], PlanePolar<L>) {
        let (alpha, beta) = split(f);
        let (modulus, inverse_modulus, rotation) = polar_form(alpha[0], alpha[1]);
        let beta = conj_mul(rotation, beta);
        (
            [modulus, beta[0], beta[1]],
            PlanePolar {
                inverse_modulus,
                rotation,
                beta,
            },
        )
    }

    /// In the rotated frame U H Vᵀ is t + i Im(β' p̄)/|α| beside p, with P = (t, p) and β' = ūβ: the
    /// off-diagonal of (15) divides by σ₁+σ₂ = 2|α|.
    #[inline(always)]
    fn stretch_residual<L: Lane>(f: [L; 4], polar: PlanePolar<L>, p: [L; 3]) -> [L; 4] {
        let twist = polar.beta[1] * p[1] - polar.beta[0] * p[2];
        let twist = twist * polar.inverse_modulus;
        let alpha = mul(polar.rotation, [p[0], twist]);
        let beta = mul(polar.rotation, [p[1], p[2]]);
        let target = join(alpha, beta);
        f.zip(
            target,
            #[inline(always)]
            |f, t| f - t,
        )
    }

    #[inline(always)]
    fn eigen<L: Lane>([t, c, s]: [L; 3]) -> ([L; 2], [L; 2]) {
        let (radius, _, direction) = polar_form(c, s);
        ([t + radius, t - radius], direction)
    }

    #[inline(always)]
    fn from_eigen<L: Lane>([first, second]: [L; 2], direction: [L; 2]) -> [L; 3] {
        let half = first.lift(0.5);
        let radius = half * (first - second);
        [
            half * (first + second),
            radius * direction[0],
            radius * direction[1],
        ]
    }

    #[inline(always)]
    fn svd<L: Lane>(f: [L; 4]) -> ([L; 2], PlaneSvd<L>) {
        let (alpha, beta) = split(f);
        let (q, _, alpha) = polar_form(alpha[0], alpha[1]);
        let (r, _, beta) = polar_form(beta[0], beta[1]);
        ([q + r, q - r], PlaneSvd { alpha, beta })
    }

    #[inline(always)]
    fn from_svd<L: Lane>([first, second]: [L; 2], frame: PlaneSvd<L>) -> [L; 4] {
        let half = first.lift(0.5);
        let q = half * (first + second);
        let r = half * (first - second);
        join(
            [q * frame.alpha[0], q * frame.alpha[1]],
            [r * frame.beta[0], r * frame.beta[1]],
        )
    }

    #[inline(always)]
    fn symmetric_norm_squared<L: Lane>([t, c, s]: [L; 3]) -> L {
        let sum = t * t + c * c + s * s;
        sum + sum
    }
}
