//! Triangles in space: decompositions of 3×2 matrices against their definitions, forces against central
//! differences, and the energy of cloth.

use foldfree::energy::total::total;
use foldfree::energy::{Arap, Energy, LimitedArap};
use foldfree::geometry::RestShape;
use foldfree::mesh::{Shape, generate};
use foldfree::optim::Solver;
use foldfree::space::{Components, Lane, Pack, Sheet, Space};
use foldfree::wrapd::{Linear, Problem, RotationAware, Wrapd, WrapdOptions};
use glam::{DMat2, DMat3, DVec2, DVec3};
use pulp::{Arch, Simd, WithSimd};

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
    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
    fn rotation(&mut self) -> DMat3 {
        let axis = self.vector() + 1e-3;
        DMat3::from_axis_angle(axis.normalize(), 3.0 * self.signed())
    }
    /// A 3×2 matrix with these singular values.
    fn with_sigma(&mut self, sigma: [f64; 2]) -> [f64; 6] {
        let (u, angle) = (self.rotation(), 3.0 * self.signed());
        let v = DMat2::from_angle(angle);
        let column = |c: usize| {
            let row = v.transpose().col(c);
            u.x_axis * (sigma[0] * row.x) + u.y_axis * (sigma[1] * row.y)
        };
        flat(column(0), column(1))
    }
}

fn flat(a: DVec3, b: DVec3) -> [f64; 6] {
    [a.x, a.y, a.z, b.x, b.y, b.z]
}

fn columns(f: [f64; 6]) -> [DVec3; 2] {
    [DVec3::new(f[0], f[1], f[2]), DVec3::new(f[3], f[4], f[5])]
}

/// FᵀF.
fn squared(f: [f64; 6]) -> DMat2 {
    let [a, b] = columns(f);
    DMat2::from_cols(
        DVec2::new(a.dot(a), a.dot(b)),
        DVec2::new(a.dot(b), b.dot(b)),
    )
}

/// The matrix of the space's (t, c, s).
fn full([t, c, s]: [f64; 3]) -> DMat2 {
    DMat2::from_cols(DVec2::new(t + c, s), DVec2::new(s, t - c))
}

/// F times a 2×2 matrix.
fn times(f: [f64; 6], m: DMat2) -> [f64; 6] {
    let [a, b] = columns(f);
    flat(
        a * m.x_axis.x + b * m.x_axis.y,
        a * m.y_axis.x + b * m.y_axis.y,
    )
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, b| a.max(b.abs()))
}

fn difference(x: [f64; 6], y: [f64; 6]) -> f64 {
    largest(&core::array::from_fn::<f64, 6, _>(|c| x[c] - y[c]))
}

fn off(m: DMat2) -> f64 {
    largest(&m.to_cols_array())
}

/// Matrices near every special case.
fn matrices() -> Vec<[f64; 6]> {
    let mut random = Random(1);
    let mut list = vec![
        [0.0; 6],
        flat(DVec3::X, DVec3::Y),
        flat(DVec3::X, DVec3::X),
        flat(DVec3::X, -DVec3::X),
        flat(DVec3::ZERO, DVec3::Z),
        flat(DVec3::Z, DVec3::ZERO),
        flat(-DVec3::Z, 3.0 * DVec3::Z),
    ];
    for round in 0..200 {
        let (a, b) = (random.vector(), random.vector());
        let small = 10f64.powi(-(round % 20));
        list.push(flat(a, b));
        // nearly parallel columns, and a column that nearly vanishes
        list.push(flat(a, a + small * b));
        list.push(flat(a, -3.0 * a + small * b));
        list.push(flat(small * a, b));
        list.push(flat(a, small * b));
        // of rank one
        list.push(flat(0.3 * a, 0.7 * a));
        list.push(flat(a, DVec3::ZERO));
        list.push(random.with_sigma([1.0, 1.0]));
        list.push(random.with_sigma([1.0, small]));
        list.push(flat(a, b).map(|x| x * 10f64.powi(round % 240 - 120)));
    }
    list
}

