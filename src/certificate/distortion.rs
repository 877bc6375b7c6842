//! Singular values and symmetric Dirichlet energy of a map, measured triangle by triangle.
//!
//! Formulas: F = [u₁−u₀, u₂−u₀] · [x₁−x₀, x₂−x₀]⁻¹ with x the rest triangle in its own plane. With
//! α = ((a+d)/2, (c−b)/2) and β = ((a−d)/2, (b+c)/2), the parts of F = (a b; c d) that keep and that
//! reverse orientation, σ₁ = |α| + |β| and σ₂ = |α| − |β|; where that difference cancels,
//! σ₂ = det F / σ₁ with det F from the robust orientation predicate.

use super::predicates::orientation;
use crate::mesh::SurfaceMesh;
use glam::{DVec2, DVec3};
use std::cmp::Ordering;

/// Measures of a whole map.
pub(super) struct Distortion {
    pub symmetric_dirichlet: f64,
    pub smallest_sigma: f64,
    pub largest_sigma: f64,
    pub worst_anisotropy: f64,
    /// Triangles without area at rest, which have no singular values.
    pub flat_at_rest: usize,
}

/// Singular values of (a b; c d), the larger first; the smaller has the sign of the determinant.
fn singular_values([a, b, c, d]: [f64; 4]) -> (f64, f64) {
    let alpha = ((a + d) * 0.5).hypot((c - b) * 0.5);
    let beta = ((a - d) * 0.5).hypot((b + c) * 0.5);
    (alpha + beta, alpha - beta)
}

/// The power of two that brings the largest coordinate between 1 and 2; 1 when there is none.
pub(super) fn normalizing(largest: f64) -> f64 {
    if largest == 0.0 || !largest.is_finite() {
        return 1.0;
    }
    // Subnormal numbers are treated as the smallest normal one: their inverse would overflow.
    let exponent = (largest.to_bits() >> 52).clamp(1, 2045);
    f64::from_bits((2046 - exponent) << 52)
}

/// Signed singular values of one triangle (σ₁ ≥ |σ₂|) and its rest area; `None` without an area.
fn triangle(x: [DVec3; 3], u: [DVec2; 3], sign: Ordering) -> Option<(f64, f64, f64)> {
    let (e, f) = (x[1] - x[0], x[2] - x[0]);
    let length = e.length();
    let doubled = e.cross(f).length();
    if !(length > 0.0 && doubled > 0.0 && doubled.is_finite()) {
        return None;
    }
    // The rest triangle in its plane is (0,0), (length, 0), (along, height).
    let (along, height) = (e.dot(f) / length, doubled / length);
    let (p, q) = (u[1] - u[0], u[2] - u[0]);
    let first = p / length;
    let second = (q - first * along) / height;
    let (s1, difference) = singular_values([first.x, second.x, first.y, second.y]);
    let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
    let s2 = if difference.abs() > 0.25 * s1 {
        difference
    } else if s1 > 0.0 {
        robust::orient2d(coord(u[0]), coord(u[1]), coord(u[2])) / doubled / s1
    } else {
        0.0
    };
    // The exact sign has the last word.
    let s2 = match sign {
        Ordering::Equal => 0.0,
        Ordering::Greater => s2.abs().max(f64::MIN_POSITIVE),
        Ordering::Less => -s2.abs().max(f64::MIN_POSITIVE),
    };
    Some((s1, s2, 0.5 * doubled))
}

