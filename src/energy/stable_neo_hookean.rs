//! Stable neo-Hookean: ψ(σ) = μ/2 (I − 3) + λ/2 ((J − α)² − (1 − α)²) − μ/2 log((I + 1)/4), I = Σσᵢ²,
//! J = σ₁σ₂σ₃, α = 1 + 3μ/4λ (Smith, de Goes & Kim 2018, (14); the constants make rest have 0).
//!
//! It is the version with the logarithm, which is of I + 1 and so finite everywhere: with it F = 0 is no
//! local minimum, and what is collapsed to a point unfolds. μ and λ here are not Lamé's. The gradient is
//! μ (1 − 1/(I+1)) σ + λ (J − α) g with g = ∇J, which vanishes at rest; the Hessian is
//!
//! μ (1 − 1/(I+1)) Id + 2μ/(I+1)² σσᵀ + λ ggᵀ + λ (J − α) ∇²J,
//!
//! at rest 3μ/2 Id + (λ − 5μ/8) 11ᵀ. Linear elasticity has 2μ_Lamé Id + λ_Lamé 11ᵀ, so that
//! μ = 4/3 μ_Lamé and λ = λ_Lamé + 5/6 μ_Lamé. Since λ_Lamé > −2/3 μ_Lamé, λ is positive.

use super::moduli::{lame, uniaxial_stiffness};
use super::newton::{self, Expansion, Signs};
use super::{Constants, Energy};
use crate::optim::BuildError;
use crate::space::{Lane, Solid, Space};

/// Stable neo-Hookean elasticity of a solid; an undeformed solid has 0. Energies are in units of the
/// modulus times volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StableNeoHookean {
    mu: f64,
    lambda: f64,
}

impl StableNeoHookean {
    /// From Young's modulus (> 0, any unit of pressure) and Poisson's ratio (in (−1, 0.5)), which it has
    /// for small strains.
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn new(young: f64, poisson: f64) -> Result<Self, BuildError> {
        let [mu, lambda] = lame(young, poisson)?;
        Ok(Self {
            mu: 4.0 / 3.0 * mu,
            lambda: lambda + 5.0 / 6.0 * mu,
        })
    }

    /// α.
    fn rest_volume(&self) -> f64 {
        1.0 + 0.75 * self.mu / self.lambda
    }

    /// ψ, its gradient and its Hessian.
    #[inline(always)]
    fn expansion<L: Lane>(&self, s: [L; 3]) -> Expansion<L> {
        let one = s[0].lift(1.0);
        let (mu, lambda) = (one.lift(self.mu), one.lift(self.lambda));
        let alpha = one.lift(self.rest_volume());
        let squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
        let shrink = one / (squares + one);
        let g = [s[1] * s[2], s[0] * s[2], s[0] * s[1]];
        let j = s[0] * g[0];
        let diagonal = mu - mu * shrink;
        let pressure = lambda * (j - alpha);
        let bend = (mu + mu) * shrink * shrink;
        let mut gradient = s;
        for i in 0..3 {
            gradient[i] = diagonal * s[i] + pressure * g[i];
        }
        let mut hessian = [diagonal; 6];
        // the pairs of axes in the order of the entries, and the σ of the third
        for (entry, (a, b)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
            .into_iter()
            .enumerate()
        {
            let first = match entry {
                0..3 => diagonal,
                _ => pressure * s[3 - a - b],
            };
            hessian[entry] = first + bend * s[a] * s[b] + lambda * g[a] * g[b];
        }
        let log = (one.lift(0.25) * (squares + one)).ln();
        let volumetric = lambda * (j - one) * (j + one - (alpha + alpha));
        let value = one.lift(0.5) * (mu * (squares - one.lift(3.0) - log) + volumetric);
        (value, gradient, hessian)
    }
}

impl Energy<Solid> for StableNeoHookean {
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
        newton::prox(
            p,
            k,
            warm,
            Signs::Signed,
            #[inline(always)]
            |s| self.expansion(s),
        )
    }
}
