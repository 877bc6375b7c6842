//! The body-centred cubic lattice: two cubic grids, each with its points in the middles of the
//! other's cells. Its Delaunay tetrahedra are all alike, with dihedral angles of 60° and 90°.

use super::stencil::{Coordinates, is_long};
use super::stuffing::StuffingError;
use glam::DVec3;

/// A block of cells; cell (x, y, z) has vertex 2·cell at its corner and 2·cell + 1 in its middle.
pub(super) struct Lattice {
    origin: DVec3,
    spacing: f64,
    cells: [i64; 3],
}

/// One of the twelve tetrahedra that belong to a corner.
pub(super) struct Template {
    /// Coordinates relative to the corner, positively oriented.
    pub at: [Coordinates; 4],
    /// Differences of vertex indices to the corner.
    pub steps: [i64; 4],
}

impl Lattice {
    /// A lattice that covers the box with three cells to spare on each side, a corner in its middle.
    pub fn new(bounds: [DVec3; 2], spacing: f64) -> Result<Self, StuffingError> {
        const MOST_CELLS: f64 = 3e7;
        let extent = bounds[1] - bounds[0];
        if !(bounds[0].is_finite() && bounds[1].is_finite() && extent.min_element() >= 0.0) {
            return Err(StuffingError::Bounds);
        }
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(StuffingError::Spacing { spacing });
        }
        let half = (extent * (0.5 / spacing)).ceil() + 3.0;
        let count = half.x * half.y * half.z * 8.0;
        if !(count <= MOST_CELLS) {
            return Err(StuffingError::TooFine { cells: count });
        }
        Ok(Self {
            origin: (bounds[0] + bounds[1]) * 0.5 - half * spacing,
            spacing,
            cells: half.to_array().map(|n| 2 * n as i64),
        })
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        2 * self.cells.iter().product::<i64>() as usize
    }

    /// Coordinates of a vertex.
    pub fn coordinates(&self, vertex: u32) -> Coordinates {
        let (cell, middle) = (i64::from(vertex) / 2, i64::from(vertex) % 2);
        let row = cell / self.cells[0];
        let cell = [
            cell % self.cells[0],
            row % self.cells[1],
            row / self.cells[1],
        ];
        cell.map(|c| 2 * c + middle)
    }

    /// Where a vertex is.
    pub fn position(&self, vertex: u32) -> DVec3 {
        let [x, y, z] = self.coordinates(vertex).map(|c| c as f64);
        self.origin + DVec3::new(x, y, z) * (0.5 * self.spacing)
    }

    /// Is the edge between neighbours long, and its length.
    pub fn edge(&self, a: u32, b: u32) -> (bool, f64) {
        match is_long(self.coordinates(a), self.coordinates(b)) {
            true => (true, self.spacing),
            false => (false, self.spacing * (0.75f64).sqrt()),
        }
    }

    /// The index of a vertex less that of the corner it is seen from.
    fn step(&self, [x, y, z]: Coordinates) -> i64 {
        let cell = [x, y, z].map(|c| c.div_euclid(2));
        2 * (cell[0] + self.cells[0] * (cell[1] + self.cells[1] * cell[2])) + x.rem_euclid(2)
    }

    /// Differences of indices to the fourteen neighbours, of a corner and of a middle.
    pub fn neighbours(&self) -> [[i64; 14]; 2] {
        let mut steps = [[0; 14]; 2];
        for axis in 0..3 {
            let mut side = [0; 3];
            side[axis] = 2;
            let step = self.step(side);
            for parity in &mut steps {
                parity[2 * axis] = step;
                parity[2 * axis + 1] = -step;
            }
        }
        for corner in 0..8 {
            let step = self.step([0, 1, 2].map(|k| 2 * (corner >> k & 1) - 1));
            steps[0][6 + corner as usize] = step;
            steps[1][6 + corner as usize] = -step;
        }
        steps
    }

    /// The tetrahedra of a corner: each of the three edges in positive direction with the four edges
    /// of middles round it.
    pub fn templates(&self) -> Vec<Template> {
        const RING: [[i64; 2]; 4] = [[1, 1], [-1, 1], [-1, -1], [1, -1]];
        let mut templates = Vec::with_capacity(12);
        for axis in 0..3 {
            let middle = |[u, v]: [i64; 2]| {
                let mut at = [1; 3];
                (at[(axis + 1) % 3], at[(axis + 2) % 3]) = (u, v);
                at
            };
            let mut end = [0; 3];
            end[axis] = 2;
            for side in 0..4 {
                // Counter-clockwise seen from the end of the axis: positive.
                let at = [
                    [0; 3],
                    end,
                    middle(RING[side]),
                    middle(RING[(side + 1) % 4]),
                ];
                let steps = at.map(|at| self.step(at));
                templates.push(Template { at, steps });
            }
        }
        templates
    }

    /// Which vertices are in the solid f < 0. |f| must not be greater than the distance to the
    /// surface: blocks of cells that are far from it are decided by the value in their middle.
    pub fn sample(&self, f: &impl Fn(DVec3) -> f64) -> Vec<bool> {
        let mut inside = vec![false; self.vertices()];
        // The outermost cells stay outside, so that every vertex inside has all its neighbours.
        self.sample_block(f, [2; 3], self.cells.map(|n| n - 2), &mut inside);
        inside
    }

    fn sample_block(
        &self,
        f: &impl Fn(DVec3) -> f64,
        low: [i64; 3],
        high: [i64; 3],
        inside: &mut [bool],
    ) {
        let vertex = |[x, y, z]: [i64; 3]| self.step([2 * x, 2 * y, 2 * z]) as u32;
        let last = [high[0] - 1, high[1] - 1, high[2] - 1];
        let ends = [self.position(vertex(low)), self.position(vertex(last) + 1)];
        // A little more than the half diagonal, for rounding.
        let radius = 0.500_001 * ends[0].distance(ends[1]);
        let value = f((ends[0] + ends[1]) * 0.5);
        if value > radius {
            return;
        }
        let (mut widest, mut width) = (0, 0);
        for axis in 0..3 {
            if high[axis] - low[axis] > width {
                (widest, width) = (axis, high[axis] - low[axis]);
            }
        }
        let far = value < -radius;
        if far || width <= 2 {
            for z in low[2]..high[2] {
                for y in low[1]..high[1] {
                    for x in low[0]..high[0] {
                        for v in [vertex([x, y, z]), vertex([x, y, z]) + 1] {
                            inside[v as usize] = far || f(self.position(v)) < 0.0;
                        }
                    }
                }
            }
            return;
        }
        let middle = low[widest] + width / 2;
        let (mut first, mut second) = (high, low);
        (first[widest], second[widest]) = (middle, middle);
        self.sample_block(f, low, first, inside);
        self.sample_block(f, second, high, inside);
    }

    /// Corners that have all their tetrahedra in the lattice.
    pub fn corners(&self) -> impl Iterator<Item = u32> {
        let [x, y, z] = self.cells;
        let row = move |j: i64, k: i64| x * (j + y * k);
        (1..z - 1).flat_map(move |k| {
            (1..y - 1).flat_map(move |j| (1..x - 1).map(move |i| 2 * (i + row(j, k)) as u32))
        })
    }
}
