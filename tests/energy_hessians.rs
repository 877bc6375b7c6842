//! First and second derivatives of every energy: in the singular values against dual numbers, in F
//! against dual numbers or differences and another library's eigendecomposition.

mod dual;
mod random;

use dual::{Dual, dual};
use foldfree::energy::hessian::{Eigensystem, MOST, Square, projected_hessian};
use foldfree::energy::{
    Arap, Dirichlet, Energy, NeoHookean, StVenantKirchhoff, StableNeoHookean, SymmetricDirichlet,
};
use foldfree::space::{Components, Lane, Plane, Solid, Space};
use nalgebra_sparse::na::DMatrix;
use random::Random;

/// The two moduli every elastic energy here is made of: hardly and nearly incompressible, and auxetic.
const POISSON: [f64; 3] = [0.3, 0.49, -0.5];

#[track_caller]
fn close(a: f64, b: f64, scale: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance * scale,
        "{a} and {b} differ by {:e} of {scale}",
        (a - b).abs() / scale
    );
}

fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<f64> {
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

/// Gradient, Hessian and K_e at σ, against duals of the density.
fn check_sigma<const K: usize, S, E>(energy: E, s: [f64; K])
where
    S: Space<Sigma<f64> = [f64; K], Sigma<Dual> = [Dual; K]>,
    E: Energy<S>,
{
    let gradient = energy.gradient::<f64>(s);
    let hessian = energy.hessian(s);
    let second = |i, j| energy.density::<Dual>(dual(s, i, j)).0;
    let exact = DMatrix::from_fn(K, K, |i, j| second(i, j).eps1eps2);
    let size = exact.amax();
    let forces = gradient.map(f64::abs).into_iter().fold(size, f64::max);
    for i in 0..K {
        close(gradient[i], second(i, i).eps1, forces, 1e-13);
        for j in 0..K {
            close(hessian[i][j], exact[(i, j)], size, 1e-12);
        }
    }
    for (i, row) in hessian.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            assert!(i.max(j) < K || *entry == 0.0);
        }
    }
    let largest = eigenvalues(&exact)[K - 1];
    close(energy.effective_stiffness(s), largest, size, 1e-12);
}

/// At rest: no force, the energy said, Hooke's law.
fn check_rest(energy: impl Energy<Solid>, lame: [f64; 2]) {
    let rest = [1.0; 3];
    let [mu, lambda] = lame;
    close(energy.density(rest), 0.0, mu, 1e-14);
    assert_eq!(energy.constants().isometry, 0.0);
    for force in energy.gradient(rest) {
        close(force, 0.0, mu + lambda.abs(), 1e-14);
    }
    for (i, row) in energy.hessian(rest).iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let hooke = lambda + f64::from(u8::from(i == j)) * 2.0 * mu;
            close(*entry, hooke, mu + lambda.abs(), 1e-13);
        }
    }
    // what one axis feels near rest
    let weight = energy.constants().rest_stiffness;
    close(weight, 2.0 * mu + lambda, 2.0 * mu + lambda, 0.015);
}

fn lame(young: f64, poisson: f64) -> [f64; 2] {
    let mu = young / (2.0 * (1.0 + poisson));
    [mu, 2.0 * mu * poisson / (1.0 - 2.0 * poisson)]
}

/// Signed singular values: ordered, the last of either sign.
fn random_sigma<const K: usize>(random: &mut Random, positive: bool) -> [f64; K] {
    let mut s = random.many::<K>().map(|e| 10f64.powf(e));
    s.sort_by(|a, b| b.total_cmp(a));
    if !positive && random.next() < 0.0 {
        s[K - 1] = -s[K - 1];
    }
    s
}

#[test]
fn in_the_singular_values() {
    let mut random = Random(11);
    for round in 0..600 {
        let s3 = random_sigma::<3>(&mut random, false);
        let s2 = random_sigma::<2>(&mut random, false);
        let (p3, p2) = (s3.map(f64::abs), s2.map(f64::abs));
        check_sigma::<2, Plane, _>(Arap, s2);
        check_sigma::<3, Solid, _>(Arap, s3);
        check_sigma::<2, Plane, _>(Dirichlet, s2);
        check_sigma::<3, Solid, _>(Dirichlet, s3);
        check_sigma::<2, Plane, _>(SymmetricDirichlet, p2);
        check_sigma::<3, Solid, _>(SymmetricDirichlet, p3);
        let (young, poisson) = (3.0, POISSON[round % 3]);
        check_sigma::<3, Solid, _>(NeoHookean::new(young, poisson).unwrap(), s3);
        check_sigma::<3, Solid, _>(StableNeoHookean::new(young, poisson).unwrap(), s3);
        check_sigma::<3, Solid, _>(StVenantKirchhoff::new(young, poisson).unwrap(), s3);
    }
}