#[test]
fn singular_values_and_vectors() {
    for f in matrices() {
        let size = largest(&f).max(1e-300);
        let (sigma, frame) = Sheet::svd::<f64>(f);
        assert!(
            sigma[0] >= sigma[1] && sigma[1] >= 0.0,
            "{sigma:?} of {f:?}"
        );
        let back = Sheet::from_svd(sigma, frame);
        assert!(difference(back, f) < 3e-15 * size, "{f:?}: {back:?}");
        // the singular vectors are orthonormal: with singular values 1 and 1 they make a rotation
        let r = Sheet::from_svd([1.0, 1.0], frame);
        assert!(off(squared(r) - DMat2::IDENTITY) < 3e-15, "{f:?}: {r:?}");
        // σ₁² + σ₂² = ‖F‖², σ₁σ₂ = ‖a × b‖
        let scaled = f.map(|x| x / size);
        let [a, b] = columns(scaled);
        let s = sigma.map(|s| s / size);
        let norm = a.length_squared() + b.length_squared();
        assert!((s[0] * s[0] + s[1] * s[1] - norm).abs() < 1e-14 * norm.max(1e-300));
        assert!((s[0] * s[1] - a.cross(b).length()).abs() < 1e-14, "{f:?}");
    }
}

#[test]
fn polar_decomposition() {
    for f in matrices() {
        let size = largest(&f).max(1e-300);
        let (s, polar) = Sheet::polar::<f64>(f);
        let (s1, f1) = (full(s) * size.recip(), f.map(|x| x / size));
        assert!(off(s1 * s1 - squared(f1)) < 1e-14, "{f:?}: S {s:?}");
        // M at P = I is F − R
        if size < 1e3 {
            let m = Sheet::stretch_residual(f, polar, [1.0, 0.0, 0.0]);
            let r: [f64; 6] = core::array::from_fn(|c| f[c] - m[c]);
            let bound = 1e-14 * (1.0 + size);
            assert!(off(squared(r) - DMat2::IDENTITY) < bound, "{f:?}: {r:?}");
            assert!(difference(times(r, full(s)), f) < bound * size.max(1.0));
        }
        let (values, _) = Sheet::eigen(s);
        let (sigma, _) = Sheet::svd_of_polar(f, polar);
        let (alone, _) = Sheet::svd(f);
        assert_eq!(sigma, alone);
        for i in 0..2 {
            assert!((values[i] - sigma[i]).abs() < 1e-14 * size, "{f:?}");
        }
    }
}

#[test]
fn collapsed_triangles_have_finite_forces_that_open_them() {
    let (sigma, frame) = Sheet::svd([0.0; 6]);
    assert_eq!(sigma, [0.0; 2]);
    assert_eq!(Sheet::from_svd([1.0; 2], frame)[0..1], [1.0]);
    for f in matrices() {
        for scale in [1.0, 1e-140, 1e-151, 1e-170, 1e-300] {
            let f = f.map(|x| x * scale);
            let (s, polar) = Sheet::polar(f);
            let (sigma, frame) = Sheet::svd(f);
            let m = Sheet::stretch_residual(f, polar, [1.0, 0.2, -0.1]);
            let back = Sheet::from_svd(sigma, frame);
            let all = s.iter().chain(&sigma).chain(&m).chain(&back);
            assert!(all.clone().all(|x| x.is_finite()), "{f:?}");
            assert!(difference(back, f) < 3e-15 * largest(&f) + 1e-149);
            if sigma[0] < 1e-10 {
                // the force towards an isometry is minus one, whatever its direction
                let m = Sheet::stretch_residual(f, polar, [1.0, 0.0, 0.0]);
                assert!(off(squared(m) - DMat2::IDENTITY) < 1e-9, "{f:?}: {m:?}");
            }
        }
    }
}

/// ½‖sym(F) − P‖².
fn distance(f: [f64; 6], p: [f64; 3]) -> f64 {
    let (s, _) = Sheet::polar::<f64>(f);
    let d: [f64; 3] = core::array::from_fn(|c| s[c] - p[c]);
    0.5 * Sheet::symmetric_norm_squared(d)
}

