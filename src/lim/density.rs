//! Energy densities, as functions of the Jacobian F (column by column), with their first derivatives.
//!
//! The energies of an element are w ψ(F) + β φ(det F). Laplacians have ψ = 0: they are no sums over elements.

use super::LimEnergy;
use crate::space::{Components, Space};

/// ψ and ∂ψ/∂F.
pub fn stress<S: Space>(
    energy: LimEnergy,
    f: S::Gradient<f64>,
    svd: (S::Sigma<f64>, S::Singularframe<f64>),
) -> (f64, S::Gradient<f64>) {
    let k = S::STRETCHES;
    match energy {
        LimEnergy::Arap => {
            let rotation = S::from_svd(S::Sigma::from_fn(|_| 1.0), svd.1);
            half_square::<S>(f, rotation)
        }
        LimEnergy::Dirichlet => half_square::<S>(f, identity::<S>()),
        LimEnergy::Lscm => {
            let mean = svd.0.as_slice().iter().sum::<f64>() / k as f64;
            let similarity = S::from_svd(S::Sigma::from_fn(|_| mean), svd.1);
            let (half, stress) = half_square::<S>(f, similarity);
            (2.0 * half, S::Gradient::from_fn(|c| 2.0 * stress.at(c)))
        }
        LimEnergy::Laplacian | LimEnergy::UniformLaplacian => (0.0, S::Gradient::from_fn(|_| 0.0)),
        LimEnergy::GreenStrain => {
            let strain = green_strain::<S>(f);
            let value = strain.as_flattened().iter().map(|e| e * e).sum();
            // 4 F (FᵀF − I)
            let stress = S::Gradient::from_fn(|c| {
                let (column, row) = (c / k, c % k);
                4.0 * (0..k)
                    .map(|m| f.at(m * k + row) * strain[m][column])
                    .sum::<f64>()
            });
            (value, stress)
        }
    }
}

/// ψ alone.
pub fn density<S: Space>(energy: LimEnergy, f: S::Gradient<f64>) -> f64 {
    match energy {
        LimEnergy::Arap => {
            let (sigma, _) = S::svd(f);
            let away = sigma.as_slice().iter().map(|s| (s - 1.0) * (s - 1.0));
            0.5 * away.sum::<f64>()
        }
        LimEnergy::Lscm => {
            let (sigma, _) = S::svd(f);
            let mean = sigma.as_slice().iter().sum::<f64>() / S::STRETCHES as f64;
            // the sum over the differences: no cancellation
            let away = sigma.as_slice().iter().map(|s| (s - mean) * (s - mean));
            away.sum()
        }
        LimEnergy::Dirichlet => half_square::<S>(f, identity::<S>()).0,
        LimEnergy::Laplacian | LimEnergy::UniformLaplacian => 0.0,
        LimEnergy::GreenStrain => {
            let strain = green_strain::<S>(f);
            strain.as_flattened().iter().map(|e| e * e).sum()
        }
    }
}

fn identity<S: Space>() -> S::Gradient<f64> {
    let k = S::STRETCHES;
    S::Gradient::from_fn(|c| f64::from(u8::from(c / k == c % k)))
}

/// ½ ‖F − G‖² and F − G.
#[inline(always)]
fn half_square<S: Space>(f: S::Gradient<f64>, to: S::Gradient<f64>) -> (f64, S::Gradient<f64>) {
    let away = S::Gradient::from_fn(
        #[inline(always)]
        |c| f.at(c) - to.at(c),
    );
    let square: f64 = away.as_slice().iter().map(|a| a * a).sum();
    (0.5 * square, away)
}

/// FᵀF − I.
#[inline(always)]
pub fn green_strain<S: Space>(f: S::Gradient<f64>) -> [[f64; 3]; 3] {
    let k = S::STRETCHES;
    let mut out = [[0.0; 3]; 3];
    for a in 0..k {
        for b in 0..k {
            out[a][b] = (0..k).map(|i| f.at(a * k + i) * f.at(b * k + i)).sum();
        }
        out[a][a] -= 1.0;
    }
    out
}