#[test]
fn small_strains_follow_hooke() {
    for poisson in POISSON {
        let young = 5.0;
        let moduli = lame(young, poisson);
        check_rest(NeoHookean::new(young, poisson).unwrap(), moduli);
        check_rest(StableNeoHookean::new(young, poisson).unwrap(), moduli);
        check_rest(StVenantKirchhoff::new(young, poisson).unwrap(), moduli);
    }
}

#[test]
fn moduli_out_of_range_are_refused() {
    for (young, poisson, word) in [
        (0.0, 0.3, "young"),
        (f64::NAN, 0.3, "young"),
        (f64::INFINITY, 0.3, "young"),
        (1.0, 0.5, "poisson"),
        (1.0, -1.0, "poisson"),
        (1.0, f64::NAN, "poisson"),
    ] {
        let errors = [
            NeoHookean::new(young, poisson).err(),
            StableNeoHookean::new(young, poisson).err(),
            StVenantKirchhoff::new(young, poisson).err(),
        ];
        for error in errors {
            assert!(error.unwrap().to_string().contains(word));
        }
    }
}

/// ψ(F) without singular values.
trait OfMatrix<S: Space>: Energy<S> {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L;
}

/// What the formulas are made of.
struct Invariants<L> {
    /// ‖F‖².
    squares: L,
    /// det F.
    volume: L,
    /// ‖cof F‖².
    cofactor: L,
    /// ‖FᵀF‖².
    fourth: L,
    /// k.
    dimension: f64,
}

fn invariants<L: Lane>(f: &[L], k: usize) -> Invariants<L> {
    let zero = f[0].lift(0.0);
    let at = |i: usize, j: usize| f[(j % k) * k + i % k];
    let sum = |terms: &mut dyn Iterator<Item = L>| terms.fold(zero, |a, b| a + b);
    let squared = |x: L| x * x;
    let cofactor = |i: usize, j: usize| match k {
        2 => at(i + 1, j + 1),
        _ => at(i + 1, j + 1) * at(i + 2, j + 2) - at(i + 1, j + 2) * at(i + 2, j + 1),
    };
    let product = |a: usize, b: usize| sum(&mut (0..k).map(|i| at(i, a) * at(i, b)));
    let pairs = || (0..k * k).map(|c| (c % k, c / k));
    let volume = match k {
        2 => at(0, 0) * at(1, 1) - at(0, 1) * at(1, 0),
        _ => sum(&mut (0..3).map(|j| at(0, j) * cofactor(0, j))),
    };
    Invariants {
        squares: sum(&mut f.iter().map(|&x| squared(x))),
        volume,
        cofactor: sum(&mut pairs().map(|(i, j)| squared(cofactor(i, j)))),
        fourth: sum(&mut pairs().map(|(i, j)| squared(product(i, j)))),
        dimension: k as f64,
    }
}

impl<S: Space> OfMatrix<S> for Dirichlet {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L {
        m.squares * m.squares.lift(0.5)
    }
}

impl<S: Space> OfMatrix<S> for SymmetricDirichlet {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L {
        // ‖F⁻¹‖ = ‖cof F‖/|det F|
        m.squares + m.cofactor / (m.volume * m.volume)
    }
}

impl OfMatrix<Plane> for Arap {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L {
        let two = m.squares.lift(2.0);
        m.squares - two * (m.squares + two * m.volume).sqrt() + two
    }
}

impl OfMatrix<Solid> for NeoHookean {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L {
        let lift = |c: f64| m.squares.lift(c);
        let log = match m.volume.any(lift(0.1).lt(m.volume)) {
            true => m.volume.ln(),
            false => {
                let d = m.volume - lift(0.1);
                lift(0.1f64.ln()) + lift(10.0) * d - lift(50.0) * d * d
            }
        };
        lift(0.5 * self.mu) * (m.squares - lift(m.dimension)) - lift(self.mu) * log
            + lift(0.5 * self.lambda) * log * log
    }
}

/// Young's modulus and Poisson's ratio of the matrix formulas below, which have no access to fields.
const YOUNG: f64 = 2.0;
const RATIO: f64 = 0.4;

