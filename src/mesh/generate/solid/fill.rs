//! Implicit solids of a wanted number of tetrahedra, in one piece.

use super::implicit::Implicit;
use super::stuffing::stuff;
use super::wish;
use crate::disjoint_sets::DisjointSets;
use crate::mesh::SolidMesh;
use glam::DVec3;

/// Looks for the spacing that gives the wanted number. `figure` makes the function of a solid whose
/// parts are nowhere thinner than a radius; `volume` is about that of the solid.
pub(super) fn stuffed(figure: fn(f64) -> Implicit, volume: f64, tetrahedra: usize) -> SolidMesh {
    // A lattice finds every part of a round stroke whose radius is more than √5/4 of the spacing, the
    // distance from its vertices that a point can have; a little more keeps the parts joined.
    const THICKNESS: [f64; 3] = [0.75, 0.7, 0.8];
    // Thicker than this, the parts would run into each other.
    const THICKEST: f64 = 0.17;
    const CLOSE: f64 = 0.04;
    let wanted = wish(tetrahedra).max(100.0);
    let fill = |spacing: f64, thickness: f64, shift: f64| -> SolidMesh {
        let solid = figure((thickness * spacing).min(THICKEST));
        let shift = DVec3::new(0.13, 0.29, 0.41) * (shift.fract() * spacing);
        let bounds = solid.bounds().map(|corner| corner + shift);
        let mesh = stuff(|p| solid.value(p), bounds, spacing).unwrap_or_default();
        largest_piece(mesh)
    };
    // The number grows with the inverse cube of the spacing, roughly. Where it jumps, because a part
    // appears or breaks off, ever farther neighbours of the best spacing are tried, with other
    // thicknesses and the lattice moved.
    let mut spacing = (12.0 * volume / wanted).cbrt();
    let mut best = (f64::INFINITY, spacing, SolidMesh::default());
    for attempt in 0..30 {
        let other = if attempt < 6 { 0 } else { attempt };
        let mesh = fill(spacing, THICKNESS[other % 3], 0.1 * other as f64);
        let ratio = mesh.simplices.len().max(1) as f64 / wanted;
        let miss = ratio.ln().abs();
        if miss < best.0 {
            best = (miss, spacing, mesh);
        }
        if best.0 < CLOSE {
            break;
        }
        spacing = match attempt {
            0..6 => spacing * ratio.cbrt().clamp(0.5, 2.0),
            _ if attempt % 2 == 0 => best.1 * (1.0 + 0.01 * (attempt - 4) as f64),
            _ => best.1 * (1.0 - 0.01 * (attempt - 4) as f64),
        };
    }
    best.2
}

/// The piece with the most tetrahedra; of equal ones the first.
fn largest_piece(mesh: SolidMesh) -> SolidMesh {
    let mut pieces = DisjointSets::new(mesh.positions.len());
    for &[a, b, c, d] in &mesh.simplices {
        for v in [b, c, d] {
            pieces.join(a, v);
        }
    }
    let mut sizes = vec![0usize; mesh.positions.len()];
    for tetrahedron in &mesh.simplices {
        sizes[pieces.find(tetrahedron[0]) as usize] += 1;
    }
    let most = sizes.iter().copied().max().unwrap_or(0);
    let Some(chosen) = sizes.iter().position(|&size| size == most) else {
        return mesh;
    };
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    let mut piece = SolidMesh::default();
    for v in 0..mesh.positions.len() {
        if pieces.find(v as u32) as usize == chosen {
            numbers[v] = piece.positions.len() as u32;
            piece.positions.push(mesh.positions[v]);
        }
    }
    for tetrahedron in &mesh.simplices {
        if numbers[tetrahedron[0] as usize] != u32::MAX {
            piece
                .simplices
                .push(tetrahedron.map(|v| numbers[v as usize]));
        }
    }
    piece
}
