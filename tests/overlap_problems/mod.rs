//! Bodies that would pass through each other, or through themselves, on the way to where they are pulled.
#![allow(dead_code)]

mod held_out;

#[allow(unused_imports)]
pub use held_out::*;

use foldfree::mesh::{SimplicialMesh, SolidMesh, SurfaceMesh};
use glam::DVec3;
use std::collections::BTreeMap;

/// Where a problem begins, and where pins go, one move after the other.
pub struct Moves<const K: usize> {
    pub rest: SimplicialMesh<K>,
    pub start: Vec<DVec3>,
    pub pins: Vec<u32>,
    /// All pins at once, move by move.
    pub moves: Vec<Vec<(u32, DVec3)>>,
}

impl<const K: usize> Moves<K> {
    fn new(rest: SimplicialMesh<K>) -> Self {
        Self {
            start: rest.positions.clone(),
            rest,
            pins: Vec::new(),
            moves: Vec::new(),
        }
    }

    /// Holds the vertices for which this is true.
    fn hold(mut self, is_held: impl Fn(DVec3) -> bool) -> Self {
        let all = 0..self.rest.positions.len() as u32;
        self.pins = all
            .filter(|&v| is_held(self.rest.positions[v as usize]))
            .collect();
        self
    }

    /// Appends a move: where pins go that begin at such a point.
    fn then(mut self, to: impl Fn(DVec3) -> DVec3) -> Self {
        let go = |&v: &u32| (v, to(self.start[v as usize]));
        self.moves.push(self.pins.iter().map(go).collect());
        self
    }
}

/// Cubes of a lattice, each six tetrahedra; `part` says which body a cube belongs to: vertices of different bodies
/// are different. `place` puts a lattice point of a body into space.
pub fn cubes(cells: &[([i32; 3], u8)], place: impl Fn([i32; 3], u8) -> DVec3) -> SolidMesh {
    let mut mesh = SolidMesh::default();
    let mut number = BTreeMap::new();
    for &(cell, part) in cells {
        let mut corner = |bits: usize| {
            let at: [i32; 3] = std::array::from_fn(|i| cell[i] + (bits >> i & 1) as i32);
            *number.entry((part, at)).or_insert_with(|| {
                mesh.positions.push(place(at, part));
                mesh.positions.len() as u32 - 1
            })
        };
        let corners: [u32; 8] = std::array::from_fn(&mut corner);
        // around the diagonal from corner 0 to corner 7
        for (a, b) in [(1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)] {
            mesh.simplices.push([0, a, b, 7].map(|c: usize| corners[c]));
        }
    }
    mesh
}

/// The same of squares, two triangles each, in the plane z = 0.
pub fn squares(cells: &[([i32; 2], u8)], place: impl Fn([i32; 2], u8) -> DVec3) -> SurfaceMesh {
    let mut mesh = SurfaceMesh::default();
    let mut number = BTreeMap::new();
    for &(cell, part) in cells {
        let mut corner = |bits: usize| {
            let at: [i32; 2] = std::array::from_fn(|i| cell[i] + (bits >> i & 1) as i32);
            *number.entry((part, at)).or_insert_with(|| {
                mesh.positions.push(place(at, part));
                mesh.positions.len() as u32 - 1
            })
        };
        let corners: [u32; 4] = std::array::from_fn(&mut corner);
        for t in [[0, 1, 3], [0, 3, 2]] {
            mesh.simplices.push(t.map(|c: usize| corners[c]));
        }
    }
    mesh
}

/// All cells of a block from `low` up to `high`, `fine` times finer.
pub fn block<const D: usize>(
    low: [i32; D],
    high: [i32; D],
    fine: i32,
    part: u8,
) -> Vec<([i32; D], u8)> {
    let mut cells = vec![[0; D]];
    for i in 0..D {
        let range = low[i] * fine..high[i] * fine;
        cells = range
            .flat_map(|x| {
                cells.iter().map(move |c| {
                    let mut c = *c;
                    c[i] = x;
                    c
                })
            })
            .collect();
    }
    cells.into_iter().map(|c| (c, part)).collect()
}

pub fn point(at: [i32; 3], fine: i32) -> DVec3 {
    DVec3::new(f64::from(at[0]), f64::from(at[1]), f64::from(at[2])) / f64::from(fine)
}

