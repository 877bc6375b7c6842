//! Cameras: an orbit around the surface, a pan and zoom over the map.

use glam::{DMat3, DVec3, Mat4, Quat, Vec2, Vec3};

/// Looks at a surface from a turning sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orbit {
    /// Model to view rotation.
    pub rotation: Quat,
    /// Magnification; 1 fits the bounding sphere.
    pub zoom: f32,
    /// Centre of the bounding sphere, in the surface's unit.
    pub centre: Vec3,
    /// Radius of the bounding sphere, in the surface's unit.
    pub radius: f32,
    /// Magnification at which the surface filled a square view at first.
    fit: f32,
    /// Half the depth that is shown, in radii.
    reach: f32,
}

impl Orbit {
    /// A three-quarter view down the thinnest principal axis of the points (n×3, interleaved).
    pub fn around(positions: &[f64]) -> Self {
        let points = || {
            positions
                .as_chunks::<3>()
                .0
                .iter()
                .map(|&p| DVec3::from_array(p))
        };
        let (low, high) = points().fold((DVec3::MAX, DVec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
        let centre = 0.5 * (low + high);
        let radius = points()
            .map(|p| p.distance(centre))
            .fold(0.0, f64::max)
            .max(f64::MIN_POSITIVE);
        let [thin, _, wide] = principal_axes(positions);
        // The view looks down −z: put the thinnest axis there, then tip it back.
        let up = thin
            * if thin.dot(DVec3::Z + 0.1 * DVec3::Y).is_sign_negative() {
                -1.0
            } else {
                1.0
            };
        let right = wide
            * if wide.dot(DVec3::X + 0.1 * DVec3::Y).is_sign_negative() {
                -1.0
            } else {
                1.0
            };
        let frame = DMat3::from_cols(right, up.cross(right), up).transpose();
        let front = Quat::from_mat3(&frame.as_mat3());
        let rotation = Quat::from_rotation_x(-0.92) * Quat::from_rotation_z(-0.5) * front;
        let orbit = Self {
            rotation,
            zoom: 1.0,
            centre: centre.as_vec3(),
            radius: radius as f32,
            fit: 1.0,
            reach: 1.6,
        };
        orbit.centred(positions)
    }

    /// Looks straight down at points of a plane z = constant, with room to drag some of them out.
    pub fn above(positions: &[f64]) -> Self {
        let orbit = Self {
            rotation: Quat::IDENTITY,
            ..Self::around(positions)
        };
        let points = positions.as_chunks::<3>().0.iter();
        let points = points.map(|&p| DVec3::from_array(p).as_vec3());
        let (low, high) = points.fold((Vec3::MAX, Vec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
        let upright = Self {
            centre: 0.5 * (low + high),
            zoom: 1.0,
            fit: 1.0,
            ..orbit
        };
        let mut upright = upright.centred(positions);
        upright.fit *= 0.76;
        upright
    }

    /// Moves what is seen by `delta` in the model.
    pub fn shift(&mut self, delta: Vec3) {
        self.centre -= delta;
    }

    /// Shows `reach` radii (at most 3.5) before and behind the centre.
    pub fn reaching(self, reach: f32) -> Self {
        let reach = reach.min(3.5);
        Self { reach, ..self }
    }

    /// Moves the centre so that the points appear in the middle of the view, and the radius so that
    /// they fill it.
    fn centred(mut self, positions: &[f64]) -> Self {
        let points = || positions.as_chunks::<3>().0.iter();
        for _ in 0..4 {
            let matrix = self.matrix(1.0);
            let (mut low, mut high) = (Vec2::MAX, Vec2::MIN);
            for p in points() {
                let v = matrix
                    .project_point3(DVec3::from_array(*p).as_vec3())
                    .truncate();
                (low, high) = (low.min(v), high.max(v));
            }
            if low.x > high.x {
                return self;
            }
            let middle = 0.5 * (low + high) * self.radius / self.zoom;
            self.centre += self.rotation.inverse() * middle.extend(0.0);
            let reach = 0.5 * (high - low).max_element();
            self.zoom = (self.zoom * 0.86 / reach.max(1e-6)).clamp(0.5, 3.0);
        }
        // From here on, 1 is the zoom that fits.
        self.fit = self.zoom;
        self.zoom = 1.0;
        self
    }

    /// Turns by a drag of `delta` points in a view `size` points wide.
    pub fn drag(&mut self, delta: Vec2, size: f32) {
        let angle = delta * (std::f32::consts::PI / size.max(1.0));
        let turn = Quat::from_rotation_y(angle.x) * Quat::from_rotation_x(angle.y);
        self.rotation = (turn * self.rotation).normalize();
    }

    /// Zooms by a factor.
    pub fn magnify(&mut self, factor: f32) {
        self.zoom = (self.zoom * factor).clamp(0.2, 60.0);
    }

    /// Model to clip space for a view of the given aspect (width / height).
    pub fn matrix(&self, aspect: f32) -> Mat4 {
        let field = 0.5f32;
        let distance = 1.0 / (0.5 * field).sin();
        let fit = self.fit * self.zoom * aspect.min(1.0);
        let (near, far) = (distance - self.reach, distance + self.reach);
        let projection = Mat4::perspective_rh_gl(field, aspect, near, far);
        Mat4::from_scale(Vec3::new(fit, fit, 1.0))
            * projection
            * Mat4::from_translation(Vec3::new(0.0, 0.0, -distance))
            * Mat4::from_quat(self.rotation)
            * Mat4::from_scale(Vec3::splat(1.0 / self.radius))
            * Mat4::from_translation(-self.centre)
    }
}

/// Unit principal axes of points, by growing variance, by Jacobi rotations of the covariance.
fn principal_axes(positions: &[f64]) -> [DVec3; 3] {
    let points = positions.as_chunks::<3>().0;
    let n = points.len().max(1) as f64;
    let mean = points.iter().map(|&p| DVec3::from_array(p)).sum::<DVec3>() / n;
    let mut m = [[0.0f64; 3]; 3];
    for &p in points {
        let d = (DVec3::from_array(p) - mean).to_array();
        for i in 0..3 {
            for j in 0..3 {
                m[i][j] += d[i] * d[j] / n;
            }
        }
    }
    let mut axes = [DVec3::X, DVec3::Y, DVec3::Z];
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q].abs() < 1e-300 {
                continue;
            }
            let angle = 0.5 * (2.0 * m[p][q]).atan2(m[q][q] - m[p][p]);
            let (s, c) = angle.sin_cos();
            for row in &mut m {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            let (row_p, row_q) = (m[p], m[q]);
            m[p] = std::array::from_fn(|k| c * row_p[k] - s * row_q[k]);
            m[q] = std::array::from_fn(|k| s * row_p[k] + c * row_q[k]);
            (axes[p], axes[q]) = (c * axes[p] - s * axes[q], s * axes[p] + c * axes[q]);
        }
    }
    let mut order = [0, 1, 2];
    // Nearly equal variances keep z thin and x wide, so that flat and round shapes stand upright.
    let size = m[0][0] + m[1][1] + m[2][2];
    let key = |i: usize| {
        let upright = axes[i].z.abs() - axes[i].x.abs();
        m[i][i] - 0.05 * size * upright
    };
    order.sort_by(|&a, &b| key(a).total_cmp(&key(b)));
    order.map(|i| axes[i].normalize_or(DVec3::Z))
}

/// A window over the plane of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pan {
    /// The point of the plane in the middle of the view.
    pub centre: Vec2,
    /// Half the height or width (the smaller) the view shows, in the map's unit.
    pub extent: f32,
    /// Whether the view follows the map; false after a person moved it.
    pub follows: bool,
}

impl Default for Pan {
    fn default() -> Self {
        Self {
            centre: Vec2::ZERO,
            extent: 1.0,
            follows: true,
        }
    }
}

impl Pan {
    /// The window that shows all of a map (n×2, interleaved) with a margin.
    pub fn fitting(uv: &[f32], size: Vec2) -> Self {
        let points = || {
            uv.as_chunks::<2>()
                .0
                .iter()
                .map(|&p| Vec2::from_array(p))
                .filter(|p| p.is_finite())
        };
        let (low, high) = points().fold((Vec2::MAX, Vec2::MIN), |(l, h), p| (l.min(p), h.max(p)));
        if low.x > high.x {
            return Self::default();
        }
        let half = 0.5 * (high - low);
        let short = size.min_element().max(1.0);
        let extent = (half.x * short / size.x.max(1.0)).max(half.y * short / size.y.max(1.0));
        let extent = if extent > 0.0 { extent * 1.12 } else { 1.0 };
        Self {
            centre: 0.5 * (low + high),
            extent,
            follows: true,
        }
    }

