//! What the element loops need of an energy, on rows of singular values: one call for a few packs, so
//! that the loops are compiled once for all energies.

use crate::energy::Energy;
use crate::energy::total::field_value;
use crate::optim::Field;
use crate::space::{Components, Lane, Pack, Scalar, Space, dispatch};
use core::marker::PhantomData;
use pulp::{Simd, WithSimd};

/// Packs a call is about. What is found before a call waits for its end: in WebAssembly a pack waits in
/// registers, and several would be copied by calls to the engine.
pub const PACKS: usize = if cfg!(target_arch = "wasm32") { 1 } else { 4 };

/// Most elements a call is about: [`PACKS`] of the widest.
pub const MOST: usize = 8 * PACKS;

/// One number an element of a call.
pub type Few = [f64; MOST];

/// An energy, element by element. `count` elements at the front of each row count; it is [`PACKS`] times
/// this machine's SIMD width.
pub trait Densities: Send + Sync {
    /// The prox (6) at the singular values `p` with weights `k`: `sigma` is where it begins (> 0, but for
    /// the last of an energy without barrier), and the result; `density` is ψ there, `stiffness`, if wanted, K_e (20). Returns the most inner iterations.
    fn prox(
        &self,
        count: usize,
        p: &[Few; 3],
        k: &Few,
        sigma: &mut [Few; 3],
        density: &mut Few,
        stiffness: Option<&mut Few>,
    ) -> u32;
    /// ψ(σ), +∞ where the energy is a barrier and the last σ is not positive; and, if wanted, ψ'(σ).
    fn evaluate(
        &self,
        count: usize,
        sigma: &[Few; 3],
        density: &mut Few,
        gradient: Option<&mut [Few; 3]>,
    );
    /// The value of a field at singular values.
    fn field(&self, sigma: [f64; 3], field: Field) -> f32;
}

/// An energy in a space.
pub struct Of<S, E> {
    energy: E,
    space: PhantomData<S>,
}

impl<S, E> Of<S, E> {
    /// Of this energy.
    pub fn new(energy: E) -> Self {
        Self {
            energy,
            space: PhantomData,
        }
    }
}

struct Prox<'a, S, E> {
    energy: E,
    count: usize,
    p: &'a [Few; 3],
    k: &'a Few,
    sigma: &'a mut [Few; 3],
    density: &'a mut Few,
    stiffness: Option<&'a mut Few>,
    space: PhantomData<S>,
}

/// Component-wise load of the elements from `at` on.
#[inline(always)]
pub fn load_few<V: Simd, A: Components<Pack<V>>>(simd: V, rows: &[Few; 3], at: usize) -> A {
    A::from_fn(
        #[inline(always)]
        |c| Pack::load(simd, &rows[c][at..at + Pack::<V>::WIDTH]),
    )
}

/// Component-wise store.
#[inline(always)]
pub fn store_few<V: Simd, A: Components<Pack<V>>>(value: A, rows: &mut [Few; 3], at: usize) {
    for c in 0..A::LEN {
        value.at(c).store(&mut rows[c][at..at + Pack::<V>::WIDTH]);
    }
}

impl<S: Space, E: Energy<S>> WithSimd for Prox<'_, S, E> {
    type Output = u32;

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) -> u32 {
        let width = Pack::<V>::WIDTH;
        let mut stiffness = self.stiffness;
        let mut most = 0;
        let mut at = 0;
        while at < self.count {
            let p: S::Sigma<Pack<V>> = load_few(simd, self.p, at);
            let warm: S::Sigma<Pack<V>> = load_few(simd, self.sigma, at);
            let k = Pack::load(simd, &self.k[at..at + width]);
            let (sigma, count) = self.energy.prox(p, k, warm);
            most = most.max(count);
            self.energy
                .density(sigma)
                .store(&mut self.density[at..at + width]);
            if let Some(stiffness) = &mut stiffness {
                let k: Pack<V> = self.energy.effective_stiffness(sigma);
                k.store(&mut stiffness[at..at + width]);
            }
            store_few(sigma, self.sigma, at);
            at += width;
        }
        most
    }
}

struct Evaluate<'a, S, E> {
    energy: E,
    count: usize,
    sigma: &'a [Few; 3],
    density: &'a mut Few,
    gradient: Option<&'a mut [Few; 3]>,
    space: PhantomData<S>,
}

impl<S: Space, E: Energy<S>> WithSimd for Evaluate<'_, S, E> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        let width = Pack::<V>::WIDTH;
        let mut gradient = self.gradient;
        let mut at = 0;
        while at < self.count {
            let sigma: S::Sigma<Pack<V>> = load_few(simd, self.sigma, at);
            let mut density: Pack<V> = self.energy.density(sigma);
            if E::BARRIER {
                let positive = density.lift(0.0).lt(sigma.at(S::STRETCHES - 1));
                density = density.select(positive, density, density.lift(f64::INFINITY));
            }
            density.store(&mut self.density[at..at + width]);
            if let Some(gradient) = &mut gradient {
                store_few(self.energy.gradient(sigma), gradient, at);
            }
            at += width;
        }
    }
}

impl<S: Space, E: Energy<S>> Densities for Of<S, E> {
    fn prox(
        &self,
        count: usize,
        p: &[Few; 3],
        k: &Few,
        sigma: &mut [Few; 3],
        density: &mut Few,
        stiffness: Option<&mut Few>,
    ) -> u32 {
        dispatch(Prox::<S, E> {
            energy: self.energy,
            count,
            p,
            k,
            sigma,
            density,
            stiffness,
            space: PhantomData,
        })
    }
    fn evaluate(
        &self,
        count: usize,
        sigma: &[Few; 3],
        density: &mut Few,
        gradient: Option<&mut [Few; 3]>,
    ) {
        dispatch(Evaluate::<S, E> {
            energy: self.energy,
            count,
            sigma,
            density,
            gradient,
            space: PhantomData,
        });
    }
    fn field(&self, sigma: [f64; 3], field: Field) -> f32 {
        let sigma = S::Sigma::from_fn(|i| sigma[i]);
        field_value::<S, E>(self.energy, sigma, field)
    }
}
