//! Shapes that are disks: bumpy cap, terrain, spiral ramp, flat sheets.

use super::{SurfaceMesh, push_quad, root, spherical, wish};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A hexagonal disk of `rings` rings (ring k has 6k vertices, 6·rings² triangles), each vertex
/// placed by `place(radius in 0..=1, angle)`.
pub(super) fn hexagonal_disk(rings: usize, place: impl Fn(f64, f64) -> DVec3) -> SurfaceMesh {
    let start = |k: usize| if k == 0 { 0 } else { 1 + 3 * k * (k - 1) };
    let mut mesh = SurfaceMesh::default();
    mesh.positions.push(place(0.0, 0.0));
    for k in 1..=rings {
        for j in 0..6 * k {
            let angle = TAU * j as f64 / (6 * k) as f64;
            mesh.positions.push(place(k as f64 / rings as f64, angle));
        }
    }
    let vertex = |k: usize, j: usize| (start(k) + if k == 0 { 0 } else { j % (6 * k) }) as u32;
    for k in 1..=rings {
        for sector in 0..6 {
            for j in 0..k {
                let outer = vertex(k, sector * k + j);
                let outer_next = vertex(k, sector * k + j + 1);
                let inner = vertex(k - 1, sector * (k - 1) + j);
                mesh.simplices.push([outer, outer_next, inner]);
                if j + 1 < k {
                    let inner_next = vertex(k - 1, sector * (k - 1) + j + 1);
                    mesh.simplices.push([inner, outer_next, inner_next]);
                }
            }
        }
    }
    mesh
}

/// A spherical cap that reaches below its equator (120° from the pole), with twenty-four bumps and dents
/// pushed along the normal.
pub(super) fn bumpy_cap(triangles: usize) -> SurfaceMesh {
    const REACH: f64 = 120.0 / 180.0 * PI;
    const BUMPS: usize = 24;
    // Centres on a golden spiral, evenly spread over the cap; heights alternate two up, one down.
    let bumps: Vec<(DVec3, f64)> = (0..BUMPS)
        .map(|i| {
            let t = (i as f64 + 0.5) / BUMPS as f64;
            let polar = (1.0 - t * (1.0 - REACH.cos())).acos();
            let longitude = TAU * 0.618_033_988_749_895 * i as f64;
            let height = if i % 3 == 2 { -0.18 } else { 0.36 };
            (spherical(polar, longitude), height)
        })
        .collect();
    hexagonal_disk(root(wish(triangles) / 6.0, 2), |radius, angle| {
        let direction = spherical(radius * REACH, angle);
        let mut height = 1.0;
        for (centre, bump) in &bumps {
            height += bump * (-direction.distance_squared(*centre) / (0.24 * 0.24)).exp();
        }
        direction * height
    })
}

/// A square landscape: a few octaves of smooth value noise.
pub(super) fn terrain(triangles: usize) -> SurfaceMesh {
    let side = root(wish(triangles) / 2.0, 2);
    grid(side, side, |s, t| {
        let (x, y) = (2.0 * s - 1.0, 2.0 * t - 1.0);
        let mut height = 0.0;
        let (mut frequency, mut amplitude) = (1.5, 0.22);
        for octave in 0..4 {
            height += amplitude * value_noise(x * frequency, y * frequency, octave);
            frequency *= 2.0;
            amplitude *= 0.36;
        }
        DVec3::new(x, y, height)
    })
}

/// A flat square of side 2, its diagonals alternating so that it bends alike to all sides.
pub(super) fn sheet(triangles: usize) -> SurfaceMesh {
    // With an even number of quads the pattern is symmetric.
    let side = root(wish(triangles) / 8.0, 1) * 2;
    grid(side, side, |s, t| {
        DVec3::new(2.0 * s - 1.0, 2.0 * t - 1.0, 0.0)
    })
}

