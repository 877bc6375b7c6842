//! Singular values of a deformation, in floating point: for information beside what is proven.

use super::super::distortion::normalizing;
use crate::space::{Solid, Space};
use glam::{DMat3, DVec3};
use std::cmp::Ordering;

/// The edges of a tetrahedron from its first corner, scaled by the power of two that brings the largest
/// component between 1 and 2, and that power.
fn edges([a, b, c, d]: [DVec3; 4]) -> (DMat3, f64) {
    let edges = [b - a, c - a, d - a];
    let largest = edges
        .iter()
        .fold(0.0, |l: f64, e| l.max(e.abs().max_element()));
    let scale = normalizing(largest);
    let [x, y, z] = edges.map(|e| e * scale);
    (DMat3::from_cols(x, y, z), scale)
}

/// Smallest (signed) and largest singular value of F = Ds Dm⁻¹; `sign` is the exact sign of its
/// determinant.
pub(super) fn extremes(rest: [DVec3; 4], image: [DVec3; 4], sign: Ordering) -> (f64, f64) {
    let ((dm, rest_scale), (ds, image_scale)) = (edges(rest), edges(image));
    let f = ds * dm.inverse();
    let ratio = rest_scale / image_scale;
    if !(f.is_finite() && ratio.is_finite()) {
        return (f64::NAN, f64::NAN);
    }
    let (sigma, _) = Solid::svd(f.to_cols_array());
    let smallest = (sigma[2] * ratio).abs();
    // The exact sign has the last word.
    let smallest = match sign {
        Ordering::Equal => 0.0,
        Ordering::Greater => smallest.max(f64::MIN_POSITIVE),
        Ordering::Less => -smallest.max(f64::MIN_POSITIVE),
    };
    (smallest, sigma[0] * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::orientation_of_tetrahedron;

    #[test]
    fn known_matrices_at_any_scale() {
        let unit = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.8);
        for (stretch, expected) in [
            (DVec3::ONE, (1.0, 1.0)),
            (DVec3::new(2.0, 0.5, 1.0), (0.5, 2.0)),
            (DVec3::new(2.0, 0.5, -1.0), (-0.5, 2.0)),
            (DVec3::new(3.0, 0.0, 1.0), (0.0, 3.0)),
        ] {
            for (s, t) in [
                (1.0, 1.0),
                (2f64.powi(-600), 2f64.powi(-500)),
                (2f64.powi(700), 3.0),
            ] {
                let rest = unit.map(|p| p * s);
                let image = unit.map(|p| turn * (p * stretch) * t);
                // A flat image is flat by its sign, whatever rounding made of it.
                let sign = match stretch.y == 0.0 {
                    true => Ordering::Equal,
                    false => orientation_of_tetrahedron(image[0], image[1], image[2], image[3]),
                };
                let (smallest, largest) = extremes(rest, image, sign);
                let close = |x: f64, y: f64| (x - y * t / s).abs() <= 1e-13 * largest;
                assert!(close(smallest, expected.0) && close(largest, expected.1));
            }
        }
    }
}
