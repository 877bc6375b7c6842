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

/// One pass over one block.
pub struct Kernel<'a, S, C, E> {
    /// What to do.
    pub pass: Pass,
    /// The elements.
    pub block: &'a mut Block,
    /// Positions, interleaved, by vertex slot.
    pub positions: &'a [f64],
    /// Corner forces out, (v·BLOCK + e)·DIM + i: first those of the coupling, then (pass `Last`) those
    /// of the energy.
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

/// Spreads scale · M onto the corners: f_v = M g_v, f_0 = −Σ f_v. Corner v of element e has its DIM
/// components side by side at (v·BLOCK + e)·DIM.
#[inline(always)]
fn spread<S: Space, V: Simd>(
    simd: V,
    block: &Block,
    m: S::Gradient<Pack<V>>,
    scale: Pack<V>,
    forces: &mut [f64],
    at: usize,
) {
    let zero = Pack::splat(simd, 0.0);
    let mut rest = [zero; 3];
    for v in 0..S::STRETCHES {
        let mut force = [zero; 3];
        for i in 0..S::DIM {
            let mut sum = zero;
            for column in 0..S::STRETCHES {
                let g = Pack::load(
                    simd,
                    &block.inverse[column * S::STRETCHES + v][at..at + Pack::<V>::WIDTH],
                );
                sum = sum + m.at(column * S::DIM + i) * g;
            }
            force[i] = scale * sum;
            rest[i] = rest[i] - force[i];
        }
        store_corner::<S, V>(force, forces, at, v + 1);
    }
    store_corner::<S, V>(rest, forces, at, 0);
}

#[inline(always)]
fn store_corner<S: Space, V: Simd>(force: [Pack<V>; 3], forces: &mut [f64], at: usize, v: usize) {
    let width = Pack::<V>::WIDTH;
    let mut lanes = [[0.0; 8]; 3];
    for i in 0..S::DIM {
        force[i].store(&mut lanes[i][..width]);
    }
    let target = &mut forces[(v * BLOCK + at) * S::DIM..][..width * S::DIM];
    for (lane, out) in target.chunks_exact_mut(S::DIM).enumerate() {
        for i in 0..S::DIM {
            out[i] = lanes[i][lane];
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
        let mut change = [0.0; BLOCK];
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
            (area * (l1 - l0)).store(&mut change[at..][..Pack::<V>::WIDTH]);

            let stiff = energy.effective_stiffness(sigma).max(least).min(most);
            // (23): stiff/k ≥ γ or k/stiff ≥ γ
            let off = (threshold * stiff.min(k)).lt(stiff.max(k));
            reweight |= stiff.any(off);
            let p = z.zip(
                dual,
                #[inline(always)]
                |z, u| z - u,
            );
            let m = C::residual(f, aux, p);
            spread::<S, V>(simd, block, m, area * k, forces, at);

            store(z, &mut block.z, at);
            store(dual, &mut block.u, at);
            store(sigma, &mut block.sigma, at);
            store([density], &mut block.z_density, at);
            store([stiff], &mut block.candidate, at);
        }
        let n = block.len;
        BlockSums {
            lagrangian_change: ordered_sum(change[..n].iter().copied()),
            z_energy: ordered_sum((0..n).map(|e| block.measure[0][e] * block.z_density[0][e])),
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
        let (forces, energy_forces) = forces.split_at_mut(forces.len() / 2);
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
            spread::<S, V>(simd, block, m, area * k, forces, at);
            store(f, &mut block.gradient, at);
            if EVALUATE {
                let (sigma, frame) = S::svd(f);
                // ∂ψ/∂F = U ψ'(σ) Vᵀ
                let stress = S::from_svd(energy.gradient(sigma), frame);
                spread::<S, V>(simd, block, stress, area, energy_forces, at);
                evaluate_at::<S, E, V>(block, energy, sigma, at);
            }
        }
        if EVALUATE {
            evaluation_sums(block)
        } else {
            BlockSums::default()
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

#[inline(always)]
fn evaluate_at<S: Space, E: Energy<S>, V: Simd>(
    block: &mut Block,
    energy: E,
    sigma: S::Sigma<Pack<V>>,
    at: usize,
) {
    let density = guarded_density::<S, E, _>(energy, sigma);
    store([density], &mut block.f_density, at);
    store(
        [sigma.at(0), sigma.at(S::STRETCHES - 1)],
        &mut block.stretch,
        at,
    );
}

fn evaluation_sums(block: &Block) -> BlockSums {
    let n = block.len;
    let mut sums = BlockSums {
        f_energy: ordered_sum((0..n).map(|e| block.measure[0][e] * block.f_density[0][e])),
        smallest: f64::INFINITY,
        ..Default::default()
    };
    for e in 0..n {
        let (largest, smallest) = (block.stretch[0][e], block.stretch[1][e]);
        sums.largest = sums.largest.max(largest);
        sums.smallest = sums.smallest.min(smallest);
        sums.inverted += usize::from(!(smallest > 0.0));
    }
    sums
}

/// Sum in a fixed order, with eight running sums.
fn ordered_sum(values: impl Iterator<Item = f64>) -> f64 {
    let mut sums = [0.0; 8];
    for (i, v) in values.enumerate() {
        sums[i % 8] += v;
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
