//! Regular solids: boxes of cubes, each five tetrahedra, and a round plate of prisms.

use super::{hexagonal_disk, wish};
use crate::mesh::SolidMesh;
use glam::DVec3;

/// A box of length 2 along x and `slenderness` times less in y and z: k × k cells across, as many
/// along as the number of tetrahedra wants.
pub(super) fn bar(slenderness: f64, tetrahedra: usize) -> SolidMesh {
    let cells = wish(tetrahedra) / 5.0;
    let across = (cells / slenderness).cbrt().round().max(1.0);
    let along = (cells / (across * across)).round().max(1.0);
    let size = DVec3::new(1.0, 1.0 / slenderness, 1.0 / slenderness) * 2.0;
    block([along as usize, across as usize, across as usize], size)
}

/// A box of cells. A cell is a tetrahedron of every other of its corners and the four it leaves over; the
/// corners alternate from cell to cell, so that diagonals of neighbours match.
fn block([nx, ny, nz]: [usize; 3], size: DVec3) -> SolidMesh {
    let mut mesh = SolidMesh::default();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let share = |i: usize, n: usize| i as f64 / n as f64 - 0.5;
                let at = DVec3::new(share(i, nx), share(j, ny), share(k, nz));
                mesh.positions.push(at * size);
            }
        }
    }
    // Corners of a cell as bits x, y, z; each cut-off corner with its three neighbours.
    const EVEN: [[usize; 4]; 5] = [
        [0, 3, 5, 6],
        [1, 3, 0, 5],
        [2, 0, 3, 6],
        [4, 0, 6, 5],
        [7, 3, 6, 5],
    ];
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let mirrored = (i + j + k) % 2;
                let vertex = |corner: usize| {
                    // The other half of the corners: mirrored in x, which turns tetrahedra over.
                    let (x, y, z) = ((corner ^ mirrored) & 1, corner >> 1 & 1, corner >> 2);
                    ((i + x) + (nx + 1) * ((j + y) + (ny + 1) * (k + z))) as u32
                };
                for tetrahedron in EVEN {
                    let [a, b, c, d] = tetrahedron.map(vertex);
                    mesh.simplices.push([a, b, c, d]);
                }
            }
        }
    }
    orient(&mut mesh);
    mesh
}

/// A round plate of radius 1 and thickness 0.2: a disk of triangles in layers of prisms.
pub(super) fn disk(tetrahedra: usize) -> SolidMesh {
    const THICKNESS: f64 = 0.2;
    // 18·rings²·layers tetrahedra, layers as high as rings are wide.
    let count = wish(tetrahedra) / 18.0;
    let layers = (count * THICKNESS * THICKNESS).cbrt().round().max(1.0);
    let rings = (count / layers).sqrt().round().max(2.0);
    let disk = hexagonal_disk(rings as usize, |radius, angle| {
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    });
    let stride = disk.positions.len() as u32;
    let mut mesh = SolidMesh::default();
    for layer in 0..=layers as usize {
        let z = THICKNESS * (layer as f64 / layers - 0.5);
        let lifted = disk.positions.iter().map(|&p| p + DVec3::Z * z);
        mesh.positions.extend(lifted);
    }
    for layer in 0..layers as u32 {
        for &(mut triangle) in &disk.simplices {
            // Diagonals rise from the lower to the higher index: the same from both sides of a wall.
            triangle.sort_unstable();
            let [a, b, c] = triangle.map(|v| v + layer * stride);
            let [x, y, z] = [a, b, c].map(|v| v + stride);
            mesh.simplices
                .extend([[a, b, c, z], [a, b, y, z], [a, x, y, z]]);
        }
    }
    orient(&mut mesh);
    mesh
}

/// Turns tetrahedra of negative volume over.
fn orient(mesh: &mut SolidMesh) {
    for tetrahedron in &mut mesh.simplices {
        let [a, b, c, d] = tetrahedron.map(|v| mesh.positions[v as usize]);
        if (b - a).cross(c - a).dot(d - a) < 0.0 {
            tetrahedron.swap(2, 3);
        }
    }
}
