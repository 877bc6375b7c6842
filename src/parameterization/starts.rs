//! Starts of a parameterization, in the unit-area scale.

use super::Start;
use crate::embedding::{harmonic, lscm, tutte};
use crate::geometry::RestShape;
use crate::mesh::SurfaceMesh;
use crate::optim::BuildError;
use glam::DVec2;

/// Number of triangles that are not strictly positive, in floating point.
fn flips(mesh: &SurfaceMesh, map: &[DVec2]) -> usize {
    mesh.simplices
        .iter()
        .filter(|t| {
            let [a, b, c] = t.map(|v| map[v as usize]);
            !((b - a).perp_dot(c - a) > 0.0)
        })
        .count()
}

/// A uniform number in [0, 1) from a counter (SplitMix64, Steele et al. 2014).
fn uniform(seed: u32, counter: u64) -> f64 {
    let mut z = (u64::from(seed) << 32 | 0x9e37)
        .wrapping_add(counter.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// The start, and which one `Automatic` became.
pub(super) fn start(
    kind: Start,
    seed: u32,
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
) -> Result<(Vec<DVec2>, Start), BuildError> {
    let map = match kind {
        Start::Automatic => {
            // needles can make the cotangent matrix indefinite in floating point
            if let Ok(map) = harmonic(mesh, rest, boundary)
                && flips(mesh, &map) == 0
            {
                return Ok((map, Start::Harmonic));
            }
            return Ok((tutte(mesh, rest, boundary)?, Start::Tutte));
        }
        Start::Harmonic => harmonic(mesh, rest, boundary)?,
        Start::Tutte => tutte(mesh, rest, boundary)?,
        Start::Lscm => lscm(mesh, rest, boundary)?,
        Start::Random => (0..mesh.positions.len() as u64)
            .map(|v| DVec2::new(uniform(seed, 2 * v), uniform(seed, 2 * v + 1)))
            .collect(),
        Start::Collapsed => vec![DVec2::ZERO; mesh.positions.len()],
    };
    Ok((map, kind))
}
