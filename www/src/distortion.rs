//! How a map stretches each triangle: the singular values of its Jacobian.

/// Rest shapes of the triangles, ready to give Jacobians: the inverse of the edge matrix in the
/// triangle's own frame, upper triangular, `[1/l, -x/(l y), 1/y]` for edges (l, 0) and (x, y).
#[derive(Debug, Clone, Default)]
pub struct RestShapes {
    inverses: Vec<[f64; 3]>,
    area: f64,
}

/// The singular values of one triangle's Jacobian; the smaller is negative where it is inverted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// The larger singular value.
    pub largest: f64,
    /// The smaller singular value, negative for a reflected triangle.
    pub smallest: f64,
}

impl Stretch {
    /// max(σ₁, 1/σ₂): how much a length is stretched or squeezed at worst; 1 for an isometry,
    /// −1 for an inverted or collapsed triangle (which has no finite value).
    pub fn distortion(self) -> f32 {
        if self.smallest > 0.0 {
            self.largest.max(1.0 / self.smallest) as f32
        } else {
            -1.0
        }
    }
}

impl RestShapes {
    /// From positions (n×3, interleaved) and triangles (m×3, interleaved, in range).
    pub fn new(positions: &[f64], indices: &[u32]) -> Self {
        let point = |i: u32| {
            let p = 3 * i as usize;
            glam::DVec3::new(positions[p], positions[p + 1], positions[p + 2])
        };
        let mut area = 0.0;
        let inverses = indices
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&[a, b, c]| {
                let (e1, e2) = (point(b) - point(a), point(c) - point(a));
                let l = e1.length();
                let x = e1.dot(e2) / l;
                let y = e1.cross(e2).length() / l;
                area += 0.5 * l * y;
                [1.0 / l, -x / (l * y), 1.0 / y]
            })
            .collect();
        Self { inverses, area }
    }

    /// Total area of the surface, in the square of its unit.
    pub fn area(&self) -> f64 {
        self.area
    }

    /// The stretch of triangle `t` with corners `uv` (any unit the rest shape has too).
    pub fn stretch(&self, t: usize, uv: [[f32; 2]; 3]) -> Stretch {
        let [i11, i12, i22] = self.inverses[t];
        let edge = |k: usize| {
            [
                f64::from(uv[k][0]) - f64::from(uv[0][0]),
                f64::from(uv[k][1]) - f64::from(uv[0][1]),
            ]
        };
        let (e1, e2) = (edge(1), edge(2));
        // F = [e1 e2] · [[i11, i12], [0, i22]]
        let (a, c) = (e1[0] * i11, e1[1] * i11);
        let (b, d) = (e1[0] * i12 + e2[0] * i22, e1[1] * i12 + e2[1] * i22);
        let similarity = (0.5 * (a + d)).hypot(0.5 * (c - b));
        let reflection = (0.5 * (a - d)).hypot(0.5 * (c + b));
        Stretch {
            largest: similarity + reflection,
            smallest: similarity - reflection,
        }
    }

    /// The distortion of every triangle of a map (n×2, interleaved), written into `out`; returns
    /// the triangles that are inverted or collapsed.
    pub fn distortions(&self, indices: &[u32], uv: &[f32], out: &mut Vec<f32>) -> Vec<u32> {
        out.clear();
        let mut inverted = Vec::new();
        for (t, corners) in indices.as_chunks::<3>().0.iter().enumerate() {
            let value = self.stretch(t, corners_of(corners, uv)).distortion();
            if value < 0.0 {
                inverted.push(t as u32);
            }
            out.push(value);
        }
        inverted
    }
}

/// The corners of a triangle in a map.
pub fn corners_of(triangle: &[u32; 3], uv: &[f32]) -> [[f32; 2]; 3] {
    triangle.map(|i| [uv[2 * i as usize], uv[2 * i as usize + 1]])
}

/// The triangle of a map that contains `point`, the last drawn if several do.
pub fn triangle_at(indices: &[u32], uv: &[f32], point: [f32; 2]) -> Option<usize> {
    let inside = |triangle: &[u32; 3]| {
        let [a, b, c] = corners_of(triangle, uv);
        let side = |p: [f32; 2], q: [f32; 2]| {
            (q[0] - p[0]) * (point[1] - p[1]) - (q[1] - p[1]) * (point[0] - p[0])
        };
        let (s, t, u) = (side(a, b), side(b, c), side(c, a));
        (s >= 0.0 && t >= 0.0 && u >= 0.0) || (s <= 0.0 && t <= 0.0 && u <= 0.0)
    };
    indices.as_chunks::<3>().0.iter().rposition(inside)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0];
    const TRIANGLES: [u32; 6] = [0, 1, 2, 0, 2, 3];

    #[test]
    fn an_isometry_has_distortion_one() {
        let rest = RestShapes::new(&SQUARE, &TRIANGLES);
        let turned = [0.0, 0.0, 0.0, 1.0, -1.0, 1.0, -1.0, 0.0f32];
        let mut out = Vec::new();
        assert!(rest.distortions(&TRIANGLES, &turned, &mut out).is_empty());
        assert!(out.iter().all(|d| (d - 1.0).abs() < 1e-6), "{out:?}");
        assert!((rest.area() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn squeeze_and_stretch_count_alike() {
        let rest = RestShapes::new(&SQUARE, &TRIANGLES);
        for factor in [2.0f32, 0.5] {
            let uv = [0.0, 0.0, factor, 0.0, factor, 1.0, 0.0, 1.0f32];
            let mut out = Vec::new();
            rest.distortions(&TRIANGLES, &uv, &mut out);
            assert!(out.iter().all(|d| (d - 2.0).abs() < 1e-6), "{out:?}");
        }
    }

    #[test]
    fn folded_and_collapsed_triangles_are_found() {
        let rest = RestShapes::new(&SQUARE, &TRIANGLES);
        let mut out = Vec::new();
        let folded = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0, 0.2f32];
        assert_eq!(rest.distortions(&TRIANGLES, &folded, &mut out), [1]);
        assert_eq!(out[1], -1.0);
        assert_eq!(rest.distortions(&TRIANGLES, &[0.0; 8], &mut out), [0, 1]);
    }

    #[test]
    fn picking_finds_the_triangle_on_top() {
        let uv = [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0f32];
        assert_eq!(triangle_at(&TRIANGLES, &uv, [0.8, 0.2]), Some(0));
        assert_eq!(triangle_at(&TRIANGLES, &uv, [0.2, 0.8]), Some(1));
        assert_eq!(triangle_at(&TRIANGLES, &uv, [1.2, 0.8]), None);
    }
}
