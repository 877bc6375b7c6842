//! Conformalized mean curvature flow (Kazhdan, Solomon & Ben-Chen 2012): mean curvature flow whose stiffness matrix
//! stays that of the first surface, so that it makes no necks but takes what is of genus 0 to a sphere, conformally.
//!
//! (M_t + δ L₀) x_{t+1} = M_t x_t
//!
//! with the lumped masses M_t of the current surface. Then the surface is put back to its first area and centroid.
//!
//! L₀ has the cotangent weights of the intrinsic Delaunay triangulation, which are never negative: every vertex goes to a
//! mean of others, so that obtuse triangles, of which surfaces that meet themselves have many, throw none out of the
//! surface. Plain cotangents can; with negative ones set to 0 the limit is no sphere.

use super::delaunay::delaunay_weights;
use crate::linalg::{Cholesky, Order, SymmetricAssembly};
use crate::optim::BuildError;
use glam::DVec3;

/// δ of the first step in units of the area, by how much it grows from step to step, and its most.
const FIRST: f64 = 1e-4;
const GROWTH: f64 = 1.25;
const MOST: f64 = 0.05;

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
        let (edges, weights) = delaunay_weights(&triangles, x);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::generate::{Shape, generate};

    /// A sphere, stretched.
    fn ellipsoid(axes: DVec3) -> (Vec<[u32; 3]>, Vec<DVec3>) {
        let sphere = generate(Shape::Sphere, 1500);
        let points = sphere.positions.iter().map(|&p| axes * p.normalize());
        (sphere.simplices.clone(), points.collect())
    }

    /// Least and most distance from the centroid.
    fn radii(surface: &Surface, x: &[DVec3]) -> (f64, f64) {
        let radii = x.iter().map(|p| p.distance(surface.centroid));
        radii.fold((f64::MAX, 0.0), |(low, high), r| (low.min(r), high.max(r)))
    }

    #[test]
    fn a_sphere_stays() {
        let (triangles, mut x) = ellipsoid(DVec3::ONE);
        let before = x.clone();
        let mut surface = Surface::new(triangles, &x).expect("fits").expect("area");
        for _ in 0..10 {
            assert!(surface.step(&mut x).expect("a step"));
        }
        let most = x.iter().zip(&before).map(|(a, b)| a.distance(*b));
        let most = most.fold(0.0, f64::max);
        assert!(most < 0.01, "{most}");
    }

    #[test]
    fn an_ellipsoid_becomes_a_sphere_of_its_area_step_by_step() {
        let (triangles, mut x) = ellipsoid(DVec3::new(3.0, 1.0, 1.5));
        let mut surface = Surface::new(triangles.clone(), &x)
            .expect("fits")
            .expect("area");
        let (area, centroid) = area_and_centroid(&triangles, &x);
        let mut last = radii(&surface, &x);
        let first = x.clone();
        for k in 0..40 {
            assert!(surface.step(&mut x).expect("a step"));
            let (now, centre) = area_and_centroid(&triangles, &x);
            assert!((now - area).abs() < 1e-12 * area, "{now} {area}");
            assert!(centre.distance(centroid) < 1e-12);
            let (least, most) = radii(&surface, &x);
            // near its end only the triangles tell it from a sphere
            let rounder = most - least < last.1 - last.0;
            assert!(rounder || most < 1.06 * least, "{k}: {least} {most}");
            last = (least, most);
            if k == 0 {
                // t is 1e-4 of the area, 42: speeds are curvatures, and the largest is that of the tip, 2 · 3
                let moved = x.iter().zip(&first).map(|(a, b)| a.distance(*b));
                let most = moved.fold(0.0, f64::max);
                assert!(most > 1e-3 && most < 1e-4 * area * 6.0, "{most}");
            }
        }
        assert!(last.1 < 1.06 * last.0, "{last:?}");
    }

    #[test]
    fn what_has_no_area_has_no_flow() {
        let x = [DVec3::ZERO, DVec3::X, 2.0 * DVec3::X];
        let line = Surface::new(vec![[0, 1, 2], [0, 2, 1]], &x).expect("fits");
        assert!(line.is_none());
    }
}
