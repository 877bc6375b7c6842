//! Steps along which triangles turn.
//!
//! Along x + t d a triangle that turns at the rate ω is stretched by (ωt)²/2, so that a long strip, which unrolls
//! without any resistance, can do so by small steps only. Here every triangle turns, with what else the
//! direction does to it carried along: F̂(t) = R(ωt) (F + t (D − ωJF)), D the change of F along d and J the
//! quarter turn. Vertices go where gradients fit best, x(t) = x + t d + A⁻¹ Σ A_e Gᵀ (F̂(t) − F − tD), A the
//! Laplacian at rest with what else holds vertices: the global step of ADMM-PD. The curve leaves x along d.
//!
//! The second derivative of the energy along it is not dᵀHd, but that and ∇E · x''(0), where x'' is −ω²F projected
//! on what is a gradient. With λ = A⁻¹ ∇E that makes −Σ A_e ω² ∇λ : F: of the stress P, the part ∇λ that is not in
//! equilibrium resists no turn. Composite majorization's term of ∇²|α| is that resistance; the difference belongs
//! there.
//!
//! ωt may be many turns: a straight strip that ought to be a coil is one after a step or two.

use crate::geometry::Elimination;
use crate::optim::BuildError;
use crate::parallel;
use crate::quasi_newton::evaluation::Evaluation;
use crate::space::plane::{conj_mul, join, mul, split};
use crate::space::{Lane, Pack, Plane, Scalar, dispatch};
use crate::wrapd::Problem;
use crate::wrapd::block::{BLOCK, Block, Row, load, packs};
use crate::wrapd::kernels::{deformation_gradient, spread, store_corners};
use crate::wrapd::system::System;
use pulp::{Simd, WithSimd};

/// Numbers of a block's corner forces.
const FORCES: usize = 3 * BLOCK * 2;

/// What a triangle must at least be like, as |α|², to turn.
const TINY: f64 = 1e-290;

/// Squarings that make a turn of a part of it.
const SQUARINGS: u32 = 10;

/// The curves, and what of the stress is out of equilibrium.
pub struct Turns {
    /// The Laplacian at rest, and the springs.
    system: System,
    /// Its factor.
    stiffness: f64,
    unknowns: usize,
    /// By slot, 0 for the pinned: λ, or what turning adds to a step.
    field: Vec<f64>,
    /// Corner forces, block by block.
    forces: Vec<f64>,
    /// ∇λ : F, block by block.
    unbalanced: Vec<Row>,
    /// The largest ωt in each block.
    fastest: Vec<f64>,
}

impl Turns {
    /// Factors the Laplacian.
    ///
    /// # Errors
    /// `TooLarge`, and `NotPositiveDefinite` where nothing holds a part of the map.
    pub fn new(
        problem: &Problem,
        elimination: &Elimination,
        evaluation: &Evaluation,
    ) -> Result<Self, BuildError> {
        let stiffness = evaluation.shape.constants.rest_stiffness;
        let mut system = System::new(problem.rest, elimination, problem.external)?;
        system
            .factorize(evaluation.terms.as_ref(), |_| stiffness)
            .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
        let blocks = evaluation.blocks.len();
        Ok(Self {
            system,
            stiffness,
            unknowns: 2 * elimination.free,
            field: vec![0.0; 2 * elimination.slot.len()],
            forces: vec![0.0; FORCES * blocks],
            unbalanced: vec![[0.0; BLOCK]; blocks],
            fastest: vec![0.0; blocks],
        })
    }

    /// ∇λ : F of each triangle, at the F of the last evaluation, whose gradient this is.
    pub fn unbalanced(&mut self, evaluation: &Evaluation, gradient: &[f64]) -> &[Row] {
        let (free, pinned) = self.field.split_at_mut(self.unknowns);
        free.copy_from_slice(gradient);
        pinned.fill(0.0);
        self.system.factor.solve_in_place(free, 2);
        let (field, stiffness) = (&self.field, self.stiffness);
        parallel::for_each_chunk(&mut self.unbalanced, 1, |i, out| {
            dispatch(Unbalanced {
                block: &evaluation.blocks[i],
                field,
                stiffness,
                out: &mut out[0],
            });
        });
        &self.unbalanced
    }

