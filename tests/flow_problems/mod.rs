//! Bodies whose wanted boundary passes through itself.
#![allow(dead_code)]

use crate::overlap_problems::{block, cubes, point, squares};
use foldfree::mesh::SimplicialMesh;
use glam::DVec3;

/// A body at rest, and where its vertices are wanted.
#[derive(Clone)]
pub struct Wanted<const K: usize> {
    pub rest: SimplicialMesh<K>,
    pub start: Vec<DVec3>,
}

impl<const K: usize> Wanted<K> {
    fn new(rest: SimplicialMesh<K>, place: impl Fn(DVec3) -> DVec3) -> Self {
        let start = rest.positions.iter().map(|&p| place(p)).collect();
        Self { rest, start }
    }

    /// In other units, turned, and elsewhere.
    pub fn moved(&self, to: impl Fn(DVec3) -> DVec3) -> Self {
        let all = |points: &[DVec3]| points.iter().map(|&p| to(p)).collect();
        Self {
            rest: SimplicialMesh {
                positions: all(&self.rest.positions),
                simplices: self.rest.simplices.clone(),
            },
            start: all(&self.start),
        }
    }

    /// Vertex v becomes `to[v]`.
    pub fn renumbered(&self, to: &[u32]) -> Self {
        let all = |points: &[DVec3]| {
            let mut new = points.to_vec();
            points
                .iter()
                .zip(to)
                .for_each(|(&p, &v)| new[v as usize] = p);
            new
        };
        let simplices = self.rest.simplices.iter();
        Self {
            rest: SimplicialMesh {
                positions: all(&self.rest.positions),
                simplices: simplices.map(|s| s.map(|v| to[v as usize])).collect(),
            },
            start: all(&self.start),
        }
    }
}

/// (x, y) on a ring around the origin: x is the way along the radius `middle`, y goes inward.
fn around(x: f64, y: f64, middle: f64) -> (f64, f64) {
    let (sin, cos) = (x / middle).sin_cos();
    ((middle - y) * sin, -(middle - y) * cos)
}

/// A bar of 12 × 1 × 1, bent to `turns` of a ring, with more than one of which its ends pass through each other; one
/// end is `lift` higher than the other.
pub fn bent_bar(fine: i32, turns: f64, lift: f64) -> Wanted<4> {
    let cells = block([-6, 0, 0], [6, 1, 1], fine, 0);
    let rest = cubes(&cells, |at, _| point(at, fine) - DVec3::new(0.0, 0.5, 0.5));
    let middle = 12.0 / (std::f64::consts::TAU * turns);
    Wanted::new(rest, |p| {
        let (x, y) = around(p.x, p.y, middle);
        DVec3::new(x, y, p.z + lift * p.x / 12.0)
    })
}

/// The same in the plane.
pub fn bent_strip(fine: i32, turns: f64) -> Wanted<3> {
    let cells = block([-6, 0], [6, 1], fine, 0);
    let rest = squares(&cells, |[x, y], _| {
        point([x, y, 0], fine) - DVec3::new(0.0, 0.5, 0.0)
    });
    let middle = 12.0 / (std::f64::consts::TAU * turns);
    Wanted::new(rest, |p| {
        let (x, y) = around(p.x, p.y, middle);
        DVec3::new(x, y, 0.0)
    })
}

/// A palm with three fingers, bent so far that their tips are in the palm.
pub fn fist(fine: i32) -> Wanted<4> {
    let mut cells = block([0, 0, 0], [5, 4, 1], fine, 0);
    for finger in [0, 2, 4] {
        cells.extend(block([finger, 4, 0], [finger + 1, 10, 1], fine, 0));
    }
    let rest = cubes(&cells, |at, _| point(at, fine));
    Wanted::new(rest, |p| match p.y > 4.0 {
        // around an axis 0.6 above the palm's upper side
        true => {
            let (y, z) = around(p.y - 4.0, p.z - 0.5, 1.1);
            DVec3::new(p.x, 4.0 + y, 1.6 + z)
        }
        false => p,
    })
}

/// Two boxes, the smaller one inside the other.
pub fn nested_boxes() -> Wanted<4> {
    let mut cells = block([0; 3], [3; 3], 1, 0);
    cells.extend(block([0; 3], [1; 3], 1, 1));
    let rest = cubes(&cells, |at, part| {
        point(at, 1) + f64::from(part) * DVec3::splat(4.0)
    });
    Wanted::new(rest, |p| match p.x >= 4.0 {
        true => DVec3::splat(1.2) + 0.5 * (p - DVec3::splat(4.0)),
        false => p,
    })
}

/// A box with a cavity, which is wanted `by` to the side of where it is.
pub fn hollow_box(by: f64) -> Wanted<4> {
    let mut cells = block([0; 3], [6; 3], 1, 0);
    cells.retain(|(cell, _)| !cell.iter().all(|&i| i == 2 || i == 3));
    let rest = cubes(&cells, |at, _| point(at, 2) - DVec3::splat(1.5));
    Wanted::new(rest, |p| match p.abs().max_element() <= 0.5 {
        true => p + by * DVec3::X,
        false => p,
    })
}

/// The same in the plane.
pub fn hollow_square(by: f64) -> Wanted<3> {
    let mut cells = block([0; 2], [6; 2], 1, 0);
    cells.retain(|(cell, _)| !cell.iter().all(|&i| i == 2 || i == 3));
    let rest = squares(&cells, |[x, y], _| {
        point([x, y, 0], 2) - DVec3::new(1.5, 1.5, 0.0)
    });
    Wanted::new(rest, |p| match p.abs().max_element() <= 0.5 {
        true => p + by * DVec3::X,
        false => p,
    })
}
