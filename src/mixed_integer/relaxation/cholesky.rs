//! Level 3: sparse Cholesky. Fixed unknowns keep an identity row and column, so that the pattern, its
//! order and its symbolic factor stay valid (paper, §3.2).

use super::system::System;
use crate::linalg::{Cholesky, NotPositiveDefinite};
use crate::mixed_integer::reduced::Reduced;

/// Solves for the free unknowns.
pub(super) fn solve(
    cholesky: &mut Cholesky,
    reduced: &Reduced,
    system: &mut System,
    passes: usize,
) -> Result<(), NotPositiveDefinite> {
    let mut masked = reduced.matrix().clone();
    let fixed = &system.fixed;
    {
        let (offsets, rows, values) = masked.csc_data_mut();
        for (j, ends) in offsets.windows(2).enumerate() {
            for entry in ends[0]..ends[1] {
                let i = rows[entry];
                if fixed[i] || fixed[j] {
                    values[entry] = f64::from(u8::from(i == j));
                }
            }
        }
    }
    cholesky.factorize(&masked)?;
    for _ in 0..passes {
        let free = |(r, fixed): (&f64, &bool)| if *fixed { 0.0 } else { *r };
        let mut delta: Vec<f64> = system
            .residual
            .iter()
            .zip(&system.fixed)
            .map(free)
            .collect();
        cholesky.solve_in_place(&mut delta, 1);
        let mut residual = vec![0.0; delta.len()];
        system.multiply(&delta, &mut residual);
        for (new, old) in residual.iter_mut().zip(&system.residual) {
            *new = old - *new;
        }
        system.change_all(&delta, &residual);
        system.refresh(reduced);
    }
    Ok(())
}