impl OfMatrix<Solid> for StableNeoHookean {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L {
        let lift = |c: f64| m.squares.lift(c);
        let [mu, lambda] = lame(YOUNG, RATIO);
        let (mu, lambda) = (4.0 * mu / 3.0, lambda + 5.0 * mu / 6.0);
        let away = m.volume - lift(1.0 + mu / lambda - mu / (4.0 * lambda));
        lift(0.5 * mu) * (m.squares - lift(3.0)) + lift(0.5 * lambda) * away * away
            - lift(0.5 * mu) * (m.squares + lift(1.0)).ln()
    }
}

impl OfMatrix<Solid> for StVenantKirchhoff {
    fn of<L: Lane>(&self, m: &Invariants<L>) -> L {
        let lift = |c: f64| m.squares.lift(c);
        let trace = lift(0.5) * (m.squares - lift(3.0));
        // ‖C − I‖²/4
        let strain = lift(0.25) * (m.fourth - lift(2.0) * m.squares + lift(3.0));
        lift(self.mu) * strain + lift(0.5 * self.lambda) * trace * trace
    }
}

fn by_duals<const N: usize, S: Space, E: OfMatrix<S>>(energy: E, f: [f64; N]) -> DMatrix<f64> {
    DMatrix::from_fn(N, N, |i, j| {
        let m = invariants::<Dual>(&dual(f, i, j), S::DIM);
        energy.of(&m).0.eps1eps2
    })
}

fn top<S: Space>(square: Square) -> DMatrix<f64> {
    let n = S::DIM * S::STRETCHES;
    for (i, row) in square.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            assert!(i.max(j) < n || *entry == 0.0);
        }
    }
    assert!(n <= MOST);
    DMatrix::from_fn(n, n, |i, j| square[i][j])
}

/// The eigensystem at F: eigenvalues, matrix and projection of the exact Hessian.
fn check_matrix<S: Space>(
    energy: impl Energy<S>,
    f: S::Gradient<f64>,
    exact: &DMatrix<f64>,
    tolerance: f64,
) {
    let system = Eigensystem::<S>::new(energy, f);
    let size = exact.amax();
    let off = |a: DMatrix<f64>, b: &DMatrix<f64>| (a - b).amax() / size;
    let mut values = system.values().to_vec();
    values.sort_by(f64::total_cmp);
    for (a, b) in values.iter().zip(eigenvalues(exact)) {
        close(*a, b, size, tolerance);
    }
    assert_eq!(values.len(), S::DIM * S::STRETCHES);
    let whole = off(top::<S>(system.map(|v| v)), exact);
    assert!(whole <= tolerance, "{whole:e} at {:?}", f.as_slice());
    let dense = exact.clone().symmetric_eigen();
    let clamped = DMatrix::from_diagonal(&dense.eigenvalues.map(|v| v.max(0.0)));
    let clamped = &dense.eigenvectors * clamped * dense.eigenvectors.transpose();
    let projected = top::<S>(projected_hessian::<S, _>(energy, f));
    assert!(eigenvalues(&projected)[0] >= -1e-13 * size);
    let part = off(projected, &clamped);
    assert!(part <= tolerance, "{part:e} at {:?}", f.as_slice());
}

/// U diag(σ) Vᵀ with random rotations.
fn random_matrix<S: Space>(random: &mut Random, sigma: &[f64]) -> S::Gradient<f64> {
    let any = S::Gradient::from_fn(|_| random.next());
    S::from_svd(S::Sigma::from_fn(|i| sigma[i]), S::svd(any).1)
}

/// Singular values in general position, nearly or exactly equal, nearly or exactly opposite.
fn special_sigma<const K: usize>(random: &mut Random, round: usize) -> [f64; K] {
    let mut s = random_sigma::<K>(random, false);
    let near = [0.0, 1e-14, 1e-10, 1e-7, 1e-5, 1e-3][round / 4 % 6];
    match round % 4 {
        0 => {}
        1 => s[1] = s[0] * (1.0 - near),
        2 => s[K - 1] = s[K - 2] * (1.0 - near),
        _ => s[K - 1] = -s[K - 2] * (1.0 - near),
    }
    if K == 3 && round.is_multiple_of(7) {
        s = [s[0]; K];
    }
    s.sort_by(|a, b| b.abs().total_cmp(&a.abs()));
    s
}

/// Where a quotient is replaced by its limit or nearly so, it is right to about this.
const TOLERANCE: f64 = 3e-9;

