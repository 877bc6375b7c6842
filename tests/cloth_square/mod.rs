//! Rectangles of cloth.
#![allow(dead_code)]

use foldfree::mesh::SurfaceMesh;
use glam::DVec3;

/// A rectangle in the plane z = 0 of `columns` × `rows` quads of that size, divided along alternating
/// diagonals.
pub fn rectangle(columns: usize, rows: usize, size: f64) -> SurfaceMesh {
    let mut mesh = SurfaceMesh::default();
    for j in 0..=rows {
        let point = |i: usize| size * DVec3::new(i as f64, j as f64, 0.0);
        mesh.positions.extend((0..=columns).map(point));
    }
    let at = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    for j in 0..rows {
        for i in 0..columns {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.simplices.extend(match (i + j) % 2 {
                0 => [[a, b, d], [b, c, d]],
                _ => [[a, b, c], [a, c, d]],
            });
        }
    }
    mesh
}

/// The unit square of n × n quads.
pub fn square(n: usize) -> SurfaceMesh {
    rectangle(n, n, 1.0 / n as f64)
}

/// Its corners.
pub fn corners(n: usize) -> Vec<u32> {
    [0, n, n * (n + 1), n * (n + 2)].map(|v| v as u32).to_vec()
}

/// The square with its corners drawn together by 5 % and wrinkles all over, of up to 10 cm.
pub fn wrinkled(mesh: &SurfaceMesh, corners: &[u32]) -> Vec<DVec3> {
    let middle = DVec3::new(0.5, 0.5, 0.0);
    let wrinkle = |p: &DVec3| {
        let corner = |&c: &u32| mesh.positions[c as usize].distance_squared(*p);
        let fade: f64 = corners
            .iter()
            .map(|c| 1.0 - (-25.0 * corner(c)).exp())
            .product();
        let (x, y) = (12.0 * p.x, 12.0 * p.y);
        let wrinkle = DVec3::new(
            (y + 1.0).sin() * (0.7 * x).cos(),
            x.sin() * (0.5 * y + 2.0).cos(),
            1.5 * (0.8 * x + 0.3).sin() * (0.6 * y + 0.5).sin(),
        );
        middle + 0.95 * (*p - middle) + 0.1 * fade * wrinkle
    };
    mesh.positions.iter().map(wrinkle).collect()
}
