//! Polar decomposition, eigenvalues and singular values of `Plane`, against arithmetic of thousands of
//! bits, where they are difficult: near the identity, tiny, huge, reflected, of rank one, conformal.

use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;
use foldfree::space::{Components, Lane, Pack, Plane, Space};
use pulp::{Arch, Simd, WithSimd};

type Big = FBig<HalfEven, 2>;

/// Exact sums and products of the squares of doubles between 1e±150 fit into this many bits.
const BITS: usize = 4096;

fn big(x: f64) -> Big {
    Big::try_from(x).unwrap().with_precision(BITS).value()
}

fn root(x: Big) -> Big {
    // exactly 0 is the only value rounding can take below it
    if x <= big(0.0) {
        big(0.0)
    } else {
        x.with_precision(BITS).value().nth_root(2)
    }
}

/// What the decomposition of F is, by ‖F‖² and det F alone: (σ₁ ± σ₂)² = ‖F‖² ± 2 det F.
struct Truth {
    sigma: [Big; 2],
    /// S = (FᵀF + det F · I)/(σ₁+σ₂): entries 11, 12, 22; R = (F + cof F)/(σ₁+σ₂): cosine, sine.
    polar: Option<([Big; 3], [Big; 2])>,
}

fn truth(f: [f64; 4]) -> Truth {
    let [a, c, b, d] = f.map(big);
    let norm = &a * &a + &b * &b + &c * &c + &d * &d;
    let det = &a * &d - &b * &c;
    let sum = root(&norm + big(2.0) * &det);
    let difference = root(&norm - big(2.0) * &det);
    let half = big(0.5);
    let polar = (sum > big(0.0)).then(|| {
        let stretch = [
            (&a * &a + &c * &c + &det) / &sum,
            (&a * &b + &c * &d) / &sum,
            (&b * &b + &d * &d + &det) / &sum,
        ];
        let rotation = [(&a + &d) / &sum, (&c - &b) / &sum];
        (stretch, rotation)
    });
    Truth {
        sigma: [&half * (&sum + &difference), &half * (&sum - &difference)],
        polar,
    }
}

/// |computed − exact| in units of `scale`.
fn error(computed: f64, exact: &Big, scale: f64) -> f64 {
    assert!(computed.is_finite());
    ((big(computed) - exact) / big(scale))
        .to_f64()
        .value()
        .abs()
}

/// A few roundings; every bound below is relative to σ₁.
const SMALL: f64 = 2e-15;

/// Parts of a matrix (α or β) below this are taken to have no direction.
const TINY: f64 = 1e-150;

#[track_caller]
fn check(f: [f64; 4]) {
    let exact = truth(f);
    let scale = exact.sigma[0].to_f64().value();
    if scale == 0.0 {
        return;
    }
    let (sigma, frame) = Plane::svd(f);
    for i in 0..2 {
        let e = error(sigma[i], &exact.sigma[i], scale);
        assert!(
            e <= SMALL,
            "σ{} of {f:?}: {} is off by {e:e}",
            i + 1,
            sigma[i]
        );
    }
    for (back, f_k) in Plane::from_svd(sigma, frame).iter().zip(f) {
        assert!(
            (back - f_k).abs() <= SMALL * scale + TINY,
            "from_svd of {f:?}: {back}"
        );
    }

    let (s, polar) = Plane::polar(f);
    let Some((stretch, rotation)) = exact.polar else {
        return;
    };
    // where σ₁+σ₂ is small against σ₁, R and S turn with the rounding of F
    let sum = (&exact.sigma[0] + &exact.sigma[1]).to_f64().value();
    if sum < 2.0 * TINY {
        return;
    }
    let turning = 1.0 + scale / sum;
    let entries = [s[0] + s[1], s[2], s[0] - s[1]];
    for (entry, exact) in entries.iter().zip(&stretch) {
        let e = error(*entry, exact, scale * turning);
        assert!(e <= SMALL, "S of {f:?}: {entry} is off by {e:e}");
    }
    // M at P = 0 is F; at P = I it is F − R
    let m = Plane::stretch_residual(f, polar, [1.0, 0.0, 0.0]);
    let r = [f[0] - m[0], f[1] - m[1]];
    for (r, exact) in r.iter().zip(&rotation) {
        let e = error(*r, exact, (1.0 + scale) * turning);
        assert!(e <= SMALL, "R of {f:?}: {r} is off by {e:e}");
    }

    let (values, vectors) = Plane::eigen(s);
    for i in 0..2 {
        let e = error(values[i], &exact.sigma[i], scale);
        assert!(
            e <= 2.0 * SMALL,
            "eigenvalue {} of {f:?}: off by {e:e}",
            i + 1
        );
    }
    for (back, s) in Plane::from_eigen(values, vectors).iter().zip(s) {
        assert!(
            (back - s).abs() <= SMALL * scale + TINY,
            "from_eigen of {f:?}: {back}, {s}"
        );
    }
    let norm = &exact.sigma[0] * &exact.sigma[0] + &exact.sigma[1] * &exact.sigma[1];
    let e = error(Plane::symmetric_norm_squared(s), &norm, scale * scale);
    assert!(e <= 4.0 * SMALL, "‖S‖² of {f:?} is off by {e:e}");
}

