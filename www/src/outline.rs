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

/// How many times, on average, a map (n×2) covers its bounding box; 1 at least.
pub fn layers(indices: &[u32], uv: &[f32]) -> usize {
    let (mut low, mut high) = ([f32::MAX; 2], [f32::MIN; 2]);
    for p in uv.as_chunks::<2>().0 {
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(p[k]), high[k].max(p[k]));
        }
    }
    let bounds = f64::from(high[0] - low[0]) * f64::from(high[1] - low[1]);
    let at = |i: u32| {
        [
            f64::from(uv[2 * i as usize]),
            f64::from(uv[2 * i as usize + 1]),
        ]
    };
    let area: f64 = indices
        .as_chunks::<3>()
        .0
        .iter()
        .map(|&[a, b, c]| {
            let (a, b, c) = (at(a), at(b), at(c));
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        })
        .sum();
    if bounds > 0.0 && area.is_finite() {
        ((area / bounds).ceil() as usize).max(1)
    } else {
        1
    }
}

/// Corners in the order the map is painted: upright triangles, then inverted ones (those with a
/// negative distortion), of each one in `thinning`.
pub fn painting_order(distortions: &[f32], thinning: usize, out: &mut Vec<u32>) {
    out.clear();
    for inverted in [false, true] {
        let triangles = (0..distortions.len()).filter(|t| (distortions[*t] < 0.0) == inverted);
        for t in triangles.step_by(thinning.max(1)) {
            let t = 3 * t as u32;
            out.extend([t, t + 1, t + 2]);
        }
    }
}

/// Where two edges of a map meet: the crossing of their lines if it is on both, else the middle of
/// the two (edges that touch or lie on each other).
pub fn meeting(edges: &[[u32; 2]; 2], uv: &[f32]) -> [f32; 2] {
    let at = |v: u32| glam::Vec2::new(uv[2 * v as usize], uv[2 * v as usize + 1]);
    let [[a, b], [c, d]] = edges.map(|edge| edge.map(at));
    let (r, s) = (b - a, d - c);
    let (t, u) = (
        (c - a).perp_dot(s) / r.perp_dot(s),
        (c - a).perp_dot(r) / r.perp_dot(s),
    );
    let on = |x: f32| (-1e-3..=1.001).contains(&x);
    let point = if on(t) && on(u) {
        a + t * r
    } else {
        0.25 * (a + b + c + d)
    };
    point.to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_meet_where_their_lines_cross() {
        let cross = [0.0, 0.0, 2.0, 2.0, 0.0, 2.0, 2.0, 0.0f32];
        assert_eq!(meeting(&[[0, 1], [2, 3]], &cross), [1.0, 1.0]);
        let along = [0.0, 0.0, 2.0, 0.0, 1.0, 0.0, 3.0, 0.0f32];
        assert_eq!(meeting(&[[0, 1], [2, 3]], &along), [1.5, 0.0]);
    }

    #[test]
    fn layers_count_how_often_a_map_covers_itself() {
        let square = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0f32];
        assert_eq!(layers(&[0, 1, 2, 0, 2, 3], &square), 1);
        assert_eq!(layers(&[0, 1, 2, 0, 2, 3].repeat(50), &square), 50);
        assert_eq!(layers(&[0, 1, 2], &[0.0; 6]), 1);
    }

    #[test]
    fn inverted_triangles_are_painted_last() {
        let mut out = Vec::new();
        painting_order(&[1.0, -1.0, 2.0], 1, &mut out);
        assert_eq!(out, [0, 1, 2, 6, 7, 8, 3, 4, 5]);
        painting_order(&[1.0, -1.0, 2.0], 2, &mut out);
        assert_eq!(out, [0, 1, 2, 3, 4, 5]);
    }

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
