//! What lies under the pointer, and where a dragged point goes.

use glam::{Mat4, Vec2, Vec3};

/// Projects points of the model into a view and back. View points have their origin top left, y down.
#[derive(Debug, Clone, Copy)]
pub struct Lens {
    matrix: Mat4,
    inverse: Mat4,
    size: Vec2,
}

impl Lens {
    /// For a model-to-clip matrix and a view of that size in points.
    pub fn new(matrix: Mat4, size: Vec2) -> Self {
        Self {
            matrix,
            inverse: matrix.inverse(),
            size,
        }
    }

    /// Where a point appears, and its depth (less is nearer).
    pub fn project(&self, p: Vec3) -> (Vec2, f32) {
        let clip = self.matrix.project_point3(p);
        let at = Vec2::new(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y) * self.size;
        (at, clip.z)
    }

    /// The point of the model that appears at `at` with that depth.
    pub fn unproject(&self, at: Vec2, depth: f32) -> Vec3 {
        let unit = at / self.size;
        let clip = Vec3::new(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y, depth);
        self.inverse.project_point3(clip)
    }

    /// How far a point `p` moves when it is dragged from `from` to `to` in its camera plane.
    pub fn drag(&self, p: Vec3, from: Vec2, to: Vec2) -> Vec3 {
        let (_, depth) = self.project(p);
        self.unproject(to, depth) - self.unproject(from, depth)
    }

    /// The direction towards the viewer at a point, of unit length.
    pub fn towards_viewer(&self, p: Vec3) -> Vec3 {
        let (at, depth) = self.project(p);
        (self.unproject(at, depth - 1e-3) - self.unproject(at, depth + 1e-3)).normalize_or_zero()
    }
}

fn point(positions: &[f32], v: u32) -> Vec3 {
    Vec3::from_slice(&positions[3 * v as usize..])
}

/// The skin triangle nearest to the viewer at `at`, as its index and depth there.
pub fn triangle_at(
    lens: &Lens,
    skin: &[[u32; 3]],
    positions: &[f32],
    at: Vec2,
) -> Option<(usize, f32)> {
    let mut best: Option<(usize, f32)> = None;
    for (t, triangle) in skin.iter().enumerate() {
        let [(a, za), (b, zb), (c, zc)] = triangle.map(|v| lens.project(point(positions, v)));
        let area = (b - a).perp_dot(c - a);
        let (u, v) = (
            (b - at).perp_dot(c - at) / area,
            (c - at).perp_dot(a - at) / area,
        );
        let w = 1.0 - u - v;
        if u >= 0.0 && v >= 0.0 && w >= 0.0 {
            let depth = u * za + v * zb + w * zc;
            if best.is_none_or(|(_, z)| depth < z) {
                best = Some((t, depth));
            }
        }
    }
    best
}

/// The vertex a pointer at `at` means: the nearest corner of the skin triangle under it, or, beside
/// the solid, the nearest skin vertex within `reach`.
pub fn vertex_at(
    lens: &Lens,
    skin: &[[u32; 3]],
    outside: &[u32],
    positions: &[f32],
    at: Vec2,
    reach: f32,
) -> Option<u32> {
    let distance = |v: u32| lens.project(point(positions, v)).0.distance(at);
    let nearest = |vertices: &[u32]| {
        vertices
            .iter()
            .map(|&v| (v, distance(v)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    if let Some((t, _)) = triangle_at(lens, skin, positions, at) {
        return nearest(&skin[t]).map(|(v, _)| v);
    }
    nearest(outside).filter(|(_, d)| *d < reach).map(|(v, _)| v)
}

/// Of `candidates`, the one that appears within `reach` of `at`, nearest to the viewer.
pub fn nearest_in_front(
    lens: &Lens,
    candidates: impl IntoIterator<Item = (u32, Vec3)>,
    at: Vec2,
    reach: f32,
) -> Option<u32> {
    candidates
        .into_iter()
        .filter_map(|(id, p)| {
            let (place, depth) = lens.project(p);
            (place.distance(at) < reach).then_some((id, depth))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(id, _)| id)
}

/// All vertices that appear inside a rectangle of the view, on the skin or within.
pub fn vertices_in(lens: &Lens, positions: &[f32], a: Vec2, b: Vec2) -> Vec<u32> {
    let (low, high) = (a.min(b), a.max(b));
    (0u32..)
        .zip(positions.as_chunks::<3>().0)
        .filter(|(_, p)| {
            let (at, _) = lens.project(Vec3::from_array(**p));
            at.cmpge(low).all() && at.cmple(high).all()
        })
        .map(|(v, _)| v)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Orbit;
    use crate::solid::tests::cube;

    fn scene() -> (Lens, Vec<f32>, Vec<[u32; 3]>) {
        let (positions, _, skin) = cube();
        let size = Vec2::new(500.0, 400.0);
        let lens = Lens::new(Orbit::around(&positions).matrix(1.25), size);
        let single = positions.iter().map(|p| *p as f32).collect();
        (lens, single, skin.as_chunks::<3>().0.to_vec())
    }

    #[test]
    fn projecting_and_back_is_the_identity() {
        let (lens, positions, _) = scene();
        for p in positions.as_chunks::<3>().0 {
            let p = Vec3::from_array(*p);
            let (at, depth) = lens.project(p);
            assert!(lens.unproject(at, depth).distance(p) < 1e-3);
        }
    }

    #[test]
    fn a_dragged_point_stays_under_the_pointer() {
        let (lens, _, _) = scene();
        let p = Vec3::new(1.0, 0.2, 0.7);
        let (from, depth) = lens.project(p);
        let to = from + Vec2::new(40.0, -25.0);
        let (after, depth_after) = lens.project(p + lens.drag(p, from, to));
        assert!(after.distance(to) < 0.05, "{after} {to}");
        assert!((depth - depth_after).abs() < 1e-4);
    }

    #[test]
    fn the_nearest_vertex_is_picked_and_hidden_ones_are_not() {
        let (lens, positions, skin) = scene();
        let outside: Vec<u32> = (0..8).collect();
        let depth = |v: u32| lens.project(point(&positions, v)).1;
        let front = (0..8u32)
            .min_by(|a, b| depth(*a).total_cmp(&depth(*b)))
            .unwrap();
        let at = lens.project(point(&positions, front)).0;
        let found = vertex_at(&lens, &skin, &outside, &positions, at, 10.0);
        assert_eq!(found, Some(front));
        let nowhere = vertex_at(&lens, &skin, &outside, &positions, Vec2::ZERO, 10.0);
        assert_eq!(nowhere, None);
        let back = (0..8u32)
            .max_by(|a, b| depth(*a).total_cmp(&depth(*b)))
            .unwrap();
        let at = lens.project(point(&positions, back)).0;
        assert_ne!(
            vertex_at(&lens, &skin, &outside, &positions, at, 10.0),
            Some(back)
        );
    }

    #[test]
    fn a_box_holds_what_appears_in_it() {
        let (lens, positions, _) = scene();
        let all = vertices_in(&lens, &positions, Vec2::ZERO, Vec2::new(500.0, 400.0));
        assert_eq!(all.len(), 8);
        let at = lens.project(point(&positions, 5)).0;
        let one = vertices_in(&lens, &positions, at - 4.0, at + 4.0);
        assert_eq!(one, [5]);
    }

    #[test]
    fn the_viewer_is_in_front() {
        let (lens, _, _) = scene();
        let p = Vec3::splat(0.5);
        let nearer = p + 0.1 * lens.towards_viewer(p);
        assert!(lens.project(nearer).1 < lens.project(p).1);
    }
}
