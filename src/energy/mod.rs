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

use crate::optim::Yardstick;
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
}

/// The energy that a body's changes are measured against, where an isometry has none, over rest stiffness
/// times measure: that of a strain of 1.1e-4 all over, ½·1.14e-4². Of the quasi-static problems of the
/// paper one has a minimum of 0 (untwist: 4 m³ of Young's modulus 1e7, Poisson's ratio 0.45); for it this
/// is 1 J, the 1 in the authors' criterion |ΔE|/(|E| + 1) < 1e-11.
const FLOOR: f64 = 6.5e-9;

impl Constants {
    /// The reported energy, from Σ A ψ and Σ A.
    pub fn reported(&self, sum: f64, measure: f64) -> f64 {
        self.relative(sum, measure) + self.offset
    }

    /// The same without the offset, which of a small body would leave few digits.
    pub fn relative(&self, sum: f64, measure: f64) -> f64 {
        self.scale * (sum - self.isometry * measure)
    }

    /// What changes of the [`relative`](Self::relative) energy, and the gradient, are measured against for
    /// a body of this Σ A in `stretches` dimensions. With the unit u of energy a measure – `offset`, where
    /// an isometry has that, else the stiffness at rest – they are u Σ A, of the latter a [small
    /// part](FLOOR), and u Σ A over the body's size (Σ A)^(1/k).
    ///
    /// A gradient g of the elements' Laplacian times stiffness k, with n vertices, is of an energy
    /// E − E* ≤ |g|²/2kλ, λ ≈ π² size^(d−2)/n its least eigenvalue. At 1e-11 of this force that is, for
    /// n = 1e4, about 1e-11 of this floor: neither criterion makes the other idle.
    pub fn yardstick(&self, measure: f64, stretches: usize) -> Yardstick {
        let size = match stretches {
            2 => measure.sqrt(),
            _ => measure.cbrt(),
        };
        let (unit, part) = match self.offset > 0.0 {
            true => (self.offset, 1.0),
            false => (self.scale * self.rest_stiffness, FLOOR),
        };
        Yardstick {
            floor: part * unit * measure,
            force: unit * (measure / size),
            rounding: 0.0,
        }
    }
}
