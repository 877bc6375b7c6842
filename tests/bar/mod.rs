//! Bars of tetrahedra.
#![allow(dead_code)] // not every test uses all

use foldfree::mesh::SolidMesh;
use glam::{DMat3, DVec3};

/// A bar of cubes, five tetrahedra each, along x.
pub fn bar(nx: usize, n: usize) -> SolidMesh {
    let at = |x: usize, y: usize, z: usize| ((z * (n + 1) + y) * (nx + 1) + x) as u32;
    let mut mesh = SolidMesh::default();
    for v in 0..(nx + 1) * (n + 1) * (n + 1) {
        let (x, y, z) = (v % (nx + 1), v / (nx + 1) % (n + 1), v / (nx + 1) / (n + 1));
        mesh.positions
            .push(DVec3::new(x as f64, y as f64, z as f64) / n as f64);
    }
    for cell in 0..nx * n * n {
        let (x, y, z) = (cell % nx, cell / nx % n, cell / nx / n);
        let c = |i: usize| at(x + i % 2, y + i / 2 % 2, z + i / 4);
        let even = [
            [0, 1, 2, 4],
            [3, 2, 1, 7],
            [5, 4, 7, 1],
            [6, 7, 4, 2],
            [1, 4, 2, 7],
        ];
        let odd = [
            [1, 3, 0, 5],
            [2, 0, 3, 6],
            [4, 5, 6, 0],
            [7, 6, 5, 3],
            [0, 3, 5, 6],
        ];
        let five = if (x + y + z) % 2 == 0 { even } else { odd };
        for t in five {
            let [a, b, d, e] = t.map(c);
            let p = |v: u32| mesh.positions[v as usize];
            let volume = DMat3::from_cols(p(b) - p(a), p(d) - p(a), p(e) - p(a)).determinant();
            mesh.simplices.push(if volume > 0.0 {
                [a, b, d, e]
            } else {
                [a, b, e, d]
            });
        }
    }
    mesh
}

/// The bar twisted by `angle` along its length, and its two ends.
pub fn twisted(mesh: &SolidMesh, angle: f64) -> (Vec<DVec3>, Vec<u32>) {
    let length = mesh.positions.iter().fold(0.0f64, |a, p| a.max(p.x));
    let start = mesh.positions.iter().map(|&p| {
        let centre = DVec3::new(0.0, 0.5, 0.5);
        DMat3::from_rotation_x(angle * p.x / length) * (p - centre) + centre
    });
    let end = |&v: &u32| {
        let x = mesh.positions[v as usize].x;
        x == 0.0 || x == length
    };
    let pins = (0..mesh.positions.len() as u32).filter(end).collect();
    (start.collect(), pins)
}