#[test]
fn in_the_matrix_plane() {
    let mut random = Random(12);
    for round in 0..2000 {
        let sigma = special_sigma::<2>(&mut random, round);
        let f: [f64; 4] = random_matrix::<Plane>(&mut random, &sigma);
        let exact = by_duals::<4, Plane, _>(Dirichlet, f);
        check_matrix::<Plane>(Dirichlet, f, &exact, TOLERANCE);
        let sum = sigma[0] + sigma[1];
        if sum > 1e-3 * sigma[0] {
            let exact = by_duals::<4, Plane, _>(Arap, f);
            check_matrix::<Plane>(Arap, f, &exact, TOLERANCE);
        }
        let f: [f64; 4] = random_matrix::<Plane>(&mut random, &sigma.map(f64::abs));
        let exact = by_duals::<4, Plane, _>(SymmetricDirichlet, f);
        check_matrix::<Plane>(SymmetricDirichlet, f, &exact, TOLERANCE);
    }
}

#[test]
fn in_the_matrix_solid() {
    let mut random = Random(13);
    for round in 0..2000 {
        let sigma = special_sigma::<3>(&mut random, round);
        let f: [f64; 9] = random_matrix::<Solid>(&mut random, &sigma);
        macro_rules! check {
            ($energy:expr, $f:expr) => {
                let exact = by_duals::<9, Solid, _>($energy, $f);
                check_matrix::<Solid>($energy, $f, &exact, TOLERANCE);
            };
        }
        check!(Dirichlet, f);
        check!(StableNeoHookean::new(YOUNG, RATIO).unwrap(), f);
        check!(StVenantKirchhoff::new(YOUNG, RATIO).unwrap(), f);
        // not across the seam of the logarithm, where the third derivative jumps
        let volume: f64 = sigma.iter().product();
        if (volume - 0.1).abs() > 1e-3 {
            check!(NeoHookean::new(YOUNG, RATIO).unwrap(), f);
        }
        let f: [f64; 9] = random_matrix::<Solid>(&mut random, &sigma.map(f64::abs));
        check!(SymmetricDirichlet, f);
    }
}

/// ARAP in three dimensions has no formula in invariants: differences of the stress.
#[test]
fn arap_of_a_solid() {
    let mut random = Random(14);
    let stress = |f: [f64; 9]| {
        let (sigma, frame) = Solid::svd(f);
        Solid::from_svd(Energy::<Solid>::gradient(&Arap, sigma), frame)
    };
    for round in 0..500 {
        let sigma = special_sigma::<3>(&mut random, round);
        if sigma[1] + sigma[2] < 0.05 * sigma[0] {
            continue;
        }
        let f: [f64; 9] = random_matrix::<Solid>(&mut random, &sigma);
        let h = 1e-5 * (sigma[1] + sigma[2]);
        let columns: Vec<[f64; 9]> = (0..9)
            .map(|c| {
                let moved = |d: f64| {
                    let mut f = f;
                    f[c] += d;
                    stress(f)
                };
                let (a, b) = (moved(h), moved(-h));
                std::array::from_fn(|i| (a[i] - b[i]) / (2.0 * h))
            })
            .collect();
        let exact = DMatrix::from_fn(9, 9, |i, j| 0.5 * (columns[j][i] + columns[i][j]));
        check_matrix::<Solid>(Arap, f, &exact, 1e-7);
    }
}

/// What the Hessian is nowhere: not a number. And its projection is never indefinite.
#[test]
fn degenerate_matrices() {
    fn check<S: Space>(energy: impl Energy<S>, f: S::Gradient<f64>) {
        let system = Eigensystem::<S>::new(energy, f);
        assert!(
            system.values().iter().all(|v| !v.is_nan()),
            "{:?} at {:?}",
            system.values(),
            f.as_slice()
        );
        let projected = top::<S>(system.map(|v| v.max(0.0)));
        assert!(projected.iter().all(|x| x.is_finite()));
        assert!(eigenvalues(&projected)[0] >= -1e-12 * projected.amax());
    }
    for scale in [0.0, 1e-200, 1e-14, 1.0, 1e6] {
        for [a, b, c] in [
            [1.0, 1.0, 1.0],
            [1.0, 1.0, -1.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 1e-14, -1e-14],
        ] {
            let f = [a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c].map(|x| scale * x);
            check::<Solid>(Arap, f);
            check::<Solid>(Dirichlet, f);
            check::<Solid>(NeoHookean::new(YOUNG, RATIO).unwrap(), f);
            check::<Solid>(StableNeoHookean::new(YOUNG, RATIO).unwrap(), f);
            check::<Solid>(StVenantKirchhoff::new(YOUNG, RATIO).unwrap(), f);
            let f = [b, 0.0, 0.0, c].map(|x| scale * x);
            check::<Plane>(Arap, f);
            check::<Plane>(Dirichlet, f);
        }
    }
}
