//! The boundary of a disk, laid on a circle.

use crate::mesh::SurfaceMesh;
use glam::DVec2;

/// The boundary loop on a circle of unit area (radius √(1/π)), counter-clockwise, with arc lengths in
/// proportion to the lengths of its edges in space. One position a vertex of the loop.
pub fn boundary_to_circle(mesh: &SurfaceMesh, boundary: &[u32]) -> Vec<DVec2> {
    let n = boundary.len();
    let at = |k: usize| mesh.positions[boundary[k % n] as usize];
    let lengths: Vec<f64> = (0..n).map(|k| at(k).distance(at(k + 1))).collect();
    let total: f64 = lengths.iter().sum();
    let radius = core::f64::consts::FRAC_1_PI.sqrt();
    let mut along = 0.0;
    lengths
        .iter()
        .map(|l| {
            let angle = core::f64::consts::TAU * along / total;
            along += l;
            radius * DVec2::from_angle(angle)
        })
        .collect()
}
