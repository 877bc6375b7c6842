//! Second derivatives of the energy densities with respect to the Jacobian F (column by column).

use super::LimEnergy;
use super::barrier::Barrier;
use super::density::green_strain;
use super::elements::Law;
use crate::energy::hessian::{Eigensystem, MOST, Square};
use crate::space::{Components, Space};

/// ∂²ψ/∂F², of energies with rotations in them as if these stayed as they are.
pub fn frozen<S: Space>(energy: LimEnergy, f: S::Gradient<f64>) -> Square {
    let k = S::STRETCHES;
    match energy {
        LimEnergy::Laplacian | LimEnergy::UniformLaplacian => [[0.0; MOST]; MOST],
        LimEnergy::Dirichlet | LimEnergy::Arap => multiple_of_identity(k, 1.0),
        LimEnergy::Lscm => similarity_curvature::<S>(f),
        LimEnergy::GreenStrain => green_curvature::<S>(f),
    }
}

fn multiple_of_identity(k: usize, factor: f64) -> Square {
    let mut out = [[0.0; MOST]; MOST];
    (0..k * k).for_each(|c| out[c][c] = factor);
    out
}

/// Of Σ ‖FᵀF − I‖²: 4 (D (FᵀF − I) + F DᵀF + F FᵀD) for a change D.
fn green_curvature<S: Space>(f: S::Gradient<f64>) -> Square {
    let k = S::STRETCHES;
    let strain = green_strain::<S>(f);
    let mut outer = [[0.0; 3]; 3];
    for i in 0..k {
        for j in 0..k {
            outer[i][j] = (0..k).map(|a| f.at(a * k + i) * f.at(a * k + j)).sum();
        }
    }
    let mut out = [[0.0; MOST]; MOST];
    for a in 0..k {
        for i in 0..k {
            for b in 0..k {
                for j in 0..k {
                    let mut sum = f.at(b * k + i) * f.at(a * k + j);
                    if i == j {
                        sum += strain[b][a];
                    }
                    if a == b {
                        sum += outer[i][j];
                    }
                    out[a * k + i][b * k + j] = 4.0 * sum;
                }
            }
        }
    }
    out
}

/// Of the squared distance to the similarities: 2 (I − R Rᵀ/k), R as a vector; in the plane, where the energy is
/// quadratic, its second derivatives.
fn similarity_curvature<S: Space>(f: S::Gradient<f64>) -> Square {
    let k = S::STRETCHES;
    let mut out = multiple_of_identity(k, 2.0);
    if k == 2 {
        // by columns: ψ = ½ (F₁₁ − F₂₂)² + ½ (F₁₂ + F₂₁)²
        for (a, b, sign) in [(0, 3, -1.0), (1, 2, 1.0)] {
            out[a][a] = 1.0;
            out[b][b] = 1.0;
            out[a][b] = sign;
            out[b][a] = sign;
        }
        return out;
    }
    let (_, frame) = S::svd(f);
    let rotation = S::from_svd(S::Sigma::from_fn(|_| 1.0), frame);
    for a in 0..k * k {
        for b in 0..k * k {
            out[a][b] -= 2.0 / k as f64 * rotation.at(a) * rotation.at(b);
        }
    }
    out
}

/// The second derivatives of w ψ + β φ(det F), of what is negative in them the part `kept` (Smith, de Goes & Kim 2019).
/// ½ ‖F‖² stands for Dirichlet, whose linear part has none.
pub fn projected<S: Space>(
    law: Law,
    weight: f64,
    barrier: &Barrier,
    f: S::Gradient<f64>,
    kept: f64,
) -> Square {
    let k = S::STRETCHES;
    let others = |sigma: S::Sigma<f64>, i: usize| -> f64 {
        let rest = (0..k).filter(|&c| c != i);
        rest.map(|c| sigma.at(c)).product()
    };
    let volume = |sigma: S::Sigma<f64>| -> f64 { sigma.as_slice().iter().product() };
    let mean = |sigma: S::Sigma<f64>| sigma.as_slice().iter().sum::<f64>() / k as f64;
    let gradient = |sigma: S::Sigma<f64>| {
        let slope = match law.beta > 0.0 {
            true => law.beta * barrier.at(volume(sigma)).slope,
            false => 0.0,
        };
        S::Sigma::from_fn(|i| {
            let s = sigma.at(i);
            let own = match law.energy {
                LimEnergy::Arap => s - 1.0,
                LimEnergy::Dirichlet => s,
                LimEnergy::Lscm => 2.0 * (s - mean(sigma)),
                LimEnergy::GreenStrain => 4.0 * s * (s * s - 1.0),
                LimEnergy::Laplacian | LimEnergy::UniformLaplacian => 0.0,
            };
            weight * own + slope * others(sigma, i)
        })
    };
    let hessian = |sigma: S::Sigma<f64>| {
        let barrier = barrier.at(volume(sigma));
        let (slope, curvature) = match law.beta > 0.0 {
            true => (law.beta * barrier.slope, law.beta * barrier.curvature),
            false => (0.0, 0.0),
        };
        let mut out = [[0.0; 3]; 3];
        for i in 0..k {
            for j in 0..k {
                let mut entry = curvature * others(sigma, i) * others(sigma, j);
                if i != j {
                    let third = (0..k).filter(|&c| c != i && c != j);
                    entry += slope * third.map(|c| sigma.at(c)).product::<f64>();
                }
                let same = f64::from(u8::from(i == j));
                entry += weight
                    * match law.energy {
                        LimEnergy::Arap | LimEnergy::Dirichlet => same,
                        LimEnergy::Lscm => 2.0 * (same - 1.0 / k as f64),
                        LimEnergy::GreenStrain => same * (12.0 * sigma.at(i) * sigma.at(i) - 4.0),
                        LimEnergy::Laplacian | LimEnergy::UniformLaplacian => 0.0,
                    };
                out[i][j] = entry;
            }
        }
        out
    };
    Eigensystem::<S>::of(f, &gradient, &hessian).map(|value| value.max(kept * value))
}
