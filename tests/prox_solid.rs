//! The proximal step of the elastic energies, argmin_z ψ(z) + k/2 ‖z − p‖² (6), against search.

mod random;

use foldfree::energy::{Dirichlet, Energy, NeoHookean, StVenantKirchhoff, StableNeoHookean};
use foldfree::space::{Pack, Plane, Solid, Space};
use pulp::{Arch, Simd, WithSimd};
use random::Random;

/// ψ(z) + k/2 ‖z − p‖².
fn value<E: Energy<Solid>>(energy: E, z: [f64; 3], p: [f64; 3], k: f64) -> f64 {
    let distance: f64 = z.iter().zip(p).map(|(z, p)| (z - p) * (z - p)).sum();
    energy.density::<f64>(z) + 0.5 * k * distance
}

/// Downhill along the axes, with ever smaller steps, where `allowed`.
fn compass(
    value: &dyn Fn([f64; 3]) -> f64,
    allowed: &dyn Fn([f64; 3]) -> bool,
    mut z: [f64; 3],
) -> f64 {
    let mut best = value(z);
    let mut step = 0.25 * z.iter().fold(0.1, |a: f64, z| a.max(z.abs()));
    while step > 1e-5 {
        let before = best;
        for i in 0..3 {
            for sign in [1.0, -1.0] {
                let mut other = z;
                other[i] += sign * step;
                if allowed(other) && value(other) < best {
                    (z, best) = (other, value(other));
                }
            }
        }
        if best == before {
            step *= 0.5;
        }
    }
    best
}

/// What is asked of the local step: a pull towards a target of any kind.
struct Case {
    p: [f64; 3],
    k: f64,
    warm: [f64; 3],
}

/// Targets from tiny to large, sorted, positive, with a reflection, or with any signs; weights about
/// the one at rest; warm starts at rest, or anywhere.
fn case(random: &mut Random, round: usize, stiffness: f64) -> Case {
    let decades = [0.1, 0.5, 1.0, 2.0][round % 4];
    let mut p = random.many::<3>().map(|e| 10f64.powf(decades * e));
    match round / 4 % 4 {
        0 => {}
        3 => p = p.map(|p| if random.next() < 0.0 { -p } else { p }),
        _ => {
            p.sort_by(|a, b| b.total_cmp(a));
            p[2] = -p[2];
        }
    }
    p.sort_by(|a, b| b.total_cmp(a));
    let k = stiffness * 10f64.powf(random.next());
    let warm = match round / 16 % 2 {
        0 => [1.0; 3],
        _ => random.many::<3>().map(|e| 10f64.powf(decades * e)),
    };
    Case { p, k, warm }
}

/// Stationary, no worse than where it may begin, and how often a search with many starts finds less.
fn check<E: Energy<Solid>>(
    name: &str,
    energy: E,
    seed: u64,
    rounds: usize,
    allowed: impl Fn([f64; 3]) -> bool,
) -> usize {
    let mut random = Random(seed);
    let (mut most, mut worse) = (0, 0);
    let stiffness = energy.constants().rest_stiffness;
    for round in 0..rounds {
        let Case { p, k, warm } = case(&mut random, round, stiffness);
        let (z, count) = energy.prox::<f64>(p, k, warm);
        let context = format!("{name}, round {round}: p {p:?}, k {k:e}, warm {warm:?}: {z:?}");
        assert!(allowed(z), "{context}");
        let found = value(energy, z, p, k);
        let noise = |v: f64| 1e-12 * (v.abs() + stiffness);
        for begin in [p.map(|p| p.abs().max(1e-6)), warm] {
            let there = value(energy, begin, p, k);
            assert!(found <= there + noise(there), "{context}: {begin:?}");
        }
        // where the target is far from any stretch the minimum may be on the border of what is allowed
        if !allowed(p) || (!allowed([-1.0; 3]) && p[1] < p[2].abs()) {
            continue;
        }
        most = most.max(count);
        let gradient = energy.gradient::<f64>(z);
        let hessian = energy.hessian(z);
        let bend = hessian.as_flattened().iter();
        let bend = bend.fold(k, |a: f64, h| a.max(h.abs()));
        let size = z.iter().fold(1e-6, |a: f64, z| a.max(z.abs()));
        for i in 0..3 {
            let residual = gradient[i] + k * (z[i] - p[i]);
            let largest = gradient[i].abs() + k * (z[i].abs() + p[i].abs()) + bend * size;
            assert!(residual.abs() <= 1e-12 * largest, "{context}: {residual:e}");
        }
        // random points over the range of p and rest, the best of them followed downhill
        let reach = p.iter().fold(1.0, |a: f64, p| a.max(p.abs()));
        let mut points: Vec<[f64; 3]> = (0..300)
            .map(|_| random.many::<3>().map(|x| 1.5 * reach * x * x.abs()))
            .filter(|z| allowed(*z))
            .chain([warm, p.map(f64::abs)])
            .chain(Some(p).filter(|p| allowed(*p)))
            .collect();
        let objective = |z: [f64; 3]| value(energy, z, p, k);
        points.sort_by(|a, b| objective(*a).total_cmp(&objective(*b)));
        let best = points[..4]
            .iter()
            .map(|z| compass(&objective, &allowed, *z))
            .fold(f64::INFINITY, f64::min);
        if found > best + 1e-9 * (best.abs() + stiffness) {
            worse += 1;
            // another minimum: no saddle, no maximum
            let h = hessian;
            let (curvatures, _) = Solid::eigen([
                h[0][0] + k,
                h[1][1] + k,
                h[2][2] + k,
                h[0][1],
                h[0][2],
                h[1][2],
            ]);
            assert!(curvatures[2] > 0.0, "{context}: {curvatures:?}");
            println!("{context}: {found}, and {best} by search");
        }
    }
    println!("{name}: at most {most} steps, {worse} of {rounds} not the global minimum");
    assert!(most < 50, "{name}: {most} steps");
    worse
}

