//! Harmonic maps with the boundary on a circle.

use super::boundary_to_circle;
use crate::geometry::{Elimination, RestShape, cotangent_weights, uniform_weights};
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
    harmonic_around(mesh, rest, boundary, &[])
}

/// The same of a surface with holes, each of which has a vertex in its middle, tied to all of its rim.
pub fn harmonic_around(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
    holes: &[Vec<u32>],
) -> Result<Vec<DVec2>, BuildError> {
    weighted(mesh, rest, boundary, holes, &cotangent_weights(rest))
}

/// Tutte's embedding (1963; Floater 1997) in a circle of unit area: never has flips in exact
/// arithmetic.
pub fn tutte(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
) -> Result<Vec<DVec2>, BuildError> {
    tutte_around(mesh, rest, boundary, &[])
}

/// The same of a surface with holes, each of which has a vertex in its middle, tied to all of its rim: without the
/// middles an embedding of the surface.
pub fn tutte_around(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
    holes: &[Vec<u32>],
) -> Result<Vec<DVec2>, BuildError> {
    weighted(mesh, rest, boundary, holes, &uniform_weights(rest))
}

/// The map whose interior vertices are the weighted means of their neighbours.
fn weighted(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
    holes: &[Vec<u32>],
    weights: &[[f64; 3]],
) -> Result<Vec<DVec2>, BuildError> {
    let n = mesh.positions.len();
    let middles = (n as u32..).zip(holes);
    let spokes: Vec<(u32, u32, f64)> = middles
        .flat_map(|(middle, rim)| rim.iter().map(move |&v| (v, middle, 1.0)))
        .collect();
    let circle = boundary_to_circle(mesh, boundary);
    let fixed: Vec<_> = boundary.iter().copied().zip(circle).collect();
    let mut map = extension(rest, n + holes.len(), &fixed, weights, &spokes)?;
    map.truncate(n);
    Ok(map)
}

/// The vectors at these vertices, and harmonically what they make of all others.
///
/// # Errors
/// `TooLarge`; `NotPositiveDefinite` where a part of the surface has none of them.
pub fn harmonic_extension(
    rest: &RestShape,
    vertices: usize,
    fixed: &[(u32, DVec2)],
) -> Result<Vec<DVec2>, BuildError> {
    extension(rest, vertices, fixed, &cotangent_weights(rest), &[])
}

fn extension(
    rest: &RestShape,
    n: usize,
    fixed: &[(u32, DVec2)],
    weights: &[[f64; 3]],
    spokes: &[(u32, u32, f64)],
) -> Result<Vec<DVec2>, BuildError> {
    let mut map = vec![DVec2::ZERO; n];
    for &(v, p) in fixed {
        map[v as usize] = p;
    }
    let pins: Vec<u32> = fixed.iter().map(|&(v, _)| v).collect();
    let Elimination { slot, free, levels } = Elimination::with_couplings(rest, n, &pins, spokes);
    let is_free = |slot: u32| (slot as usize) < free;

    // each edge of each element: both diagonals and the off-diagonal entry
    let edges: Vec<(u32, u32, f64)> = rest
        .vertices
        .chunks_exact(3)
        .zip(weights)
        .flat_map(|(t, w)| [(t[1], t[2], w[0]), (t[2], t[0], w[1]), (t[0], t[1], w[2])])
        .chain(spokes.iter().copied())
        .collect();
    let entries: Vec<(u32, u32, f64)> = edges
        .iter()
        .flat_map(|&(a, b, w)| {
            let (a, b) = (slot[a as usize], slot[b as usize]);
            [(a, a, w), (b, b, w), (a, b, -w)]
        })
        .collect();
    let mut rhs = vec![0.0; 2 * free];
    for &(a, b, w) in &edges {
        for (inner, outer) in [(a, b), (b, a)] {
            let row = slot[inner as usize];
            if is_free(row) && !is_free(slot[outer as usize]) {
                let p = map[outer as usize];
                rhs[2 * row as usize] += w * p.x;
                rhs[2 * row as usize + 1] += w * p.y;
            }
        }
    }
    let mut assembly = SymmetricAssembly::new(free, entries.iter().map(|e| (e.0, e.1)));
    assembly.fill(|c| entries[c].2);
    let mut factor = Cholesky::analyze(assembly.matrix(), &levels)?;
    factor
        .factorize(assembly.matrix())
        .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
    factor.solve_in_place(&mut rhs, 2);
    for (p, &row) in map.iter_mut().zip(&slot).filter(|&(_, &row)| is_free(row)) {
        *p = DVec2::new(rhs[2 * row as usize], rhs[2 * row as usize + 1]);
    }
    Ok(map)
}
