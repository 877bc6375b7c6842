//! On which side of a line is a point?
//!
//! `robust::orient2d` (Shewchuk's adaptive predicate) is exact as long as no product inside it
//! overflows or falls below the smallest normal number. Coordinates that are zero or between
//! [`SAFE_MIN`] and [`SAFE_MAX`] in size cannot do either. Anything outside goes to integers of
//! 4480 bits, wide enough for the product of any two doubles: slow, exact and never needed by a
//! sane map. (Scaling by a power of two would not do: the doubles of one triangle can span 2098
//! binary orders of magnitude.)

use super::wide::WideSum;
use glam::DVec2;
use std::cmp::Ordering;

/// Smallest non-zero coordinate left to `robust`: a coordinate is then a multiple of 2⁻⁴⁵², a
/// product of two differences a multiple of 2⁻⁹⁰⁴, far above the subnormal numbers.
const SAFE_MIN: f64 = f64::from_bits((1023 - 400) << 52);
/// Largest coordinate left to `robust`: products stay below 2¹⁰⁰³ and can be split.
const SAFE_MAX: f64 = f64::from_bits((1023 + 500) << 52);

fn is_safe(x: f64) -> bool {
    x == 0.0 || (SAFE_MIN..=SAFE_MAX).contains(&x.abs())
}

/// Exact side of `c` seen from `a` towards `b`: `Greater` when a, b, c turn counter-clockwise
/// (c on the left), `Less` when clockwise, `Equal` when they are on one line. All coordinates must
/// be finite; with one that is not, the answer is `Equal`.
pub fn orientation(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
    let safe = |p: DVec2| is_safe(p.x) && is_safe(p.y);
    if safe(a) && safe(b) && safe(c) {
        let coord = |p: DVec2| robust::Coord { x: p.x, y: p.y };
        let det = robust::orient2d(coord(a), coord(b), coord(c));
        det.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
    } else if a.is_finite() && b.is_finite() && c.is_finite() {
        orientation_by_integers(a, b, c)
    } else {
        Ordering::Equal
    }
}

/// Lexicographic order of points: by x, then by y.
pub fn compare_points(a: DVec2, b: DVec2) -> Ordering {
    let by = |p: f64, q: f64| p.partial_cmp(&q).unwrap_or(Ordering::Equal);
    by(a.x, b.x).then(by(a.y, b.y))
}

/// 64-bit words of the wide integers: 2 · (1074 + 1024) bits and three bits of carry.
const WORDS: usize = 70;

/// The determinant as the difference of two sums of exact products:
/// (aₓb_y + bₓc_y + cₓa_y) − (a_y bₓ + b_y cₓ + c_y aₓ).
fn orientation_by_integers(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
    let mut sum = WideSum::<WORDS>::ZERO;
    for (p, q, subtract) in [
        (a.x, b.y, false),
        (b.x, c.y, false),
        (c.x, a.y, false),
        (a.y, b.x, true),
        (b.y, c.x, true),
        (c.y, a.x, true),
    ] {
        sum.add([p, q], subtract);
    }
    sum.sign()
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    fn exact(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
        let r = |x: f64| RBig::try_from(x).expect("finite");
        let det = (r(b.x) - r(a.x)) * (r(c.y) - r(a.y)) - (r(b.y) - r(a.y)) * (r(c.x) - r(a.x));
        det.cmp(&RBig::ZERO)
    }

    #[test]
    fn one_ulp_off_a_line_is_seen() {
        let (a, b) = (DVec2::new(0.1, 0.1), DVec2::new(0.7, 0.7));
        for t in [0.1, 0.2, 0.3, 0.5, 0.9, 12.0, 1e-9] {
            let on = DVec2::splat(t);
            assert_eq!(orientation(a, b, on), Ordering::Equal);
            let above = DVec2::new(on.x, on.y.next_up());
            assert_eq!(orientation(a, b, above), Ordering::Greater);
            let below = DVec2::new(on.x, on.y.next_down());
            assert_eq!(orientation(a, b, below), Ordering::Less);
        }
    }

    #[test]
    fn extreme_ranges_stay_exact() {
        let (tiny, huge) = (f64::from_bits(1), f64::MAX);
        let o = DVec2::ZERO;
        let ccw = |a, b, c| orientation(a, b, c) == Ordering::Greater;
        assert!(ccw(o, DVec2::new(tiny, 0.0), DVec2::new(0.0, tiny)));
        assert!(ccw(o, DVec2::new(huge, 0.0), DVec2::new(0.0, huge)));
        assert!(ccw(
            DVec2::new(-huge, -huge),
            DVec2::new(huge, huge.next_down()),
            DVec2::new(huge, huge),
        ));
        assert!(ccw(o, DVec2::new(huge, 0.0), DVec2::new(huge, tiny)));
        assert_eq!(
            orientation(o, DVec2::splat(huge), DVec2::splat(tiny)),
            Ordering::Equal
        );
        assert_eq!(
            orientation(o, DVec2::new(f64::NAN, 0.0), DVec2::Y),
            Ordering::Equal
        );
    }

    fn any_finite() -> impl Strategy<Value = f64> {
        any::<u64>()
            .prop_map(f64::from_bits)
            .prop_filter("finite", |x| x.is_finite())
    }

    proptest! {
        #[test]
        fn agrees_with_rationals_on_any_doubles(v in prop::array::uniform6(any_finite())) {
            let [a, b, c] = [0, 2, 4].map(|i| DVec2::new(v[i], v[i + 1]));
            prop_assert_eq!(orientation(a, b, c), exact(a, b, c));
        }

        #[test]
        fn agrees_with_rationals_close_to_a_line(
            v in prop::array::uniform4(-1.0f64..1.0), t in -2.0f64..2.0, ulps in -2i64..=2, e in -1000i32..1000,
        ) {
            let (a, b) = (DVec2::new(v[0], v[1]), DVec2::new(v[2], v[3]));
            let c = a + t * (b - a);
            let c = DVec2::new(c.x, f64::from_bits((c.y.to_bits() as i64 + ulps) as u64));
            for s in [1.0, 2f64.powi(e)] {
                let [a, b, c] = [a * s, b * s, c * s];
                prop_assert_eq!(orientation(a, b, c), exact(a, b, c));
                let wide = orientation_by_integers(a, b, c);
                prop_assert_eq!(wide, exact(a, b, c));
            }
        }
    }
}
