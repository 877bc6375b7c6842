//! The element loops: local step, forces of the global step, evaluation.
//!
//! Forces are kept a corner (vertex v of element e) and gathered by the vertices in a fixed order
//! afterwards, so that no result depends on the number of threads.

use super::Coupling;
use super::block::{BLOCK, Block, BlockSums, load, packs, store};
use crate::energy::Energy;
use crate::space::{Components, Lane, Pack, Scalar, Space};
use core::marker::PhantomData;
use pulp::{Simd, WithSimd};

/// Which element loop, with what it needs beside the block.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pass {
    /// Z, U, candidate weights, and the forces at the current F with the new P = Z − U. Candidate
    /// stiffnesses are clamped to the given range (22).
    Local {
        /// Least and most candidate stiffness.
        clamp: [f64; 2],
        /// γ of (23).
        threshold: f64,
        /// Set Z and U from F first.
        reset: bool,
    },
    /// F at new positions and its forces.
    Forces,
    /// F at new positions, its forces, and the energy's density, flips, stretches and own forces
    /// there.
    Last,
}

impl Pass {
    /// Numbers a corner has in the force array.
    pub fn stride(self, dimension: usize) -> usize {
        match self {
            Pass::Last => 2 * dimension,
            _ => dimension,
        }
    }
}

/// One pass over one block.
pub struct Kernel<'a, S, C, E> {
    /// What to do.
    pub pass: Pass,
    /// The elements.
    pub block: &'a mut Block,
    /// Positions, interleaved, by vertex slot.
    pub positions: &'a [f64],
    /// Corner forces out, (v·BLOCK + e)·[`Pass::stride`] + i: those of the coupling, in the pass `Last`
    /// followed by those of the energy.
    pub forces: &'a mut [f64],
    /// The energy.
    pub energy: E,
    /// Space and coupling.
    pub types: PhantomData<(S, C)>,
}

/// Positions of vertex v of the elements from `at` on (entries beyond DIM are 0).
#[inline(always)]
fn corner<S: Space, V: Simd>(
    simd: V,
    block: &Block,
    positions: &[f64],
    at: usize,
    v: usize,
) -> [Pack<V>; 3] {
    let mut lanes = [[0.0; 8]; 3];
    let slots = &block.vertices[v][at..at + Pack::<V>::WIDTH];
    for (lane, &slot) in slots.iter().enumerate() {
        let position = &positions[slot as usize * S::DIM..][..S::DIM];
        for i in 0..S::DIM {
            lanes[i][lane] = position[i];
        }
    }
    let width = Pack::<V>::WIDTH;
    [
        Pack::load(simd, &lanes[0][..width]),
        Pack::load(simd, &lanes[1][..width]),
        Pack::load(simd, &lanes[2][..width]),
    ]
}

/// F of the elements from `at` on: [x₁−x₀ … x_k−x₀] Dm⁻¹.
#[inline(always)]
fn deformation_gradient<S: Space, V: Simd>(
    simd: V,
    block: &Block,
    positions: &[f64],
    at: usize,
) -> S::Gradient<Pack<V>> {
    let zero = Pack::splat(simd, 0.0);
    // at most 3 edges of dimension 3
    let mut edges = [[zero; 3]; 3];
    let origin = corner::<S, V>(simd, block, positions, at, 0);
    for (v, edge) in edges.iter_mut().enumerate().take(S::STRETCHES) {
        let tip = corner::<S, V>(simd, block, positions, at, v + 1);
        for i in 0..S::DIM {
            edge[i] = tip[i] - origin[i];
        }
    }
    S::Gradient::from_fn(
        #[inline(always)]
        |c| {
            let (column, i) = (c / S::DIM, c % S::DIM);
            let mut sum = zero;
            for (v, edge) in edges.iter().enumerate().take(S::STRETCHES) {
                let g = Pack::load(
                    simd,
                    &block.inverse[column * S::STRETCHES + v][at..at + Pack::<V>::WIDTH],
                );
                let term = edge[i] * g;
                sum = if v == 0 { term } else { sum + term };
            }
            sum
        },
    )
}

