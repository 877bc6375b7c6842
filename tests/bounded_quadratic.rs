//! L-BFGS-B against all active sets by brute force, and against the conditions of optimality.

mod random;

use foldfree::optim::lbfgsb::{LbfgsbOptions, Quadratic, minimize, projected_norm};
use random::Random;

/// ½ λᵀHλ + gᵀλ; counts how often H is applied, and follows the steps it is told of.
struct Dense {
    n: usize,
    h: Vec<f64>,
    applied: usize,
    last: Vec<f64>,
    followed: Vec<f64>,
}

impl Dense {
    fn random(n: usize, rank: usize, ridge: f64, random: &mut Random) -> Self {
        let factor: Vec<f64> = (0..n * rank).map(|_| random.next()).collect();
        let mut h = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                let products = (0..rank).map(|k| factor[i * rank + k] * factor[j * rank + k]);
                h[i * n + j] = products.sum::<f64>() + if i == j { ridge } else { 0.0 };
            }
        }
        Self {
            n,
            h,
            applied: 0,
            last: Vec::new(),
            followed: vec![0.0; n],
        }
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        let rows = self.h.chunks_exact(self.n);
        rows.map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
            .collect()
    }

    fn value(&self, g: &[f64], x: &[f64]) -> f64 {
        let hx = self.times(x);
        (0..self.n).map(|i| x[i] * (0.5 * hx[i] + g[i])).sum()
    }
}

impl Quadratic for Dense {
    fn apply(&mut self, direction: &[f64], out: &mut [f64]) {
        self.applied += 1;
        self.last = direction.to_vec();
        out.copy_from_slice(&self.times(direction));
    }
    fn moved(&mut self, step: f64) {
        for (f, d) in self.followed.iter_mut().zip(&self.last) {
            *f += step * d;
        }
    }
}

/// The solution of A x = b by elimination with pivots.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for c in 0..n {
        let p = (c..n).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs()))?;
        if a[p][c].abs() < 1e-12 {
            return None;
        }
        a.swap(p, c);
        b.swap(p, c);
        for r in 0..n {
            if r != c {
                let f = a[r][c] / a[c][c];
                for k in c..n {
                    let above = a[c][k];
                    a[r][k] -= f * above;
                }
                b[r] -= f * b[c];
            }
        }
    }
    Some((0..n).map(|i| b[i] / a[i][i]).collect())
}

/// The minimum over λ ≥ 0, by trying every set of positive variables.
fn brute_force(q: &Dense, g: &[f64]) -> Vec<f64> {
    let n = q.n;
    let mut best = (0.0, vec![0.0; n]);
    for set in 0u32..1 << n {
        let free: Vec<usize> = (0..n).filter(|i| set >> i & 1 == 1).collect();
        let a = free
            .iter()
            .map(|&i| free.iter().map(|&j| q.h[i * n + j]).collect());
        let b = free.iter().map(|&i| -g[i]).collect();
        let Some(x) = solve(a.collect(), b) else {
            continue;
        };
        if x.iter().any(|&x| x < 0.0) {
            continue;
        }
        let mut full = vec![0.0; n];
        free.iter().zip(&x).for_each(|(&i, &x)| full[i] = x);
        let value = q.value(g, &full);
        if value < best.0 {
            best = (value, full);
        }
    }
    best.1
}

const OPTIONS: LbfgsbOptions = LbfgsbOptions {
    history: 6,
    max_iterations: 500,
    tolerance: 1e-10,
};

#[test]
fn small_problems_end_where_brute_force_does() {
    let mut random = Random(5);
    for case in 0..60 {
        let n = 2 + case % 8;
        let mut q = Dense::random(n, n + 2, 1e-2, &mut random);
        let g: Vec<f64> = (0..n).map(|_| random.next()).collect();
        let expected = brute_force(&q, &g);
        // from zero, and from somewhere else
        for warm in [false, true] {
            let mut lambda: Vec<f64> = (0..n)
                .map(|_| if warm { random.next().max(0.0) } else { 0.0 })
                .collect();
            let start = lambda.clone();
            q.followed.copy_from_slice(&start);
            let hx = q.times(&lambda);
            let mut gradient: Vec<f64> = g.iter().zip(hx).map(|(g, h)| g + h).collect();
            minimize(&mut q, &mut lambda, &mut gradient, OPTIONS);
            for i in 0..n {
                assert!(
                    (lambda[i] - expected[i]).abs() < 1e-7,
                    "case {case}: {lambda:?} {expected:?}"
                );
                assert!(lambda[i] >= 0.0);
                assert!((q.followed[i] - lambda[i]).abs() < 1e-12, "steps are told");
            }
        }
    }
}

#[test]
fn large_and_singular_problems_meet_the_conditions() {
    let mut random = Random(11);
    for (n, rank) in [(200, 300), (300, 60)] {
        let mut q = Dense::random(n, rank, 0.0, &mut random);
        // g in the range of H plus what is positive: bounded below
        let x: Vec<f64> = (0..n).map(|_| random.next()).collect();
        let g: Vec<f64> = q
            .times(&x)
            .iter()
            .map(|h| h + 0.1 * random.next().abs())
            .collect();
        let (mut lambda, mut gradient) = (vec![0.0; n], g.clone());
        let first = projected_norm(&lambda, &gradient);
        let options = LbfgsbOptions {
            max_iterations: 3000,
            tolerance: 1e-6 * first,
            ..OPTIONS
        };
        let iterations = minimize(&mut q, &mut lambda, &mut gradient, options);
        assert!(
            projected_norm(&lambda, &gradient) <= 1e-6 * first,
            "{n} {rank}: {iterations}"
        );
        let again: Vec<f64> = q
            .times(&lambda)
            .iter()
            .zip(&g)
            .map(|(h, g)| h + g)
            .collect();
        for (a, b) in again.iter().zip(&gradient) {
            assert!(
                (a - b).abs() < 1e-8 * first,
                "the gradient is that of the result"
            );
        }
        assert!(
            q.applied <= iterations + 1,
            "one product an iteration, one for the scale"
        );
    }
}

#[test]
fn every_iteration_descends_and_a_minimum_is_left_alone() {
    let mut random = Random(3);
    let mut q = Dense::random(40, 50, 1e-3, &mut random);
    let g: Vec<f64> = (0..40).map(|_| random.next()).collect();
    let (mut lambda, mut gradient) = (vec![0.0; 40], g.clone());
    let mut value = 0.0;
    for count in 1..30 {
        let (mut l, mut d) = (vec![0.0; 40], g.clone());
        let options = LbfgsbOptions {
            max_iterations: count,
            ..OPTIONS
        };
        minimize(&mut q, &mut l, &mut d, options);
        let now = q.value(&g, &l);
        assert!(now <= value, "{count}: {value} {now}");
        value = now;
        (lambda, gradient) = (l, d);
    }
    minimize(&mut q, &mut lambda, &mut gradient, OPTIONS);
    let there = lambda.clone();
    let options = LbfgsbOptions {
        tolerance: 1e-8,
        ..OPTIONS
    };
    assert_eq!(minimize(&mut q, &mut lambda, &mut gradient, options), 0);
    assert_eq!(lambda, there);
}
