//! How far the sparse factor and the relaxed solution can be from the truth.

use super::problem::multiply;
use super::reduced::Reduced;
use crate::linalg::Cholesky;

const EPSILON: f64 = f64::EPSILON;

/// Bounds (with an estimated condition number), for [`super::lattice::Proof`].
#[derive(Debug, Clone, Copy)]
pub struct RoundingError {
    /// η: |L⁻¹ (L Lᵀ − Ã) L⁻ᵀ|.
    pub factor: f64,
    /// ρ: the error of the relaxed solution in the norm of the energy.
    pub relaxation: f64,
}

impl RoundingError {
    /// Of a factor and of y with Ã y ≈ b̃.
    pub fn new(reduced: &Reduced, cholesky: &mut Cholesky, y: &[f64]) -> Self {
        let m = reduced.dimension();
        if m == 0 {
            return Self {
                factor: 0.0,
                relaxation: 0.0,
            };
        }
        let (offsets, rows, values) = reduced.matrix().csc_data();
        let diagonal: Vec<f64> = offsets[..m].iter().map(|&begin| values[begin]).collect();
        // a margin of 4 for an estimate from above
        let least = 0.25 * least_eigenvalue(&diagonal, cholesky);
        // Demmel (1989): |ΔÃ_ij| ≤ w ε √(Ã_ii Ã_jj) where L has a row of w entries at most
        let (widest, entries) = cholesky.row_entries();
        let frobenius = (widest as f64 + 2.0) * EPSILON * (2.0 * entries as f64).sqrt();
        let mut residual = vec![0.0; m];
        multiply(reduced.matrix(), y, &mut residual);
        // of each row the sum of sizes and the number of terms
        let mut sizes: Vec<f64> = reduced.linear().iter().map(|b| b.abs()).collect();
        let mut terms = vec![3.0f64; m];
        for j in 0..m {
            for entry in offsets[j]..offsets[j + 1] {
                let (i, a) = (rows[entry], values[entry].abs());
                sizes[i] += a * y[j].abs();
                terms[i] += 1.0;
                if i != j {
                    sizes[j] += a * y[i].abs();
                    terms[j] += 1.0;
                }
            }
        }
        let mut squared = 0.0;
        for i in 0..m {
            let left = (reduced.linear()[i] - residual[i]).abs() + terms[i] * EPSILON * sizes[i];
            squared += left * left / diagonal[i];
        }
        Self {
            factor: frobenius / least,
            relaxation: (squared / least).sqrt(),
        }
    }
}

/// An estimate (from above) of the least eigenvalue of D^−½ Ã D^−½, by inverse iteration.
fn least_eigenvalue(diagonal: &[f64], cholesky: &mut Cholesky) -> f64 {
    const ITERATIONS: usize = 12;
    let root: Vec<f64> = diagonal.iter().map(|d| d.sqrt()).collect();
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    // all smooth and rough modes: pseudo-random signs (a linear congruence)
    let mut state = 1u32;
    let mut v: Vec<f64> = (0..root.len())
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            0.5 + f64::from(state >> 8) / f64::from(1u32 << 24)
        })
        .collect();
    let mut least = 1.0;
    for _ in 0..ITERATIONS {
        let length = norm(&v);
        v.iter_mut().zip(&root).for_each(|(v, r)| *v *= r / length);
        cholesky.solve_in_place(&mut v, 1);
        v.iter_mut().zip(&root).for_each(|(v, r)| *v *= r);
        least = norm(&v).recip();
    }
    least
}
