//! ∂²ψ/∂F² by its eigensystem, and its positive semidefinite part (Smith, de Goes & Kim 2019,
//! "Analytic Eigensystems for Isotropic Distortion Energies").
//!
//! With F = U diag(σ) Vᵀ and ψᵢ = ∂ψ/∂σᵢ the eigenmatrices are
//!
//! - k *scalings* U diag(a) Vᵀ, a an eigenvector of ∂²ψ/∂σ², with its eigenvalue;
//! - for each pair of axes a *twist* U (eᵢeⱼᵀ − eⱼeᵢᵀ) Vᵀ/√2 with (ψᵢ + ψⱼ)/(σᵢ + σⱼ),
//! - and a *flip* U (eᵢeⱼᵀ + eⱼeᵢᵀ) Vᵀ/√2 with (ψᵢ − ψⱼ)/(σᵢ − σⱼ).
//!
//! Plain `f64`: it is for second-order methods, whose time goes elsewhere.

use super::Energy;
use crate::space::{Components, Solid, Space};

/// Most entries of F.
pub const MOST: usize = 9;

/// A symmetric matrix on the entries of F (column by column), of which the first k² rows and columns
/// are used; the others are 0.
pub type Square = [[f64; MOST]; MOST];

/// A gradient in the singular values,
pub type Gradient<'a, S> = dyn Fn(<S as Space>::Sigma<f64>) -> <S as Space>::Sigma<f64> + 'a;

/// and second derivatives.
pub type Hessian<'a, S> = dyn Fn(<S as Space>::Sigma<f64>) -> [[f64; 3]; 3] + 'a;

/// Eigenvalues and eigenmatrices of ∂²ψ/∂F²; spaces of d = k only.
#[derive(Debug, Clone, Copy)]
pub struct Eigensystem<S: Space> {
    values: [f64; MOST],
    /// Of unit norm.
    modes: [S::Gradient<f64>; MOST],
}

impl<S: Space> Eigensystem<S> {
    /// At F (column by column).
    pub fn new<E: Energy<S>>(energy: E, f: S::Gradient<f64>) -> Self {
        Self::of(f, &|sigma| energy.gradient(sigma), &|sigma| {
            energy.hessian(sigma)
        })
    }

    /// Of any function of the singular values with this gradient and these second derivatives, at F; behind
    /// pointers, so that it is compiled once a dimension, not once a function.
    #[inline(never)]
    pub fn of(f: S::Gradient<f64>, gradient: &Gradient<S>, hessian: &Hessian<S>) -> Self {
        const { assert!(S::DIM == S::STRETCHES) };
        let k = S::STRETCHES;
        let (sigma, frame) = S::svd(f);
        let mut this = Self {
            values: [0.0; MOST],
            modes: [S::Gradient::from_fn(|_| 0.0); MOST],
        };
        let (values, vectors) = eigen(hessian(sigma), k);
        for m in 0..k {
            this.values[m] = values[m];
            this.modes[m] = S::from_svd(S::Sigma::from_fn(|i| vectors[m][i]), frame);
        }
        // uᵢ and vᵢ, up to one sign for both, which a twist or flip only takes on
        let axes: [_; 3] = core::array::from_fn(|i| {
            let unit = S::Sigma::from_fn(|j| f64::from(u8::from(i == j)));
            factors(S::from_svd(unit, frame).as_slice(), k)
        });
        let mut m = k;
        for j in 1..k {
            for i in 0..j {
                let ((ui, vi), (uj, vj)) = (axes[i], axes[j]);
                let mode = |sign: f64| {
                    S::Gradient::from_fn(|c| {
                        let (column, row) = (c / k, c % k);
                        let both = ui[row] * vj[column] + sign * uj[row] * vi[column];
                        both * core::f64::consts::FRAC_1_SQRT_2
                    })
                };
                this.values[m] = quotient::<S>(gradient, hessian, sigma, (i, j), 1.0);
                this.modes[m] = mode(-1.0);
                this.values[m + 1] = quotient::<S>(gradient, hessian, sigma, (i, j), -1.0);
                this.modes[m + 1] = mode(1.0);
                m += 2;
            }
        }
        this
    }

    /// The eigenvalues: those of the k scalings, then twist and flip of the pairs (0, 1), (0, 2), (1, 2).
    pub fn values(&self) -> &[f64] {
        &self.values[..S::DIM * S::STRETCHES]
    }

