//! Problems that no constant of the solver was chosen on.

use super::{Moves, block, cubes, point, squares};
use glam::DVec3;

/// Two square rings, one through the other, pulled apart until both are stretched.
pub fn linked_rings(fine: i32) -> Moves<4> {
    let ring = |part: u8| {
        let mut cells = block([0, 0, 0], [5, 5, 1], fine, part);
        let inside = |c: i32| (fine..4 * fine).contains(&c);
        cells.retain(|(cell, _)| !(inside(cell[0]) && inside(cell[1])));
        cells
    };
    let mut cells = ring(0);
    cells.extend(ring(1));
    let rest = cubes(&cells, |at, part| {
        let p = point(at, fine);
        match part {
            0 => p,
            // upright, and its near side in the middle of the other
            _ => DVec3::new(p.x + 2.1, 3.04 - p.z, p.y - 2.03),
        }
    });
    Moves::new(rest)
        .hold(|p| p.x == 0.0 || p.x == 7.1)
        .then(|p| if p.x > 6.0 { p + 1.5 * DVec3::X } else { p })
        .then(|p| if p.x > 6.0 { p + 3.0 * DVec3::X } else { p })
}

/// Two combs, teeth between teeth, pushed together and then sideways.
pub fn combs(fine: i32) -> Moves<4> {
    let mut cells = block([0, 0, 0], [7, 1, 1], fine, 0);
    for tooth in 0..4 {
        cells.extend(block([2 * tooth, 1, 0], [2 * tooth + 1, 4, 1], fine, 0));
    }
    let other: Vec<_> = cells.iter().map(|(cell, _)| (*cell, 1)).collect();
    cells.extend(other);
    let rest = cubes(&cells, |at, part| {
        let p = point(at, fine) * DVec3::new(0.9, 1.0, 1.0);
        match part {
            0 => p,
            _ => DVec3::new(7.23 - p.x, 8.1 - p.y, p.z + 0.03),
        }
    });
    let top = |p: DVec3| p.y > 8.0;
    let go = |p: DVec3, by: DVec3| if top(p) { p + by } else { p };
    Moves::new(rest)
        .hold(|p| p.y == 0.0 || top(p))
        .then(|p| go(p, DVec3::new(0.0, -2.0, 0.0)))
        .then(|p| go(p, DVec3::new(0.8, -2.0, 0.0)))
        .then(|p| go(p, DVec3::new(1.5, -2.5, 0.2)))
}

/// A peg that is a little too wide, pushed into the hole of a plate.
pub fn peg(fine: i32) -> Moves<4> {
    let mut cells = block([0, 0, 0], [3, 3, 1], fine, 0);
    let inside = |c: i32| (fine..2 * fine).contains(&c);
    cells.retain(|(cell, _)| !(inside(cell[0]) && inside(cell[1])));
    cells.extend(block([1, 1, 1], [2, 2, 3], fine, 1));
    let rest = cubes(&cells, |at, part| {
        let p = point(at, fine);
        match part {
            0 => p,
            _ => {
                // pointed, and wider than the hole behind the point
                let wide = 0.7 + 0.5 * (p.z - 1.0).min(1.0);
                let middle = DVec3::new(1.5, 1.5, 0.0);
                let q = p - middle;
                middle + DVec3::new(wide * q.x + 0.03, wide * q.y - 0.02, q.z + 0.05)
            }
        }
    });
    let top = |p: DVec3| p.z > 3.0;
    let outer = |p: DVec3| p.z < 1.5 && (p.x == 0.0 || p.x == 3.0 || p.y == 0.0 || p.y == 3.0);
    let go = |p: DVec3, by: f64| if top(p) { p - by * DVec3::Z } else { p };
    Moves::new(rest)
        .hold(|p| outer(p) || top(p))
        .then(|p| go(p, 0.5))
        .then(|p| go(p, 1.0))
        .then(|p| go(p, 1.5))
}