/// The forces of scale · M on the corners: f_v = M g_v, f_0 = −Σ f_v.
#[inline(always)]
fn spread<S: Space, V: Simd>(
    simd: V,
    block: &Block,
    m: S::Gradient<Pack<V>>,
    scale: Pack<V>,
    at: usize,
) -> [[Pack<V>; 3]; 4] {
    let zero = Pack::splat(simd, 0.0);
    let mut corners = [[zero; 3]; 4];
    for v in 0..S::STRETCHES {
        for i in 0..S::DIM {
            let mut sum = zero;
            for column in 0..S::STRETCHES {
                let g = Pack::load(
                    simd,
                    &block.inverse[column * S::STRETCHES + v][at..at + Pack::<V>::WIDTH],
                );
                sum = sum + m.at(column * S::DIM + i) * g;
            }
            corners[v + 1][i] = scale * sum;
            corners[0][i] = corners[0][i] - corners[v + 1][i];
        }
    }
    corners
}

/// Writes corner forces: K vectors a corner, side by side.
#[inline(always)]
fn store_corners<S: Space, V: Simd, const K: usize>(
    vectors: [[[Pack<V>; 3]; 4]; K],
    forces: &mut [f64],
    at: usize,
) {
    let width = Pack::<V>::WIDTH;
    let stride = K * S::DIM;
    for v in 0..=S::STRETCHES {
        let mut lanes = [[[0.0; 8]; 3]; K];
        for (lanes, vector) in lanes.iter_mut().zip(&vectors) {
            for i in 0..S::DIM {
                vector[v][i].store(&mut lanes[i][..width]);
            }
        }
        let target = &mut forces[(v * BLOCK + at) * stride..][..width * stride];
        for (lane, out) in target.chunks_exact_mut(stride).enumerate() {
            for k in 0..K {
                for i in 0..S::DIM {
                    out[k * S::DIM + i] = lanes[k][i][lane];
                }
            }
        }
    }
}

impl<S: Space, C: Coupling<S>, E: Energy<S>> WithSimd for Kernel<'_, S, C, E> {
    type Output = BlockSums;

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) -> BlockSums {
        match self.pass {
            Pass::Local {
                clamp,
                threshold,
                reset,
            } => self.local(simd, clamp, threshold, reset),
            Pass::Forces => self.forces::<V, false>(simd),
            Pass::Last => self.forces::<V, true>(simd),
        }
    }
}

