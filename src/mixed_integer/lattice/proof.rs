//! What a finished enumeration proves in spite of rounding errors.
//!
//! Three things stand between the true energy and the squared distances that were enumerated. (1) The
//! reduced matrix Ã is L Lᵀ + ΔÃ; if |L⁻¹ΔÃL⁻ᵀ| ≤ η then the true form is at least (1 − η) times the
//! computed one, and so is its Schur complement. (2) The relaxed solution has the residual r: in the norm
//! of the energy it is off by ρ = √(rᵀÃ⁻¹r), by which distances may be too long. (3) The reduced basis R'
//! stands for R U; both give the same distances up to the factor |R U R'⁻¹|, and an error of the target.

use super::Reduction;
use crate::mixed_integer::search::IntegerForm;

const EPSILON: f64 = f64::EPSILON;

/// Bounds of rounding errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proof {
    /// η: relative error of squared distances.
    pub relative: f64,
    /// ρ: absolute error of distances ‖R (z − c)‖.
    pub absolute: f64,
}

impl Proof {
    /// For a form with these errors of factorisation (1) and relaxation (2), enumerated in a reduced basis.
    pub fn new(form: &IntegerForm, reduction: &Reduction, factor: f64, relaxation: f64) -> Self {
        let k = form.k;
        let size = k as f64 + 4.0;
        let inverse = upper_inverse(reduction.basis(), k);
        let (u, r) = (reduction.transform(), &form.factor);
        // M = R U R'⁻¹, orthogonal but for rounding, and a bound for the errors of computing it
        let (mut product, mut errors) = (vec![0.0; k * k], 0.0);
        let mut column = vec![[0.0; 2]; k];
        let mut rows = vec![[0.0; 2]; k];
        for j in 0..k {
            column.fill([0.0; 2]);
            for (i, v) in inverse[j * k..j * k + j + 1].iter().enumerate() {
                for (c, u) in column.iter_mut().zip(&u[i * k..(i + 1) * k]) {
                    c[0] += u * v;
                    c[1] += (u * v).abs();
                }
            }
            rows.fill([0.0; 2]);
            for (i, c) in column.iter().enumerate() {
                for (row, l) in rows.iter_mut().zip(&r[i * k..i * k + i + 1]) {
                    row[0] += l * c[0];
                    row[1] += l.abs() * c[1];
                }
            }
            for (i, row) in rows.iter().enumerate() {
                product[j * k + i] = row[0];
                errors += row[1] * row[1];
            }
        }
        let mut defect = 0.0;
        for i in 0..k {
            for j in 0..k {
                let (a, b) = (&product[i * k..(i + 1) * k], &product[j * k..(j + 1) * k]);
                let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                let wrong = dot - f64::from(u8::from(i == j));
                defect += wrong * wrong;
            }
        }
        let basis = defect.sqrt() + 4.0 * size * EPSILON * errors.sqrt();
        // the target: ‖M y − R c‖, and the rounding of both
        let root = form.root(&form.offset(&reduction.integers(&vec![0.0; k])));
        let target = reduction.target();
        let mut turned = vec![0.0; k];
        for (j, y) in target.iter().enumerate() {
            for (t, m) in turned.iter_mut().zip(&product[j * k..(j + 1) * k]) {
                *t += m * y;
            }
        }
        let moved: f64 = turned
            .iter()
            .zip(&root)
            .map(|(a, b)| (a + b) * (a + b))
            .sum();
        let norm: f64 = target.iter().map(|y| y * y).sum::<f64>().sqrt();
        let center: f64 = form.center.iter().map(|c| c * c).sum::<f64>().sqrt();
        let largest = r.iter().map(|l| l * l).sum::<f64>().sqrt();
        let rounding = 2.0 * size * EPSILON * (norm * (1.0 + errors.sqrt()) + center * largest);
        Self {
            // enumeration: sums of k terms for the center, k squares for the distance
            relative: factor + basis + 8.0 * size * EPSILON,
            absolute: relaxation + moved.sqrt() + rounding,
        }
    }

    /// The least that ½‖R (z − c)‖² can be, if no computed squared distance is below `squared`.
    pub fn energy(&self, squared: f64) -> f64 {
        let distance = (squared.max(0.0).sqrt() - self.absolute).max(0.0);
        0.5 * distance * distance * (1.0 - self.relative).max(0.0)
    }
}

/// The inverse of an upper triangular matrix, column by column.
fn upper_inverse(r: &[f64], k: usize) -> Vec<f64> {
    let mut inverse = vec![0.0; k * k];
    for j in 0..k {
        let column = &mut inverse[j * k..j * k + j + 1];
        column[j] = 1.0;
        for i in (0..=j).rev() {
            column[i] /= r[i * k + i];
            let x = column[i];
            for (c, r) in column[..i].iter_mut().zip(&r[i * k..i * k + i]) {
                *c -= r * x;
            }
        }
    }
    inverse
}
