//! The proximal step of one element, argmin_Z ψ(Z) + k/2 ‖Z − P‖² (6), against brute force.

mod plane_oracle;

use foldfree::energy::{Arap, Energy, SymmetricDirichlet};
use foldfree::space::{Lane, Pack, Plane};
use foldfree::wrapd::{Coupling, Linear, RotationAware};
use plane_oracle::{Matrix, full, matrix};
use pulp::{Arch, Simd, WithSimd};

/// Half a unit in the last place of 1.
const ROUNDING: f64 = f64::EPSILON / 2.0;

/// ±10^e over the exponents, and 0.
fn spread(exponents: std::ops::RangeInclusive<i32>) -> Vec<f64> {
    let positive = exponents.flat_map(|e| [1.0, 2.7].map(|m| m * 10f64.powi(e)));
    let positive: Vec<f64> = positive.collect();
    let negative = positive.iter().rev().map(|p| -p);
    negative
        .chain([0.0])
        .chain(positive.iter().copied())
        .collect()
}

/// From rest weights of soft energies to beyond the cap of (24b) on stiff ones.
fn stiffnesses() -> Vec<f64> {
    (-3..=9)
        .flat_map(|e| [1.0, 3.1].map(|m| m * 10f64.powi(e)))
        .collect()
}

/// One axis of symmetric Dirichlet: the derivative of z² + z⁻² + k/2 (z − p)² rises from −∞ to ∞ on
/// z > 0, so bisection finds its root to the last bit that rounding allows.
fn root_by_bisection(p: f64, k: f64) -> f64 {
    let slope = |z: f64| (2.0 + k) * z - k * p - 2.0 / (z * z * z);
    let (mut low, mut high) = (1e-20, 1e20);
    for _ in 0..60 {
        // the middle of the exponents, until both have the same
        let z = f64::sqrt(low) * f64::sqrt(high);
        if slope(z) < 0.0 { low = z } else { high = z }
    }
    for _ in 0..60 {
        let z = 0.5 * (low + high);
        if slope(z) < 0.0 { low = z } else { high = z }
    }
    0.5 * (low + high)
}

#[test]
fn the_bisection_is_the_minimum_of_a_dense_search() {
    for k in stiffnesses() {
        for p in spread(-6..=6) {
            let value = |z: f64| z * z + 1.0 / (z * z) + 0.5 * k * (z - p) * (z - p);
            let best = value(root_by_bisection(p, k));
            for step in -2000..=2000 {
                let z = 10f64.powf(step as f64 / 200.0);
                // the value itself is known to this much
                let noise = 4.0 * f64::EPSILON * (best.abs() + k * p * p);
                assert!(
                    best <= value(z) + noise,
                    "k {k:e}, p {p:e}: better at {z:e}"
                );
            }
        }
    }
}

#[test]
fn symmetric_dirichlet_from_any_warm_start() {
    let mut most = 0;
    for k in stiffnesses() {
        for p in spread(-6..=6) {
            let exact = root_by_bisection(p, k);
            for warm in (-8..=8).map(|e| 10f64.powi(e)) {
                let ([z, other], count) =
                    Energy::<Plane>::prox(&SymmetricDirichlet, [p, p], k, [warm, exact]);
                let context = format!("k {k:e}, p {p:e}, warm {warm:e}: {z:e} of {exact:e}");
                // z is the root of a z − b = 2 z⁻³, whose condition number is at most 1 in a and b:
                // a few roundings are all that can be lost
                assert!((z - exact).abs() <= 16.0 * ROUNDING * exact, "{context}");
                assert!(
                    (other - exact).abs() <= 16.0 * ROUNDING * exact,
                    "{context}"
                );
                let terms = [(2.0 + k) * z, -k * p, -2.0 / (z * z * z)];
                let residual: f64 = terms.iter().sum();
                let size: f64 = terms.iter().map(|t| t.abs()).sum();
                assert!(residual.abs() <= 16.0 * ROUNDING * size, "{context}");
                // the loop's bound is for safety only
                assert!(count < 60, "{context}: {count} iterations");
                most = most.max(count);
            }
        }
    }
    println!("at most {most} iterations");
}

#[test]
fn warm_starts_are_worth_it() {
    for k in stiffnesses() {
        for p in spread(-2..=2) {
            let exact = root_by_bisection(p, k);
            let (_, count) = Energy::<Plane>::prox(
                &SymmetricDirichlet,
                [p, p],
                k,
                [exact * 1.001, exact * 0.999],
            );
            assert!(count <= 3, "k {k:e}, p {p:e}: {count}");
        }
    }
}

#[test]
fn arap_is_the_weighted_mean() {
    for k in stiffnesses() {
        for p in spread(-6..=6) {
            let ([z, _], _) = Energy::<Plane>::prox(&Arap, [p, 0.0], k, [1.0, 1.0]);
            // stationary: 2 (z − 1) + k (z − p) = 0, up to the rounding of its terms
            let size = 2.0 + 2.0 * z.abs() + k * (z.abs() + p.abs());
            let residual = 2.0 * (z - 1.0) + k * (z - p);
            assert!(
                residual.abs() <= 8.0 * ROUNDING * size,
                "k {k:e}, p {p:e}: {residual:e}"
            );
        }
    }
}