#[test]
fn the_force_is_the_derivative_of_the_distance_to_a_stretch() {
    let mut random = Random(7);
    for round in 0..300 {
        // sym(F) is smooth on the scale of σ₂
        let last = 10f64.powi(-(round % 5));
        let first = 1.0 + random.signed().abs();
        let f = random.with_sigma([first, last]);
        let p = [1.0 + random.signed(), random.signed(), random.signed()];
        let (_, polar) = Sheet::polar(f);
        let force = Sheet::stretch_residual(f, polar, p);
        let h = 1e-4 * last;
        for c in 0..6 {
            // the fourth-order central difference
            let at = |steps: f64| {
                let mut moved = f;
                moved[c] += steps * h;
                distance(moved, p)
            };
            let slope = (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / (12.0 * h);
            let error = (slope - force[c]).abs();
            assert!(
                error < 1e-11 / h + 1e-10,
                "{f:?}, {c}: {slope} {}",
                force[c]
            );
        }
    }
}

#[test]
fn turning_space_turns_the_force() {
    let mut random = Random(11);
    for _ in 0..200 {
        let f = random.with_sigma([1.3, 0.2]);
        let p = [1.0 + random.signed(), random.signed(), random.signed()];
        let q = random.rotation();
        let turn = |f: [f64; 6]| {
            let [a, b] = columns(f);
            flat(q * a, q * b)
        };
        let force = |f: [f64; 6]| Sheet::stretch_residual(f, Sheet::polar(f).1, p);
        assert!(difference(force(turn(f)), turn(force(f))) < 1e-13);
    }
}

/// Everything `Sheet` computes of one matrix.
#[inline(always)]
fn everything<L: Lane>(f: [L; 6]) -> [L; 23] {
    let (sigma, frame) = Sheet::svd(f);
    let (s, polar) = Sheet::polar(f);
    let p = [s[0] * s[1], s[2], s[0] + s[1]];
    let m = Sheet::stretch_residual(f, polar, p);
    let back = Sheet::from_svd([sigma[1], sigma[0]], frame);
    let r = Sheet::from_svd([f[0].lift(1.0), f[0].lift(1.0)], frame);
    let mut out = [f[0]; 23];
    out[..2].copy_from_slice(&sigma);
    out[2..5].copy_from_slice(&s);
    out[5..11].copy_from_slice(&m);
    out[11..17].copy_from_slice(&back);
    out[17..].copy_from_slice(&r);
    out
}

/// The same in registers: component k of matrix e is at k·n + e.
struct InRegisters<'a>(&'a [f64], usize);

impl WithSimd for InRegisters<'_> {
    type Output = Vec<f64>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let Self(rows, n) = self;
        let mut out = vec![0.0; 23 * n];
        for at in (0..n).step_by(Pack::<S>::WIDTH) {
            let f: [Pack<S>; 6] = Components::from_fn(
                #[inline(always)]
                |k| Pack::load(simd, &rows[k * n + at..]),
            );
            for (k, value) in everything(f).into_iter().enumerate() {
                value.store(&mut out[k * n + at..]);
            }
        }
        out
    }
}

#[test]
fn registers_give_the_bits_of_their_elements() {
    let mut list = matrices();
    list.truncate(list.len() / 8 * 8);
    let n = list.len();
    let rows: Vec<f64> = (0..6 * n).map(|i| list[i % n][i / n]).collect();
    let packed = Arch::new().dispatch(InRegisters(&rows, n));
    for (e, &f) in list.iter().enumerate() {
        for (k, alone) in everything(f).into_iter().enumerate() {
            let packed = packed[k * n + e];
            assert_eq!(packed.to_bits(), alone.to_bits(), "result {k} of {f:?}");
        }
    }
}

fn limited(least: f64, most: f64) -> LimitedArap {
    LimitedArap::new(3.0, [least, most]).unwrap()
}

