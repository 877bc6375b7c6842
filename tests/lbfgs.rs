//! The direction of `Lbfgs` is that of the two-loop recursion as the textbook has it.

use foldfree::linalg::{Cholesky, SymmetricAssembly};
use foldfree::optim::lbfgs::Lbfgs;
use foldfree::optim::vectors::dot;

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
    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }
}

/// The Laplacian of a path, made definite: solves of `columns` interleaved right-hand sides.
fn path(n: usize) -> Cholesky {
    let mut list: Vec<(u32, u32, f64)> = (0..n as u32).map(|v| (v, v, 2.1)).collect();
    list.extend((1..n as u32).map(|v| (v, v - 1, -1.0)));
    let mut assembly = SymmetricAssembly::new(n, list.iter().map(|e| (e.0, e.1)));
    assembly.fill(|c| list[c].2);
    let mut factor = Cholesky::analyze(assembly.matrix(), &[]).unwrap();
    factor.factorize(assembly.matrix()).unwrap();
    factor
}

/// H g for the pairs (s, y), oldest first (Nocedal & Wright, algorithm 7.4), H₀ = A⁻¹.
fn two_loops(
    pairs: &[(Vec<f64>, Vec<f64>)],
    factor: &mut Cholesky,
    columns: usize,
    g: &[f64],
) -> Vec<f64> {
    let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut q = g.to_vec();
    let mut alphas = Vec::new();
    for (s, y) in pairs.iter().rev() {
        let alpha = product(s, &q) / product(y, s);
        q.iter_mut().zip(y).for_each(|(q, y)| *q -= alpha * y);
        alphas.push(alpha);
    }
    factor.solve_in_place(&mut q, columns);
    for ((s, y), alpha) in pairs.iter().zip(alphas.into_iter().rev()) {
        let beta = product(y, &q) / product(y, s);
        q.iter_mut()
            .zip(s)
            .for_each(|(q, s)| *q += s * (alpha - beta));
    }
    q
}

/// A change of the gradient along a step `s`, of positive curvature: a positive diagonal matrix times
/// s, and a little noise.
fn change(random: &mut Random, s: &[f64]) -> Vec<f64> {
    let length = dot(s, s).sqrt() / (s.len() as f64).sqrt();
    s.iter()
        .map(|s| (2.0 + random.next()) * s + 0.1 * length * random.next())
        .collect()
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

#[test]
fn directions_are_those_of_the_textbook() {
    let mut random = Random(1);
    for (vertices, columns, window) in
        [(1, 1, 1), (5, 2, 3), (40, 3, 6), (1500, 2, 6), (9000, 2, 9)]
    {
        let n = vertices * columns;
        let mut factor = path(vertices);
        let mut history = Lbfgs::new(window);
        let mut pairs: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        let mut g = random.vector(n);
        for round in 0..20 {
            if round == 13 {
                history.clear();
                pairs.clear();
            }
            // every so often another objective, as in another iteration of ADMM
            if round % 3 == 1 {
                history.new_objective();
                g = random.vector(n);
            }
            let mut direction = vec![f64::NAN; n];
            let slope = history.direction(&mut factor, columns, &g, &mut direction);
            let expected = two_loops(&pairs, &mut factor, columns, &g);
            let size = expected.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            for (d, e) in direction.iter().zip(&expected) {
                // some twenty sums of n terms
                assert!(
                    (d + e).abs() <= 1e-10 * size,
                    "{n} unknowns, round {round}: {d} and −{e}"
                );
            }
            // the slope is taken of the direction itself, and H is positive
            let along: f64 = g.iter().zip(&direction).map(|(g, d)| g * d).sum();
            assert!((slope - along).abs() <= 1e-12 * along.abs());
            assert!(slope < 0.0);

            // a line search may have gone less far
            if round % 4 == 2 {
                direction.iter_mut().for_each(|d| *d *= 0.125);
                history.shorten(0.125);
            }
            let after = sum(&g, &change(&mut random, &direction));
            history.push(&direction, &g, &after);
            // as the history computes it
            let y = after.iter().zip(&g).map(|(a, g)| a - g).collect();
            pairs.push((direction, y));
            if pairs.len() > window {
                pairs.remove(0);
            }
            assert_eq!(history.len(), pairs.len());
            g = after;
        }
    }
}

/// Full steps on a quadratic function whose Hessian is H₀⁻¹ but for four large entries: what the
/// history is for.
#[test]
fn a_history_finds_the_minimum_that_its_first_guess_misses() {
    let vertices = 30;
    let mut factor = path(vertices);
    let stiff = |i: usize| if i % 8 == 3 { 1.0 } else { 0.0 };
    let hessian = |x: &[f64]| -> Vec<f64> {
        (0..vertices)
            .map(|i| {
                let before = if i > 0 { x[i - 1] } else { 0.0 };
                let after = if i + 1 < vertices { x[i + 1] } else { 0.0 };
                (2.1 + stiff(i)) * x[i] - before - after
            })
            .collect()
    };
    let mut residual_after = |window: usize, steps: usize| {
        let mut x = Random(2).vector(vertices);
        let mut history = Lbfgs::new(window);
        let mut gradient = hessian(&x);
        let first = dot(&gradient, &gradient).sqrt();
        for _ in 0..steps {
            let mut direction = vec![0.0; vertices];
            history.direction(&mut factor, 1, &gradient, &mut direction);
            x.iter_mut().zip(&direction).for_each(|(x, d)| *x += d);
            let after = hessian(&x);
            history.push(&direction, &gradient, &after);
            gradient = after;
        }
        dot(&gradient, &gradient).sqrt() / first
    };
    let (short, long) = (residual_after(1, 12), residual_after(6, 12));
    assert!(
        long <= 1e-5 && 20.0 * long < short,
        "{long:e}, with one pair {short:e}"
    );
}

#[test]
fn a_step_without_curvature_changes_nothing() {
    let mut random = Random(3);
    let n = 64;
    for window in [1, 3] {
        let mut factor = path(n);
        let mut history = Lbfgs::new(window);
        let mut g = random.vector(n);
        let mut direction = vec![0.0; n];
        for _ in 0..5 {
            history.direction(&mut factor, 1, &g, &mut direction);
            let after = sum(&g, &change(&mut random, &direction));
            history.push(&direction, &g, &after);
            g = after;
        }
        let probe = random.vector(n);
        let mut of = |history: &mut Lbfgs, g: &[f64]| {
            history.new_objective();
            let mut direction = vec![0.0; n];
            history.direction(&mut factor, 1, g, &mut direction);
            direction
        };
        let before = of(&mut history, &probe);
        let against: Vec<f64> = before.iter().map(|d| -d).collect();
        for change in [against, vec![0.0; n], vec![f64::NAN; n]] {
            let step = of(&mut history, &probe);
            history.push(&step, &probe, &sum(&probe, &change));
            assert_eq!(history.len(), window);
            assert_eq!(
                before,
                of(&mut history, &probe),
                "an accepted pair was pushed out"
            );
        }
    }
}

#[test]
fn sums_are_of_all_entries() {
    for n in [0, 1, 7, 8, 9, 1023, 1024, 1025, 5000] {
        let a: Vec<f64> = (0..n).map(|i| (i % 13) as f64).collect();
        let b: Vec<f64> = (0..n).map(|i| (i % 7) as f64 - 3.0).collect();
        // whole numbers: any order gives the same sum
        let expected: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
        assert_eq!(dot(&a, &b), expected);
    }
}
