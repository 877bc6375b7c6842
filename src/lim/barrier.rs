//! The barrier of an element (paper, (3) and (4)), as a function of J = det of its Jacobian.
//!
//! With the measure λ = J m of an element that has m at rest, ε, and s = Γ (m − ε), the argument of the cubic g
//! is (λ − ε)/s = (J − η)/(Γ (1 − η)), η = ε/m: areas and volumes, halved or not, do not show. With
//! y = (J − η)/(Γ (1 − η)) the cubic (4) is g = y³ − 3y² + 3y = 1 − (1 − y)³, and
//!
//! φ = 1/g − 1,  φ′ = −g′/g²,  φ″ = (2g′² − g″g)/g³
//!
//! for 0 < y < 1; φ = 0 from there on, twice continuously differentiable, and +∞ up to y = 0. (The paper's appendix
//! prints g″g′ in φ″.)

/// Of one element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Barrier {
    /// η: where the barrier is infinite.
    pub wall: f64,
    /// 1/(Γ (1 − η)).
    pub steepness: f64,
}

/// φ and its derivatives with respect to J.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BarrierValue {
    /// φ.
    pub value: f64,
    /// dφ/dJ ≤ 0.
    pub slope: f64,
    /// d²φ/dJ² ≥ 0.
    pub curvature: f64,
}

impl Barrier {
    /// With its wall at η in [0, 1), beginning to act where J = η + Γ (1 − η).
    pub fn new(wall: f64, reach: f64) -> Self {
        let steepness = (reach * (1.0 - wall)).recip();
        Self { wall, steepness }
    }

    /// At J.
    #[inline]
    pub fn at(&self, j: f64) -> BarrierValue {
        let y = (j - self.wall) * self.steepness;
        if y >= 1.0 {
            return BarrierValue {
                value: 0.0,
                slope: 0.0,
                curvature: 0.0,
            };
        }
        if !(y > 0.0) {
            return BarrierValue {
                value: f64::INFINITY,
                slope: f64::NEG_INFINITY,
                curvature: f64::INFINITY,
            };
        }
        let rest = 1.0 - y;
        let g = y * (3.0 - y * (3.0 - y));
        let g1 = 3.0 * rest * rest;
        let g2 = -6.0 * rest;
        let inverse = g.recip();
        BarrierValue {
            // 1/g − 1 = (1 − y)³/g without cancellation
            value: rest * rest * rest * inverse,
            slope: -g1 * inverse * inverse * self.steepness,
            curvature: (2.0 * g1 * g1 - g2 * g)
                * (inverse * inverse * inverse)
                * (self.steepness * self.steepness),
        }
    }
}
