//! Shapes without boundary: torus, sphere, rounded cube.

use super::{SurfaceMesh, push_quad, root, wish};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// A torus of radii 1 and 0.4, of nearly equilateral triangles in staggered rows.
pub(super) fn torus(triangles: usize) -> SurfaceMesh {
    const MINOR: f64 = 0.4;
    // Rows round the tube, an even number of them so that the stagger closes; the spacing within a
    // row is 2/√3 of the spacing of rows, at the tube's middle.
    let rows = root(wish(triangles) / 2.0 * MINOR * 2.0 / 3f64.sqrt(), 4).div_ceil(2) * 2;
    let columns = ((wish(triangles) / 2.0 / rows as f64).round() as usize).max(6);
    let mut mesh = SurfaceMesh::default();
    for row in 0..rows {
        let stagger = if row % 2 == 0 { 0.0 } else { 0.5 };
        let (s, c) = (TAU * row as f64 / rows as f64).sin_cos();
        for column in 0..columns {
            let (sin, cos) = (TAU * (column as f64 + stagger) / columns as f64).sin_cos();
            let radius = 1.0 + MINOR * c;
            mesh.positions
                .push(DVec3::new(radius * cos, radius * sin, MINOR * s));
        }
    }
    let vertex = |row: usize, column: usize| ((row % rows) * columns + column % columns) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (vertex(row, column), vertex(row, column + 1));
            let (c, d) = (vertex(row + 1, column), vertex(row + 1, column + 1));
            mesh.simplices.extend(if row % 2 == 0 {
                [[a, b, c], [b, d, c]]
            } else {
                [[a, d, c], [a, b, d]]
            });
        }
    }
    mesh
}

/// A unit sphere: an icosahedron, its faces divided n × n and pushed out (20·n² triangles).
pub(super) fn sphere(triangles: usize) -> SurfaceMesh {
    const T: f64 = 1.618_033_988_749_895;
    const CORNERS: [[f64; 3]; 12] = [
        [-1.0, T, 0.0],
        [1.0, T, 0.0],
        [-1.0, -T, 0.0],
        [1.0, -T, 0.0],
        [0.0, -1.0, T],
        [0.0, 1.0, T],
        [0.0, -1.0, -T],
        [0.0, 1.0, -T],
        [T, 0.0, -1.0],
        [T, 0.0, 1.0],
        [-T, 0.0, -1.0],
        [-T, 0.0, 1.0],
    ];
    #[rustfmt::skip]
    const FACES: [[usize; 3]; 20] = [
        [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
        [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
        [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
        [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
    ];
    let n = root(wish(triangles) / 20.0, 1);
    let mut mesh = SurfaceMesh::default();
    // Vertices on shared edges are found again by the two corners and the weight of the first.
    let mut shared: HashMap<[usize; 6], u32> = HashMap::new();
    for face in FACES {
        let mut row_starts = Vec::with_capacity(n + 1);
        let mut ids = Vec::new();
        for i in 0..=n {
            row_starts.push(ids.len());
            for j in 0..=n - i {
                let weights = [n - i - j, i, j];
                // The barycentric address, independent of the face that asks: sorted corners of
                // non-zero weight.
                let mut address: Vec<(usize, usize)> = (0..3)
                    .map(|k| (face[k], weights[k]))
                    .filter(|&(_, weight)| weight > 0)
                    .collect();
                address.sort_unstable();
                let mut key = [0; 6];
                for (k, &(corner, weight)) in address.iter().enumerate() {
                    key[2 * k] = corner + 1;
                    key[2 * k + 1] = weight;
                }
                let id = *shared.entry(key).or_insert_with(|| {
                    let mut point = DVec3::ZERO;
                    for &(corner, weight) in &address {
                        point += DVec3::from_array(CORNERS[corner]) * weight as f64;
                    }
                    mesh.positions.push(point.normalize());
                    (mesh.positions.len() - 1) as u32
                });
                ids.push(id);
            }
        }
        for i in 0..n {
            for j in 0..n - i {
                let (a, b) = (ids[row_starts[i] + j], ids[row_starts[i] + j + 1]);
                let c = ids[row_starts[i + 1] + j];
                mesh.simplices.push([a, c, b]);
                if j + 1 < n - i {
                    mesh.simplices.push([b, c, ids[row_starts[i + 1] + j + 1]]);
                }
            }
        }
    }
    mesh
}

/// A cube of side 2 whose edges are rounded with radius 0.35 (12·n² triangles).
pub(super) fn rounded_cube(triangles: usize) -> SurfaceMesh {
    const RADIUS: f64 = 0.35;
    let n = root(wish(triangles) / 12.0, 2);
    let mut mesh = SurfaceMesh::default();
    let push = |mesh: &mut SurfaceMesh, i: usize, j: usize, k: usize| {
        let cube = DVec3::new(i as f64, j as f64, k as f64) * (2.0 / n as f64) - DVec3::ONE;
        let inner = cube.clamp(DVec3::splat(RADIUS - 1.0), DVec3::splat(1.0 - RADIUS));
        mesh.positions
            .push(inner + (cube - inner).normalize() * RADIUS);
    };
    // Lattice points of the cube's surface: the bottom, then ring by ring, then the top.
    let ring = |step: usize| match (step / n, step % n) {
        (0, s) => (s, 0),
        (1, s) => (n, s),
        (2, s) => (n - s, n),
        (_, s) => (0, n - s),
    };
    for k in [0, n] {
        if k == n {
            for height in 1..n {
                for step in 0..4 * n {
                    let (i, j) = ring(step);
                    push(&mut mesh, i, j, height);
                }
            }
        }
        for j in 0..=n {
            for i in 0..=n {
                push(&mut mesh, i, j, k);
            }
        }
    }
    let plate = (n + 1) * (n + 1);
    let vertex = |i: usize, j: usize, k: usize| -> u32 {
        let id = if k == 0 {
            j * (n + 1) + i
        } else if k == n {
            plate + (n - 1) * 4 * n + j * (n + 1) + i
        } else {
            let step = if j == 0 {
                i
            } else if i == n {
                n + j
            } else if j == n {
                2 * n + (n - i)
            } else {
                3 * n + (n - j)
            };
            plate + (k - 1) * 4 * n + step % (4 * n)
        };
        id as u32
    };
    for a in 0..n {
        for b in 0..n {
            let (c, d) = (a + 1, b + 1);
            for quad in [
                [
                    vertex(a, b, 0),
                    vertex(a, d, 0),
                    vertex(c, d, 0),
                    vertex(c, b, 0),
                ],
                [
                    vertex(a, b, n),
                    vertex(c, b, n),
                    vertex(c, d, n),
                    vertex(a, d, n),
                ],
                [
                    vertex(a, 0, b),
                    vertex(c, 0, b),
                    vertex(c, 0, d),
                    vertex(a, 0, d),
                ],
                [
                    vertex(a, n, b),
                    vertex(a, n, d),
                    vertex(c, n, d),
                    vertex(c, n, b),
                ],
                [
                    vertex(0, a, b),
                    vertex(0, a, d),
                    vertex(0, c, d),
                    vertex(0, c, b),
                ],
                [
                    vertex(n, a, b),
                    vertex(n, c, b),
                    vertex(n, c, d),
                    vertex(n, a, d),
                ],
            ] {
                push_quad(&mut mesh, quad);
            }
        }
    }
    mesh
}
