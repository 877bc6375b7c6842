//! Neo-Hookean: ψ(σ) = μ/2 (Σσᵢ² − 3) − μ ℓ(J) + λ/2 ℓ(J)², J = σ₁σ₂σ₃ (Bonet & Wood 2008).
//!
//! ℓ(J) = log J for J > 0.1; below, it is continued by its Taylor polynomial of second order at 0.1,
//! as the authors of WRAPD do, so that inverted elements have a finite energy.
//!
//! With f(J) = −μ ℓ + λ/2 ℓ² and g = ∇J the gradient is μ σ + f' g and the Hessian
//! μ I + f'' g gᵀ + f' ∇²J, where (∇²J)ᵢⱼ is the third σ.

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

/// Most Newton steps of a prox: for safety only.
const MOST_STEPS: u32 = 50;

impl NeoHookean {
    /// From Young's modulus (> 0, any unit of pressure) and Poisson's ratio (in (−1, 0.5)).
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn new(young: f64, poisson: f64) -> Result<Self, BuildError> {
        let wrong = |option, what: &str| {
            let what = what.into();
            Err(BuildError::InvalidOption { option, what })
        };
        if !(young > 0.0 && young.is_finite()) {
            return wrong("young", "must be positive and finite");
        }
        if !(poisson > -1.0 && poisson < 0.5) {
            return wrong("poisson", "must be above −1 and below 0.5");
        }
        Ok(Self {
            mu: young / (2.0 * (1.0 + poisson)),
            lambda: young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
        })
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

    /// ψ + k/2 ‖σ − p‖², its gradient and its Hessian (xx, yy, zz, xy, xz, yz).
    #[inline(always)]
    fn augmented<L: Lane>(&self, s: [L; 3], p: [L; 3], k: L) -> (L, [L; 3], [L; 6]) {
        let (mu, half) = (k.lift(self.mu), k.lift(0.5));
        let g = [s[1] * s[2], s[0] * s[2], s[0] * s[1]];
        let [f, d, dd] = self.volumetric(s[0] * g[0]);
        let away = [s[0] - p[0], s[1] - p[1], s[2] - p[2]];
        let squares = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - k.lift(3.0);
        let distance = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
        let value = half * mu * squares + f + half * k * distance;
        let mut gradient = away;
        for i in 0..3 {
            gradient[i] = mu * s[i] + d * g[i] + k * away[i];
        }
        let diagonal = mu + k;
        let hessian = [
            diagonal + dd * g[0] * g[0],
            diagonal + dd * g[1] * g[1],
            diagonal + dd * g[2] * g[2],
            dd * g[0] * g[1] + d * s[2],
            dd * g[0] * g[2] + d * s[1],
            dd * g[1] * g[2] + d * s[0],
        ];
        (value, gradient, hessian)
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

/// The solution of H d = −g, where the symmetric H (xx, yy, zz, xy, xz, yz) is made definite by lifting
/// its eigenvalues to at least `least`.
#[inline(always)]
fn newton_direction<L: Lane>(h: [L; 6], g: [L; 3], least: L) -> [L; 3] {
    // L D Lᵀ; its pivots say whether H is definite
    let d0 = h[0];
    let (l1, l2) = (h[3] / d0, h[4] / d0);
    let d1 = h[1] - l1 * h[3];
    let cross = h[5] - l1 * h[4];
    let l3 = cross / d1;
    let d2 = h[2] - l2 * h[4] - l3 * cross;
    let y1 = g[1] - l1 * g[0];
    let y2 = g[2] - l2 * g[0] - l3 * y1;
    let z2 = -y2 / d2;
    let z1 = -y1 / d1 - l3 * z2;
    let z0 = -g[0] / d0 - l1 * z1 - l2 * z2;
    let lowest = d0.min(d1).min(d2);
    let definite = (g[0].lift(0.1) * least).lt(lowest);
    let zero = least.lift(0.0);
    if !least.any(zero.lt(least.select(definite, zero, least))) {
        return [z0, z1, z2];
    }
    let (values, v) = Solid::eigen(h);
    let mut d = [zero; 3];
    for k in 0..3 {
        let along = v[k][0] * g[0] + v[k][1] * g[1] + v[k][2] * g[2];
        let step = along / values[k].max(least);
        for i in 0..3 {
            d[i] = d[i] - step * v[k][i];
        }
    }
    [
        zero.select(definite, z0, d[0]),
        zero.select(definite, z1, d[1]),
        zero.select(definite, z2, d[2]),
    ]
}

impl Energy<Solid> for NeoHookean {
    const BARRIER: bool = false;

    fn constants(&self) -> Constants {
        Constants {
            // the weight of the authors' code
            rest_stiffness: 2.0066 * self.mu + 1.0122 * self.lambda,
            isometry: 0.0,
            scale: 1.0,
            offset: 0.0,
            // as in the authors' code: the minimum may be 0
            floor: 1.0,
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
        let zero = s[0].lift(0.0);
        self.augmented(s, s, zero).1
    }

    #[inline(always)]
    fn effective_stiffness<L: Lane>(&self, s: [L; 3]) -> L {
        let zero = s[0].lift(0.0);
        let (_, _, hessian) = self.augmented(s, s, zero);
        Solid::eigen(hessian).0[0]
    }

    /// Newton's method on the three σ with eigenvalues lifted where the Hessian is not definite, and
    /// Armijo's rule.
    #[inline(always)]
    fn prox<L: Lane>(&self, p: [L; 3], k: L, warm: [L; 3]) -> ([L; 3], u32) {
        let (zero, half) = (k.lift(0.0), k.lift(0.5));
        // the better of the two: the target without its reflection, and where it was
        let tiny = k.lift(1e-6);
        let target = [
            p[0].abs().max(tiny),
            p[1].abs().max(tiny),
            p[2].abs().max(tiny),
        ];
        let (there, ..) = self.augmented(target, p, k);
        let (here, ..) = self.augmented(warm, p, k);
        let mut s = keep(zero.lt(there - here), warm, target);
        let (mut value, mut gradient, mut hessian) = self.augmented(s, p, k);
        let mut count = 0;
        loop {
            count += 1;
            let d = newton_direction(hessian, gradient, half * k);
            let size = s[0].abs().max(s[1].abs()).max(s[2].abs());
            let step = d[0].abs().max(d[1].abs()).max(d[2].abs());
            // quadratic convergence: what is left after this step is of the order of its square
            let moving = (k.lift(1e-8) * (size + k.lift(1e-8))).lt(step);
            let going = s[0].any(moving) && count < MOST_STEPS;
            let slope = gradient[0] * d[0] + gradient[1] * d[1] + gradient[2] * d[2];
            // with two negative stretches J would be positive again: only the last may change sign
            let mut t = k.lift(1.0);
            for i in 0..2 {
                let back = -d[i];
                let reach = k.lift(0.9) * s[i] / back;
                t = t.min(zero.select(zero.lt(back), reach, t));
            }
            let mut next;
            let mut halvings = 0;
            loop {
                next = [s[0] + t * d[0], s[1] + t * d[1], s[2] + t * d[2]];
                let (trial, g, h) = self.augmented(next, p, k);
                let bound = value + k.lift(1e-4) * t * slope;
                // only who still moves has to descend: at the minimum rounding decides
                let fails = zero.lt(zero.select(moving, trial - bound, zero));
                halvings += 1;
                if !zero.any(fails) || halvings == 30 {
                    (value, gradient, hessian) = match going {
                        true => (
                            zero.select(moving, trial, value),
                            keep(moving, g, gradient),
                            keep(moving, h, hessian),
                        ),
                        false => (value, gradient, hessian),
                    };
                    break;
                }
                t = zero.select(fails, half * t, t);
            }
            if !going {
                return (next, count);
            }
            // who has arrived waits with the last step undone, and takes it at the end
            s = keep(moving, next, s);
        }
    }
}

#[inline(always)]
fn keep<L: Lane, const N: usize>(mask: L::Mask, yes: [L; N], no: [L; N]) -> [L; N] {
    let mut out = no;
    for i in 0..N {
        out[i] = yes[i].select(mask, yes[i], no[i]);
    }
    out
}
