//! Tetrahedra in space.
//!
//! The polar decomposition comes from the singular value decomposition F = U Σ Vᵀ with proper U and V:
//! R = U Vᵀ, S = V Σ Vᵀ; the last singular value carries the sign of det F. A symmetric matrix is
//! stored as (xx, yy, zz, xy, xz, yz).

use super::three::{
    Columns, Three, bilinear, eigen, eigen_near, identity, sum_of_products, svd, svd_near,
};
use super::{Lane, Space};

/// Tetrahedra (k = 3) in space (d = 3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Solid;

/// Singular values and vectors.
#[derive(Debug, Clone, Copy)]
pub struct SolidSvd<T> {
    sigma: Three<T>,
    u: Columns<T>,
    v: Columns<T>,
}

#[inline(always)]
fn columns<L: Copy>(f: [L; 9]) -> Columns<L> {
    [[f[0], f[1], f[2]], [f[3], f[4], f[5]], [f[6], f[7], f[8]]]
}

#[inline(always)]
fn flat<L: Copy>([a, b, c]: Columns<L>) -> [L; 9] {
    [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]]
}

/// V diag(values) Vᵀ.
#[inline(always)]
fn symmetric<L: Lane>(values: Three<L>, v: Columns<L>) -> [L; 6] {
    let s = sum_of_products(values, v, v);
    [s[0][0], s[1][1], s[2][2], s[0][1], s[0][2], s[1][2]]
}

impl Space for Solid {
    const DIM: usize = 3;
    const STRETCHES: usize = 3;
    const KAPPA: f64 = 1.0;

    type Gradient<T: Copy> = [T; 9];
    type Symmetric<T: Copy> = [T; 6];
    type Sigma<T: Copy> = [T; 3];
    type Polar<T: Copy> = SolidSvd<T>;
    type Eigenframe<T: Copy> = Columns<T>;
    type Singularframe<T: Copy> = (Columns<T>, Columns<T>);

    type Guess<T: Copy> = [T; 9];

    fn no_guess() -> [f64; 9] {
        flat(identity(0.0))
    }
    /// V.
    #[inline(always)]
    fn guess<L: Lane>(polar: SolidSvd<L>) -> [L; 9] {
        flat(polar.v)
    }
    #[inline(always)]
    fn polar_near<L: Lane>(f: [L; 9], guess: [L; 9]) -> ([L; 6], SolidSvd<L>) {
        let (sigma, u, v) = svd_near(columns(f), columns(guess));
        (symmetric(sigma, v), SolidSvd { sigma, u, v })
    }
    type Kept<T: Copy> = [T; 12];

    /// U and σ.
    #[inline(always)]
    fn keep<L: Lane>(polar: SolidSvd<L>) -> [L; 12] {
        let ([a, b, c], s) = (polar.u, polar.sigma);
        [
            a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], s[0], s[1], s[2],
        ]
    }
    #[inline(always)]
    fn polar_again<L: Lane>(_: [L; 9], guess: [L; 9], kept: [L; 12]) -> ([L; 6], SolidSvd<L>) {
        let [a, b, c, d, e, f, g, h, i, sigma @ ..] = kept;
        let (u, v) = ([[a, b, c], [d, e, f], [g, h, i]], columns(guess));
        (symmetric(sigma, v), SolidSvd { sigma, u, v })
    }
    #[inline(always)]
    fn eigen_near<L: Lane>(s: [L; 6], polar: SolidSvd<L>) -> ([L; 3], Columns<L>) {
        eigen_near(s, polar.v)
    }

    #[inline(always)]
    fn polar<L: Lane>(f: [L; 9]) -> ([L; 6], SolidSvd<L>) {
        let (sigma, u, v) = svd(columns(f));
        (symmetric(sigma, v), SolidSvd { sigma, u, v })
    }

    /// U H Vᵀ with H_ii = P̃_ii and H_ij = 2σᵢ P̃_ij/(σᵢ+σⱼ) (15), P̃ = Vᵀ P V.
    #[inline(always)]
    fn stretch_residual<L: Lane>(f: [L; 9], polar: SolidSvd<L>, p: [L; 6]) -> [L; 9] {
        let SolidSvd { sigma, u, v } = polar;
        let zero = f[0].lift(0.0);
        let tiny = f[0].lift(1e-12) * sigma[0];
        let mut h = [[zero; 3]; 3];
        for i in 0..3 {
            h[i][i] = bilinear(p, v[i], v[i]);
            for j in 0..i {
                let pij = bilinear(p, v[i], v[j]);
                let sum = sigma[i] + sigma[j];
                let quotient = (pij + pij) / sum;
                let quotient = zero.select(tiny.lt(sum), quotient, zero);
                h[i][j] = sigma[i] * quotient;
                h[j][i] = sigma[j] * quotient;
            }
        }
        // columns of U H: Σᵢ Uᵢ H_ij
        let mut uh = [[zero; 3]; 3];
        for j in 0..3 {
            for r in 0..3 {
                uh[j][r] = u[0][r] * h[0][j] + u[1][r] * h[1][j] + u[2][r] * h[2][j];
            }
        }
        let one = zero.lift(1.0);
        let target = flat(sum_of_products([one; 3], uh, v));
        let mut m = f;
        for c in 0..9 {
            m[c] = f[c] - target[c];
        }
        m
    }

    #[inline(always)]
    fn eigen<L: Lane>(s: [L; 6]) -> ([L; 3], Columns<L>) {
        eigen(s)
    }

    #[inline(always)]
    fn from_eigen<L: Lane>(values: [L; 3], frame: Columns<L>) -> [L; 6] {
        symmetric(values, frame)
    }

    #[inline(always)]
    fn svd<L: Lane>(f: [L; 9]) -> ([L; 3], (Columns<L>, Columns<L>)) {
        let (sigma, u, v) = svd(columns(f));
        (sigma, (u, v))
    }

    #[inline(always)]
    fn svd_of_polar<L: Lane>(_: [L; 9], polar: SolidSvd<L>) -> ([L; 3], (Columns<L>, Columns<L>)) {
        (polar.sigma, (polar.u, polar.v))
    }

    #[inline(always)]
    fn from_svd<L: Lane>(sigma: [L; 3], (u, v): (Columns<L>, Columns<L>)) -> [L; 9] {
        flat(sum_of_products(sigma, u, v))
    }

    #[inline(always)]
    fn symmetric_norm_squared<L: Lane>(s: [L; 6]) -> L {
        let off = s[3] * s[3] + s[4] * s[4] + s[5] * s[5];
        s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + off + off
    }
}
