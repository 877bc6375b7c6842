//! How a deformation stretches each tetrahedron: the singular values of its gradient.

use glam::{DMat3, DVec3};

/// The fourth vertex of a triangle of a plane: above its first by one, wherever that is. Of the singular values one is
/// then 1, so that worst stretch, volume (here area) and inversion are those of the triangle.
pub const ABOVE: u32 = u32::MAX;

/// A least singular value below this part of the largest is nothing but rounding.
const FLAT: f64 = 1e-12;

/// Inverses of the rest edge matrices.
#[derive(Debug, Clone, Default)]
pub struct RestShapes {
    inverses: Vec<DMat3>,
}

/// The singular values of one deformation gradient; the smallest is negative where the tetrahedron
/// is inverted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretches {
    /// The largest.
    pub largest: f64,
    /// The one between.
    pub middle: f64,
    /// The smallest, with the sign of the determinant.
    pub smallest: f64,
}

impl Stretches {
    /// Of a deformation gradient: square roots of the eigenvalues of FᵀF.
    pub fn of(gradient: DMat3) -> Self {
        let [a, b, c] = eigenvalues(gradient.transpose() * gradient).map(|x| x.max(0.0).sqrt());
        let volume = gradient.determinant();
        // The least singular value of a flat tetrahedron comes better from the volume.
        let least = if a * b > 0.0 {
            c.min(volume.abs() / (a * b))
        } else {
            0.0
        };
        Self {
            largest: a,
            middle: b,
            smallest: if volume > 0.0 { least } else { -least },
        }
    }

    /// max(σ₁, 1/σ₃): how much a length is stretched or squeezed at worst; `None` for an inverted
    /// or collapsed tetrahedron.
    pub fn worst(self) -> Option<f64> {
        // What is flat has a determinant of rounding errors.
        (self.smallest > FLAT * self.largest).then(|| self.largest.max(1.0 / self.smallest))
    }

    /// Volume over rest volume.
    pub fn volume(self) -> f64 {
        self.largest * self.middle * self.smallest
    }
}

impl RestShapes {
    /// From rest positions (n×3) and tetrahedra in range. A tetrahedron turned inside out at rest
    /// is taken as it is.
    pub fn new(positions: &[f64], tetrahedra: &[[u32; 4]]) -> Self {
        let point = |v: u32| DVec3::from_slice(&positions[3 * v as usize..]);
        let inverses = tetrahedra
            .iter()
            .map(|t| edges(places(*t, point)).inverse())
            .collect();
        Self { inverses }
    }

    /// The stretches of tetrahedron `t` with vertices at `corners`.
    pub fn stretches(&self, t: usize, corners: [DVec3; 4]) -> Stretches {
        Stretches::of(edges(corners) * self.inverses[t])
    }
}

/// The corners of a tetrahedron in positions (n×3).
pub fn corners(tetrahedron: [u32; 4], positions: &[f32]) -> [DVec3; 4] {
    places(tetrahedron, |v| {
        let p = 3 * v as usize;
        DVec3::new(
            f64::from(positions[p]),
            f64::from(positions[p + 1]),
            f64::from(positions[p + 2]),
        )
    })
}

fn places(tetrahedron: [u32; 4], point: impl Fn(u32) -> DVec3) -> [DVec3; 4] {
    let first = point(tetrahedron[0]);
    tetrahedron.map(|v| match v {
        ABOVE => first + DVec3::Z,
        _ => point(v),
    })
}

fn edges([a, b, c, d]: [DVec3; 4]) -> DMat3 {
    DMat3::from_cols(b - a, c - a, d - a)
}

