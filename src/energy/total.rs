//! The energy of a whole map, its gradient and its extremes: plain and sequential, for starts,
//! direct methods and as the independent check of the vectorised kernels.

use super::Energy;
use crate::geometry::RestShape;
use crate::optim::Field;
use crate::space::{Components, Space};

/// A map's energy and what a report says beside it.
#[derive(Debug, Clone, PartialEq)]
pub struct Total {
    /// Reported energy (scaled and shifted as the energy's docs say); infinite where a barrier is
    /// broken.
    pub energy: f64,
    /// Gradient of the reported energy, vertices × dimension, interleaved.
    pub gradient: Vec<f64>,
    /// Elements with σ_last ≤ 0.
    pub inverted: usize,
    /// Smallest signed singular value.
    pub smallest_sigma: f64,
    /// Largest singular value.
    pub largest_sigma: f64,
}

/// F of one element.
pub fn deformation_gradient<S: Space>(
    rest: &RestShape,
    x: &[f64],
    element: usize,
) -> S::Gradient<f64> {
    let simplex = rest.simplex(element);
    let hats: [[f64; 3]; 4] = core::array::from_fn(|v| {
        if v < simplex.len() {
            rest.hat_gradient(element, v)
        } else {
            [0.0; 3]
        }
    });
    S::Gradient::from_fn(|c| {
        let (column, i) = (c / S::DIM, c % S::DIM);
        simplex
            .iter()
            .zip(&hats)
            .map(|(&v, g)| x[v as usize * S::DIM + i] * g[column])
            .sum()
    })
}

/// Adds `scale` · M g_v to the rows of `target` that belong to the element's vertices: the transpose
/// of [`deformation_gradient`].
pub fn spread<S: Space>(
    rest: &RestShape,
    element: usize,
    m: S::Gradient<f64>,
    scale: f64,
    target: &mut [f64],
) {
    for (v, &vertex) in rest.simplex(element).iter().enumerate() {
        let g = rest.hat_gradient(element, v);
        for i in 0..S::DIM {
            let force: f64 = (0..S::STRETCHES)
                .map(|column| m.at(column * S::DIM + i) * g[column])
                .sum();
            target[vertex as usize * S::DIM + i] += scale * force;
        }
    }
}

/// Evaluates a map (positions interleaved, vertices × dimension).
pub fn total<S: Space, E: Energy<S>>(energy: E, rest: &RestShape, x: &[f64]) -> Total {
    let mut out = Total {
        energy: 0.0,
        gradient: vec![0.0; x.len()],
        inverted: 0,
        smallest_sigma: f64::INFINITY,
        largest_sigma: 0.0,
    };
    let constants = energy.constants();
    let (mut sum, mut measure) = (0.0, 0.0);
    for e in 0..rest.len() {
        let f = deformation_gradient::<S>(rest, x, e);
        let (sigma, frame) = S::svd(f);
        let last = sigma.at(S::STRETCHES - 1);
        out.smallest_sigma = out.smallest_sigma.min(last);
        out.largest_sigma = out.largest_sigma.max(sigma.at(0));
        out.inverted += usize::from(!(last > 0.0));
        let area = rest.measure[e];
        measure += area;
        sum += area * energy.density(sigma);
        let stress = S::from_svd(energy.gradient(sigma), frame);
        spread::<S>(rest, e, stress, constants.scale * area, &mut out.gradient);
    }
    out.energy = if E::BARRIER && out.inverted > 0 {
        f64::INFINITY
    } else {
        constants.reported(sum, measure)
    };
    out
}

/// The distortion a page shows: the symmetric Dirichlet density of each element relative to an
/// isometry's, infinite where inverted.
pub fn distortion<S: Space>(rest: &RestShape, x: &[f64]) -> Vec<f32> {
    (0..rest.len())
        .map(|e| {
            let (sigma, _) = S::svd(deformation_gradient::<S>(rest, x, e));
            relative_distortion(sigma.as_slice())
        })
        .collect()
}

/// (Σᵢ σᵢ² + σᵢ⁻²)/2k, infinite where the last σ is not positive.
pub fn relative_distortion(sigma: &[f64]) -> f32 {
    match sigma.last() {
        Some(&last) if last > 0.0 => {
            let sum: f64 = sigma.iter().map(|s| s * s + (s * s).recip()).sum();
            (sum / (2.0 * sigma.len() as f64)) as f32
        }
        _ => f32::INFINITY,
    }
}

/// The value of a field at an element with these singular values.
pub fn field_value<S: Space, E: Energy<S>>(energy: E, sigma: S::Sigma<f64>, field: Field) -> f32 {
    let s = sigma.as_slice();
    let last = s[S::STRETCHES - 1];
    if !(last > 0.0) {
        return f32::INFINITY;
    }
    match field {
        Field::Distortion => relative_distortion(s),
        Field::Stretch => s[0].max(last.recip()) as f32,
        Field::Stress => {
            // principal Cauchy stresses σᵢ ψᵢ/J, of which a sheet has none across it
            let psi = energy.gradient(sigma);
            let volume: f64 = s.iter().product();
            let t = |i: usize| match i < S::STRETCHES {
                true => s[i] * psi.at(i) / volume,
                false => 0.0,
            };
            let [a, b, c] = [t(0) - t(1), t(1) - t(2), t(2) - t(0)];
            (0.5 * (a * a + b * b + c * c)).sqrt() as f32
        }
    }
}
