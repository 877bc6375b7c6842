//! Deformation energies as functions of the singular values: one file an energy.

mod arap;
mod dirichlet;
pub mod hessian;
mod limited_arap;
mod moduli;
mod neo_hookean;
mod newton;
mod st_venant_kirchhoff;
mod stable_neo_hookean;
mod symmetric_dirichlet;
pub mod total;

pub use arap::Arap;
pub use dirichlet::Dirichlet;
pub use limited_arap::LimitedArap;
pub use neo_hookean::NeoHookean;
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use stable_neo_hookean::StableNeoHookean;
pub use symmetric_dirichlet::SymmetricDirichlet;

use crate::space::{Lane, Space};

/// A rotation-invariant energy density ψ(σ) per unit of rest measure.
pub trait Energy<S: Space>: Copy + Send + Sync + 'static {
    /// ψ(σ); meaningless for σ outside the energy's domain.
    fn density<L: Lane>(&self, sigma: S::Sigma<L>) -> L;
    /// ∂ψ/∂σᵢ.
    fn gradient<L: Lane>(&self, sigma: S::Sigma<L>) -> S::Sigma<L>;
    /// ∂²ψ/∂σᵢ∂σⱼ; entries beyond k are 0.
    fn hessian(&self, sigma: S::Sigma<f64>) -> [[f64; 3]; 3];
    /// K_e(σ), the largest eigenvalue of ∂²ψ/∂σ² (20).
    fn effective_stiffness<L: Lane>(&self, sigma: S::Sigma<L>) -> L;
    /// argmin_z ψ(z) + k/2 ‖z − p‖² (6), to rounding, and how many inner iterations it took. Where
    /// that has several minima it may be one that is not the lowest. `warm` is where to begin (entries
    /// > 0, but for the last of an energy without barrier).
    fn prox<L: Lane>(&self, p: S::Sigma<L>, k: L, warm: S::Sigma<L>) -> (S::Sigma<L>, u32);
    /// Does the energy need all σ > 0 (a barrier against inversion)?
    const BARRIER: bool;
    /// Least and most singular value: outside, the energy is infinite, though `density` is not. An
    /// iterate that breaks these limits has not converged.
    fn limits(&self) -> [f64; 2] {
        [f64::NEG_INFINITY, f64::INFINITY]
    }
    /// What belongs to the energy as a whole.
    fn constants(&self) -> Constants;
}

/// Numbers of an energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constants {
    /// The weight of an element at rest (21): K_e(1), or, where a change of volume is much stiffer
    /// than all else, what one axis feels.
    pub rest_stiffness: f64,
    /// ψ of an isometry; 0 where ψ is reported as it is.
    pub isometry: f64,
    /// Reported energy = scale · Σ A (ψ − isometry) + offset.
    pub scale: f64,
    /// See `scale`: what an isometry is reported to have.
    pub offset: f64,
    /// Changes of the energy are measured against |E| + floor.
    pub floor: f64,
}

impl Constants {
    /// The reported energy, from Σ A ψ and Σ A.
    pub fn reported(&self, sum: f64, measure: f64) -> f64 {
        self.scale * (sum - self.isometry * measure) + self.offset
    }
}