/// Eigenvalues of a symmetric matrix, largest first (Smith 1961, by the angle of the cubic).
fn eigenvalues(m: DMat3) -> [f64; 3] {
    let mean = (m.x_axis.x + m.y_axis.y + m.z_axis.z) / 3.0;
    let off = m.x_axis.y.powi(2) + m.x_axis.z.powi(2) + m.y_axis.z.powi(2);
    let diagonal = DVec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z) - DVec3::splat(mean);
    let p = ((diagonal.length_squared() + 2.0 * off) / 6.0).sqrt();
    if !(p > f64::EPSILON * mean.abs()) {
        return [mean; 3];
    }
    let shifted = (m - DMat3::from_diagonal(DVec3::splat(mean))) * (1.0 / p);
    let angle = (0.5 * shifted.determinant()).clamp(-1.0, 1.0).acos() / 3.0;
    let first = mean + 2.0 * p * angle.cos();
    let last = mean + 2.0 * p * (angle + std::f64::consts::TAU / 3.0).cos();
    [first, 3.0 * mean - first - last, last]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(angle: f64) -> DMat3 {
        DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), angle)
    }

    #[test]
    fn rotations_do_not_stretch() {
        let s = Stretches::of(turn(2.4));
        assert!((s.largest - 1.0).abs() < 1e-7 && (s.smallest - 1.0).abs() < 1e-7);
        assert!((s.worst().unwrap() - 1.0).abs() < 1e-7);
    }

    #[test]
    fn singular_values_are_found_between_rotations() {
        for values in [[3.0, 1.5, 0.25], [2.0, 2.0, 1.0], [1.0, 0.5, 1e-3]] {
            let [a, b, c] = values;
            for sign in [1.0, -1.0] {
                let stretch = DMat3::from_diagonal(DVec3::new(a, b, sign * c));
                let s = Stretches::of(turn(0.7) * stretch * turn(-1.9));
                assert!((s.largest - a).abs() < 1e-6 * a, "{s:?}");
                assert!((s.middle - b).abs() < 1e-6 * a, "{s:?}");
                assert!((s.smallest - sign * c).abs() < 1e-6 * a, "{s:?}");
                assert!((s.volume() - sign * a * b * c).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn inverted_and_collapsed_tetrahedra_have_no_worst_stretch() {
        let mirror = DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
        assert_eq!(Stretches::of(mirror).worst(), None);
        assert_eq!(Stretches::of(DMat3::ZERO).worst(), None);
        for k in 0..20 {
            let flat = DMat3::from_diagonal(DVec3::new(1.0, 0.5, 0.0));
            let turned = turn(0.3 * f64::from(k)) * flat * turn(1.0 - f64::from(k));
            assert_eq!(Stretches::of(turned).worst(), None, "{k}");
        }
    }

    #[test]
    fn a_triangle_of_the_plane_is_stretched_as_in_the_plane() {
        let rest = [0.0, 0.0, 2.0, 1.0, 0.0, 2.0, 0.0, 1.0, 2.0];
        let shapes = RestShapes::new(&rest, &[[0, 1, 2, ABOVE]]);
        let at = |x: f32, y: f32| {
            let moved = [0.0, 0.0, 2.0, x, 0.0, 2.0, 0.0, y, 2.0];
            shapes.stretches(0, corners([0, 1, 2, ABOVE], &moved))
        };
        for (x, y, worst) in [(3.0, 2.0, 3.0), (0.5, 0.25, 4.0), (2.0, 0.25, 4.0)] {
            let s = at(x, y);
            assert!((s.worst().unwrap() - worst).abs() < 1e-6, "{s:?}");
            assert!((s.volume() - f64::from(x * y)).abs() < 1e-6, "{s:?}");
        }
        assert_eq!(at(3.0, -2.0).worst(), None);
        assert_eq!(at(0.5, -0.5).worst(), None);
    }

    #[test]
    fn the_rest_shape_is_not_stretched() {
        let (positions, tetrahedra, _) = crate::solid::tests::cube();
        let tetrahedra = tetrahedra.as_chunks::<4>().0;
        let rest = RestShapes::new(&positions, tetrahedra);
        let single: Vec<f32> = positions.iter().map(|p| *p as f32).collect();
        for (t, tetrahedron) in tetrahedra.iter().enumerate() {
            let s = rest.stretches(t, corners(*tetrahedron, &single));
            assert!((s.worst().unwrap() - 1.0).abs() < 1e-7);
        }
    }
}
