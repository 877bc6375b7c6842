//! Conformalized mean curvature flow (Kazhdan, Solomon & Ben-Chen 2012): mean curvature flow whose stiffness matrix
//! stays that of the first surface, so that it makes no necks but takes what is of genus 0 to a sphere, conformally.
//!
//! (M_t + δ L₀) x_{t+1} = M_t x_t
//!
//! with the lumped masses M_t of the current surface. Then the surface is put back to its first area and centroid.
//!
//! Weights of L₀ are (cot α + cot β)/2, and 0 where that is negative, at edges that are not Delaunay. The matrix is
//! positive definite either way; without negative weights every vertex goes to a mean of others, so that obtuse
//! triangles, of which surfaces that meet themselves have many, cannot throw one out of the surface.

use crate::linalg::{Cholesky, Order, SymmetricAssembly};
use crate::optim::BuildError;
use glam::DVec3;

/// δ of the first step in units of the area, by how much it grows from step to step, and its most.
const FIRST: f64 = 1e-4;
const GROWTH: f64 = 1.25;
const MOST: f64 = 0.05;

/// Bound of cotangents: triangles flatter than that have the weights of one that is as flat.
const MOST_COTANGENT: f64 = 1e4;

/// A closed connected surface that flows.
pub struct Surface {
    triangles: Vec<[u32; 3]>,
    /// Of the first surface, all of it and its centroid.
    area: f64,
    centroid: DVec3,
    /// δ of the next step.
    delta: f64,
    /// Place of each vertex in the order of elimination.
    slot: Vec<u32>,
    /// Weights of L₀ by edge, the values of its entries being three each.
    weights: Vec<f64>,
    matrix: SymmetricAssembly,
    factor: Cholesky,
}

impl Surface {
    /// `None` if it has no area.
    pub fn new(triangles: Vec<[u32; 3]>, x: &[DVec3]) -> Result<Option<Self>, BuildError> {
        let (area, centroid) = area_and_centroid(&triangles, x);
        if !(area > 0.0) {
            return Ok(None);
        }
        let (edges, weights) = stiffness(&triangles, x);
        let n = x.len();
        let Order { unknowns, levels } = Order::new(n, edges.iter().map(|e| (e[0], e[1])));
        let mut slot = vec![0; n];
        (0..)
            .zip(&unknowns)
            .for_each(|(k, &v)| slot[v as usize] = k);
        let at = |v: u32| slot[v as usize];
        let entries: Vec<(u32, u32)> = edges
            .iter()
            .flat_map(|&[a, b]| [(at(a), at(a)), (at(b), at(b)), (at(a), at(b))])
            .chain((0..n as u32).map(|v| (at(v), at(v))))
            .collect();
        let matrix = SymmetricAssembly::new(n, entries.iter().copied());
        let factor = Cholesky::analyze(matrix.matrix(), &levels)?;
        Ok(Some(Self {
            triangles,
            area,
            centroid,
            delta: FIRST,
            slot,
            weights,
            matrix,
            factor,
        }))
    }

    /// One step. False, and x as it was, if that is not possible in floating point.
    pub fn step(&mut self, x: &mut [DVec3]) -> Result<bool, BuildError> {
        let delta = self.delta * self.area;
        let mut mass = vec![0.0; x.len()];
        for t in &self.triangles {
            let third = area(t, x) / 3.0;
            t.iter().for_each(|&v| mass[v as usize] += third);
        }
        let (weights, edges) = (&self.weights, 3 * self.weights.len());
        self.matrix.fill(|c| match c {
            c if c >= edges => mass[c - edges],
            c if c % 3 == 2 => -delta * weights[c / 3],
            c => delta * weights[c / 3],
        });
        let factored = self.factor.factorize(self.matrix.matrix());
        factored.map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
        let mut solution = vec![0.0; 3 * x.len()];
        let rows = solution.as_chunks_mut::<3>().0;
        for ((&slot, p), m) in self.slot.iter().zip(&*x).zip(&mass) {
            rows[slot as usize] = (m * (*p - self.centroid)).to_array();
        }
        self.factor.solve_in_place(&mut solution, 3);
        let rows = solution.as_chunks::<3>().0;
        let at = |&slot: &u32| DVec3::from_array(rows[slot as usize]);
        let new: Vec<DVec3> = self.slot.iter().map(at).collect();
        let (area, centroid) = area_and_centroid(&self.triangles, &new);
        let scale = (self.area / area).sqrt();
        if !scale.is_finite() {
            return Ok(false);
        }
        for (p, new) in x.iter_mut().zip(&new) {
            *p = self.centroid + scale * (*new - centroid);
        }
        self.delta = (GROWTH * self.delta).min(MOST);
        Ok(true)
    }
}

fn area(t: &[u32; 3], x: &[DVec3]) -> f64 {
    let [a, b, c] = t.map(|v| x[v as usize]);
    0.5 * (b - a).cross(c - a).length()
}

fn area_and_centroid(triangles: &[[u32; 3]], x: &[DVec3]) -> (f64, DVec3) {
    let (mut all, mut sum) = (0.0, DVec3::ZERO);
    for t in triangles {
        let (area, [a, b, c]) = (area(t, x), t.map(|v| x[v as usize]));
        all += area;
        sum += area / 3.0 * (a + b + c);
    }
    (all, sum / all)
}

/// The edges, each once, and their weights.
fn stiffness(triangles: &[[u32; 3]], x: &[DVec3]) -> (Vec<[u32; 2]>, Vec<f64>) {
    let mut halves: Vec<([u32; 2], f64)> = Vec::with_capacity(3 * triangles.len());
    for t in triangles {
        for k in 0..3 {
            let [v, a, b] = [0, 1, 2].map(|i| t[(k + i) % 3]);
            let [p, q] = [a, b].map(|w| x[w as usize] - x[v as usize]);
            halves.push(([a.min(b), a.max(b)], 0.5 * cotangent(p, q)));
        }
    }
    // by value too: the sum does not depend on the order of the triangles
    halves.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let same = halves.chunk_by(|a, b| a.0 == b.0);
    same.map(|same| {
        let weight: f64 = same.iter().map(|half| half.1).sum();
        (same[0].0, weight.max(0.0))
    })
    .unzip()
}

/// Of the angle between p and q.
fn cotangent(p: DVec3, q: DVec3) -> f64 {
    let longest = p.length_squared().max(q.length_squared());
    if !(longest > 0.0) {
        return 0.0;
    }
    p.dot(q) / p.cross(q).length().max(longest / MOST_COTANGENT)
}
