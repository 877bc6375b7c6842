//! The energies that are no sums over elements: quadratic forms ½ uᵀ Q u of the displacements.

use super::LimEnergy;
use crate::geometry::{RestShape, vertex_measures};
use std::collections::BTreeMap;

/// Rows of a sparse matrix: entries in ascending order of their columns.
type Rows = Vec<BTreeMap<u32, f64>>;

/// Q as entries (vertex, vertex, value), a pair of different vertices once for both, in the units of positions
/// that are to be multiplied by `scale`; none for the energies of elements.
pub fn quadratic_form(
    energy: LimEnergy,
    rest: &RestShape,
    vertices: usize,
    scale: f64,
) -> Vec<(u32, u32, f64)> {
    match energy {
        LimEnergy::Laplacian => {
            let measure = vertex_measures(rest, vertices);
            // Lᵀ M⁻¹ L has the unit of length^(k−4), and is applied to squares of lengths
            let unit = scale.powi(rest.stretches as i32 - 2);
            product(&cotangent(rest, vertices), |v| match measure[v] > 0.0 {
                true => unit / measure[v],
                false => 0.0,
            })
        }
        LimEnergy::UniformLaplacian => product(&uniform(rest, vertices), |_| scale * scale),
        _ => Vec::new(),
    }
}

/// Σ A g_a·g_b: minus the Laplacian, times the vertices' measures.
fn cotangent(rest: &RestShape, vertices: usize) -> Rows {
    let mut rows = vec![BTreeMap::new(); vertices];
    for e in 0..rest.len() {
        for (a, &v) in rest.simplex(e).iter().enumerate() {
            for (b, &w) in rest.simplex(e).iter().enumerate() {
                let entry = rest.measure[e] * rest.hat_product(e, a, b);
                *rows[v as usize].entry(w).or_insert(0.0) += entry;
            }
        }
    }
    rows
}

/// A vertex less the mean of its neighbours.
fn uniform(rest: &RestShape, vertices: usize) -> Rows {
    let mut rows: Rows = vec![BTreeMap::new(); vertices];
    for e in 0..rest.len() {
        for &v in rest.simplex(e) {
            let others = rest.simplex(e).iter().filter(|&&w| w != v);
            rows[v as usize].extend(others.map(|&w| (w, 0.0)));
        }
    }
    for (v, row) in rows
        .iter_mut()
        .enumerate()
        .filter(|(_, row)| !row.is_empty())
    {
        let part = -(row.len() as f64).recip();
        row.values_mut().for_each(|entry| *entry = part);
        row.insert(v as u32, 1.0);
    }
    rows
}

/// The lower triangle of Lᵀ W L.
fn product(rows: &Rows, weight: impl Fn(usize) -> f64) -> Vec<(u32, u32, f64)> {
    let mut out: Rows = vec![BTreeMap::new(); rows.len()];
    for (v, row) in rows.iter().enumerate() {
        let weight = weight(v);
        for (&a, &x) in row {
            for (&b, &y) in row.range(..=a) {
                *out[a as usize].entry(b).or_insert(0.0) += weight * x * y;
            }
        }
    }
    let rows = out.iter().enumerate();
    rows.flat_map(|(a, row)| row.iter().map(move |(&b, &value)| (a as u32, b, value)))
        .collect()
}
