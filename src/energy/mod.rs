//! Deformation energies as functions of the singular values: one file an energy.

mod arap;
mod symmetric_dirichlet;
pub mod total;

pub use arap::Arap;
pub use symmetric_dirichlet::SymmetricDirichlet;

use crate::space::{Lane, Scalar, Space};

/// A rotation-invariant energy density ψ(σ) per unit of rest measure.
pub trait Energy<S: Space>: Copy + Send + Sync + 'static {
    /// ψ(σ). Arithmetic only, so that dual numbers pass through; meaningless for σ outside the
    /// energy's domain.
    fn density<T: Scalar>(&self, sigma: S::Sigma<T>) -> T;
    /// ∂ψ/∂σᵢ.
    fn gradient<T: Scalar>(&self, sigma: S::Sigma<T>) -> S::Sigma<T>;
    /// K_e(σ), the largest eigenvalue of ∂²ψ/∂σ² (20).
    fn effective_stiffness<L: Lane>(&self, sigma: S::Sigma<L>) -> L;
    /// argmin_z ψ(z) + k/2 ‖z − p‖² (6), to rounding, and how many inner iterations it took.
    /// `warm` is where to begin (entries > 0).
    fn prox<L: Lane>(&self, p: S::Sigma<L>, k: L, warm: S::Sigma<L>) -> (S::Sigma<L>, u32);
    /// Does the energy need all σ > 0 (a barrier against inversion)?
    const BARRIER: bool;
    /// ψ of an isometry.
    const ISOMETRY: f64;
    /// The stiffness at rest, K_e(1) (21).
    const REST_STIFFNESS: f64;
    /// Reported energy = SCALE · Σ A (ψ − ISOMETRY) + OFFSET, for a rest shape of unit measure.
    const SCALE: f64;
    /// See `SCALE`: what an isometry is reported to have.
    const OFFSET: f64;
}
