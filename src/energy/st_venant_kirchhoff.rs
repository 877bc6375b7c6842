//! St. Venant–Kirchhoff: ψ(σ) = μ Σ Eᵢ² + λ/2 (Σ Eᵢ)², Eᵢ = (σᵢ² − 1)/2, the principal Green strains.
//!
//! With T = λ Σ Eᵢ the gradient is σᵢ (2μ Eᵢ + T), and the Hessian diag(2μ Eᵢ + T + 2μ σᵢ²) + λ σσᵀ.
//!
//! ψ is even in every σ: an element is as content as its mirror image, and resists no further
//! compression below σ = 1/√3 along one axis. It is the model of large turns and small strains, and does not
//! unfold what begins folded.
//!
//! The prox. Its minimum has the signs of p, for a change of one sign to that of p leaves ψ and shortens
//! the distance. For σ > 0 the problem in wᵢ = σᵢ² is
//!
//! μ/4 Σ (wᵢ − 1)² + λ/8 (Σ wᵢ − 3)² + k/2 Σ (wᵢ − 2 |pᵢ| √wᵢ + pᵢ²),
//!
//! a sum of convex terms (the first two together, where λ < 0, as 2μ + 3λ > 0). So there is one
//! stationary point with all σ > 0, though the problem in σ is not convex, and any descent that keeps
//! the signs ends at the global minimum.

use super::moduli::{lame, uniaxial_stiffness};
use super::newton::{self, Expansion, Signs};
use super::{Constants, Energy};
use crate::optim::BuildError;
use crate::space::{Lane, Solid, Space};

/// St. Venant–Kirchhoff elasticity of a solid; an undeformed solid has 0. Energies are in units of the
/// modulus times volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StVenantKirchhoff {
    /// μ, the second Lamé parameter.
    pub mu: f64,
    /// λ, the first.
    pub lambda: f64,
}

impl StVenantKirchhoff {
    /// From Young's modulus (> 0, any unit of pressure) and Poisson's ratio (in (−1, 0.5)).
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn new(young: f64, poisson: f64) -> Result<Self, BuildError> {
        let [mu, lambda] = lame(young, poisson)?;
        Ok(Self { mu, lambda })
    }

    /// ψ, its gradient and its Hessian.
    #[inline(always)]
    fn expansion<L: Lane>(&self, s: [L; 3]) -> Expansion<L> {
        let one = s[0].lift(1.0);
        let half = one.lift(0.5);
        let (mu, lambda) = (one.lift(self.mu), one.lift(self.lambda));
        let twice_mu = mu + mu;
        let mut strain = s;
        for i in 0..3 {
            // not σ² − 1, which would cancel near rest
            strain[i] = half * (s[i] - one) * (s[i] + one);
        }
        let trace = strain[0] + strain[1] + strain[2];
        let squares = strain[0] * strain[0] + strain[1] * strain[1] + strain[2] * strain[2];
        let tension = lambda * trace;
        let mut gradient = s;
        let mut diagonal = s;
        for i in 0..3 {
            let stress = twice_mu * strain[i] + tension;
            gradient[i] = s[i] * stress;
            diagonal[i] = stress + (twice_mu + lambda) * s[i] * s[i];
        }
        let hessian = [
            diagonal[0],
            diagonal[1],
            diagonal[2],
            lambda * s[0] * s[1],
            lambda * s[0] * s[2],
            lambda * s[1] * s[2],
        ];
        (mu * squares + half * tension * trace, gradient, hessian)
    }
}

impl Energy<Solid> for StVenantKirchhoff {
    const BARRIER: bool = false;

    fn constants(&self) -> Constants {
        let stress = |s: f64| Energy::<Solid>::gradient(self, [s, 1.0, 1.0])[0];
        Constants {
            rest_stiffness: uniaxial_stiffness(stress),
            isometry: 0.0,
            scale: 1.0,
            offset: 0.0,
        }
    }

    #[inline(always)]
    fn density<L: Lane>(&self, s: [L; 3]) -> L {
        self.expansion(s).0
    }

    #[inline(always)]
    fn gradient<L: Lane>(&self, s: [L; 3]) -> [L; 3] {
        self.expansion(s).1
    }

    fn hessian(&self, s: [f64; 3]) -> [[f64; 3]; 3] {
        newton::square(self.expansion(s).2)
    }

    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, s: [L; 3]) -> L {
        Solid::eigen(self.expansion(s).2).0[0]
    }

    #[inline(always)]
    fn prox<L: Lane>(&self, p: [L; 3], k: L, warm: [L; 3]) -> ([L; 3], u32) {
        let zero = k.lift(0.0);
        let tiny = k.lift(1e-6);
        let (mut target, mut begin) = (p, warm);
        for i in 0..3 {
            target[i] = p[i].abs();
            begin[i] = warm[i].abs().max(tiny);
        }
        let (mut z, count) = newton::prox(
            target,
            k,
            begin,
            Signs::Positive,
            #[inline(always)]
            |s| self.expansion(s),
        );
        for i in 0..3 {
            z[i] = zero.select(p[i].lt(zero), -z[i], z[i]);
        }
        (z, count)
    }
}
