//! The per-element state, in blocks of fixed size: the unit of parallel work, of vectorisation and of
//! ordered summation.

use crate::space::{Components, Pack};
use pulp::Simd;

/// Elements a block has. A multiple of every SIMD width; the last block is padded with copies of its
/// last element that count for nothing.
pub const BLOCK: usize = 512;

/// One scalar an element.
pub type Row = Vec<f64>;

/// State of up to [`BLOCK`] elements, component by component (component c of element e is at
/// c·BLOCK + e).
#[derive(Debug, Clone)]
pub struct Block {
    /// Real elements (the rest is padding).
    pub len: usize,
    /// Vertex slots of each element: row v·BLOCK + e is vertex v of element e.
    pub vertices: Vec<u32>,
    /// Dm⁻¹, k×k by columns.
    pub inverse: Row,
    /// Rest measure A.
    pub measure: Row,
    /// Current weight over A: k = w²/A of the prox.
    pub stiffness: Row,
    /// Candidate for `stiffness` (22).
    pub candidate: Row,
    /// F at the current positions.
    pub gradient: Row,
    /// Z.
    pub z: Row,
    /// U, scaled dual.
    pub u: Row,
    /// Singular values of Z: the warm start of the next prox.
    pub sigma: Row,
    /// ψ(Z).
    pub z_density: Row,
    /// ψ(F), infinite where inverted.
    pub f_density: Row,
    /// Largest and smallest singular value of F (rows 0, 1).
    pub stretch: Row,
    /// What the last pass added up.
    pub sums: BlockSums,
}

impl Block {
    /// Takes over the candidate weights: U is scaled by w²/w_cand² (paper §5.1).
    pub fn take_candidates(&mut self) {
        for u in self.u.chunks_exact_mut(BLOCK) {
            for ((u, old), new) in u.iter_mut().zip(&self.stiffness).zip(&self.candidate) {
                *u *= old / new;
            }
        }
        self.stiffness.copy_from_slice(&self.candidate);
    }
}

/// Sums and extremes over a block's real elements.
#[derive(Debug, Clone, Copy, Default)]
pub struct BlockSums {
    /// L₁ − L₀ of the local step.
    pub lagrangian_change: f64,
    /// Σ A ψ(Z).
    pub z_energy: f64,
    /// Σ A ψ(F).
    pub f_energy: f64,
    /// Elements with det F ≤ 0.
    pub inverted: usize,
    /// Smallest signed singular value of F.
    pub smallest: f64,
    /// Largest singular value of F.
    pub largest: f64,
    /// max over elements of (23)'s ratio.
    pub ratio: f64,
    /// Most prox iterations.
    pub prox_iterations: u32,
}

/// Component-wise load of the elements from `at` on.
#[inline(always)]
pub fn load<S: Simd, A: Components<Pack<S>>>(simd: S, rows: &[f64], at: usize) -> A {
    A::from_fn(
        #[inline(always)]
        |c| Pack::load(simd, &rows[c * BLOCK + at..][..Pack::<S>::WIDTH]),
    )
}

/// Component-wise store.
#[inline(always)]
pub fn store<S: Simd, A: Components<Pack<S>>>(value: A, rows: &mut [f64], at: usize) {
    for c in 0..A::LEN {
        value
            .at(c)
            .store(&mut rows[c * BLOCK + at..][..Pack::<S>::WIDTH]);
    }
}