/// A slender beam whose ends come together until it lies on itself.
pub fn buckling_beam(fine: i32) -> Moves<4> {
    let cells = block([-5, 0, 0], [5, 1, 1], fine, 0);
    let rest = cubes(&cells, |at, _| {
        let p = point(at, fine);
        // bent a little to begin with, so that it knows where to go
        p + DVec3::new(0.0, 0.02 * (p.x * p.x - 25.0) / 25.0, 0.01 * p.x)
    });
    let mut problem = Moves::new(rest).hold(|p| p.x.abs() == 5.0);
    for k in 1..=4 {
        let part = 1.0 - 0.22 * f64::from(k);
        problem = problem.then(|p| DVec3::new(part * p.x, p.y, p.z));
    }
    problem
}

/// A plate between two others, all three pressed together and sheared.
pub fn stack(fine: i32) -> Moves<4> {
    let mut cells = Vec::new();
    for part in 0..3u8 {
        let z = i32::from(part);
        cells.extend(block([0, 0, z], [3, 3, z + 1], fine, part));
    }
    let rest = cubes(&cells, |at, part| {
        let gap = f64::from(part);
        point(at, fine) + gap * DVec3::new(0.07, -0.05, 0.1)
    });
    let top = |p: DVec3| p.z > 3.1;
    let go = |p: DVec3, by: DVec3| if top(p) { p + by } else { p };
    Moves::new(rest)
        .hold(|p| p.z == 0.0 || top(p))
        .then(|p| go(p, DVec3::new(0.0, 0.0, -0.8)))
        .then(|p| go(p, DVec3::new(0.8, 0.4, -0.8)))
}

/// Two wheels with teeth, in the plane; one is turned by its hub, the other's hub is held.
pub fn gears_in_the_plane(fine: i32) -> Moves<3> {
    let (rings, around) = (3 * fine, 24 * fine);
    let mut cells = Vec::new();
    for part in 0..2u8 {
        for j in 0..around {
            let is_tooth = (j / (2 * fine)) % 2 == 0;
            let height = if is_tooth { rings + fine } else { rings };
            cells.extend((0..height).map(|i| ([i, j], part)));
        }
    }
    let angle = |j: i32| std::f64::consts::TAU * f64::from(j) / f64::from(around);
    let hub = |part: u8| DVec3::new(2.44 * f64::from(part), 0.0, 0.0);
    let mut rest = squares(&cells, |[i, j], part| {
        let r = 0.3 + f64::from(i) / f64::from(rings) * 0.7;
        // a tooth of the one faces a gap of the other
        let turn = if part == 0 {
            0.0
        } else {
            angle(2 * fine) + 0.01
        };
        let a = angle(j) - angle(fine) + turn;
        hub(part) + r * DVec3::new(a.cos(), a.sin(), 0.0)
    });
    close(&mut rest);
    let is_hub = |p: DVec3| (0..2).any(|k| ((p - hub(k)).length() - 0.3).abs() < 1e-9);
    let turned = |p: DVec3, by: f64| {
        if p.x > 1.0 {
            return p;
        }
        let (s, c) = f64::sin_cos(by);
        DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, 0.0)
    };
    Moves::new(rest)
        .hold(is_hub)
        .then(|p| turned(p, 0.8))
        .then(|p| turned(p, 1.6))
        .then(|p| turned(p, 2.4))
}

/// Joins vertices in the same place: the last column of a ring is its first.
fn close(mesh: &mut foldfree::mesh::SurfaceMesh) {
    let mut kept: Vec<DVec3> = Vec::new();
    let mut number = Vec::new();
    for p in &mesh.positions {
        let known = kept.iter().position(|q| p.distance(*q) < 1e-9);
        number.push(known.unwrap_or(kept.len()) as u32);
        if known.is_none() {
            kept.push(*p);
        }
    }
    mesh.positions = kept;
    for t in &mut mesh.simplices {
        *t = t.map(|v| number[v as usize]);
    }
}
