//! Second derivatives of the energy densities with respect to the Jacobian F (column by column).

use super::density::green_strain;
use super::turning::Turning;
use super::{LimEnergy, LimHessian};
use crate::energy::hessian::{MOST, Square};
use crate::space::{Components, Space};

/// ∂²ψ/∂F², or what is taken for it.
pub fn curvature<S: Space>(energy: LimEnergy, kind: LimHessian, f: S::Gradient<f64>) -> Square {
    let k = S::STRETCHES;
    match (energy, kind) {
        (LimEnergy::Laplacian | LimEnergy::UniformLaplacian, _) => [[0.0; MOST]; MOST],
        (LimEnergy::Dirichlet, _) | (LimEnergy::Arap, LimHessian::Frozen) => {
            multiple_of_identity(k, 1.0)
        }
        (LimEnergy::Arap, LimHessian::Projected) => {
            let mut out = multiple_of_identity(k, 1.0);
            Turning::<S>::new(f).soften(1.0, 2.0, &mut out);
            out
        }
        (LimEnergy::Lscm, _) => similarity_curvature::<S>(kind, f),
        (LimEnergy::GreenStrain, _) => green_curvature::<S>(f),
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

/// Of the squared distance to the similarities, ‖F‖² − (Σ σᵢ)²/k: 2 (I − R Rᵀ/k), R as a vector, with frozen
/// rotations; [turning](Turning) takes 4 mean(σ)/(σᵢ + σⱼ) from it, at most what is there. In the plane that is
/// all of it: there the energy is quadratic.
fn similarity_curvature<S: Space>(kind: LimHessian, f: S::Gradient<f64>) -> Square {
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
    let turning = Turning::<S>::new(f);
    for a in 0..k * k {
        for b in 0..k * k {
            out[a][b] -= 2.0 / k as f64 * turning.rotation.at(a) * turning.rotation.at(b);
        }
    }
    if kind == LimHessian::Projected {
        let mean = turning.sigma.as_slice().iter().sum::<f64>() / k as f64;
        turning.soften(2.0, 4.0 * mean, &mut out);
    }
    out
}