/// A small generator of pseudo-random numbers (SplitMix64), here in −1..1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn many(&mut self) -> [f64; 4] {
        [0; 4].map(|_| self.next())
    }
}

fn difficult() -> Vec<[f64; 4]> {
    let mut random = Random(1);
    let mut list = Vec::new();
    for _ in 0..40 {
        let r = random.many();
        let (sin, cos) = (3.0 * r[0]).sin_cos();
        // near the identity, down to the last bit
        for size in [0.0, 1e-16, 2e-16, 1e-15, 1e-12, 1e-8, 1e-4] {
            list.push([
                1.0 + size * r[0],
                size * r[1],
                size * r[2],
                1.0 + size * r[3],
            ]);
            // near a rotation, and near a reflection: there σ₁+σ₂ vanishes
            list.push([cos + size * r[0], sin, -sin, cos + size * r[3]]);
            list.push([cos + size * r[0], sin, sin, -cos + size * r[3]]);
        }
        list.push(r);
        // similar, anti-similar
        list.push([r[0], r[1], -r[1], r[0]]);
        list.push([r[0], r[1], r[1], -r[0]]);
        // rank one, exactly and but for rounding
        list.push([3.0 * r[0], 5.0 * r[0], 3.0 * r[1], 5.0 * r[1]]);
        list.push([r[0] * r[2], r[0] * r[3], r[1] * r[2], r[1] * r[3]]);
        list.push([r[0], 0.0, 0.0, 0.0]);
        list.push([0.0, r[0], 0.0, 0.0]);
        // very different stretches
        list.push([1e9 * r[0], 1e-9, 0.0, 1e-9 * r[1]]);
        list.push([1e5 * cos, 1e5 * sin, -1e-7 * sin, 1e-7 * cos]);
        list.push([1e5 * cos, 1e5 * sin, 1e-7 * sin, -1e-7 * cos]);
    }
    list.extend([
        [1.0, 0.0, 0.0, 1.0],
        [1.0, 0.0, 0.0, -1.0],
        [-1.0, 0.0, 0.0, -1.0],
    ]);
    list.extend([[0.0, 1.0, 1.0, 0.0], [0.0, 1.0, -1.0, 0.0], [0.0; 4]]);
    list
}

#[test]
fn decompositions_are_exact_to_rounding() {
    for f in difficult() {
        check(f);
    }
}

#[test]
fn tiny_and_huge_ones_too() {
    for (i, f) in difficult()
        .into_iter()
        .enumerate()
        .filter(|(i, _)| i % 7 == 0)
    {
        let exponents = [-140, -100, -60, -30, -16, -8, 8, 16, 60, 100, 140];
        let size = 10f64.powi(exponents[i / 7 % exponents.len()]);
        check(f.map(|f| f * size));
    }
}

#[test]
fn what_is_too_small_to_square_vanishes() {
    // the decomposition squares: below 1e-150 it is exact in the absolute sense only
    for exponent in [-151, -155, -160, -165, -200, -300] {
        for f in difficult().into_iter().step_by(5) {
            let f = f.map(|f| f * 10f64.powi(exponent));
            let exact = truth(f);
            let (sigma, frame) = Plane::svd(f);
            for i in 0..2 {
                let e = error(sigma[i], &exact.sigma[i], 1.0);
                assert!(e <= TINY, "σ{} of {f:?}: {}", i + 1, sigma[i]);
            }
            let back = Plane::from_svd([1.0, 1.0], frame);
            let norm: f64 = back.iter().map(|x| x * x).sum();
            assert!(
                (norm - 2.0).abs() < 1e-10,
                "the frame of {f:?} is no rotation: {back:?}"
            );
            let (s, polar) = Plane::polar(f);
            let m = Plane::stretch_residual(f, polar, [0.3, 0.2, -0.1]);
            assert!(
                s.iter().chain(&m).all(|x| x.is_finite()),
                "{f:?}: {s:?} {m:?}"
            );
        }
    }
}