    /// Moves towards `goal` if that is out of sight or much smaller; `rate` 1 jumps.
    /// Returns whether it moved.
    pub fn follow(&mut self, goal: Pan, rate: f32) -> bool {
        if !self.follows {
            return false;
        }
        let off = self.centre.distance(goal.centre) > 0.02 * goal.extent;
        let change = goal.extent / self.extent;
        if !off && (0.94..=1.02).contains(&change) {
            return false;
        }
        self.centre = self.centre.lerp(goal.centre, rate);
        self.extent *= change.powf(rate);
        true
    }

    /// Points of the screen per unit of the map, for a view `size` points large.
    pub fn scale(&self, size: Vec2) -> f32 {
        0.5 * size.min_element() / self.extent
    }

    /// From the map to the view (origin in its middle, y up).
    pub fn to_view(&self, p: Vec2, size: Vec2) -> Vec2 {
        (p - self.centre) * self.scale(size)
    }

    /// From the view (origin in its middle, y up) to the map.
    pub fn to_map(&self, p: Vec2, size: Vec2) -> Vec2 {
        p / self.scale(size) + self.centre
    }

    /// Moves by a drag in view points (y up).
    pub fn drag(&mut self, delta: Vec2, size: Vec2) {
        self.centre -= delta / self.scale(size);
        self.follows = false;
    }

