//! Harmonic maps with the boundary on a circle.

use super::boundary_to_circle;
use crate::geometry::{RestShape, cotangent_weights, uniform_weights};
use crate::linalg::{Cholesky, SymmetricAssembly};
use crate::mesh::SurfaceMesh;
use crate::optim::BuildError;
use glam::DVec2;

/// The cotangent harmonic map to a circle of unit area (Eck et al. 1995). May have flips where the
/// surface has obtuse angles.
pub fn harmonic(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
) -> Result<Vec<DVec2>, BuildError> {
    weighted(mesh, rest, boundary, &cotangent_weights(rest))
}

/// Tutte's embedding (1963; Floater 1997) in a circle of unit area: never has flips in exact
/// arithmetic.
pub fn tutte(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
) -> Result<Vec<DVec2>, BuildError> {
    weighted(mesh, rest, boundary, &uniform_weights(rest))
}

/// The map whose interior vertices are the weighted means of their neighbours.
fn weighted(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
    weights: &[[f64; 3]],
) -> Result<Vec<DVec2>, BuildError> {
    let n = mesh.positions.len();
    let mut map = vec![DVec2::ZERO; n];
    const FIXED: u32 = u32::MAX;
    let mut unknown = vec![0u32; n];
    for (&v, p) in boundary.iter().zip(boundary_to_circle(mesh, boundary)) {
        map[v as usize] = p;
        unknown[v as usize] = FIXED;
    }
    let free: Vec<u32> = (0..n as u32)
        .filter(|&v| unknown[v as usize] != FIXED)
        .collect();
    for (k, &v) in free.iter().enumerate() {
        unknown[v as usize] = k as u32;
    }
    let order = {
        let unknown = &unknown;
        Cholesky::order(
            free.len(),
            rest.pairs()
                .map(|(a, b, _)| (unknown[a as usize], unknown[b as usize])),
        )
    };
    for (k, &first) in order.unknowns.iter().enumerate() {
        unknown[free[first as usize] as usize] = k as u32;
    }

    // each edge of each element: both diagonals and the off-diagonal entry
    let edges: Vec<(u32, u32, f64)> = rest
        .vertices
        .chunks_exact(3)
        .zip(weights)
        .flat_map(|(t, w)| [(t[1], t[2], w[0]), (t[2], t[0], w[1]), (t[0], t[1], w[2])])
        .collect();
    let entries: Vec<(u32, u32, f64)> = edges
        .iter()
        .flat_map(|&(a, b, w)| {
            let (a, b) = (unknown[a as usize], unknown[b as usize]);
            [(a, a, w), (b, b, w), (a, b, -w)]
        })
        .collect();
    let mut rhs = vec![0.0; 2 * free.len()];
    for &(a, b, w) in &edges {
        for (inner, outer) in [(a, b), (b, a)] {
            let row = unknown[inner as usize];
            if row != FIXED && unknown[outer as usize] == FIXED {
                let p = map[outer as usize];
                rhs[2 * row as usize] += w * p.x;
                rhs[2 * row as usize + 1] += w * p.y;
            }
        }
    }
    let mut assembly = SymmetricAssembly::new(free.len(), entries.iter().map(|e| (e.0, e.1)));
    assembly.fill(|c| entries[c].2);
    let mut factor = Cholesky::analyze(assembly.matrix(), &order.parts)?;
    factor
        .factorize(assembly.matrix())
        .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
    factor.solve_in_place(&mut rhs, 2);
    for &v in &free {
        let row = unknown[v as usize] as usize;
        map[v as usize] = DVec2::new(rhs[2 * row], rhs[2 * row + 1]);
    }
    Ok(map)
}