/// A flat square of side 1 at the origin, all cells split along the diagonal from (0, 0) to (1, 1).
pub(super) fn unit_grid(triangles: usize) -> SurfaceMesh {
    let side = root(wish(triangles) / 2.0, 1);
    let mut mesh = grid(side, side, |s, t| DVec3::new(s, t, 0.0));
    mesh.simplices.clear();
    for row in 0..side {
        for column in 0..side {
            let v = (row * (side + 1) + column) as u32;
            let above = v + side as u32 + 1;
            let cell = [[v, v + 1, above + 1], [v, above + 1, above]];
            mesh.simplices.extend(cell);
        }
    }
    mesh
}

/// A flat disk of radius 1.
pub(super) fn round_sheet(triangles: usize) -> SurfaceMesh {
    hexagonal_disk(root(wish(triangles) / 6.0, 2), |radius, angle| {
        DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
    })
}

/// A helical ramp of 1.6 turns, a little hilly across.
pub(super) fn spiral_ramp(triangles: usize) -> SurfaceMesh {
    const TURNS: f64 = 1.6;
    const INNER: f64 = 0.45;
    const OUTER: f64 = 1.0;
    const PITCH: f64 = 0.55;
    // Square quads at the middle radius.
    let length = TURNS * TAU * 0.5 * (INNER + OUTER);
    let across = root(wish(triangles) / 2.0 * (OUTER - INNER) / length, 2);
    let along = ((wish(triangles) / 2.0 / across as f64).round() as usize).max(12);
    grid(along, across, |s, t| {
        let angle = TURNS * TAU * s;
        let radius = OUTER - (OUTER - INNER) * t;
        DVec3::new(
            radius * angle.cos(),
            radius * angle.sin(),
            // The surface is oriented upwards: as the angle grows the radius shrinks.
            PITCH * TURNS * s + 0.02 * (PI * t).sin() * (5.0 * angle).sin(),
        )
    })
}

/// A grid of `columns` × `rows` quads over the unit square.
fn grid(columns: usize, rows: usize, place: impl Fn(f64, f64) -> DVec3) -> SurfaceMesh {
    let mut mesh = SurfaceMesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            let (s, t) = (column as f64 / columns as f64, row as f64 / rows as f64);
            mesh.positions.push(place(s, t));
        }
    }
    let vertex = |column: usize, row: usize| (row * (columns + 1) + column) as u32;
    for row in 0..rows {
        for column in 0..columns {
            let quad = [
                vertex(column, row),
                vertex(column + 1, row),
                vertex(column + 1, row + 1),
                vertex(column, row + 1),
            ];
            push_quad(&mut mesh, quad);
        }
    }
    mesh
}

/// Smooth noise in −1..=1: random values at whole coordinates, blended with quintic weights.
fn value_noise(x: f64, y: f64, octave: u32) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v) = (fade(x - i), fade(y - j));
    let value = |di: i64, dj: i64| lattice(i as i64 + di, j as i64 + dj, octave);
    let bottom = value(0, 0) * (1.0 - u) + value(1, 0) * u;
    let top = value(0, 1) * (1.0 - u) + value(1, 1) * u;
    bottom * (1.0 - v) + top * v
}

/// A fixed pseudo-random number in −1..=1 for a lattice point (the finaliser of MurmurHash3).
fn lattice(i: i64, j: i64, octave: u32) -> f64 {
    let mut h = (i as u32)
        .wrapping_mul(0x9E37_79B1)
        .wrapping_add((j as u32).wrapping_mul(0x85EB_CA77))
        .wrapping_add(octave.wrapping_mul(0xC2B2_AE3D))
        .wrapping_add(0x27D4_EB2F);
    h = (h ^ (h >> 16)).wrapping_mul(0x85EB_CA6B);
    h = (h ^ (h >> 13)).wrapping_mul(0xC2B2_AE35);
    h ^= h >> 16;
    f64::from(h) / f64::from(u32::MAX) * 2.0 - 1.0
}
