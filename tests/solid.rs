//! Decompositions of 3×3 matrices, forces and the neo-Hookean energy, against their definitions.

use foldfree::energy::{Constants, Energy, NeoHookean};
use foldfree::space::{Lane, Solid, Space};
use glam::{DMat3, DVec3};

/// A small generator of pseudo-random numbers (SplitMix64), in (−1, 1).
struct Random(u64);

impl Random {
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        2.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 1.0
    }
    fn matrix(&mut self) -> DMat3 {
        DMat3::from_cols_array(&core::array::from_fn(|_| self.signed()))
    }
    fn rotation(&mut self) -> DMat3 {
        let axis = DVec3::new(self.signed(), self.signed(), self.signed());
        DMat3::from_axis_angle((axis + 1e-3).normalize(), 3.0 * self.signed())
    }
}

fn largest(m: DMat3) -> f64 {
    m.to_cols_array().iter().fold(0.0, |a, b| a.max(b.abs()))
}

/// Matrices near every special case.
fn matrices() -> Vec<DMat3> {
    let mut random = Random(1);
    let mut list = vec![
        DMat3::IDENTITY,
        DMat3::ZERO,
        -DMat3::IDENTITY,
        DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)),
        DMat3::from_diagonal(DVec3::new(0.0, 2.0, 0.0)),
        DMat3::from_cols(DVec3::X, DVec3::X, DVec3::X),
    ];
    for round in 0..200 {
        let (r, q, m) = (random.rotation(), random.rotation(), random.matrix());
        list.push(m);
        list.push(r);
        list.push(r + 1e-9 * m);
        list.push(10f64.powi(round % 240 - 120) * m);
        let sigma = DVec3::new(
            1.0,
            random.signed(),
            10f64.powi(-(round % 30)) * random.signed(),
        );
        list.push(r * DMat3::from_diagonal(sigma) * q);
        // two equal, two opposite
        list.push(r * DMat3::from_diagonal(DVec3::new(2.0, 1.0, 1.0)) * q);
        list.push(r * DMat3::from_diagonal(DVec3::new(2.0, 1.0, -1.0)) * q);
    }
    list
}

fn diagonal(s: [f64; 3]) -> DMat3 {
    DMat3::from_diagonal(DVec3::from_array(s))
}

#[test]
fn singular_values() {
    for f in matrices() {
        let size = largest(f).max(1e-300);
        let (sigma, (u, v)) = Solid::svd::<f64>(f.to_cols_array());
        let [u, v] = [u, v].map(|m| DMat3::from_cols_array_2d(&m));
        for m in [u, v] {
            let error = largest(m.transpose() * m - DMat3::IDENTITY);
            assert!(error < 1e-14, "not a rotation: {error:e} at {f}");
            assert!((m.determinant() - 1.0).abs() < 1e-14);
        }
        let error = largest(u * diagonal(sigma) * v.transpose() - f);
        assert!(error < 1e-14 * size, "{error:e} of {size:e} at {f}");
        let slack = 1e-14 * size;
        assert!(sigma[0] >= sigma[1] && sigma[1] >= 0.0, "{sigma:?}");
        assert!(sigma[2].abs() <= sigma[1] + slack, "{sigma:?}");
        let again = Solid::from_svd(sigma, Solid::svd::<f64>(f.to_cols_array()).1);
        assert!(largest(DMat3::from_cols_array(&again) - f) < 1e-14 * size);
    }
}

fn full(s: [f64; 6]) -> DMat3 {
    DMat3::from_cols_array(&[s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2]])
}

fn packed(m: DMat3) -> [f64; 6] {
    let [a, b, c] = m.to_cols_array_2d();
    [a[0], b[1], c[2], b[0], c[0], c[1]]
}

