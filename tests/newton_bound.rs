//! The step bound against roots that are known exactly.

mod random;

use dashu_ratio::RBig;
use foldfree::newton::bound::{area_coefficients, first_root, volume_coefficients};
use random::Random;

/// The Bernstein coefficients of degree 3 on [0, 1] of a cubic with these monomial coefficients.
fn bernstein(a: [RBig; 4]) -> [RBig; 4] {
    let third = |n: i64| RBig::from_parts(n.into(), 3u8.into());
    let [a0, a1, a2, a3] = a;
    [
        a0.clone(),
        &a0 + third(1) * &a1,
        &a0 + third(2) * &a1 + third(1) * &a2,
        &a0 + &a1 + &a2 + &a3,
    ]
}

/// The product of (1 − u/r) over the roots r.
fn with_roots(roots: &[RBig]) -> [RBig; 4] {
    let mut a = [RBig::ONE, RBig::ZERO, RBig::ZERO, RBig::ZERO];
    for r in roots {
        let mut next = a.clone();
        for k in 0..3 {
            next[k + 1] = &next[k + 1] - &a[k] / r;
        }
        a = next;
    }
    a
}

fn floats(a: [RBig; 4]) -> [f64; 4] {
    a.map(|x| x.to_f64().value())
}

fn rational(x: f64) -> RBig {
    RBig::try_from(x).unwrap()
}

/// The smallest root in (0, 1].
fn smallest(roots: &[f64]) -> f64 {
    let inside = roots.iter().copied().filter(|&r| r > 0.0 && r <= 1.0);
    inside.fold(f64::INFINITY, f64::min)
}

#[test]
fn cubics_of_known_roots() {
    let mut random = Random(5);
    let mut finite = 0;
    for case in 0..20_000 {
        let count = case % 3 + 1;
        let scales = [1e-6, 1e-3, 0.3, 1.5, 40.0];
        let mut roots: Vec<f64> = (0..count)
            .map(|_| {
                let scale = scales[((random.next() + 1.0) * 2.5) as usize % 5];
                scale * random.next()
            })
            .filter(|r| r.abs() > 1e-12)
            .collect();
        let apart = |a: f64, b: f64| (a - b).abs() > 1e-3 * a.abs();
        let first = smallest(&roots);
        if roots.iter().any(|&r| r != first && !apart(first, r)) {
            roots = vec![roots[0]];
        }
        let exact: Vec<RBig> = roots.iter().map(|&r| rational(r)).collect();
        let expected = smallest(&roots);
        let found = first_root(floats(bernstein(with_roots(&exact))));
        if expected == f64::INFINITY {
            assert!(
                found == f64::INFINITY || found > 1.0 - 1e-9,
                "{roots:?}: {found}"
            );
        } else {
            finite += 1;
            // the coefficients are rounded, which moves roots by this much for the gaps above
            let error = (found - expected) / expected;
            assert!(error.abs() < 1e-8, "{roots:?}: {found} for {expected}");
        }
    }
    assert!(finite > 5_000);
}

#[test]
fn double_roots_and_near_misses() {
    let mut random = Random(6);
    for _ in 0..5_000 {
        let r = 0.5 + 0.45 * random.next();
        let other = 3.0 + 2.0 * random.next();
        let found = first_root(floats(bernstein(with_roots(&[
            rational(r),
            rational(r),
            rational(other),
        ]))));
        // to √ε: with the coefficients rounded there may be two roots, or none
        let near = (found / r - 1.0).abs() < 1e-6;
        assert!(near || found == f64::INFINITY, "{r}: {found}");
        // a little lower there are two
        let mut lower = floats(bernstein(with_roots(&[
            rational(r),
            rational(r),
            rational(other),
        ])));
        lower.iter_mut().for_each(|b| *b -= 1e-6);
        let found = first_root(lower);
        assert!(found < r && found > r - 0.01, "{r}: {found}");
    }
    // (u − a)² + b² has none
    for b in [1e-3, 0.1, 1.0] {
        for a in [0.1, 0.5, 0.9] {
            let [a, b] = [rational(a), rational(b)];
            let quadratic = [
                &a * &a + &b * &b,
                RBig::from(-2) * &a,
                RBig::ONE,
                RBig::ZERO,
            ];
            assert_eq!(first_root(floats(bernstein(quadratic))), f64::INFINITY);
        }
    }
}

#[test]
fn scale_changes_nothing() {
    let mut random = Random(7);
    for _ in 0..2_000 {
        let mut b: [f64; 4] = random.many();
        b[0] = b[0].abs() + 1e-3;
        let root = first_root(b);
        for power in [-900, -300, -3, 5, 300, 900] {
            let factor = 2.0f64.powi(power);
            assert_eq!(first_root(b.map(|x| x * factor)), root);
        }
        // no sign change before it
        if root.is_finite() {
            let value = |u: f64| {
                let v = 1.0 - u;
                v * v * v * b[0]
                    + 3.0 * u * v * v * b[1]
                    + 3.0 * u * u * v * b[2]
                    + u * u * u * b[3]
            };
            assert!((0..100).all(|k| value(root * f64::from(k) / 100.0) > -1e-15));
        }
    }
}

#[test]
fn bad_coefficients_end() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..4 {
            let mut b = [1.0, 0.5, -0.5, -1.0];
            b[place] = bad;
            let found = first_root(b);
            assert!(found.is_nan() || found >= 0.0);
        }
    }
    assert_eq!(first_root([0.0, 1.0, 1.0]), 0.0);
    assert_eq!(first_root([1.0, 1.0, 1.0]), f64::INFINITY);
    assert_eq!(first_root([1.0, 0.5, 0.0]), 1.0);
}

/// The value at u of a polynomial in Bernstein form.
fn value<const N: usize>(mut b: [f64; N], u: f64) -> f64 {
    for round in 1..N {
        for i in 0..N - round {
            b[i] = (1.0 - u) * b[i] + u * b[i + 1];
        }
    }
    b[0]
}

#[test]
fn coefficients_are_those_of_the_determinant() {
    let mut random = Random(8);
    for _ in 0..500 {
        let [e, g]: [[[f64; 2]; 2]; 2] = [
            [random.many(), random.many()],
            [random.many(), random.many()],
        ];
        let b = area_coefficients(e, g);
        for u in [0.0, 0.2, 0.7, 1.0] {
            let m = |c: usize, i: usize| (1.0 - u) * e[c][i] + u * g[c][i];
            let det = m(0, 0) * m(1, 1) - m(1, 0) * m(0, 1);
            assert!((value(b, u) - det).abs() < 1e-14);
        }
        let three = |random: &mut Random| [random.many(), random.many(), random.many()];
        let (e, g): ([[f64; 3]; 3], [[f64; 3]; 3]) = (three(&mut random), three(&mut random));
        let b = volume_coefficients(e, g);
        for u in [0.0, 0.3, 0.6, 1.0] {
            let column = |c: usize| {
                glam::DVec3::from_array(core::array::from_fn(|i| (1.0 - u) * e[c][i] + u * g[c][i]))
            };
            let det = glam::DMat3::from_cols(column(0), column(1), column(2)).determinant();
            assert!((value(b, u) - det).abs() < 1e-14);
        }
    }
}
