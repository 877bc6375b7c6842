//! A map, made ready for the graphics card: distortions, what is inverted, and the order of painting.

use super::bench::Problem;
use super::gpu::MapData;
use crate::outline;

/// How many times a map may cover itself before its triangles are drawn one for many: what lies
/// deeper cannot be seen, and painting it would stop a graphics card.
const MOST_LAYERS: usize = 24;

/// Memory for painting, used again and again.
#[derive(Default)]
pub struct Painting {
    distortions: Vec<f32>,
    corner_distortions: Vec<f32>,
    corners: Vec<f32>,
    boundary: Vec<f32>,
    order: Vec<u32>,
}

/// What painting found out about a map.
pub struct Painted {
    /// Inverted or collapsed triangles.
    pub inverted: Vec<u32>,
    /// Every how many triangles one is drawn: 1 unless it covers itself many times.
    pub thinning: usize,
    /// How many times it covers its bounding box.
    pub layers: usize,
}

impl Painting {
    /// Paints a map of the problem; `hand` passes it on.
    pub fn paint(
        &mut self,
        problem: &Problem,
        map: &[f32],
        hand: impl FnOnce(&MapData<'_>),
    ) -> Painted {
        let indices = &problem.indices;
        let inverted = problem
            .rest
            .distortions(indices, map, &mut self.distortions);
        self.corner_distortions.clear();
        self.corner_distortions
            .extend(self.distortions.iter().flat_map(|d| [*d; 3]));
        outline::per_corner(indices, map, 2, &mut self.corners);
        let layers = outline::layers(indices, map);
        let thinning = layers.div_ceil(MOST_LAYERS).max(1);
        outline::painting_order(&self.distortions, thinning, &mut self.order);
        self.boundary.clear();
        outline::segments_of_edges(&problem.boundary, map, &mut self.boundary);
        hand(&MapData {
            corners: &self.corners,
            distortions: &self.corner_distortions,
            order: &self.order,
            boundary: &self.boundary,
        });
        Painted {
            inverted,
            thinning,
            layers,
        }
    }
}
