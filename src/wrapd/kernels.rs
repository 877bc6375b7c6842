//! The element loops: local step, forces of the global step, evaluation.
//!
//! Forces are kept a corner (vertex v of element e) and gathered by the vertices in a fixed order
//! afterwards, so that no result depends on the number of threads.

use super::Coupling;
use super::block::{BLOCK, Block, BlockSums, load, packs, store};
use super::densities::{Densities, MOST, PACKS, load_few, store_few};
use crate::space::{Components, Lane, Pack, Space};
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
pub struct Kernel<'a, S, C> {
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
    pub energy: &'a dyn Densities,
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
pub(crate) fn deformation_gradient<S: Space, V: Simd>(
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

/// A vector a corner.
pub(crate) type Corners<V> = [[Pack<V>; 3]; 4];

/// The forces of scale · M on the corners: f_v = M g_v, f_0 = −Σ f_v.
#[inline(always)]
pub(crate) fn spread<S: Space, V: Simd>(
    simd: V,
    block: &Block,
    m: S::Gradient<Pack<V>>,
    scale: Pack<V>,
    at: usize,
) -> Corners<V> {
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
pub(crate) fn store_corners<S: Space, V: Simd, const K: usize>(
    vectors: [Corners<V>; K],
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

impl<S: Space, C: Coupling<S>> WithSimd for Kernel<'_, S, C> {
    type Output = BlockSums;

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) -> BlockSums {
        match self.pass {
            Pass::Local {
                clamp,
                threshold,
                reset,
            } => self.local(simd, clamp, threshold, reset),
            Pass::Forces => self.forces(simd),
            Pass::Last => self.last(simd),
        }
    }
}

/// Where the packs of a call to the energy begin, and how many elements it is about.
#[inline(always)]
fn calls<V: Simd>() -> (impl Iterator<Item = usize>, usize) {
    let count = PACKS * Pack::<V>::WIDTH;
    let begins = (0..BLOCK / count).map(
        #[inline(always)]
        move |call| call * count,
    );
    (begins, count)
}

/// F and the forces of the coupling, from positions.
struct Moved<S: Space, C: Coupling<S>, V: Simd> {
    f: S::Gradient<Pack<V>>,
    aux: C::Aux<Pack<V>>,
    force: Corners<V>,
}

impl<S: Space, C: Coupling<S>> Kernel<'_, S, C> {
    #[inline(always)]
    fn local<V: Simd>(self, simd: V, clamp: [f64; 2], threshold: f64, reset: bool) -> BlockSums {
        let Self {
            block,
            forces,
            energy,
            ..
        } = self;
        let width = Pack::<V>::WIDTH;
        let (mut change, mut z_energy) = (RunningSums::default(), RunningSums::default());
        let mut prox_iterations = 0;
        let mut reweight = false;
        let zero = Pack::splat(simd, 0.0);
        let half = Pack::splat(simd, 0.5);
        let threshold = Pack::splat(simd, threshold);
        let least = Pack::splat(simd, clamp[0]);
        let most = Pack::splat(simd, clamp[1]);
        // rest weights need no eigenvalues
        let weighs = clamp[0] < clamp[1];
        let (mut values, mut sigmas) = ([[0.0; MOST]; 3], [[0.0; MOST]; 3]);
        let (mut weights, mut densities, mut stiffness) = ([0.0; MOST], [0.0; MOST], [0.0; MOST]);
        let (calls, count) = calls::<V>();
        for begin in calls {
            // what the energy does not change: the target sym(F) + U, its frame, and ‖target − Z‖²
            let prepared = <[_; PACKS] as Components<_>>::from_fn(
                #[inline(always)]
                |pack| {
                    let at = begin + pack * width;
                    let f: S::Gradient<Pack<V>> = load(simd, &block.gradient, at);
                    let (s, aux) = C::local_again(
                        f,
                        load(simd, &block.guess, at),
                        load(simd, &block.kept, at),
                    );
                    let (target, misfit) = if reset {
                        (s, zero)
                    } else {
                        let z: C::Local<Pack<V>> = load(simd, &block.z, at);
                        let u: C::Local<Pack<V>> = load(simd, &block.u, at);
                        let target = s.zip(
                            u,
                            #[inline(always)]
                            |s, u| s + u,
                        );
                        let away = target.zip(
                            z,
                            #[inline(always)]
                            |t, z| t - z,
                        );
                        (target, C::norm_squared(away))
                    };
                    let (p, frame) = C::spectrum(target, aux);
                    store_few(p, &mut values, pack * width);
                    (target, frame, aux, misfit)
                },
            );
            let few = begin..begin + count;
            for (row, sigma) in sigmas.iter_mut().zip(&block.sigma) {
                row[..count].copy_from_slice(&sigma[few.clone()]);
            }
            weights[..count].copy_from_slice(&block.stiffness[0][few.clone()]);
            if reset {
                // Z is sym(F), whose values are those of the target
                energy.evaluate(count, &values, &mut densities, None);
                block.z_density[0][few].copy_from_slice(&densities[..count]);
            }
            let iterations = energy.prox(
                count,
                &values,
                &weights,
                &mut sigmas,
                &mut densities,
                weighs.then_some(&mut stiffness),
            );
            prox_iterations = prox_iterations.max(iterations);
            for pack in 0..PACKS {
                let (target, frame, aux, misfit) = prepared[pack];
                let at = begin + pack * width;
                let few = pack * width..(pack + 1) * width;
                let f: S::Gradient<Pack<V>> = load(simd, &block.gradient, at);
                let [area]: [Pack<V>; 1] = load(simd, &block.measure, at);
                let [k]: [Pack<V>; 1] = load(simd, &block.stiffness, at);
                let [density_old]: [Pack<V>; 1] = load(simd, &block.z_density, at);
                let sigma: S::Sigma<Pack<V>> = load_few(simd, &sigmas, pack * width);
                let density = Pack::load(simd, &densities[few.clone()]);
                let half_k = half * k;
                let l0 = density_old + half_k * misfit;
                let z: C::Local<Pack<V>> = C::compose(sigma, frame);
                let dual = target.zip(
                    z,
                    #[inline(always)]
                    |t, z| t - z,
                );
                let l1 = density + half_k * C::norm_squared(dual);
                change.add(simd, area * (l1 - l0), at);
                z_energy.add(simd, area * density, at);

                let stiff = match weighs {
                    true => Pack::load(simd, &stiffness[few]).max(least).min(most),
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
        }
        BlockSums {
            lagrangian_change: change.total(),
            z_energy: z_energy.total(),
            reweight,
            prox_iterations,
            ..Default::default()
        }
    }

    /// F at the positions, which is stored, and the forces of the coupling there.
    #[inline(always)]
    fn moved<V: Simd>(simd: V, block: &mut Block, positions: &[f64], at: usize) -> Moved<S, C, V> {
        let f = deformation_gradient::<S, V>(simd, block, positions, at);
        let [area]: [Pack<V>; 1] = load(simd, &block.measure, at);
        let [k]: [Pack<V>; 1] = load(simd, &block.stiffness, at);
        let z: C::Local<Pack<V>> = load(simd, &block.z, at);
        let u: C::Local<Pack<V>> = load(simd, &block.u, at);
        let (_, aux) = C::local(f, load(simd, &block.guess, at));
        store(C::guess(aux), &mut block.guess, at);
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
        Moved { f, aux, force }
    }

    #[inline(always)]
    fn forces<V: Simd>(self, simd: V) -> BlockSums {
        for at in packs::<V>() {
            let moved = Self::moved::<V>(simd, self.block, self.positions, at);
            store_corners::<S, V, 1>([moved.force], self.forces, at);
        }
        BlockSums::default()
    }

    #[inline(always)]
    fn last<V: Simd>(self, simd: V) -> BlockSums {
        let Self {
            block,
            forces,
            energy,
            positions,
            ..
        } = self;
        let width = Pack::<V>::WIDTH;
        let mut sums = RunningSums::default();
        let mut inverted = RunningSums::default();
        let (zero, one) = (Pack::splat(simd, 0.0), Pack::splat(simd, 1.0));
        let mut extremes = [Pack::splat(simd, f64::INFINITY), zero];
        let (mut sigmas, mut gradients) = ([[0.0; MOST]; 3], [[0.0; MOST]; 3]);
        let mut densities = [0.0; MOST];
        let (calls, count) = calls::<V>();
        for begin in calls {
            let moved = <[_; PACKS] as Components<_>>::from_fn(
                #[inline(always)]
                |pack| {
                    let at = begin + pack * width;
                    let Moved { f, aux, force } = Self::moved(simd, block, positions, at);
                    store(C::keep(aux), &mut block.kept, at);
                    let (sigma, frame) = C::svd(f, aux);
                    store_few(sigma, &mut sigmas, pack * width);
                    (frame, force)
                },
            );
            energy.evaluate(count, &sigmas, &mut densities, Some(&mut gradients));
            for pack in 0..PACKS {
                let (frame, force) = moved[pack];
                let at = begin + pack * width;
                let sigma: S::Sigma<Pack<V>> = load_few(simd, &sigmas, pack * width);
                store(sigma, &mut block.stretch, at);
                let [area]: [Pack<V>; 1] = load(simd, &block.measure, at);
                // ∂ψ/∂F = U ψ'(σ) Vᵀ
                let stress = S::from_svd(load_few(simd, &gradients, pack * width), frame);
                let stress = spread::<S, V>(simd, block, stress, area, at);
                store_corners::<S, V, 2>([force, stress], forces, at);
                // where an element is inverted the sum says nothing: it may be infinite, or, from the
                // padding, not a number
                let density = Pack::load(simd, &densities[pack * width..(pack + 1) * width]);
                sums.add(simd, area * density, at);
                let last = sigma.at(S::STRETCHES - 1);
                extremes = [extremes[0].min(last), extremes[1].max(sigma.at(0))];
                let folded = zero.select(zero.lt(last), zero, one);
                inverted.add(simd, zero.select(zero.lt(area), folded, zero), at);
            }
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