/// Two hooks, one in the other; the second is pulled away until both are stretched.
pub fn interlocked_arms(fine: i32) -> Moves<4> {
    let mut cells = block([0, 0, 0], [5, 1, 1], fine, 0);
    cells.extend(block([4, 1, 0], [5, 3, 1], fine, 0));
    cells.extend(block([2, 3, 0], [8, 4, 1], fine, 1));
    cells.extend(block([2, 1, 0], [3, 3, 1], fine, 1));
    let rest = cubes(&cells, |at, part| {
        point(at, fine) + f64::from(part) * DVec3::new(0.0, 0.3, 0.07)
    });
    Moves::new(rest)
        .hold(|p| p.x == 0.0 || p.x == 8.0)
        .then(|p| if p.x == 8.0 { p + 1.5 * DVec3::X } else { p })
        .then(|p| if p.x == 8.0 { p + 3.0 * DVec3::X } else { p })
}

/// The same in the plane.
pub fn interlocked_arms_in_the_plane(fine: i32) -> Moves<3> {
    let mut cells = block([0, 0], [5, 1], fine, 0);
    cells.extend(block([4, 1], [5, 3], fine, 0));
    cells.extend(block([2, 3], [8, 4], fine, 1));
    cells.extend(block([2, 1], [3, 3], fine, 1));
    let rest = squares(&cells, |[x, y], part| {
        point([x, y, 0], fine) + f64::from(part) * DVec3::new(0.0, 0.3, 0.0)
    });
    Moves::new(rest)
        .hold(|p| p.x == 0.0 || p.x == 8.0)
        .then(|p| if p.x == 8.0 { p + 1.5 * DVec3::X } else { p })
        .then(|p| if p.x == 8.0 { p + 3.0 * DVec3::X } else { p })
}

/// A sheet bent to a U, of which one end is then pressed onto the other flank, and into it.
pub fn folded_sheet(fine: i32) -> Moves<4> {
    let cells = block([-6, 0, 0], [6, 4, 1], fine, 0);
    let rest = cubes(&cells, |at, _| point(at, fine) * DVec3::new(1.0, 1.0, 0.5));
    let mut problem = Moves::new(rest);
    let length = 4.0;
    for p in &mut problem.start {
        // half a circle in the middle, straight on both sides
        let radius = length / std::f64::consts::PI;
        let angle = (p.x / radius).clamp(-0.5 * std::f64::consts::PI, 0.5 * std::f64::consts::PI);
        let straight = p.x - angle * radius;
        let r = radius + 0.25 - p.z;
        let along = straight.abs();
        *p = DVec3::new(r * angle.cos() - along, p.y, r * angle.sin());
    }
    // of the lower flank the end is held, that of the upper one is pressed onto its middle
    let ends: Vec<bool> = problem
        .rest
        .positions
        .iter()
        .map(|p| p.x.abs() == 6.0)
        .collect();
    problem.pins = (0..ends.len() as u32)
        .filter(|&v| ends[v as usize])
        .collect();
    let go = |p: DVec3, by: f64| match p.z > 0.0 {
        true => p + DVec3::new(1.5, 0.0, -by),
        false => p,
    };
    problem.then(|p| go(p, 1.2)).then(|p| go(p, 2.3))
}

/// A beam that is twisted while its ends come closer, so that it would wind through itself.
pub fn twisted_beam(fine: i32, turns: usize) -> Moves<4> {
    let cells = block([-6, 0, 0], [6, 1, 1], fine, 0);
    let rest = cubes(&cells, |at, _| point(at, fine) - DVec3::new(0.0, 0.5, 0.5));
    let mut problem = Moves::new(rest).hold(|p| p.x.abs() == 6.0);
    for k in 1..=turns {
        problem = problem.then(|p| {
            let angle = 0.25 * std::f64::consts::PI * k as f64 * p.x.signum();
            let (s, c) = angle.sin_cos();
            let closer = p.x * (1.0 - 0.1 * k as f64);
            DVec3::new(closer, c * p.y - s * p.z, s * p.y + c * p.z)
        });
    }
    problem
}