/// Measures the map `uv` of `rest`. A triangle with a coordinate that is not finite, at rest or in
/// the map, makes every measure NaN or infinite.
pub(super) fn measure(rest: &SurfaceMesh, uv: &[DVec2]) -> Distortion {
    let largest = |v: &mut dyn Iterator<Item = f64>| v.fold(0.0, f64::max);
    let origin = rest.positions.first().copied().unwrap_or_default();
    let rest_scale = normalizing(largest(
        &mut rest.positions.iter().map(|p| p.abs().max_element()),
    ));
    let map_scale = normalizing(largest(&mut uv.iter().map(|p| p.abs().max_element())));
    let origin = origin * rest_scale;
    // σ = σ of the scaled triangles · rest_scale / map_scale
    let ratio = rest_scale / map_scale;

    let mut area_sum = 0.0;
    let mut energy_sum = 0.0;
    let mut flat_at_rest = 0;
    let (mut smallest, mut largest, mut worst) = (f64::INFINITY, 0.0f64, 1.0f64);
    for t in &rest.simplices {
        let x = t.map(|v| rest.positions[v as usize] * rest_scale - origin);
        let exact = t.map(|v| uv[v as usize]);
        if !(exact.iter().all(|p| p.is_finite()) && x.iter().all(|p| p.is_finite())) {
            return Distortion {
                symmetric_dirichlet: f64::INFINITY,
                smallest_sigma: f64::NAN,
                largest_sigma: f64::NAN,
                worst_anisotropy: f64::INFINITY,
                flat_at_rest,
            };
        }
        let sign = orientation(exact[0], exact[1], exact[2]);
        let Some((s1, s2, area)) = triangle(x, exact.map(|p| p * map_scale), sign) else {
            flat_at_rest += 1;
            continue;
        };
        let (s1, s2) = (s1 * ratio, s2 * ratio);
        area_sum += area;
        energy_sum += area
            * if s2 > 0.0 {
                // ψ − 4 without cancellation near an isometry.
                let term = |s: f64| (s - s.recip()) * (s - s.recip());
                term(s1) + term(s2)
            } else {
                f64::INFINITY
            };
        smallest = smallest.min(s2);
        largest = largest.max(s1);
        worst = worst.max(if s2 == 0.0 {
            f64::INFINITY
        } else {
            s1 / s2.abs()
        });
    }
    let measured = flat_at_rest < rest.simplices.len();
    let or_nan = |x: f64| if measured { x } else { f64::NAN };
    Distortion {
        symmetric_dirichlet: or_nan(1.0 + 0.25 * energy_sum / area_sum),
        smallest_sigma: or_nan(smallest),
        largest_sigma: or_nan(largest),
        worst_anisotropy: or_nan(worst),
        flat_at_rest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const REST: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn sigmas(f: [f64; 4]) -> (f64, f64) {
        let u = [DVec2::ZERO, DVec2::new(f[0], f[2]), DVec2::new(f[1], f[3])];
        let (s1, s2, area) = triangle(REST, u, orientation(u[0], u[1], u[2])).expect("area");
        assert_eq!(area, 0.5);
        (s1, s2)
    }

    #[test]
    fn singular_values_of_known_matrices() {
        assert_eq!(sigmas([1.0, 0.0, 0.0, 1.0]), (1.0, 1.0));
        assert_eq!(sigmas([2.0, 0.0, 0.0, -3.0]), (3.0, -2.0));
        assert_eq!(sigmas([0.0; 4]), (0.0, 0.0));
        assert_eq!(sigmas([1.0, 1.0, 1.0, 1.0]), (2.0, 0.0));
        // Nearly singular: the small one keeps its digits.
        let (s1, s2) = sigmas([1.0, 0.0, 0.0, 1e-14]);
        assert!((s1 - 1.0).abs() < 1e-15 && (s2 / 1e-14 - 1.0).abs() < 1e-12);
        let (_, s2) = sigmas([1e-160, 0.0, 0.0, -1e-160]);
        assert!((s2 / -1e-160 - 1.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn singular_values_reproduce_norm_and_determinant(f in prop::array::uniform4(-10.0f64..10.0)) {
            let (s1, s2) = sigmas(f);
            let norm = f.iter().map(|x| x * x).sum::<f64>();
            prop_assert!((s1 * s1 + s2 * s2 - norm).abs() <= 1e-13 * norm);
            let det = f[0] * f[3] - f[1] * f[2];
            prop_assert!((s1 * s2 - det).abs() <= 1e-13 * norm);
            prop_assert!(s1 >= s2.abs() * (1.0 - 1e-15));
        }

        #[test]
        fn rotated_frames_agree(angle in 0.0..6.2, s in prop::array::uniform2(1e-6f64..1e6)) {
            let r = DVec2::from_angle(angle);
            let (s1, s2) = sigmas([r.x * s[0], -r.y * s[1], r.y * s[0], r.x * s[1]]);
            prop_assert!((s1 / s[0].max(s[1]) - 1.0).abs() < 1e-12);
            prop_assert!((s2 / s[0].min(s[1]) - 1.0).abs() < 1e-8);
        }
    }
}