#[test]
fn the_prox_within_limits_is_the_best_of_a_search() {
    let mut random = Random(3);
    for (least, most) in [(0.9, 1.1), (0.0, f64::INFINITY), (1.0, 1.2), (0.5, 1.0)] {
        let energy = limited(least, most);
        for _ in 0..100 {
            let p = [2.0 * random.signed(), 1.0 + random.signed()];
            let k = 10f64.powf(random.signed());
            let (z, _) = Energy::<Sheet>::prox(&energy, p, k, [1.0; 2]);
            let value = |z: [f64; 2]| {
                Energy::<Sheet>::density(&energy, z)
                    + 0.5 * k * ((z[0] - p[0]).powi(2) + (z[1] - p[1]).powi(2))
            };
            for i in 0..2 {
                assert!((least..=most).contains(&z[i]), "{z:?}");
                for s in 0..=400 {
                    let s = least + (most.min(4.0) - least) * f64::from(s) / 400.0;
                    let mut other = z;
                    other[i] = s;
                    assert!(
                        value(z) <= value(other) + 1e-12,
                        "{p:?} {k}: {z:?} {other:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn limits_out_of_range() {
    for (stiffness, limits, named) in [
        (0.0, [0.9, 1.1], "stretch"),
        (f64::NAN, [0.9, 1.1], "stretch"),
        (f64::INFINITY, [0.9, 1.1], "stretch"),
        (1.0, [-0.1, 1.1], "limits"),
        (1.0, [1.1, 1.2], "limits"),
        (1.0, [0.9, 0.95], "limits"),
        (1.0, [1.0, 1.0], "limits"),
        (1.0, [f64::NAN, 1.1], "limits"),
        (1.0, [0.9, f64::NAN], "limits"),
    ] {
        let error = LimitedArap::new(stiffness, limits).unwrap_err();
        assert!(error.to_string().contains(named), "{error}");
    }
}

/// A surface, and its positions bent and disturbed.
fn disturbed() -> (RestShape, Vec<f64>) {
    let mesh = generate(Shape::BumpyCap, 150);
    let rest = RestShape::of_surface(&mesh, 1.0).unwrap();
    let mut random = Random(13);
    let x = mesh.positions.iter().flat_map(|p| {
        let p = DVec3::new(p.x * p.z, 1.2 * p.y, p.x - 0.3 * p.z) + 0.05 * random.vector();
        p.to_array()
    });
    (rest, x.collect())
}

#[test]
fn the_gradient_of_a_sheet_is_that_of_its_energy() {
    let (rest, x) = disturbed();
    let energy = limited(0.9, 1.1);
    let exact = total::<Sheet, _>(energy, &rest, &x);
    let h = 1e-5;
    for i in (0..x.len()).step_by(7) {
        let at = |by: f64| {
            let mut moved = x.clone();
            moved[i] += by;
            total::<Sheet, _>(energy, &rest, &moved).energy
        };
        let slope = (at(h) - at(-h)) / (2.0 * h);
        let error = (slope - exact.gradient[i]).abs();
        assert!(error < 1e-7, "{i}: {slope} {}", exact.gradient[i]);
    }
}

#[test]
fn kernels_agree_with_the_plain_evaluation() {
    let (rest, x) = disturbed();
    let energy = limited(0.9, 1.1);
    let plain = total::<Sheet, _>(energy, &rest, &x);
    let pins = [0, 5, 9];
    let free = plain.gradient.iter().enumerate();
    let squares = free.filter(|(i, _)| !pins.contains(&((i / 3) as u32)));
    let norm = squares.map(|(_, g)| g * g).sum::<f64>().sqrt();
    let problem = Problem {
        rest: &rest,
        start: &x,
        pins: &pins,
        external: None,
    };
    let options = WrapdOptions::default();
    let solvers = [
        Wrapd::new::<Sheet, RotationAware, _>(problem, energy, options).unwrap(),
        Wrapd::new::<Sheet, Linear, _>(problem, energy, options).unwrap(),
    ];
    for solver in solvers {
        let report = solver.report();
        assert!((report.energy / plain.energy - 1.0).abs() < 1e-12);
        assert!((report.gradient_norm / norm - 1.0).abs() < 1e-12);
        assert_eq!(report.inverted, plain.inverted);
        assert!((report.smallest_sigma - plain.smallest_sigma).abs() < 1e-13);
        assert!((report.largest_sigma - plain.largest_sigma).abs() < 1e-13);
    }
}

#[test]
fn a_crumpled_sheet_goes_back_to_its_rest_shape() {
    let (rest, x) = disturbed();
    let mesh = generate(Shape::BumpyCap, 150);
    // one triangle is held where it belongs
    let held = mesh.simplices[0];
    let mut start = x;
    for v in held {
        let p = mesh.positions[v as usize].to_array();
        start[3 * v as usize..][..3].copy_from_slice(&p);
    }
    let problem = Problem {
        rest: &rest,
        start: &start,
        pins: &held,
        external: None,
    };
    let options = WrapdOptions {
        tolerance: 1e-14,
        ..Default::default()
    };
    let mut solver = Wrapd::new::<Sheet, RotationAware, _>(problem, Arap, options).unwrap();
    let cancel = Default::default();
    foldfree::optim::run(&mut solver, &mut |_: &dyn Solver| (), &cancel).unwrap();
    assert!(solver.report().energy < 1e-12, "{:?}", solver.report());
    assert!(solver.report().largest_sigma < 1.0 + 1e-5);
}