    /// x(t) into the free part of `trial`; all by slot, `direction` 0 for the pinned. Returns the largest ωt.
    pub fn go(
        &mut self,
        evaluation: &Evaluation,
        x: &[f64],
        direction: &[f64],
        t: f64,
        trial: &mut [f64],
    ) -> f64 {
        let (fastest, forces) = (&mut self.fastest, &mut self.forces);
        let stiffness = self.stiffness;
        parallel::for_each_block(fastest, forces, FORCES, |i, fastest, forces| {
            *fastest = dispatch(Turn {
                block: &evaluation.blocks[i],
                x,
                direction,
                t,
                stiffness,
                forces,
            });
        });
        let free = &mut self.field[..self.unknowns];
        evaluation.gather_planar(&self.forces, free);
        self.system.factor.solve_in_place(free, 2);
        for (((trial, x), d), c) in trial.iter_mut().zip(x).zip(direction).zip(free) {
            *trial = x + t * d + *c;
        }
        self.fastest.iter().copied().fold(0.0, f64::max)
    }
}

struct Unbalanced<'a> {
    block: &'a Block,
    field: &'a [f64],
    stiffness: f64,
    out: &'a mut Row,
}

impl WithSimd for Unbalanced<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        for at in packs::<V>() {
            let f: [Pack<V>; 4] = load(simd, &self.block.gradient, at);
            let g = deformation_gradient::<Plane, V>(simd, self.block, self.field, at);
            let sum = (f[0] * g[0] + f[1] * g[1]) + (f[2] * g[2] + f[3] * g[3]);
            let sum = Pack::splat(simd, self.stiffness) * sum;
            sum.store(&mut self.out[at..at + Pack::<V>::WIDTH]);
        }
    }
}

struct Turn<'a> {
    block: &'a Block,
    x: &'a [f64],
    direction: &'a [f64],
    t: f64,
    stiffness: f64,
    forces: &'a mut [f64],
}

impl WithSimd for Turn<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) -> f64 {
        let t = Pack::splat(simd, self.t);
        let (zero, one) = (t.lift(0.0), t.lift(1.0));
        let mut fastest = zero;
        for at in packs::<V>() {
            let f = deformation_gradient::<Plane, V>(simd, self.block, self.x, at);
            let d = deformation_gradient::<Plane, V>(simd, self.block, self.direction, at);
            let ([alpha, beta], [alpha_rate, beta_rate]) = (pair(split(f)), pair(split(d)));
            // dα/α = stretch + iω
            let square = alpha[0] * alpha[0] + alpha[1] * alpha[1];
            let turns = t.lift(TINY).lt(square);
            let rate = conj_mul(alpha, alpha_rate);
            let inverse = square.select(turns, square.recip(), zero);
            let (stretch, omega) = (t * rate[0] * inverse, t * rate[1] * inverse);
            fastest = fastest.max(omega.abs());
            let rotation = turn(omega);
            let grown = one + stretch;
            let alpha_then = mul(rotation, [grown * alpha[0], grown * alpha[1]]);
            // what D does beside turning β
            let beta_then = mul(
                rotation,
                [
                    beta[0] + t * beta_rate[0] + omega * beta[1],
                    beta[1] + t * beta_rate[1] - omega * beta[0],
                ],
            );
            let more = |then: Pack<V>, now, rate| (then - now) - t * rate;
            let residual = join(
                [
                    more(alpha_then[0], alpha[0], alpha_rate[0]),
                    more(alpha_then[1], alpha[1], alpha_rate[1]),
                ],
                [
                    more(beta_then[0], beta[0], beta_rate[0]),
                    more(beta_then[1], beta[1], beta_rate[1]),
                ],
            );
            let [area]: [Pack<V>; 1] = load(simd, &self.block.measure, at);
            let scale = area * t.lift(self.stiffness);
            let corners = spread::<Plane, V>(simd, self.block, residual, scale, at);
            store_corners::<Plane, V, 1>([corners], self.forces, at);
        }
        fastest.fold(f64::max)
    }
}

/// e^(iω), by the Padé approximant of the part ω/2ⁿ, of modulus 1 as that is, and n squarings: to 1e-9 up to ten
/// radians.
#[inline(always)]
fn turn<L: Lane>(omega: L) -> [L; 2] {
    let part = omega * omega.lift(1.0 / f64::from(1 << SQUARINGS));
    let real = omega.lift(1.0) - part * part * omega.lift(1.0 / 12.0);
    let imaginary = omega.lift(0.5) * part;
    let (real2, imaginary2) = (real * real, imaginary * imaginary);
    let scale = (real2 + imaginary2).recip();
    let mut rotation = [
        (real2 - imaginary2) * scale,
        (real + real) * imaginary * scale,
    ];
    for _ in 0..SQUARINGS {
        rotation = mul(rotation, rotation);
    }
    rotation
}

fn pair<T>((first, second): (T, T)) -> [T; 2] {
    [first, second]
}
