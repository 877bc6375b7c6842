//! A known solution to compare with.

use crate::failure::Failure;
use crate::files;
use crate::report::Iteration;
use foldfree::certificate::{Certificate, CornerMap};
use foldfree::mesh::SurfaceMesh;
use foldfree::parameterization::Parameterization;
use glam::DVec2;
use serde::Serialize;
use std::path::Path;

/// How a run compares with the solution.
#[derive(Debug, Serialize)]
pub struct Comparison {
    pub file: String,
    /// Symmetric Dirichlet energy of the solution on this surface.
    pub energy: f64,
    /// Certified energy of the result over it, less one.
    pub relative_energy_error: f64,
    /// First iteration without inverted elements and with an energy up to 1 % above the solution's.
    pub iterations_to_1_percent: Option<usize>,
    /// The same up to 1e-6.
    pub iterations_to_1e_6: Option<usize>,
    /// ‖x − x*‖ / ‖x₀ − x*‖ with both x moved rigidly as close to x* as they get.
    pub relative_position_error: f64,
}

impl Comparison {
    /// In words.
    pub fn summary(&self) -> String {
        let count =
            |n: Option<usize>| n.map_or("never".to_owned(), |n| format!("after {n} iterations"));
        let error = self.relative_energy_error;
        let this = if error.is_finite() {
            format!("this one {error:+.3e} of it more")
        } else {
            "this one folds".to_owned()
        };
        format!(
            "The solution has energy {:.9}, {this}; within 1 % {}, within 1e-6 {}.",
            self.energy,
            count(self.iterations_to_1_percent),
            count(self.iterations_to_1e_6),
        )
    }
}

/// The solution, brought to the vertices of the mesh that is flattened.
pub struct Reference {
    file: String,
    energy: f64,
    uv: Vec<DVec2>,
    start: Vec<DVec2>,
}

impl Reference {
    /// Reads a solution for `input`. The map is at its start.
    pub fn read(path: &Path, input: &SurfaceMesh, map: &Parameterization) -> Result<Self, Failure> {
        let file = files::read_mesh(path)?;
        let corners = files::corner_images(path, &file)?;
        if corners.len() != input.simplices.len() {
            let (found, expected) = (corners.len(), input.simplices.len());
            let what = format!("has {found} triangles, the input has {expected}");
            return Err(Failure::of_file(path, what));
        }
        let mesh = map.mesh();
        let mut uv = vec![DVec2::ZERO; mesh.positions.len()];
        let triangles = mesh.simplices.iter().zip(&input.simplices).zip(&corners);
        for ((disk, original), images) in triangles {
            for &v in disk {
                // Triangles may have been turned round: find the corner by its vertex.
                let source = map.input_vertices()[v as usize];
                if let Some(k) = original.iter().position(|&w| w == source) {
                    uv[v as usize] = images[k];
                }
            }
        }
        // Measured on the solution's own seams, which need not be ours.
        let own = CornerMap::new(input, &corners);
        Ok(Self {
            file: path.display().to_string(),
            energy: Certificate::of_map(&own.mesh, &own.uv).symmetric_dirichlet,
            uv,
            start: map.uv(),
        })
    }

    /// Compares a finished run.
    pub fn compare(
        self,
        uv: &[DVec2],
        certificate: &Certificate,
        iterations: &[Iteration],
    ) -> Comparison {
        let first = |margin: f64| {
            let reached =
                |i: &&Iteration| i.inverted == 0 && i.energy <= self.energy * (1.0 + margin);
            iterations.iter().find(reached).map(|i| i.iteration)
        };
        Comparison {
            energy: self.energy,
            relative_energy_error: certificate.symmetric_dirichlet / self.energy - 1.0,
            iterations_to_1_percent: first(1e-2),
            iterations_to_1e_6: first(1e-6),
            relative_position_error: rigid_distance(uv, &self.uv)
                / rigid_distance(&self.start, &self.uv),
            file: self.file,
        }
    }
}

/// Distance of two point sets after the best rotation and translation of the first.
fn rigid_distance(moved: &[DVec2], fixed: &[DVec2]) -> f64 {
    let mean = |x: &[DVec2]| x.iter().sum::<DVec2>() / x.len() as f64;
    let (p, q) = (mean(moved), mean(fixed));
    let pairs = || moved.iter().zip(fixed).map(|(a, b)| (*a - p, *b - q));
    // The best rotation has the angle of Σ conj(a) b.
    let sum: DVec2 = pairs()
        .map(|(a, b)| DVec2::new(a.dot(b), a.perp_dot(b)))
        .sum();
    let rotation = sum.try_normalize().unwrap_or(DVec2::X);
    let squares = pairs().map(|(a, b)| rotation.rotate(a).distance_squared(b));
    squares.sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigid_motions_do_not_count() {
        let a: Vec<DVec2> = (0..9)
            .map(|i| DVec2::new(f64::from(i % 4), f64::from(i * i % 7)))
            .collect();
        let turn = DVec2::from_angle(2.0);
        let b: Vec<DVec2> = a
            .iter()
            .map(|p| turn.rotate(*p) + DVec2::new(5.0, -3.0))
            .collect();
        assert!(rigid_distance(&a, &b) < 1e-12);
        let mut c = b.clone();
        c[0].x += 1e-3;
        let d = rigid_distance(&a, &c);
        assert!(d > 5e-4 && d < 1e-3);
    }
}