#[test]
fn polar_decomposition_and_eigenvalues() {
    for f in matrices() {
        let size = largest(f).max(1e-300);
        let (s, _) = Solid::polar::<f64>(f.to_cols_array());
        // S² = FᵀF, scaled so that the squares neither vanish nor overflow
        let (s1, f1) = (full(s) * size.recip(), f * size.recip());
        assert!(largest(s1 * s1 - f1.transpose() * f1) < 1e-13, "{f}");
        let (values, frame) = Solid::eigen::<f64>(s);
        let v = DMat3::from_cols_array_2d(&frame);
        assert!((v.determinant() - 1.0).abs() < 1e-14);
        assert!(largest(v * diagonal(values) * v.transpose() - full(s)) < 1e-14 * size);
        assert!(values[0] >= values[1] && values[1] >= values[2]);
        let again = full(Solid::from_eigen(values, frame));
        assert!(largest(again - full(s)) < 1e-14 * size);
        // indefinite ones, too
        let shifted = full(s) - DMat3::IDENTITY * (0.7 * size);
        let (values, frame) = Solid::eigen::<f64>(packed(shifted));
        let again = full(Solid::from_eigen(values, frame));
        assert!(largest(again - shifted) < 1e-14 * size);
    }
}

#[test]
fn the_force_is_the_derivative_of_the_distance_to_a_stretch() {
    let mut random = Random(7);
    for _ in 0..200 {
        let f = random.matrix() + DMat3::from_diagonal(DVec3::splat(0.3));
        let m = random.matrix();
        let p = m + m.transpose();
        // ½‖sym(F) − P‖²
        let value = |f: DMat3| {
            let (s, _) = Solid::polar::<f64>(f.to_cols_array());
            let d = full(s) - p;
            0.5 * d.to_cols_array().iter().map(|x| x * x).sum::<f64>()
        };
        let (sigma, _) = Solid::svd::<f64>(f.to_cols_array());
        if sigma[1] + sigma[2] < 0.1 {
            continue; // the rotation jumps near here
        }
        let (_, polar) = Solid::polar::<f64>(f.to_cols_array());
        let force = Solid::stretch_residual(f.to_cols_array(), polar, packed(p));
        for c in 0..9 {
            let mut step = [0.0; 9];
            step[c] = 1e-5;
            let step = DMat3::from_cols_array(&step);
            let slope = (value(f + step) - value(f - step)) / 2e-5;
            assert!((slope - force[c]).abs() < 1e-6, "{c}: {slope} {}", force[c]);
        }
    }
}

#[test]
fn the_logarithm_is_that_of_the_standard_library() {
    let mut random = Random(3);
    for _ in 0..100_000 {
        let x = 10f64.powf(300.0 * random.signed().powi(3));
        let (mine, exact) = (Lane::ln(x), f64::ln(x));
        assert!(
            (mine - exact).abs() <= 1.5 * f64::EPSILON * exact.abs(),
            "{x:e}"
        );
    }
    for x in [
        1.0,
        1.0 + f64::EPSILON,
        1.0 - f64::EPSILON / 2.0,
        2f64.sqrt(),
        0.5f64.sqrt(),
    ] {
        let (mine, exact) = (Lane::ln(x), f64::ln(x));
        assert!(
            (mine - exact).abs() <= 1.5 * f64::EPSILON * exact.abs(),
            "{x:e}"
        );
    }
}

fn material() -> NeoHookean {
    NeoHookean::new(1.0, 0.45).unwrap()
}

fn density(s: [f64; 3]) -> f64 {
    Energy::<Solid>::density(&material(), s)
}

/// Stretches on either side of J = 0.1, and reflected.
fn stretches(random: &mut Random) -> [f64; 3] {
    let mut s: [f64; 3] = core::array::from_fn(|_| 0.05 + 1.5 * random.signed().abs());
    if random.signed() < 0.0 {
        s[2] = -s[2];
    }
    s
}

