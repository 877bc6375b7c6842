//! Starts of a parameterization, in the unit-area scale.

use super::Start;
use super::atlas::{Atlas, part};
use crate::embedding::{harmonic_around, lscm, tutte_around};
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

/// The start of one chart, and which one `Automatic` became.
fn of_chart(
    kind: Start,
    seed: u32,
    mesh: &SurfaceMesh,
    rest: &RestShape,
    boundary: &[u32],
    holes: &[Vec<u32>],
) -> Result<(Vec<DVec2>, Start), BuildError> {
    let map = match kind {
        Start::Automatic => {
            // needles can make the cotangent matrix indefinite in floating point
            if let Ok(map) = harmonic_around(mesh, rest, boundary, holes)
                && flips(mesh, &map) == 0
            {
                return Ok((map, Start::Harmonic));
            }
            let map = tutte_around(mesh, rest, boundary, holes)?;
            return Ok((map, Start::Tutte));
        }
        Start::Harmonic => harmonic_around(mesh, rest, boundary, holes)?,
        Start::Tutte => tutte_around(mesh, rest, boundary, holes)?,
        Start::Lscm => lscm(mesh, rest, boundary)?,
        Start::Random => (0..mesh.positions.len() as u64)
            .map(|v| DVec2::new(uniform(seed, 2 * v), uniform(seed, 2 * v + 1)))
            .collect(),
        Start::Collapsed => vec![DVec2::ZERO; mesh.positions.len()],
    };
    Ok((map, kind))
}

/// The start of every chart, in the scale where all of them have unit area, all in the same place; and which
/// one `Automatic` became (Tutte's, where it did for one of them).
pub(super) fn start(
    kind: Start,
    seed: u32,
    atlas: &Atlas,
    rest: &RestShape,
    scale: f64,
) -> Result<(Vec<DVec2>, Start), BuildError> {
    if let [chart] = &atlas.charts[..] {
        return of_chart(kind, seed, &atlas.mesh, rest, &chart.outline, &chart.holes);
    }
    let mut all = Vec::with_capacity(atlas.mesh.positions.len());
    let mut became = match kind {
        Start::Automatic => Start::Harmonic,
        kind => kind,
    };
    for chart in &atlas.charts {
        let (mesh, _) = part(&atlas.mesh, &chart.triangles);
        let rest = RestShape::of_surface(&mesh, scale)?;
        let own = |list: &Vec<u32>| -> Vec<u32> {
            list.iter().map(|v| v - chart.vertices.start).collect()
        };
        let holes: Vec<Vec<u32>> = chart.holes.iter().map(own).collect();
        let outline = own(&chart.outline);
        let seed = seed.wrapping_add(chart.vertices.start);
        let (map, used) = of_chart(kind, seed, &mesh, &rest, &outline, &holes)?;
        if kind == Start::Automatic && used == Start::Tutte {
            became = used;
        }
        let side = rest.measure.iter().sum::<f64>().sqrt();
        all.extend(map.into_iter().map(|p| side * p));
    }
    Ok((all, became))
}
