//! 2×2 matrices by another library, to compare the crate's own with.
#![allow(dead_code)]

use nalgebra_sparse::na::{Matrix2, SVD};

pub type Matrix = Matrix2<f64>;

/// A gradient stored by columns as a matrix.
pub fn matrix(f: [f64; 4]) -> Matrix {
    Matrix::new(f[0], f[2], f[1], f[3])
}

/// A symmetric matrix in the coordinates of `Plane` as a matrix: t I + [[c, s], [s, −c]].
pub fn full([t, c, s]: [f64; 3]) -> Matrix {
    Matrix::new(t + c, s, s, t - c)
}

/// U, signed σ, V with proper U and V: a reflection is on the last singular value.
pub fn signed_svd(f: &Matrix) -> (Matrix, [f64; 2], Matrix) {
    let SVD {
        u,
        v_t,
        singular_values: sigma,
    } = SVD::new(*f, true, true);
    let (mut u, mut v) = (u.unwrap(), v_t.unwrap().transpose());
    let mut sigma = [sigma[0], sigma[1]];
    if sigma[0] < sigma[1] {
        sigma.swap(0, 1);
        u.swap_columns(0, 1);
        v.swap_columns(0, 1);
    }
    for side in [&mut u, &mut v] {
        if side.determinant() < 0.0 {
            side.set_column(1, &-side.column(1));
            sigma[1] = -sigma[1];
        }
    }
    (u, sigma, v)
}

/// M of the paper's (13)–(16), as written there.
pub fn stretch_residual(f: &Matrix, p: &Matrix) -> Matrix {
    let (u, sigma, v) = signed_svd(f);
    let h = Matrix::from_fn(|i, j| {
        let product = |a: usize, b: usize| (v.column(a).transpose() * p * v.column(b))[(0, 0)];
        sigma[i] / (sigma[i] + sigma[j]) * (product(i, j) + product(j, i))
    });
    f - u * h * v.transpose()
}