#[test]
fn neo_hookean_derivatives() {
    let energy = material();
    let Constants { isometry, .. } = Energy::<Solid>::constants(&energy);
    assert_eq!(density([1.0; 3]), isometry);
    assert_eq!(Energy::<Solid>::gradient(&energy, [1.0; 3]), [0.0; 3]);
    let mut random = Random(5);
    for _ in 0..1000 {
        let s = stretches(&mut random);
        let j: f64 = s.iter().product();
        if (j - 0.1).abs() < 1e-3 {
            continue; // the third derivative jumps there
        }
        let moved = |i: usize, by: f64| {
            let mut s = s;
            s[i] += by;
            s
        };
        let gradient = Energy::<Solid>::gradient(&energy, s);
        let scale = 1.0 + gradient.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let mut hessian = [[0.0; 3]; 3];
        for i in 0..3 {
            let h = 1e-5;
            let slope = (density(moved(i, h)) - density(moved(i, -h))) / (2.0 * h);
            assert!(
                (slope - gradient[i]).abs() < 1e-5 * scale,
                "{s:?}: {slope} {gradient:?}"
            );
            let [high, low] = [h, -h].map(|h| Energy::<Solid>::gradient(&energy, moved(i, h)));
            hessian[i] = core::array::from_fn(|k| (high[k] - low[k]) / (2.0 * h));
        }
        let (values, _) = Solid::eigen::<f64>(packed(DMat3::from_cols_array_2d(&hessian)));
        let stiffness = Energy::<Solid>::effective_stiffness(&energy, s);
        let size = values[0].abs().max(values[2].abs()).max(1.0);
        assert!(
            (stiffness - values[0]).abs() < 1e-4 * size,
            "{s:?}: {stiffness} {values:?}"
        );
    }
}

#[test]
fn neo_hookean_prox_is_the_best_of_a_search_and_stationary() {
    let energy = material();
    let mut random = Random(9);
    for round in 0..60 {
        let scale = [1.0, 3.0, 8.0][round % 3];
        let mut p: [f64; 3] = core::array::from_fn(|_| scale * random.signed().abs());
        p.sort_by(|a, b| b.total_cmp(a));
        if round % 4 == 0 {
            p[2] = -p[2];
        }
        let k = 10f64.powf(1.0 + random.signed());
        let value = |s: [f64; 3]| {
            let squares: f64 = (0..3).map(|i| (s[i] - p[i]).powi(2)).sum();
            density(s) + 0.5 * k * squares
        };
        for warm in [[1.0; 3], [p[0].max(0.1), 1.0, 0.2]] {
            let (s, count) = Energy::<Solid>::prox(&energy, p, k, warm);
            assert!(count < 50, "{p:?} {k}");
            let gradient = Energy::<Solid>::gradient(&energy, s);
            let size = k * p.iter().chain(&s).fold(1.0f64, |a, b| a.max(b.abs()));
            for i in 0..3 {
                let force = gradient[i] + k * (s[i] - p[i]);
                assert!(force.abs() < 1e-9 * size, "{p:?} {k} → {s:?}: {force:e}");
            }
            // nothing better near it
            for _ in 0..2000 {
                let near = s.map(|x| x + 0.2 * random.signed());
                assert!(
                    value(s) <= value(near) + 1e-12 * size,
                    "{p:?} {k}: {s:?} {near:?}"
                );
            }
            // two negative stretches have a positive J: that is no answer
            assert!(s[0] > 0.0 && s[1] > 0.0, "{p:?} {k} → {s:?}");
        }
    }
}

#[test]
fn materials_out_of_range() {
    for (young, poisson, named) in [
        (0.0, 0.3, "young"),
        (-1.0, 0.3, "young"),
        (f64::NAN, 0.3, "young"),
        (1.0, 0.5, "poisson"),
        (1.0, 0.7, "poisson"),
        (1.0, -1.0, "poisson"),
        (1.0, f64::NAN, "poisson"),
    ] {
        let error = NeoHookean::new(young, poisson).unwrap_err();
        assert!(error.to_string().contains(named), "{error}");
    }
}
