//! A map given corner by corner, as texture coordinates in files are.

use crate::mesh::SurfaceMesh;
use glam::DVec2;

/// A map with one image point a vertex, made from one with an image point a corner.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerMap {
    /// The surface, torn where the corners of a vertex have different images: there the vertex stands
    /// several times. Triangles are in the order they had.
    pub mesh: SurfaceMesh,
    /// Image of every vertex of `mesh`.
    pub uv: Vec<DVec2>,
    /// The vertex of the untorn surface that every vertex of `mesh` is.
    pub source_vertices: Vec<u32>,
}

impl CornerMap {
    /// The map that takes corner k of triangle t to `corners[t][k]`. Corners of one vertex with equal
    /// images become one vertex, vertices of no triangle are dropped.
    ///
    /// # Panics
    /// If there are not as many triples as triangles, or a triangle names a vertex that does not exist.
    pub fn new(surface: &SurfaceMesh, corners: &[[DVec2; 3]]) -> Self {
        assert_eq!(surface.simplices.len(), corners.len());
        // Bits of the coordinates, with one zero, tell equal points from others.
        let key = |x: f64| (x + 0.0).to_bits();
        let mut order: Vec<(u32, u64, u64, u32)> = (0..3 * corners.len())
            .map(|i| {
                let (vertex, p) = (surface.simplices[i / 3][i % 3], corners[i / 3][i % 3]);
                (vertex, key(p.x), key(p.y), i as u32)
            })
            .collect();
        order.sort_unstable();
        let mut map = Self {
            mesh: SurfaceMesh {
                positions: Vec::new(),
                simplices: surface.simplices.clone(),
            },
            uv: Vec::new(),
            source_vertices: Vec::new(),
        };
        for same in order.chunk_by(|a, b| (a.0, a.1, a.2) == (b.0, b.1, b.2)) {
            let (vertex, corner) = (same[0].0, same[0].3 as usize);
            let index = map.uv.len() as u32;
            map.mesh.positions.push(surface.positions[vertex as usize]);
            map.uv.push(corners[corner / 3][corner % 3]);
            map.source_vertices.push(vertex);
            for &(.., corner) in same {
                map.mesh.simplices[corner as usize / 3][corner as usize % 3] = index;
            }
        }
        map
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn equal_corners_are_one_vertex_and_seams_are_torn() {
        let surface = SurfaceMesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::NAN, DVec3::Y, DVec3::ONE],
            simplices: vec![[0, 1, 3], [1, 4, 3]],
        };
        let p = |x: f64, y: f64| DVec2::new(x, y);
        let welded = [
            [p(-0.0, 0.0), p(1.0, 0.0), p(0.0, 1.0)],
            [p(1.0, -0.0), p(1.0, 1.0), p(0.0, 1.0)],
        ];
        let map = CornerMap::new(&surface, &welded);
        assert_eq!(map.source_vertices, [0, 1, 3, 4]);
        assert_eq!(map.mesh.simplices, [[0, 1, 2], [1, 3, 2]]);
        let mut torn = welded;
        torn[1][0].x = 1.0f64.next_up();
        let map = CornerMap::new(&surface, &torn);
        assert_eq!(map.source_vertices, [0, 1, 1, 3, 4]);
        assert_eq!(map.mesh.simplices, [[0, 1, 3], [2, 4, 3]]);
    }
}