    /// Σ g(λ) Q Qᵀ.
    pub fn map(&self, g: impl Fn(f64) -> f64) -> Square {
        let n = S::DIM * S::STRETCHES;
        let mut out = [[0.0; MOST]; MOST];
        for (&value, mode) in self.values().iter().zip(&self.modes) {
            let value = g(value);
            for a in 0..n {
                for b in 0..n {
                    out[a][b] += value * mode.at(a) * mode.at(b);
                }
            }
        }
        out
    }
}

/// ∂²ψ/∂F² with its negative eigenvalues set to 0, at F (column by column); spaces of d = k only.
pub fn projected_hessian<S: Space, E: Energy<S>>(energy: E, f: S::Gradient<f64>) -> Square {
    Eigensystem::new(energy, f).map(|value| value.max(0.0))
}

/// A diagonal k×k matrix, for the energies that are sums over the axes.
pub(super) fn diagonal<S: Space>(entry: impl Fn(usize) -> f64) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    for i in 0..S::STRETCHES {
        out[i][i] = entry(i);
    }
    out
}

/// Eigenvalues and unit eigenvectors of the upper left k×k part.
fn eigen(h: [[f64; 3]; 3], k: usize) -> ([f64; 3], [[f64; 3]; 3]) {
    // of unit size, so that squares neither vanish nor overflow
    let entries = h.as_flattened().iter();
    let size = entries
        .fold(0.0, |a: f64, x| a.max(x.abs()))
        .max(f64::MIN_POSITIVE);
    let mut h = h.map(|row| row.map(|x| x / size));
    if k == 2 {
        // a third axis on its own, with the least eigenvalue: it comes last
        h[2][2] = -3.0;
    }
    let (values, vectors) = Solid::eigen([h[0][0], h[1][1], h[2][2], h[0][1], h[0][2], h[1][2]]);
    (values.map(|v| v * size), vectors)
}

/// u and v of M = u vᵀ (k×k, by columns), both of unit length.
fn factors(m: &[f64], k: usize) -> ([f64; 3], [f64; 3]) {
    let norm = |column: &[f64]| column.iter().map(|x| x * x).sum::<f64>();
    let column = |c: usize| &m[c * k..(c + 1) * k];
    let largest = (1..k).fold(0, |best, c| {
        if norm(column(c)) > norm(column(best)) {
            c
        } else {
            best
        }
    });
    let (mut u, mut v) = ([0.0; 3], [0.0; 3]);
    let length = norm(column(largest)).sqrt();
    for i in 0..k {
        u[i] = column(largest)[i] / length;
    }
    for c in 0..k {
        v[c] = column(c).iter().zip(&u).map(|(m, u)| m * u).sum();
    }
    (u, v)
}

/// Below this difference, relative to the two σ, a quotient is replaced by its limit: it is wrong by the
/// square of the difference then, where the quotient would be by rounding over the difference.
const CLOSE: f64 = 1e-5;

/// (ψᵢ + s ψⱼ)/(σᵢ + s σⱼ) for s = ±1.
fn quotient<S: Space>(
    gradient_at: &Gradient<S>,
    hessian_at: &Hessian<S>,
    sigma: S::Sigma<f64>,
    (i, j): (usize, usize),
    s: f64,
) -> f64 {
    let (a, b) = (sigma.at(i), sigma.at(j));
    let numerator = |sigma| {
        let gradient = gradient_at(sigma);
        gradient.at(i) + s * gradient.at(j)
    };
    let close = (CLOSE * (a.abs() + b.abs())).max(1e-12);
    let difference = a + s * b;
    if difference.abs() > close {
        return numerator(sigma) / difference;
    }
    // where the denominator vanishes so does the numerator: its derivative along (1, s), over that of
    // the denominator
    let middle = 0.5 * (a - s * b);
    let between = S::Sigma::from_fn(|c| match c {
        _ if c == i => middle,
        _ if c == j => -s * middle,
        _ => sigma.at(c),
    });
    let gradient = gradient_at(between);
    let size = gradient.at(i).abs() + gradient.at(j).abs();
    let left = gradient.at(i) + s * gradient.at(j);
    if left.abs() > 1e-8 * size {
        // unless the energy has a kink there, as ARAP has where a reflected element turns about
        let away = if difference < 0.0 { -close } else { close };
        return numerator(sigma) / away;
    }
    let h = hessian_at(between);
    0.5 * (h[i][i] + h[j][j]) + s * h[i][j]
}
