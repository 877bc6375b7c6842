//! The global step: the dual (10) of the quadratic problem (6).

use super::constraint::Constraint;
use super::simplex::corners;
use crate::linalg::Cholesky;
use crate::optim::lbfgsb::{LbfgsbOptions, Quadratic, minimize};

/// Pairs that L-BFGS-B keeps.
const HISTORY: usize = 6;

/// A linearised constraint (2): ∇c on the slots that are unknowns (the others have 0).
struct Row<const D: usize> {
    slots: [u32; 4],
    gradient: [[f64; D]; 4],
}

/// H = C A⁻¹ Cᵀ, and the step it is about.
struct Dual<'a, const D: usize> {
    rows: Vec<Row<D>>,
    factor: &'a mut Cholesky,
    /// A⁻¹Cᵀ times the last direction.
    response: Vec<[f64; D]>,
    /// x̄(λ) − x̄.
    step: &'a mut [[f64; D]],
}

impl<const D: usize> Dual<'_, D> {
    fn spread(rows: &[Row<D>], lambda: &[f64], out: &mut [[f64; D]]) {
        for (row, &l) in rows.iter().zip(lambda) {
            if l == 0.0 {
                continue;
            }
            for (&slot, g) in row.slots.iter().zip(&row.gradient) {
                for (x, g) in out[slot as usize].iter_mut().zip(g) {
                    *x += l * g;
                }
            }
        }
    }

    fn gather(row: &Row<D>, x: &[[f64; D]]) -> f64 {
        let mut sum = 0.0;
        for (&slot, g) in row.slots.iter().zip(&row.gradient) {
            for (x, g) in x[slot as usize].iter().zip(g) {
                sum += x * g;
            }
        }
        sum
    }
}

impl<const D: usize> Quadratic for Dual<'_, D> {
    fn apply(&mut self, direction: &[f64], out: &mut [f64]) {
        self.response.fill([0.0; D]);
        Self::spread(&self.rows, direction, &mut self.response);
        self.factor
            .solve_in_place(self.response.as_flattened_mut(), D);
        for (out, row) in out.iter_mut().zip(&self.rows) {
            *out = Self::gather(row, &self.response);
        }
    }

    fn moved(&mut self, step: f64) {
        for (x, r) in self.step.iter_mut().zip(&self.response) {
            for (x, r) in x.iter_mut().zip(r) {
                *x += step * r;
            }
        }
    }
}

/// Solves (10) about `x`, warm-started by the multipliers of the constraints, which it sets. `step` comes as the
/// negative gradient b − A x̄ of (6a) on the unknowns, and leaves as x̄(λ) − x̄ (9). Returns the iterations.
pub fn global_step<const D: usize>(
    constraints: &mut [Constraint],
    x: &[[f64; D]],
    factor: &mut Cholesky,
    step: &mut [[f64; D]],
    max_iterations: usize,
) -> usize {
    let unknowns = step.len() as u32;
    if unknowns == 0 {
        return 0;
    }
    let mut lambda: Vec<f64> = constraints.iter().map(|c| c.lambda).collect();
    let rows: Vec<Row<D>> = constraints
        .iter()
        .map(|c| {
            let mut slots = c.slots;
            let mut gradient = c.gradient_at(&corners(x, &slots));
            for (slot, g) in slots.iter_mut().zip(&mut gradient) {
                if *slot >= unknowns {
                    (*slot, *g) = (0, [0.0; D]);
                }
            }
            Row { slots, gradient }
        })
        .collect();
    Dual::spread(&rows, &lambda, step);
    factor.solve_in_place(step.as_flattened_mut(), D);
    if constraints.is_empty() || max_iterations == 0 {
        return 0;
    }
    let mut gradient: Vec<f64> = constraints
        .iter()
        .zip(&rows)
        .map(|(c, row)| c.value(x) + Dual::gather(row, step) - c.offset)
        .collect();
    let least = constraints.iter().map(|c| c.offset);
    let least = least.fold(f64::INFINITY, f64::min);
    let mut dual = Dual {
        rows,
        factor,
        response: vec![[0.0; D]; step.len()],
        step,
    };
    let options = LbfgsbOptions {
        history: HISTORY,
        max_iterations,
        tolerance: TOLERANCE * least,
    };
    let iterations = minimize(&mut dual, &mut lambda, &mut gradient, options);
    for (constraint, lambda) in constraints.iter_mut().zip(lambda) {
        constraint.lambda = lambda;
    }
    iterations
}

/// How well the linearised constraints are met, relative to the least η: what is left is the polisher's.
const TOLERANCE: f64 = 0.1;
