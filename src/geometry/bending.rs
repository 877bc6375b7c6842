//! The energy of a bent sheet, quadratic in the positions (Bergou et al. 2006).

use super::{RestShape, cotangent_weights};
use crate::mesh::MeshError;
use crate::mesh::topology::{next, opposites, previous};

/// The matrix B of the bending energy ½ tr(XᵀBX) of a triangulated sheet, as contributions (vertex,
/// vertex, value): each pair of a hinge once, in either order, its diagonal included; they add up. X holds
/// one row a vertex.
///
/// A hinge is two triangles at an edge, with the rest areas A₀ and A₁. With the cotangents of their
/// rest angles at the ends of the edge, K x is the edge's share of the Laplacian of the positions; it
/// vanishes where the hinge is flat. Each contributes `stiffness`/(A₀+A₁) KᵀK. Orientations do not
/// matter. A surface that is curved at rest is pulled flat, too: this energy knows no other rest.
///
/// `stiffness` is the D of a plate, force times length (newton metres; Young's modulus times
/// thickness³/12): the energy is an approximation of D/2 ∫ κ² on a sheet that is bent one way, exact in
/// the limit of a regular triangulation. There the energy of the paper, whose factor is 3/(A₀+A₁), is three
/// times that, as hinges have besides the mean curvature a share of the Gaussian (Seung & Nelson 1988).
/// On irregular triangulations no factor is right for all directions, and refinement does not help.
///
/// # Errors
/// [`MeshError`] where more than two triangles meet in an edge, or two are the same.
pub fn quadratic_bending(
    rest: &RestShape,
    vertices: usize,
    stiffness: f64,
) -> Result<Vec<(u32, u32, f64)>, MeshError> {
    let corners = &rest.vertices;
    let opposite = opposites(corners.as_chunks::<3>().0, vertices)?;
    let halves = cotangent_weights(rest);
    let cotangent = |corner: u32| 2.0 * halves[corner as usize / 3][corner as usize % 3];
    let vertex = |corner: u32| corners[corner as usize];
    let mut list = Vec::new();
    for corner in 0..opposite.len() as u32 {
        let across = opposite[corner as usize];
        // none is the highest number; every other hinge is met from both sides
        if across >= opposite.len() as u32 || across < corner {
            continue;
        }
        let [start, end] = [next(corner), previous(corner)];
        let (mut far_start, mut far_end) = (next(across), previous(across));
        if vertex(far_start) != vertex(start) {
            core::mem::swap(&mut far_start, &mut far_end);
        }
        let (at_start, far_at_start) = (cotangent(start), cotangent(far_start));
        let (at_end, far_at_end) = (cotangent(end), cotangent(far_end));
        let hinge = [
            (vertex(start), at_end + far_at_end),
            (vertex(end), at_start + far_at_start),
            (vertex(corner), -at_start - at_end),
            (vertex(across), -far_at_start - far_at_end),
        ];
        let area = rest.measure[corner as usize / 3] + rest.measure[across as usize / 3];
        let scale = stiffness / area;
        for (i, &(a, p)) in hinge.iter().enumerate() {
            list.extend(hinge[..=i].iter().map(|&(b, q)| (a, b, scale * p * q)));
        }
    }
    Ok(list)
}

/// The area of every vertex: a third of each triangle's (in general: of each element's measure over its
/// number of corners).
pub fn vertex_measures(rest: &RestShape, vertices: usize) -> Vec<f64> {
    let mut shares = vec![0.0; vertices];
    let corners = rest.stretches + 1;
    for (e, measure) in rest.measure.iter().enumerate() {
        for &v in rest.simplex(e) {
            shares[v as usize] += measure / corners as f64;
        }
    }
    shares
}