/// ψ of a matrix, without its singular values; infinite where σ is outside the energy's domain.
trait OfMatrix: Energy<Plane> {
    fn of(&self, z: &Matrix) -> f64;
}

impl OfMatrix for SymmetricDirichlet {
    fn of(&self, z: &Matrix) -> f64 {
        let det = z.determinant();
        if det <= 0.0 {
            return f64::INFINITY;
        }
        z.norm_squared() * (1.0 + 1.0 / (det * det))
    }
}

impl OfMatrix for Arap {
    fn of(&self, z: &Matrix) -> f64 {
        // ‖Z − R‖² with the best proper R: ‖Z‖² − 2 (σ₁+σ₂) + 2, and (σ₁+σ₂)² = ‖Z‖² + 2 det
        let sum = (z.norm_squared() + 2.0 * z.determinant()).max(0.0).sqrt();
        z.norm_squared() - 2.0 * sum + 2.0
    }
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
}

/// The prox of a local variable as the solver composes it: no change of any entry of Z makes the
/// matrix problem's value smaller.
fn check_composite<C: Coupling<Plane>, E: OfMatrix>(
    energy: E,
    target: C::Local<f64>,
    k: f64,
    as_matrix: impl Fn(C::Local<f64>) -> Matrix,
    allowed: impl Fn(&Matrix) -> bool,
    directions: &[Matrix],
) {
    // the decomposition may begin at that of another gradient, and ends at the same values
    let (_, near) = C::local([1.0, 0.25, -0.5, 0.125], C::no_guess());
    let (p, frame) = C::spectrum(target, near);
    let (sigma, _) = energy.prox(p, k, [1.0, 1.0]);
    let z = as_matrix(C::compose(sigma, frame));
    let target = as_matrix(target);
    assert!(allowed(&z));
    let value = |z: &Matrix| energy.of(z) + 0.5 * k * (z - target).norm_squared();
    let best = value(&z);
    assert!(best.is_finite());
    let noise = 64.0 * f64::EPSILON * (best + k * (z.norm_squared() + target.norm_squared()));
    for direction in directions {
        for size in [1e-6, 1e-3, 1e-1, 1.0, 10.0] {
            let other = z + direction * size;
            if !allowed(&other) {
                continue;
            }
            let other = value(&other);
            assert!(
                best <= other + noise,
                "k {k:e}: {best} at {z}, {other} beside it, target {target}"
            );
        }
    }
}

#[test]
fn the_composed_step_solves_the_matrix_problem() {
    let mut random = Random(5);
    for round in 0..400 {
        let k = [0.5, 8.0, 100.0, 1e5][round % 4];
        // targets of every kind: positive, indefinite (a reflected element), small
        let scale = [1.0, 3.0, 0.01][round % 3];
        let mut random_matrix = || Matrix::from_fn(|_, _| random.next());
        let any: Vec<Matrix> = (0..40).map(|_| random_matrix()).collect();
        let symmetric: Vec<Matrix> = any.iter().map(|m| 0.5 * (m + m.transpose())).collect();
        let s = [0; 3].map(|_| scale * random.next());
        let f = [0; 4].map(|_| scale * random.next());
        // a stretch is not turned by half a turn: its trace is positive
        let stretch = |z: &Matrix| z.trace() > 0.0;
        check_composite::<RotationAware, _>(SymmetricDirichlet, s, k, full, stretch, &symmetric);
        check_composite::<Linear, _>(SymmetricDirichlet, f, k, matrix, |_| true, &any);
        check_composite::<Linear, _>(Arap, f, k, matrix, |_| true, &any);
    }
}

/// Many proxes in registers, and one by one.
struct SideBySide<'a> {
    p: &'a [f64],
    k: &'a [f64],
    warm: &'a [f64],
}

impl WithSimd for SideBySide<'_> {
    type Output = Vec<f64>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<f64> {
        let mut out = vec![0.0; self.p.len()];
        for at in (0..self.p.len()).step_by(Pack::<S>::WIDTH) {
            let [p, k, warm] = [self.p, self.k, self.warm].map(
                #[inline(always)]
                |row| Pack::load(simd, &row[at..]),
            );
            let (z, _) = Energy::<Plane>::prox(&SymmetricDirichlet, [p, -p], k, [warm, warm]);
            z[0].max(z[1]).store(&mut out[at..]);
        }
        out
    }
}

#[test]
fn a_register_gives_the_bits_of_its_elements() {
    // neighbours that need very different numbers of iterations
    let mut random = Random(6);
    let mut row = |decades: f64| -> Vec<f64> {
        (0..8 * 500)
            .map(|_| 10f64.powf(decades * random.next()))
            .collect()
    };
    let (p, k, warm) = (row(3.0), row(4.0), row(4.0));
    let packed = Arch::new().dispatch(SideBySide {
        p: &p,
        k: &k,
        warm: &warm,
    });
    for (i, packed) in packed.iter().enumerate() {
        let ([a, b], _) =
            Energy::<Plane>::prox(&SymmetricDirichlet, [p[i], -p[i]], k[i], [warm[i]; 2]);
        let alone = Lane::max(a, b);
        assert_eq!(
            packed.to_bits(),
            alone.to_bits(),
            "element {i}: {packed:e} beside others, {alone:e} alone"
        );
    }
}