#[test]
fn nothing_is_undefined_at_zero() {
    let (sigma, frame) = Plane::svd([0.0; 4]);
    assert_eq!(sigma, [0.0, 0.0]);
    assert_eq!(Plane::from_svd([2.0, 2.0], frame), [2.0, 0.0, 0.0, 2.0]);
    let (s, polar) = Plane::polar([0.0; 4]);
    assert_eq!(s, [0.0; 3]);
    // R is the identity
    let m = Plane::stretch_residual([0.0; 4], polar, [1.0, 0.0, 0.0]);
    assert_eq!(m, [-1.0, 0.0, 0.0, -1.0]);
    let (values, vectors) = Plane::eigen([0.0; 3]);
    assert_eq!(values, [0.0, 0.0]);
    assert_eq!(Plane::from_eigen([3.0, 1.0], vectors), [2.0, 1.0, 0.0]);
}

/// Everything `Plane` computes of one matrix.
#[inline(always)]
fn everything<L: Lane>(f: [L; 4]) -> [L; 17] {
    let (sigma, frame) = Plane::svd(f);
    let (s, polar) = Plane::polar(f);
    let p = [s[0] * s[1], s[2], s[0] + s[1]];
    let m = Plane::stretch_residual(f, polar, p);
    let (values, vectors) = Plane::eigen(s);
    let back = Plane::from_svd([sigma[1], sigma[0]], frame);
    let again = Plane::from_eigen([values[1], values[0]], vectors);
    [
        sigma[0],
        sigma[1],
        s[0],
        s[1],
        s[2],
        m[0],
        m[1],
        m[2],
        m[3],
        values[0],
        values[1],
        back[0],
        back[1],
        again[0],
        again[1],
        again[2],
        Plane::symmetric_norm_squared(s),
    ]
}

/// The same in registers: component k of matrix e is at k·n + e.
struct InRegisters<'a> {
    rows: &'a [f64],
    count: usize,
}

impl WithSimd for InRegisters<'_> {
    type Output = Vec<f64>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let n = self.count;
        let mut out = vec![0.0; 17 * n];
        for at in (0..n).step_by(Pack::<S>::WIDTH) {
            let f: [Pack<S>; 4] = Components::from_fn(
                #[inline(always)]
                |k| Pack::load(simd, &self.rows[k * n + at..]),
            );
            let result = everything(f);
            for (k, value) in result.into_iter().enumerate() {
                value.store(&mut out[k * n + at..]);
            }
        }
        out
    }
}

fn registers_agree(dispatch: impl Fn(InRegisters) -> Vec<f64>) {
    let mut list = difficult();
    for exponent in [-160, -150, -80, 80, 150] {
        let scaled = difficult().into_iter().step_by(9);
        list.extend(scaled.map(|f| f.map(|f| f * 10f64.powi(exponent))));
    }
    // a multiple of every register's width
    list.truncate(list.len() / 8 * 8);
    let n = list.len();
    let rows: Vec<f64> = (0..4 * n).map(|i| list[i % n][i / n]).collect();
    let packed = dispatch(InRegisters {
        rows: &rows,
        count: n,
    });
    for (e, &f) in list.iter().enumerate() {
        for (k, alone) in everything(f).into_iter().enumerate() {
            let packed = packed[k * n + e];
            assert!(
                packed.to_bits() == alone.to_bits() || (packed.is_nan() && alone.is_nan()),
                "result {k} of {f:?}: {packed:e} in a register, {alone:e} alone"
            );
        }
    }
}

#[test]
fn registers_give_the_bits_of_their_elements() {
    registers_agree(|work| Arch::new().dispatch(work));
}

#[cfg(target_arch = "x86_64")]
#[test]
fn so_do_registers_of_half_the_width() {
    if let Some(simd) = pulp::x86::V3::try_new() {
        registers_agree(|work| simd.vectorize(|| work.with_simd(simd)));
    }
}