    /// Zooms by a factor, keeping the point under `at` (view points, y up) in place.
    pub fn magnify(&mut self, factor: f32, at: Vec2, size: Vec2) {
        let before = self.to_map(at, size);
        self.extent /= factor.clamp(0.1, 10.0);
        self.centre += before - self.to_map(at, size);
        self.follows = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zoom_keeps_the_point_under_the_cursor() {
        let size = Vec2::new(400.0, 300.0);
        let mut pan = Pan {
            centre: Vec2::new(2.0, -1.0),
            extent: 3.0,
            follows: true,
        };
        let at = Vec2::new(70.0, -40.0);
        let before = pan.to_map(at, size);
        pan.magnify(2.5, at, size);
        assert!(pan.to_map(at, size).distance(before) < 1e-5);
        assert!(!pan.follows);
    }

    #[test]
    fn view_and_map_are_inverse() {
        let (pan, size) = (
            Pan {
                centre: Vec2::new(0.3, 0.1),
                extent: 0.7,
                follows: true,
            },
            Vec2::new(640.0, 480.0),
        );
        let p = Vec2::new(0.9, -0.4);
        assert!(pan.to_map(pan.to_view(p, size), size).distance(p) < 1e-6);
    }

    #[test]
    fn the_fitted_window_shows_every_point() {
        let (uv, size) = (
            [-3.0f32, 0.0, 5.0, 0.5, 0.0, -0.25],
            Vec2::new(500.0, 300.0),
        );
        let pan = Pan::fitting(&uv, size);
        for p in uv.as_chunks::<2>().0 {
            let v = pan.to_view(Vec2::from_array(*p), size).abs();
            assert!(v.x < 250.0 && v.y < 150.0, "{v}");
        }
        assert_eq!(Pan::fitting(&[1.0, 1.0, 1.0, 1.0], size).extent, 1.0);
        assert_eq!(Pan::fitting(&[f32::NAN, 0.0], size), Pan::default());
    }

    #[test]
    fn following_settles() {
        let goal = Pan {
            centre: Vec2::new(1.0, 1.0),
            extent: 5.0,
            follows: true,
        };
        let mut pan = Pan::default();
        assert!((0..200).any(|_| !pan.follow(goal, 0.3)));
        assert!((pan.extent / goal.extent - 1.0).abs() < 0.1);
    }

    #[test]
    fn the_orbit_shows_the_whole_surface_upright() {
        let flat: Vec<f64> = (0..100)
            .flat_map(|i| {
                [
                    f64::from(i % 10),
                    f64::from(i / 10),
                    0.01 * f64::from(i % 3),
                ]
            })
            .collect();
        let orbit = Orbit::around(&flat);
        for aspect in [0.5, 1.0, 2.0] {
            for p in flat.as_chunks::<3>().0 {
                let clip = orbit
                    .matrix(aspect)
                    .project_point3(DVec3::from_array(*p).as_vec3());
                assert!(clip.abs().max_element() <= 1.0, "{clip}");
            }
        }
        let up = orbit.rotation * Vec3::Z;
        assert!(up.y > 0.5 && up.z > 0.3, "seen from above: {up}");
    }

    #[test]
    fn principal_axes_find_the_thin_direction() {
        let thin_x: Vec<f64> = (0..64)
            .flat_map(|i| {
                [
                    0.001 * f64::from(i % 2),
                    f64::from(i % 8),
                    0.5 * f64::from(i / 8),
                ]
            })
            .collect();
        assert!(principal_axes(&thin_x)[0].x.abs() > 0.99);
    }
}
