//! The per-element state, in blocks of fixed size: the unit of parallel work, of vectorisation and of
//! ordered summation.

use crate::space::{Components, Pack};
use pulp::Simd;

/// Elements a block has. A multiple of every SIMD width; the last block is padded with copies of its
/// last element that count for nothing.
pub const BLOCK: usize = 512;

/// Where the packs of a block begin: all of it, the padding too, so that the bound is a constant.
#[inline(always)]
pub fn packs<S: Simd>() -> impl Iterator<Item = usize> {
    (0..BLOCK / Pack::<S>::WIDTH).map(
        #[inline(always)]
        |pack| pack * Pack::<S>::WIDTH,
    )
}

/// One scalar an element. Its length is a constant so that loops over a block need no bounds checks.
pub type Row = [f64; BLOCK];

/// Several scalars an element, component by component.
pub type Rows = Vec<Row>;

/// State of [`BLOCK`] elements, of which the last block's may be padding: component c of element e is at `[c][e]`.
#[derive(Debug, Clone)]
pub struct Block {
    /// Vertex slots of each element: vertex v of element e is at `[v][e]`.
    pub vertices: Vec<[u32; BLOCK]>,
    /// Dm⁻¹, k×k by columns.
    pub inverse: Rows,
    /// Rest measure A; 0 in the padding.
    pub measure: Rows,
    /// Current weight over A: k = w²/A of the prox.
    pub stiffness: Rows,
    /// Candidate for `stiffness` (22).
    pub candidate: Rows,
    /// F at the current positions.
    pub gradient: Rows,
    /// Where the decomposition of the next F begins.
    pub guess: Rows,
    /// What else is known of that of the present F, after a pass that evaluates.
    pub kept: Rows,
    /// Z.
    pub z: Rows,
    /// U, scaled dual.
    pub u: Rows,
    /// Singular values of Z: the warm start of the next prox.
    pub sigma: Rows,
    /// ψ(Z).
    pub z_density: Rows,
    /// Singular values of F after a pass that evaluates.
    pub stretch: Rows,
    /// What the last pass added up.
    pub sums: BlockSums,
}

impl Block {
    /// Takes over the candidate weights: U is scaled by w²/w_cand² (paper §5.1).
    pub fn take_candidates(&mut self) {
        let (old, new) = (&self.stiffness[0], &self.candidate[0]);
        for u in &mut self.u {
            for ((u, old), new) in u.iter_mut().zip(old).zip(new) {
                *u *= old / new;
            }
        }
        self.stiffness[0] = self.candidate[0];
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
    /// Does any weight differ from its candidate by more than the threshold (23)?
    pub reweight: bool,
    /// Most prox iterations.
    pub prox_iterations: u32,
}

/// Component-wise load of the elements from `at` on.
#[inline(always)]
pub fn load<S: Simd, A: Components<Pack<S>>>(simd: S, rows: &[Row], at: usize) -> A {
    A::from_fn(
        #[inline(always)]
        |c| Pack::load(simd, &rows[c][at..at + Pack::<S>::WIDTH]),
    )
}

/// Component-wise store.
#[inline(always)]
pub fn store<S: Simd, A: Components<Pack<S>>>(value: A, rows: &mut [Row], at: usize) {
    for c in 0..A::LEN {
        value.at(c).store(&mut rows[c][at..at + Pack::<S>::WIDTH]);
    }
}
