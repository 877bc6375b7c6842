//! Least squares conformal maps (Lévy et al. 2002).
//!
//! With positions as complex numbers z_v and hat gradients as complex numbers G_v, the anti-similarity
//! part of F is β = ½ Σ_v z_v G_v, and a map is conformal where β = 0. LSCM minimises Σ A |β|²: a
//! Hermitian form H_uv = Σ A Ḡ_u G_v, here as the real symmetric matrix of twice the size, with two
//! vertices fixed against similarities.

use crate::geometry::Elimination;
use crate::geometry::RestShape;
use crate::linalg::{Cholesky, SymmetricAssembly};
use crate::mesh::SurfaceMesh;
use crate::optim::BuildError;
use glam::DVec2;

/// The least squares conformal map with two far vertices of the boundary fixed, scaled to unit area.
/// Free of a boundary to choose; may have flips and overlaps.
pub fn lscm(
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
) -> Result<Vec<DVec2>, BuildError> {
    let n = mesh.positions.len();
    let position = |v: u32| mesh.positions[v as usize];
    let farthest = |from: u32| {
        boundary.iter().copied().fold(from, |best, v| {
            let d = |v: u32| position(v).distance_squared(position(from));
            if d(v) > d(best) { v } else { best }
        })
    };
    let first = farthest(boundary[0]);
    let second = farthest(first);
    let Elimination { slot, free, levels } = Elimination::new(rest, n, &[first, second]);
    let fixed = |v: u32| match v {
        _ if v == first => Some(DVec2::ZERO),
        _ if v == second => Some(DVec2::X),
        _ => None,
    };

    let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(rest.len() * 24);
    let mut rhs = vec![0.0; 2 * free];
    for e in 0..rest.len() {
        let simplex = rest.simplex(e);
        for a in 0..3 {
            for b in 0..3 {
                let (u, v) = (simplex[a], simplex[b]);
                let (gu, gv) = (rest.hat_gradient(e, a), rest.hat_gradient(e, b));
                // H_uv = A Ḡ_u G_v = p + i q
                let p = rest.measure[e] * (gu[0] * gv[0] + gu[1] * gv[1]);
                let q = rest.measure[e] * (gu[0] * gv[1] - gu[1] * gv[0]);
                if fixed(u).is_some() {
                    continue;
                }
                let row = 2 * slot[u as usize];
                if let Some(z) = fixed(v) {
                    rhs[row as usize] -= p * z.x - q * z.y;
                    rhs[row as usize + 1] -= q * z.x + p * z.y;
                    continue;
                }
                let column = 2 * slot[v as usize];
                // real form [[p, −q], [q, p]], lower triangle only
                for (i, j, value) in [
                    (row, column, p),
                    (row + 1, column + 1, p),
                    (row + 1, column, q),
                    (row, column + 1, -q),
                ] {
                    if i >= j {
                        entries.push((i, j, value));
                    }
                }
            }
        }
    }
    let mut assembly = SymmetricAssembly::new(2 * free, entries.iter().map(|e| (e.0, e.1)));
    assembly.fill(|c| entries[c].2);
    // two unknowns a vertex
    let double = |ends: Vec<usize>| ends.iter().map(|end| 2 * end).collect();
    let levels: Vec<Vec<usize>> = levels.into_iter().map(double).collect();
    let mut factor = Cholesky::analyze(assembly.matrix(), &levels)?;
    factor
        .factorize(assembly.matrix())
        .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
    factor.solve_in_place(&mut rhs, 1);

    let mut map: Vec<DVec2> = (0..n as u32)
        .map(|v| {
            fixed(v).unwrap_or_else(|| {
                let row = 2 * slot[v as usize] as usize;
                DVec2::new(rhs[row], rhs[row + 1])
            })
        })
        .collect();
    let area: f64 = mesh
        .simplices
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| map[v as usize]);
            0.5 * (b - a).perp_dot(c - a)
        })
        .sum();
    let scale = area.abs().max(f64::MIN_POSITIVE).sqrt().recip();
    map.iter_mut().for_each(|p| *p *= scale);
    Ok(map)
}