impl<S: Space, C: Coupling<S>, E: Energy<S>> Kernel<'_, S, C, E> {
    #[inline(always)]
    fn local<V: Simd>(self, simd: V, clamp: [f64; 2], threshold: f64, reset: bool) -> BlockSums {
        let Self {
            block,
            forces,
            energy,
            ..
        } = self;
        let (mut change, mut z_energy) = (RunningSums::default(), RunningSums::default());
        let mut prox_iterations = 0;
        let mut reweight = false;
        let threshold = Pack::splat(simd, threshold);
        let least = Pack::splat(simd, clamp[0]);
        let most = Pack::splat(simd, clamp[1]);
        for at in packs::<V>() {
            let f: S::Gradient<Pack<V>> = load(simd, &block.gradient, at);
            let [area]: [Pack<V>; 1] = load(simd, &block.measure, at);
            let [k]: [Pack<V>; 1] = load(simd, &block.stiffness, at);
            let (s, aux) = C::local(f);
            let (z_old, u, density_old) = if reset {
                let zero = area.lift(0.0);
                let (sigma, _) = C::spectrum(s);
                (
                    s,
                    C::Local::from_fn(
                        #[inline(always)]
                        |_| zero,
                    ),
                    guarded_density::<S, E, _>(energy, sigma),
                )
            } else {
                let [density]: [Pack<V>; 1] = load(simd, &block.z_density, at);
                (
                    load::<V, C::Local<_>>(simd, &block.z, at),
                    load::<V, C::Local<_>>(simd, &block.u, at),
                    density,
                )
            };
            let half_k = area.lift(0.5) * k;
            let target = s.zip(
                u,
                #[inline(always)]
                |s, u| s + u,
            );
            let l0 = density_old
                + half_k
                    * C::norm_squared(target.zip(
                        z_old,
                        #[inline(always)]
                        |t, z| t - z,
                    ));
            let (p, frame) = C::spectrum(target);
            let warm: S::Sigma<Pack<V>> = load(simd, &block.sigma, at);
            let (sigma, count) = energy.prox(p, k, warm);
            prox_iterations = prox_iterations.max(count);
            let z: C::Local<Pack<V>> = C::compose(sigma, frame);
            let density = energy.density(sigma);
            let dual = target.zip(
                z,
                #[inline(always)]
                |t, z| t - z,
            );
            let l1 = density + half_k * C::norm_squared(dual);
            change.add(simd, area * (l1 - l0), at);
            z_energy.add(simd, area * density, at);

            // rest weights need no eigenvalues
            let stiff = match clamp[0] < clamp[1] {
                true => energy.effective_stiffness(sigma).max(least).min(most),
                false => least,
            };
            // (23): stiff/k ≥ γ or k/stiff ≥ γ
            let off = (threshold * stiff.min(k)).lt(stiff.max(k));
            reweight |= stiff.any(off);
            let p = z.zip(
                dual,
                #[inline(always)]
                |z, u| z - u,
            );
            let m = C::residual(f, aux, p);
            let force = spread::<S, V>(simd, block, m, area * k, at);
            store_corners::<S, V, 1>([force], forces, at);

            store(z, &mut block.z, at);
            store(dual, &mut block.u, at);
            store(sigma, &mut block.sigma, at);
            store([density], &mut block.z_density, at);
            store([stiff], &mut block.candidate, at);
        }
        BlockSums {
            lagrangian_change: change.total(),
            z_energy: z_energy.total(),
            reweight,
            prox_iterations,
            ..Default::default()
        }
    }

    #[inline(always)]
    fn forces<V: Simd, const EVALUATE: bool>(self, simd: V) -> BlockSums {
        let Self {
            block,
            forces,
            energy,
            positions,
            ..
        } = self;
        let mut sums = RunningSums::default();
        let mut inverted = RunningSums::default();
        let (zero, one) = (Pack::splat(simd, 0.0), Pack::splat(simd, 1.0));
        let mut extremes = [Pack::splat(simd, f64::INFINITY), zero];
        for at in packs::<V>() {
            let f = deformation_gradient::<S, V>(simd, block, positions, at);
            let [area]: [Pack<V>; 1] = load(simd, &block.measure, at);
            let [k]: [Pack<V>; 1] = load(simd, &block.stiffness, at);
            let z: C::Local<Pack<V>> = load(simd, &block.z, at);
            let u: C::Local<Pack<V>> = load(simd, &block.u, at);
            let (_, aux) = C::local(f);
            let m = C::residual(
                f,
                aux,
                z.zip(
                    u,
                    #[inline(always)]
                    |z, u| z - u,
                ),
            );
            let force = spread::<S, V>(simd, block, m, area * k, at);
            store(f, &mut block.gradient, at);
            if !EVALUATE {
                store_corners::<S, V, 1>([force], forces, at);
                continue;
            }
            let (sigma, frame) = C::svd(f, aux);
            store(sigma, &mut block.stretch, at);
            // ∂ψ/∂F = U ψ'(σ) Vᵀ
            let stress = S::from_svd(energy.gradient(sigma), frame);
            let stress = spread::<S, V>(simd, block, stress, area, at);
            store_corners::<S, V, 2>([force, stress], forces, at);
            // where an element is inverted the sum says nothing: it may be infinite, or, from the
            // padding, not a number
            sums.add(simd, area * guarded_density::<S, E, _>(energy, sigma), at);
            let last = sigma.at(S::STRETCHES - 1);
            extremes = [extremes[0].min(last), extremes[1].max(sigma.at(0))];
            let folded = zero.select(zero.lt(last), zero, one);
            inverted.add(simd, zero.select(zero.lt(area), folded, zero), at);
        }
        BlockSums {
            f_energy: sums.total(),
            inverted: inverted.total() as usize,
            smallest: extremes[0].fold(f64::min),
            largest: extremes[1].fold(f64::max),
            ..Default::default()
        }
    }
}

/// ψ(σ), +∞ where the energy is a barrier and the last σ is not positive.
#[inline(always)]
fn guarded_density<S: Space, E: Energy<S>, L: Lane>(energy: E, sigma: S::Sigma<L>) -> L {
    let density = energy.density(sigma);
    if !E::BARRIER {
        return density;
    }
    let zero = density.lift(0.0);
    let positive = zero.lt(sigma.at(S::STRETCHES - 1));
    density.select(positive, density, density.lift(f64::INFINITY))
}

/// Eight running sums, the e-th element of a block into the (e mod 8)-th: the same at any SIMD width.
#[derive(Default)]
struct RunningSums([f64; 8]);

impl RunningSums {
    #[inline(always)]
    fn add<V: Simd>(&mut self, simd: V, value: Pack<V>, at: usize) {
        let width = Pack::<V>::WIDTH;
        let sums = &mut self.0[at % 8..][..width];
        (Pack::load(simd, sums) + value).store(sums);
    }
    #[inline(always)]
    fn total(&self) -> f64 {
        let [a, b, c, d, e, f, g, h] = self.0;
        ((a + e) + (c + g)) + ((b + f) + (d + h))
    }
}
