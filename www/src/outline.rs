//! Lines drawn on meshes: boundary edges, outlines of triangles.

/// The edges that belong to one triangle only, as pairs of vertices, in the triangles' direction.
pub fn boundary_edges(indices: &[u32]) -> Vec<[u32; 2]> {
    let mut edges: Vec<([u32; 2], [u32; 2])> = indices
        .as_chunks::<3>()
        .0
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|e| ([e[0].min(e[1]), e[0].max(e[1])], e))
        .collect();
    edges.sort_unstable();
    edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|same| same.len() == 1)
        .map(|same| same[0].1)
        .collect()
}

/// Segments (4 floats each: x y x y) of `edges` in a map.
pub fn segments_of_edges(edges: &[[u32; 2]], uv: &[f32], out: &mut Vec<f32>) {
    for v in edges.as_flattened() {
        out.extend_from_slice(&uv[2 * *v as usize..][..2]);
    }
}

/// Segments of the outlines of `triangles` in a map.
pub fn segments_of_triangles(triangles: &[u32], indices: &[u32], uv: &[f32], out: &mut Vec<f32>) {
    for &t in triangles {
        let [a, b, c] = [0, 1, 2].map(|k| indices[3 * t as usize + k]);
        segments_of_edges(&[[a, b], [b, c], [c, a]], uv, out);
    }
}

/// Corner values (three a triangle) from vertex values of `width` floats, for unindexed drawing.
pub fn per_corner(indices: &[u32], values: &[f32], width: usize, out: &mut Vec<f32>) {
    out.clear();
    out.reserve(indices.len() * width);
    for &v in indices {
        out.extend_from_slice(&values[v as usize * width..][..width]);
    }
}

/// Area-weighted vertex normals (n×3, unit length, zero where undefined).
pub fn vertex_normals(positions: &[f64], indices: &[u32]) -> Vec<f32> {
    let mut normals = vec![glam::DVec3::ZERO; positions.len() / 3];
    let point = |i: u32| glam::DVec3::from_slice(&positions[3 * i as usize..]);
    for &[a, b, c] in indices.as_chunks::<3>().0 {
        let normal = (point(b) - point(a)).cross(point(c) - point(a));
        for v in [a, b, c] {
            normals[v as usize] += normal;
        }
    }
    normals
        .iter()
        .flat_map(|n| n.normalize_or_zero().as_vec3().to_array())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_has_four_boundary_edges() {
        let mut edges = boundary_edges(&[0, 1, 2, 0, 2, 3]);
        edges.sort_unstable();
        assert_eq!(edges, [[0, 1], [1, 2], [2, 3], [3, 0]]);
    }

    #[test]
    fn a_closed_surface_has_none() {
        assert!(boundary_edges(&[0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]).is_empty());
    }

    #[test]
    fn segments_follow_the_map() {
        let mut out = Vec::new();
        segments_of_edges(&[[1, 0]], &[0.0, 1.0, 2.0, 3.0], &mut out);
        assert_eq!(out, [2.0, 3.0, 0.0, 1.0]);
        out.clear();
        segments_of_triangles(&[0], &[0, 1, 2], &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0], &mut out);
        assert_eq!(out.len(), 12);
    }

    #[test]
    fn normals_point_out_of_the_page() {
        let flat = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(
            vertex_normals(&flat, &[0, 1, 2]),
            [0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0]
        );
    }

    #[test]
    fn corners_repeat_vertices() {
        let mut out = vec![9.0];
        per_corner(&[1, 0, 1], &[1.0, 2.0], 1, &mut out);
        assert_eq!(out, [2.0, 1.0, 2.0]);
    }
}
