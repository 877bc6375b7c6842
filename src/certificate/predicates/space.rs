//! On which side of a plane is a point?
//!
//! `robust::orient3d` (Shewchuk's adaptive predicate) is exact as long as no product inside it
//! overflows or falls below the smallest normal number; coordinates that are zero or between
//! [`SAFE_MIN`] and [`SAFE_MAX`] in size cannot do either:
//!
//! * A coordinate of at least 2⁻²⁵⁰ is a multiple of 2⁻³⁰². So are differences, the tails that
//!   rounding cuts off them, and the halves that factors are split into; products of two of these are
//!   multiples of 2⁻⁶⁰⁴, of three of 2⁻⁹⁰⁶, and so are their rounding errors. The error bounds, the
//!   smallest factor of which is above 2⁻¹⁰², stay above 2⁻¹⁰⁰⁸ or are zero.
//! * With coordinates up to 2³⁰⁰ differences are at most 2³⁰¹, products of two of them 2⁶⁰²,
//!   differences of these 2⁶⁰³ — the largest numbers that are split, by way of a factor of 2²⁷ + 1 —
//!   and the sum of three products with a third difference is below 2⁹⁰⁶.
//!
//! Anything outside goes to integers of 6336 bits, wide enough for the product of any three doubles.

use super::wide::WideSum;
use glam::DVec3;
use std::cmp::Ordering;

/// Smallest non-zero coordinate left to `robust`.
const SAFE_MIN: f64 = f64::from_bits((1023 - 250) << 52);
/// Largest coordinate left to `robust`.
const SAFE_MAX: f64 = f64::from_bits((1023 + 300) << 52);

fn is_safe(p: DVec3) -> bool {
    let safe = |x: f64| x == 0.0 || (SAFE_MIN..=SAFE_MAX).contains(&x.abs());
    safe(p.x) && safe(p.y) && safe(p.z)
}

