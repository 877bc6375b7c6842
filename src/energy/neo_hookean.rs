//! Neo-Hookean: ψ(σ) = μ/2 (Σσᵢ² − 3) − μ ℓ(J) + λ/2 ℓ(J)², J = σ₁σ₂σ₃ (Bonet & Wood 2008).
//!
//! ℓ(J) = log J for J > 0.1; below, it is continued by its Taylor polynomial of second order at 0.1,
//! as the authors of WRAPD do, so that inverted elements have a finite energy.
//!
//! With f(J) = −μ ℓ + λ/2 ℓ² and g = ∇J the gradient is μ σ + f' g and the Hessian
//! μ I + f'' g gᵀ + f' ∇²J, where (∇²J)ᵢⱼ is the third σ.

use super::moduli::lame;
use super::newton::{self, Expansion, Signs};
use super::{Constants, Energy};
use crate::optim::BuildError;
use crate::space::{Lane, Solid, Space};

/// Neo-Hookean elasticity of a solid; an undeformed solid has 0. Energies are in units of the modulus
/// times volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NeoHookean {
    /// μ, the second Lamé parameter.
    pub mu: f64,
    /// λ, the first.
    pub lambda: f64,
}

/// Below this J the logarithm is continued.
const CONTINUED: f64 = 0.1;

impl NeoHookean {
    /// From Young's modulus (> 0, any unit of pressure) and Poisson's ratio (in (−1, 0.5)).
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn new(young: f64, poisson: f64) -> Result<Self, BuildError> {
        let [mu, lambda] = lame(young, poisson)?;
        Ok(Self { mu, lambda })
    }

    /// f, f', f'' at J.
    #[inline(always)]
    fn volumetric<L: Lane>(&self, j: L) -> [L; 3] {
        let (mu, lambda) = (j.lift(self.mu), j.lift(self.lambda));
        let [log, slope, bend] = logarithm(j);
        let stress = lambda * log - mu;
        [
            (j.lift(0.5) * lambda * log - mu) * log,
            stress * slope,
            stress * bend + lambda * slope * slope,
        ]
    }

    /// ψ, its gradient and its Hessian.
    #[inline(always)]
    fn expansion<L: Lane>(&self, s: [L; 3]) -> Expansion<L> {
        let mu = s[0].lift(self.mu);
        let g = [s[1] * s[2], s[0] * s[2], s[0] * s[1]];
        let [f, d, dd] = self.volumetric(s[0] * g[0]);
        let squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - mu.lift(3.0);
        let mut gradient = s;
        for i in 0..3 {
            gradient[i] = mu * s[i] + d * g[i];
        }
        let hessian = [
            mu + dd * g[0] * g[0],
            mu + dd * g[1] * g[1],
            mu + dd * g[2] * g[2],
            dd * g[0] * g[1] + d * s[2],
            dd * g[0] * g[2] + d * s[1],
            dd * g[1] * g[2] + d * s[0],
        ];
        (mu.lift(0.5) * mu * squares + f, gradient, hessian)
    }
}

/// ℓ, ℓ', ℓ''.
#[inline(always)]
fn logarithm<L: Lane>(j: L) -> [L; 3] {
    let bound = j.lift(CONTINUED);
    let regular = bound.lt(j);
    // where it is not used the logarithm must still be of something positive
    let safe = j.max(bound);
    let (log, slope) = (safe.ln(), safe.recip());
    let beyond = j.min(bound) - bound;
    let bend = -(slope * slope);
    // beyond is 0 where the logarithm is regular
    let log = log + (slope + j.lift(0.5) * bend * beyond) * beyond;
    let continued = slope + bend * beyond;
    [log, j.select(regular, slope, continued), bend]
}

impl Energy<Solid> for NeoHookean {
    const BARRIER: bool = false;

    fn constants(&self) -> Constants {
        Constants {
            // the secant of the uniaxial stress between 0.919 and 1.081, see `moduli`
            rest_stiffness: 2.0066 * self.mu + 1.0122 * self.lambda,
            isometry: 0.0,
            scale: 1.0,
            offset: 0.0,
        }
    }

    #[inline(always)]
    fn density<L: Lane>(&self, s: [L; 3]) -> L {
        let [f, ..] = self.volumetric(s[0] * s[1] * s[2]);
        let squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - s[0].lift(3.0);
        s[0].lift(0.5 * self.mu) * squares + f
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
