//! The failure case of the paper (§8.1, table 2), generated: a wheel with spikes whose surface is smoothed, step by
//! step, while the body keeps its rest shape; the spikes are left less and less room.

use super::{Inside, Tangle, place};
use foldfree::geometry::RestShape;
use foldfree::mesh::SolidMesh;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Cells from the hub to the rim, around, and across; the levels of a spike, and the cells around between two of them.
const RINGS: i32 = 3;
const AROUND: i32 = 48;
const ACROSS: i32 = 4;
const LEVELS: i32 = 6;
const PERIOD: i32 = 4;

/// Where a lattice point is: (ring or level, around, across). Points of spikes come nearer to the middle of their spike.
fn point([ring, around, across]: [i32; 3]) -> DVec3 {
    let along = f64::from(around);
    let height = f64::from(across) / f64::from(ACROSS) - 0.5;
    let (radius, along, height) = if ring <= RINGS {
        let radius = 0.5 + 0.5 * f64::from(ring) / f64::from(RINGS);
        (radius, along, height)
    } else {
        let level = f64::from(ring - RINGS) / f64::from(LEVELS);
        let narrower = 1.0 - 0.9 * level;
        // the middle of the two cells around and of the two across that it stands on
        let middle = f64::from(around.div_euclid(PERIOD) * PERIOD) + 1.0;
        let along = middle + narrower * (along - middle);
        (1.0 + 0.8 * level, along, narrower * height)
    };
    let angle = TAU * along / f64::from(AROUND);
    DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.6 * height)
}

/// Hexahedra, each of twelve tetrahedra around its middle; so every tetrahedron has a vertex inside.
fn wheel() -> SolidMesh {
    let mut cells = Vec::new();
    for around in 0..AROUND {
        for across in 0..ACROSS {
            cells.extend((0..RINGS).map(|ring| [ring, around, across]));
            if around % PERIOD < 2 && (1..3).contains(&across) {
                cells.extend((RINGS..RINGS + LEVELS).map(|ring| [ring, around, across]));
            }
        }
    }
    let mut mesh = SolidMesh::default();
    let mut number = BTreeMap::new();
    for cell in cells {
        let mut corner = |bits: usize| {
            let mut at: [i32; 3] = std::array::from_fn(|i| cell[i] + (bits >> i & 1) as i32);
            let here = point(at);
            at[1] %= AROUND;
            *number.entry(at).or_insert_with(|| {
                mesh.positions.push(here);
                mesh.positions.len() as u32 - 1
            })
        };
        let corners: [u32; 8] = std::array::from_fn(&mut corner);
        let middle = mesh.positions.len() as u32;
        let sum: DVec3 = corners.iter().map(|&v| mesh.positions[v as usize]).sum();
        mesh.positions.push(sum / 8.0);
        // seen from outside counter-clockwise
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        for face in faces {
            let mut quad = face.map(|c: usize| corners[c]);
            // the diagonal from the lowest number on, the same for the cell on the other side
            let lowest = (0..4).min_by_key(|&i| quad[i]).unwrap_or(0);
            quad.rotate_left(lowest);
            for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
                mesh.simplices.push([middle, quad[a], quad[b], quad[c]]);
            }
        }
    }
    mesh
}

/// The wheel, its surface smoothed so many times (every vertex moves to the mean of its neighbours on the surface) and
/// held there, and everything else where it was at rest (`Inside::Harmonic`: harmonic, and so on).
pub fn spiked_wheel(smoothings: usize, inside: Option<Inside>) -> Tangle<4> {
    let rest = wheel();
    let (shape, turned) = RestShape::of_solid(&rest).expect("a solid");
    assert!(!turned);
    let surface = rest.boundary().expect("a surface");
    let mut neighbours: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut is_pinned = vec![false; rest.positions.len()];
    for t in &surface.mesh.simplices {
        let t = t.map(|v| surface.vertices[v as usize]);
        for k in 0..3 {
            neighbours.entry(t[k]).or_default().push(t[(k + 1) % 3]);
            is_pinned[t[k] as usize] = true;
        }
    }
    let mut images = rest.positions.clone();
    for _ in 0..smoothings {
        let before = images.clone();
        for (&v, around) in &neighbours {
            let sum: DVec3 = around.iter().map(|&w| before[w as usize]).sum();
            images[v as usize] = sum / around.len() as f64;
        }
    }
    if let Some(inside) = inside {
        return place(rest, &shape, images, is_pinned, inside, 1);
    }
    let pins = (0..).zip(&is_pinned).filter(|pin| *pin.1);
    Tangle {
        pins: pins.map(|pin| pin.0).collect(),
        start: images,
        rest,
    }
}