/// Exact sign of the volume of the tetrahedron a, b, c, d, that is of det [b−a, c−a, d−a]: `Greater`
/// when b, c, d turn counter-clockwise seen from the side of their plane that `a` is not on, `Less` when
/// clockwise, `Equal` when all are in one plane. All coordinates must be finite; with one that is not,
/// the answer is `Equal`.
pub fn orientation_of_tetrahedron(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Ordering {
    if is_safe(a) && is_safe(b) && is_safe(c) && is_safe(d) {
        let coord = |p: DVec3| robust::Coord3D {
            x: p.x,
            y: p.y,
            z: p.z,
        };
        // Positive there is a fourth point on the side from which a, b, c turn clockwise: a volume
        // below zero here.
        let det = robust::orient3d(coord(a), coord(b), coord(c), coord(d));
        0.0f64.partial_cmp(&det).unwrap_or(Ordering::Equal)
    } else if a.is_finite() && b.is_finite() && c.is_finite() && d.is_finite() {
        orientation_by_integers([a, b, c, d])
    } else {
        Ordering::Equal
    }
}

/// 64-bit words of the wide integers: 3 · (1074 + 1024) bits and four bits of carry.
const WORDS: usize = 99;

/// The determinant of the rows (1, x, y, z) of the four points, by the first column: the sum of
/// ± det [p, q, r] over the four triples, six products each.
fn orientation_by_integers(points: [DVec3; 4]) -> Ordering {
    let mut sum = WideSum::<WORDS>::ZERO;
    for left_out in 0..4 {
        let rest = [0, 1, 2].map(|i| points[if i < left_out { i } else { i + 1 }]);
        for i in 0..3 {
            let [p, q, r] = [0, 1, 2].map(|k| rest[(i + k) % 3]);
            let odd = left_out % 2 == 1;
            sum.add([p.x, q.y, r.z], odd);
            sum.add([p.x, r.y, q.z], !odd);
        }
    }
    sum.sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    fn exact([a, b, c, d]: [DVec3; 4]) -> Ordering {
        let difference = |p: DVec3| {
            let r = |x: f64| RBig::try_from(x).expect("finite");
            [0, 1, 2].map(|i| r(p[i]) - r(a[i]))
        };
        let [u, v, w] = [b, c, d].map(difference);
        let minor = |i: usize, j: usize| &v[i] * &w[j] - &v[j] * &w[i];
        let det = &u[0] * minor(1, 2) + &u[1] * minor(2, 0) + &u[2] * minor(0, 1);
        det.cmp(&RBig::ZERO)
    }

    fn orientation([a, b, c, d]: [DVec3; 4]) -> Ordering {
        orientation_of_tetrahedron(a, b, c, d)
    }

    #[test]
    fn the_unit_tetrahedron_is_positive() {
        let unit = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        for scale in [1.0, SAFE_MIN, SAFE_MIN / 2.0, SAFE_MAX, 2.0 * SAFE_MAX] {
            let [a, b, c, d] = unit.map(|p| p * scale);
            assert_eq!(orientation([a, b, c, d]), Ordering::Greater);
            assert_eq!(orientation([b, a, c, d]), Ordering::Less);
            assert_eq!(orientation([b, c, a, d]), Ordering::Greater);
            assert_eq!(orientation([b, c, d, a]), Ordering::Less);
            assert_eq!(orientation([a, b, c, c]), Ordering::Equal);
            assert_eq!(orientation_by_integers([a, b, c, d]), Ordering::Greater);
        }
    }

    #[test]
    fn one_ulp_off_a_plane_is_seen() {
        let [a, b, c] = [(0.1, 0.2), (0.7, 0.3), (0.4, 0.9)].map(|(x, y)| DVec3::new(x, y, x + y));
        let base = [(0.5, 0.25), (0.3, 0.75), (12.0, 1.5)];
        for (x, y) in base {
            let z: f64 = x + y;
            let sides: Vec<Ordering> = [z.next_down(), z, z.next_up()]
                .iter()
                .map(|&z| orientation([a, b, c, DVec3::new(x, y, z)]))
                .collect();
            // The plane of the rounded points passes within an ulp or two.
            assert!(sides.is_sorted(), "{sides:?}");
            for z in [z.next_down(), z, z.next_up()] {
                let points = [a, b, c, DVec3::new(x, y, z)];
                assert_eq!(orientation(points), exact(points));
            }
        }
    }

    #[test]
    fn extreme_ranges_stay_exact() {
        let (tiny, huge) = (f64::from_bits(1), f64::MAX);
        let at = |x, y, z| DVec3::new(x, y, z);
        let o = DVec3::ZERO;
        for size in [tiny, huge] {
            let points = [
                o,
                at(size, 0.0, 0.0),
                at(0.0, size, 0.0),
                at(0.0, 0.0, size),
            ];
            assert_eq!(orientation(points), Ordering::Greater);
        }
        let points = [
            DVec3::splat(-huge),
            at(huge, -huge, 0.0),
            at(0.0, huge, tiny),
            at(tiny, huge, huge.next_down()),
        ];
        assert_eq!(orientation(points), exact(points));
        let flat = [
            o,
            at(huge, tiny, 0.0),
            at(tiny, huge, 0.0),
            at(1.0, 1.0, 0.0),
        ];
        assert_eq!(orientation(flat), Ordering::Equal);
        let lifted = [flat[0], flat[1], flat[2], at(1.0, 1.0, tiny)];
        assert_eq!(orientation(lifted), Ordering::Greater);
        for bad in [f64::NAN, f64::INFINITY] {
            let points = [o, at(bad, 0.0, 0.0), DVec3::Y, DVec3::Z];
            assert_eq!(orientation(points), Ordering::Equal);
        }
    }

    fn any_finite() -> impl Strategy<Value = f64> {
        any::<u64>()
            .prop_map(f64::from_bits)
            .prop_filter("finite", |x| x.is_finite())
    }

    fn points(v: [f64; 12]) -> [DVec3; 4] {
        [0, 3, 6, 9].map(|i| DVec3::new(v[i], v[i + 1], v[i + 2]))
    }

    proptest! {
        #[test]
        fn agrees_with_rationals_on_any_doubles(v in prop::array::uniform12(any_finite())) {
            prop_assert_eq!(orientation(points(v)), exact(points(v)));
        }

        #[test]
        fn agrees_with_rationals_at_the_ends_of_the_safe_range(
            v in prop::array::uniform12((-2i32..=2, 0.0f64..1.0)), high: bool,
        ) {
            // Zeros, and numbers on both sides of a bound.
            let scale = if high { SAFE_MAX } else { SAFE_MIN };
            let v = v.map(|(k, x)| f64::from(k.signum()) * (1.0 + x) * 2f64.powi(k) * scale);
            prop_assert_eq!(orientation(points(v)), exact(points(v)));
            prop_assert_eq!(orientation_by_integers(points(v)), exact(points(v)));
        }

        #[test]
        fn agrees_with_rationals_close_to_a_plane(
            v in prop::array::uniform9(-1.0f64..1.0), s in -2.0f64..2.0, t in -2.0f64..2.0,
            ulps in -2i64..=2, e in -330i32..330,
        ) {
            let [a, b, c] = [0, 3, 6].map(|i| DVec3::new(v[i], v[i + 1], v[i + 2]));
            let d = a + s * (b - a) + t * (c - a);
            let d = DVec3::new(d.x, d.y, f64::from_bits((d.z.to_bits() as i64 + ulps) as u64));
            for scale in [1.0, 2f64.powi(e)] {
                let four = [a, b, c, d].map(|p| p * scale);
                prop_assert_eq!(orientation(four), exact(four));
                prop_assert_eq!(orientation_by_integers(four), exact(four));
            }
        }

        #[test]
        fn agrees_with_rationals_on_coordinates_of_any_size_in_the_safe_range(
            v in prop::array::uniform12((-248i32..298, -1.0f64..1.0)), flat: bool,
        ) {
            let mut four = points(v.map(|(e, x)| (x + x.signum()) * 2f64.powi(e)));
            if flat {
                // Two differences that are parallel but for rounding.
                four[3] = four[0] + (four[1] - four[0]) * 0.5;
            }
            prop_assert_eq!(orientation(four), exact(four));
        }
    }
}