/// The first two stay positive.
fn stretch(z: [f64; 3]) -> bool {
    z[0] >= 0.0 && z[1] >= 0.0
}

#[test]
fn st_venant_kirchhoff() {
    for (i, poisson) in [0.45, 0.0, -0.8].into_iter().enumerate() {
        let energy = StVenantKirchhoff::new(1e3, poisson).unwrap();
        let worse = check("StVK", energy, i as u64, 3000, |_| true);
        assert_eq!(worse, 0);
    }
}

/// The problem is not convex: where k is below −λ_min of the Hessian, which −λ (J − α) times a σ can make
/// negative, there may be several minima, and Newton's method ends in the one downhill from where it begins.
/// Of these targets, most of them reflected, that is another than the lowest for one in a thousand.
#[test]
fn stable_neo_hookean() {
    for (i, poisson) in [0.45, 0.0, -0.8].into_iter().enumerate() {
        let energy = StableNeoHookean::new(1e3, poisson).unwrap();
        let worse = check("stable", energy, i as u64, 3000, stretch);
        assert!(worse <= [3, 1, 0][i], "{worse}");
    }
}

#[test]
fn neo_hookean() {
    let energy = NeoHookean::new(1e3, 0.45).unwrap();
    let worse = check("neo-Hookean", energy, 9, 3000, stretch);
    assert!(worse <= 2, "{worse}");
}

#[test]
fn dirichlet_is_a_shorter_target() {
    let mut random = Random(3);
    for round in 0..1000 {
        let Case { p, k, warm } = case(&mut random, round, 1.0);
        let (z, _) = Energy::<Solid>::prox::<f64>(&Dirichlet, p, k, warm);
        let (flat, _) = Energy::<Plane>::prox::<f64>(&Dirichlet, [p[0], p[2]], k, [1.0; 2]);
        assert_eq!(flat, [z[0], z[2]]);
        for i in 0..3 {
            let residual = z[i] + k * (z[i] - p[i]);
            assert!(residual.abs() <= 4.0 * f64::EPSILON * k * p[i].abs());
        }
    }
}

/// At p = 0 the target has no sign, and the minimum may be elsewhere.
#[test]
fn targets_without_a_direction() {
    for k in [0.1, 1.0, 100.0] {
        let energy = StVenantKirchhoff::new(1.0, 0.3).unwrap();
        let (z, count) = energy.prox::<f64>([0.0; 3], k, [1.0; 3]);
        assert!(count < 50, "{k}: {z:?}");
        // 2μE + 3λE + k = 0, or 0
        let squared = 1.0 - 2.0 * k / (2.0 * energy.mu + 3.0 * energy.lambda);
        for z in z {
            assert!((z - squared.max(0.0).sqrt()).abs() < 1e-7, "{k}: {z:?}");
        }
        let energy = StableNeoHookean::new(1.0, 0.3).unwrap();
        let (z, count) = energy.prox::<f64>([0.0; 3], k, [1.0; 3]);
        assert!(count < 50 && z.iter().all(|z| z.is_finite() && *z >= 0.0));
    }
}

/// Many proxes in registers, and one by one.
struct SideBySide<'a, E> {
    energy: E,
    cases: &'a [Case],
}

impl<E: Energy<Solid>> WithSimd for SideBySide<'_, E> {
    type Output = Vec<[f64; 3]>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<[f64; 3]> {
        let width = Pack::<S>::WIDTH;
        let mut out = Vec::new();
        for cases in self.cases.chunks_exact(width) {
            let row = |of: &dyn Fn(&Case) -> f64| {
                let values: Vec<f64> = cases.iter().map(of).collect();
                Pack::load(simd, &values)
            };
            let p = [0, 1, 2].map(|i| row(&|case| case.p[i]));
            let warm = [0, 1, 2].map(|i| row(&|case| case.warm[i]));
            let (z, _) = self.energy.prox(p, row(&|case| case.k), warm);
            let mut lanes = [[0.0; 8]; 3];
            for i in 0..3 {
                z[i].store(&mut lanes[i][..width]);
            }
            out.extend((0..width).map(|e| [0, 1, 2].map(|i| lanes[i][e])));
        }
        out
    }
}

#[test]
fn a_register_gives_the_bits_of_its_elements() {
    fn same<E: Energy<Solid>>(energy: E) {
        let mut random = Random(21);
        let stiffness = energy.constants().rest_stiffness;
        let cases: Vec<Case> = (0..8 * 200)
            .map(|round| case(&mut random, round, stiffness))
            .collect();
        let cases = &cases[..];
        let packed = Arch::new().dispatch(SideBySide { energy, cases });
        for (case, packed) in cases.iter().zip(&packed) {
            let (alone, _) = energy.prox::<f64>(case.p, case.k, case.warm);
            assert_eq!(alone.map(f64::to_bits), packed.map(f64::to_bits));
        }
    }
    same(StVenantKirchhoff::new(1e3, 0.4).unwrap());
    same(StableNeoHookean::new(1e3, 0.4).unwrap());
    same(NeoHookean::new(1e3, 0.4).unwrap());
}
