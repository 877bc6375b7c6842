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

/// H = C A⁻¹ Cᵀ + εI, and the step it is about.
///
/// Linearised constraints may contradict each other, and of a collapsed element the gradient vanishes: multipliers
/// would then grow without bound. With ε they are met but for ελ, and stay bounded; it is too small to be seen
/// elsewhere, where the polisher mends more than that.
struct Dual<'a, const D: usize> {
    rows: Vec<Row<D>>,
    /// ε.
    softness: f64,
    factor: &'a mut Cholesky,
    /// A⁻¹Cᵀ times the last direction.
    response: Vec<[f64; D]>,
    /// x̄(λ) − x̄.
    step: &'a mut [[f64; D]],
    watch: Option<Watch<'a, D>>,
}

/// What the dual problem goes through.
struct Watch<'a, const D: usize> {
    path: &'a mut Vec<Visited<D>>,
    /// x̄, which the step is about.
    x: &'a [[f64; D]],
    /// Of each row the place of its constraint, of so many.
    places: &'a [u32],
    constraints: usize,
}

/// A state of the dual problem, seen from the vertices.
pub struct Visited<const D: usize> {
    /// x̄(λ), by slot.
    pub x: Vec<[f64; D]>,
    /// Of every constraint: λ > 0?
    pub active: Vec<bool>,
}

impl<const D: usize> Watch<'_, D> {
    fn keep(&mut self, step: &[[f64; D]], lambda: &[f64]) {
        let mut x = self.x.to_vec();
        for (x, s) in x.iter_mut().zip(step) {
            (0..D).for_each(|i| x[i] += s[i]);
        }
        let mut active = vec![false; self.constraints];
        for (&place, &l) in self.places.iter().zip(lambda) {
            active[place as usize] = l > 0.0;
        }
        self.path.push(Visited { x, active });
    }
}

impl<const D: usize> Dual<'_, D> {
    fn spread(rows: &[Row<D>], lambda: &[f64], out: &mut [[f64; D]]) {
        for (row, &l) in rows.iter().zip(lambda) {
            if l == 0.0 {
                continue;
            }
            for corner in 0..4 {
                let x = &mut out[row.slots[corner] as usize];
                for i in 0..D {
                    x[i] += l * row.gradient[corner][i];
                }
            }
        }
    }

    fn gather(row: &Row<D>, x: &[[f64; D]]) -> f64 {
        let mut sum = 0.0;
        for corner in 0..4 {
            let x = &x[row.slots[corner] as usize];
            for i in 0..D {
                sum += x[i] * row.gradient[corner][i];
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
        for ((out, row), l) in out.iter_mut().zip(&self.rows).zip(direction) {
            *out = Self::gather(row, &self.response) + self.softness * l;
        }
    }

    fn moved(&mut self, step: f64) {
        let step_and_response = self.step.as_flattened_mut().iter_mut();
        for (x, r) in step_and_response.zip(self.response.as_flattened()) {
            *x += step * r;
        }
    }

    fn visited(&mut self, lambda: &[f64]) {
        if let Some(watch) = &mut self.watch {
            watch.keep(self.step, lambda);
        }
    }
}

/// The squared norm of the gradient of an undeformed regular element's constraint.
fn natural<const D: usize>() -> f64 {
    if D == 2 { 1.0 / 3.0 } else { 1.0 / 9.0 }
}

/// Constraints whose gradient is less than this part of the natural one say nothing when linearised.
const COLLAPSED: f64 = 1e-2;

/// ε relative to what H has on its diagonal for a constraint with the natural gradient, about.
const SOFTNESS: f64 = 1e-3;

/// How well the linearised constraints are met, relative to the least η: what is left is the polisher's.
const TOLERANCE: f64 = 0.1;

/// The global step's system: the factor of A, and the mean reciprocal of A's diagonal.
pub struct Primal<'a> {
    /// Of A.
    pub factor: &'a mut Cholesky,
    /// Mean of 1/Aᵢᵢ.
    pub compliance: f64,
}

/// Solves (10) about `x`, warm-started by the multipliers of the constraints, which it sets. `step` comes as the
/// negative gradient b − A x̄ of (6a) on the unknowns, and leaves as x̄(λ) − x̄ (9). Where a `path` is wanted, x̄(λ) of
/// the start and of every iteration is appended to it. Returns the iterations.
pub fn global_step<const D: usize>(
    constraints: &mut [Constraint],
    x: &[[f64; D]],
    primal: Primal,
    step: &mut [[f64; D]],
    max_iterations: usize,
    path: Option<&mut Vec<Visited<D>>>,
) -> usize {
    let unknowns = step.len() as u32;
    if unknowns == 0 {
        return 0;
    }
    let Primal { factor, compliance } = primal;
    let mut rows: Vec<Row<D>> = Vec::with_capacity(constraints.len());
    let mut lambda: Vec<f64> = Vec::with_capacity(constraints.len());
    // where each row's constraint is
    let mut places: Vec<u32> = Vec::with_capacity(constraints.len());
    for (place, c) in constraints.iter_mut().enumerate() {
        let mut slots = c.slots;
        let mut gradient = c.gradient_at(&corners(x, &slots));
        let square: f64 = gradient.iter().flatten().map(|g| g * g).sum();
        if c.skipped || !(square > COLLAPSED * COLLAPSED * natural::<D>()) {
            c.lambda = 0.0;
            continue;
        }
        for (slot, g) in slots.iter_mut().zip(&mut gradient) {
            if *slot >= unknowns {
                (*slot, *g) = (0, [0.0; D]);
            }
        }
        rows.push(Row { slots, gradient });
        lambda.push(c.lambda);
        places.push(place as u32);
    }
    Dual::spread(&rows, &lambda, step);
    factor.solve_in_place(step.as_flattened_mut(), D);
    let mut watch = path.map(|path| Watch {
        path,
        x,
        places: &places,
        constraints: constraints.len(),
    });
    if let Some(watch) = &mut watch {
        watch.keep(step, &lambda);
    }
    if rows.is_empty() || max_iterations == 0 {
        return 0;
    }
    let softness = SOFTNESS * natural::<D>() * compliance;
    let mut least = f64::INFINITY;
    let mut gradient = Vec::with_capacity(rows.len());
    for ((row, &place), l) in rows.iter().zip(&places).zip(&lambda) {
        let c = &constraints[place as usize];
        least = least.min(c.offset);
        gradient.push(c.value(x) + Dual::gather(row, step) - c.offset + softness * l);
    }
    let mut dual = Dual {
        rows,
        softness,
        factor,
        response: vec![[0.0; D]; step.len()],
        step,
        watch,
    };
    let options = LbfgsbOptions {
        history: HISTORY,
        max_iterations,
        tolerance: TOLERANCE * least,
    };
    let iterations = minimize(&mut dual, &mut lambda, &mut gradient, options);
    for (&place, lambda) in places.iter().zip(lambda) {
        constraints[place as usize].lambda = lambda;
    }
    iterations
}