/// One box on another, pressed down and pushed along.
pub fn sliding_boxes(fine: i32) -> Moves<4> {
    let mut cells = block([0, 0, 0], [4, 2, 1], fine, 0);
    cells.extend(block([0, 0, 1], [2, 2, 2], fine, 1));
    let rest = cubes(&cells, |at, part| {
        point(at, fine) + f64::from(part) * DVec3::new(0.03, 0.04, 0.05)
    });
    let top = |p: DVec3| p.z > 2.0;
    let go = |p: DVec3, by: DVec3| if top(p) { p + by } else { p };
    Moves::new(rest)
        .hold(|p| p.z == 0.0 || top(p))
        .then(|p| go(p, DVec3::new(0.0, 0.0, -0.3)))
        .then(|p| go(p, DVec3::new(1.0, 0.0, -0.3)))
        .then(|p| go(p, DVec3::new(2.0, 0.3, -0.3)))
}

/// Two roofs, ridge against ridge: all that meets first are parallel edges and vertices on vertices.
pub fn parallel_edges(fine: i32) -> Moves<4> {
    let mut cells = block([0, -1, 0], [3, 1, 1], fine, 0);
    cells.extend(block([0, -1, 0], [3, 1, 1], fine, 1));
    let rest = cubes(&cells, |at, part| {
        let p = point(at, fine);
        let roof = DVec3::new(p.x, p.y, p.z * (1.2 - 0.9 * p.y.abs()));
        match part {
            0 => roof,
            // the other way round, by a half turn about the x axis
            _ => DVec3::new(p.x, -roof.y, 2.5 - roof.z),
        }
    });
    let top = |p: DVec3| p.z == 2.5;
    let go = |p: DVec3, by: f64| if top(p) { p - by * DVec3::Z } else { p };
    Moves::new(rest)
        .hold(|p| p.z == 0.0 || top(p))
        .then(|p| go(p, 0.3))
        .then(|p| go(p, 0.6))
}

/// A rounded cube (below: the ball) in a box of six walls, the vertices of which come after those of the ball.
pub struct Press {
    pub problem: Moves<4>,
    /// Vertices and tetrahedra of the ball.
    pub ball: [usize; 2],
}

impl Press {
    /// Half the width of the box; that of the ball is 1.
    pub const HALF: f64 = 1.02;

    /// A ball of `cells`³ cubes.
    pub fn new(cells: i32) -> Self {
        let half = f64::from(cells) / 2.0;
        let inside = cubes(&block([0; 3], [cells; 3], 1, 0), |at, _| {
            // the surface of the cube onto a sphere, halfway to leave corners well shaped
            let p = point(at, 1) / half - DVec3::ONE;
            let most = p.abs().max_element();
            let length = p.length();
            match length > 0.0 {
                true => p * (0.35 + 0.65 * most / length),
                false => p,
            }
        });
        let ball = [inside.positions.len(), inside.simplices.len()];
        let mut shell = block([-1; 3], [2; 3], 1, 0);
        shell.retain(|(cell, _)| *cell != [0; 3]);
        let walls = cubes(&shell, |at, _| {
            let coordinate = |i: i32| [-1.5, -1.0, 1.0, 1.5][(i + 1) as usize] * Self::HALF;
            DVec3::from_array(at.map(coordinate))
        });
        let mut rest = inside;
        let first = rest.positions.len() as u32;
        rest.positions.extend(walls.positions);
        let walls = walls.simplices.iter();
        rest.simplices.extend(walls.map(|t| t.map(|v| v + first)));
        let mut problem = Moves::new(rest);
        problem.pins = (first..problem.start.len() as u32).collect();
        Self { problem, ball }
    }

    /// The walls, this much nearer.
    pub fn walls(&self, scale: f64) -> Vec<(u32, DVec3)> {
        let pins = self.problem.pins.iter();
        pins.map(|&v| (v, self.problem.start[v as usize] * scale))
            .collect()
    }

    /// The ball's volume relative to that at rest.
    pub fn volume(&self, positions: &[DVec3]) -> f64 {
        let volume = |x: &[DVec3]| {
            let tetrahedra = self.problem.rest.simplices[..self.ball[1]].iter();
            let each = tetrahedra.map(|t| {
                let [a, b, c, d] = t.map(|v| x[v as usize]);
                (b - a).cross(c - a).dot(d - a) / 6.0
            });
            each.sum::<f64>()
        };
        volume(positions) / volume(&self.problem.rest.positions)
    }
}
