//! What the second derivatives of an energy with the nearest rotation in it have beside those of one with a
//! rotation that stays.

use crate::energy::hessian::Square;
use crate::space::{Components, Space};

/// How the nearest rotation R turns as F changes: by 2/(σᵢ + σⱼ) along the twists
/// R V (eᵢeⱼᵀ − eⱼeᵢᵀ) Vᵀ/√2 = R [v]×/√2, v the third axis of F = R V Σ Vᵀ (Smith, de Goes & Kim 2019).
pub struct Turning<S: Space> {
    /// Signed singular values of F.
    pub sigma: S::Sigma<f64>,
    frame: S::Singularframe<f64>,
    /// R.
    pub rotation: S::Gradient<f64>,
}

impl<S: Space> Turning<S> {
    /// At F.
    pub fn new(f: S::Gradient<f64>) -> Self {
        let (sigma, frame) = S::svd(f);
        Self {
            sigma,
            frame,
            rotation: S::from_svd(S::Sigma::from_fn(|_| 1.0), frame),
        }
    }

    /// Takes `amount`/(σᵢ + σⱼ), but no more than `most`, from a matrix along each twist. Where σᵢ + σⱼ is
    /// not positive nothing is taken: turning makes the energy stiffer there.
    pub fn soften(&self, most: f64, amount: f64, h: &mut Square) {
        let k = S::STRETCHES;
        let axes = if k == 2 { 1 } else { 3 };
        for axis in 0..axes {
            let pair = match k {
                2 => self.sigma.at(0) + self.sigma.at(1),
                _ => self.sigma.at((axis + 1) % 3) + self.sigma.at((axis + 2) % 3),
            };
            if !(pair > 0.0) {
                continue;
            }
            // half of it, for the norm of the twist
            let part = 0.5 * (amount / pair).min(most);
            let twist = self.twist(axis);
            for a in 0..k * k {
                for b in 0..k * k {
                    h[a][b] -= part * twist.at(a) * twist.at(b);
                }
            }
        }
    }

    /// R [v]×, v the axis of this singular value; in the plane R turned by a quarter.
    fn twist(&self, axis: usize) -> S::Gradient<f64> {
        let r = |row: usize, column: usize| self.rotation.at(column * S::DIM + row);
        if S::STRETCHES == 2 {
            // R [0 −1; 1 0]
            return S::Gradient::from_fn(|c| match c / 2 {
                0 => r(c % 2, 1),
                _ => -r(c % 2, 0),
            });
        }
        // u vᵀ, and v from Rᵀ u vᵀ = v vᵀ
        let unit = S::Sigma::from_fn(|i| f64::from(u8::from(i == axis)));
        let product = S::from_svd(unit, self.frame);
        let mut square = [[0.0; 3]; 3];
        for a in 0..3 {
            for b in 0..3 {
                square[a][b] = (0..3).map(|i| r(i, a) * product.at(3 * b + i)).sum();
            }
        }
        let largest = (1..3).fold(0, |best, c| {
            if square[c][c] > square[best][best] { c } else { best }
        });
        let length = square[largest][largest].sqrt();
        let v = square[largest].map(|x| x / length);
        // column c of [v]×, v × e_c, in the rows of R
        S::Gradient::from_fn(|c| {
            let (column, row) = (c / 3, c % 3);
            let (next, last) = ((column + 1) % 3, (column + 2) % 3);
            r(row, next) * v[last] - r(row, last) * v[next]
        })
    }
}
