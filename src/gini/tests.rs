//! Constraints against finite differences, the dual problem against brute force, zones against a plain search.

use super::constraint::{Constraint, Key, Law};
use super::dual::{Primal, global_step};
use super::polisher::polish;
use super::simplex::{Corners, signed_measure};
use super::zones::Zones;
use crate::linalg::{Cholesky, SymmetricAssembly};

/// Numbers in −1..1, the same in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    fn below(&mut self, n: usize) -> u32 {
        (((self.next() + 1.0) * 0.5 * n as f64) as u32).min(n as u32 - 1)
    }
    fn points<const D: usize>(&mut self, n: usize) -> Vec<[f64; D]> {
        (0..n)
            .map(|_| std::array::from_fn(|_| self.next()))
            .collect()
    }
}

fn constraint(slots: [u32; 4], scale: f64, offset: f64) -> Constraint {
    Constraint {
        key: Key::Element(0),
        slots,
        law: Law::Measure { scale },
        base: Law::Measure { scale },
        offset,
        lambda: 0.0,
        damping: 1e-3,
        proximal: false,
        skipped: false,
    }
}

fn gradient_is_that_of_the_value<const D: usize>() {
    let mut random = Random(D as u64);
    for _ in 0..50 {
        let p: Corners<D> = random.points(4).try_into().expect("four");
        let c = constraint([0, 1, 2, 3], 1.7, 0.0);
        let g = c.gradient_at(&p);
        for v in 0..4 {
            for i in 0..D {
                // quadratic or cubic at most, linear in each corner: central differences are exact
                let h = 0.5;
                let (mut more, mut less) = (p, p);
                more[v][i] += h;
                less[v][i] -= h;
                let slope = (c.value_at(&more) - c.value_at(&less)) / (2.0 * h);
                assert!((slope - g[v][i]).abs() < 1e-13, "{slope} {}", g[v][i]);
            }
        }
    }
}

#[test]
fn gradients_are_those_of_the_values() {
    gradient_is_that_of_the_value::<2>();
    gradient_is_that_of_the_value::<3>();
    let triangle: Corners<2> = [[0.0, 0.0], [2.0, 0.0], [0.0, 3.0], [0.0, 3.0]];
    assert_eq!(signed_measure(&triangle), 3.0);
    let corner: Corners<3> = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    assert_eq!(signed_measure(&corner), 1.0);
}

/// The lower triangle of a path graph's Laplacian plus ridge, factored, and the full matrix.
fn system(n: usize, ridge: f64) -> (Cholesky, Vec<Vec<f64>>) {
    let pairs: Vec<(u32, u32)> = (0..n as u32)
        .map(|i| (i, i))
        .chain((1..n as u32).map(|i| (i, i - 1)))
        .collect();
    let mut assembly = SymmetricAssembly::new(n, pairs.iter().copied());
    assembly.fill(|k| if k < n { 2.0 + ridge } else { -1.0 });
    let mut factor = Cholesky::analyze(assembly.matrix(), &[]).expect("small");
    factor.factorize(assembly.matrix()).expect("definite");
    let mut full = vec![vec![0.0; n]; n];
    for i in 0..n {
        full[i][i] = 2.0 + ridge;
        if i > 0 {
            full[i][i - 1] = -1.0;
            full[i - 1][i] = -1.0;
        }
    }
    (factor, full)
}

fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Option<Vec<f64>> {
    let n = b.len();
    for c in 0..n {
        let p = (c..n).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs()))?;
        if a[p][c].abs() < 1e-11 {
            return None;
        }
        a.swap(p, c);
        b.swap(p, c);
        for r in (0..n).filter(|&r| r != c) {
            let f = a[r][c] / a[c][c];
            for k in c..n {
                let above = a[c][k];
                a[r][k] -= f * above;
            }
            b[r] -= f * b[c];
        }
    }
    Some((0..n).map(|i| b[i] / a[i][i]).collect())
}

/// min ½ sᵀAs − bᵀs with ∇c·s ≥ η − c, by the equations of every active set.
fn brute_force<const D: usize>(
    a: &[Vec<f64>],
    b: &[[f64; D]],
    rows: &[Vec<f64>],
    right: &[f64],
) -> Vec<f64> {
    let n = b.len() * D;
    let entry = |i: usize, j: usize| if i % D == j % D { a[i / D][j / D] } else { 0.0 };
    for set in 0u32..1 << rows.len() {
        let active: Vec<usize> = (0..rows.len()).filter(|r| set >> r & 1 == 1).collect();
        let size = n + active.len();
        let mut matrix = vec![vec![0.0; size]; size];
        let mut vector = vec![0.0; size];
        for i in 0..n {
            (0..n).for_each(|j| matrix[i][j] = entry(i, j));
            vector[i] = b[i / D][i % D];
            for (k, &r) in active.iter().enumerate() {
                matrix[i][n + k] = -rows[r][i];
                matrix[n + k][i] = rows[r][i];
                vector[n + k] = right[r];
            }
        }
        let Some(x) = solve(matrix, vector) else {
            continue;
        };
        let meets = |r: usize| (0..n).map(|i| rows[r][i] * x[i]).sum::<f64>() >= right[r] - 1e-9;
        if x[n..].iter().all(|&l| l >= -1e-9) && (0..rows.len()).all(meets) {
            return x[..n].to_vec();
        }
    }
    panic!("the problem has a solution");
}

fn the_dual_problem_ends_where_brute_force_does<const D: usize>() {
    let mut random = Random(40 + D as u64);
    let mut solved = 0;
    for _ in 0..40 {
        // six unknowns and two vertices that are held
        let n = 6;
        let (mut factor, a) = system(n, 0.1);
        let x: Vec<[f64; D]> = random.points(n + 2);
        let b: Vec<[f64; D]> = random.points(n);
        let mut constraints = Vec::new();
        let mut used: Vec<Vec<u32>> = Vec::new();
        let mut rows = Vec::new();
        let mut right = Vec::new();
        while constraints.len() < 5 {
            let s = [0; 4].map(|_| random.below(n + 2));
            if (0..4).any(|i| (0..i).any(|j| s[i] == s[j])) {
                continue;
            }
            // the same simplex twice, turned over, could not be positive both times
            let mut sorted = s;
            sorted[..=D].sort_unstable();
            if used.contains(&sorted[..=D].to_vec()) {
                continue;
            }
            used.push(sorted[..=D].to_vec());
            let slots = if D == 2 { [s[0], s[1], s[2], s[2]] } else { s };
            let c = constraint(slots, 1.0, 0.05);
            let p = slots.map(|s| x[s as usize]);
            let mut row = vec![0.0; n * D];
            for (slot, g) in slots.iter().zip(c.gradient_at(&p)) {
                for i in 0..D {
                    if (*slot as usize) < n {
                        row[*slot as usize * D + i] += g[i];
                    }
                }
            }
            right.push(c.offset - c.value_at(&p));
            rows.push(row);
            constraints.push(c);
        }
        let expected = brute_force(&a, &b, &rows, &right);
        let compliance = 1e-6;
        let factor = &mut factor;
        let mut step = b.clone();
        global_step(
            &mut constraints,
            &x,
            Primal { factor, compliance },
            &mut step,
            400,
            None,
        );
        // the constraints are met to a tenth of η, as the solver promises
        for (row, right) in rows.iter().zip(&right) {
            let value: f64 = row
                .iter()
                .zip(step.as_flattened())
                .map(|(r, s)| r * s)
                .sum();
            assert!(value >= right - 0.0051, "{value} {right}");
        }
        let apart = step.as_flattened().iter().zip(&expected);
        let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 0.1, "{apart}");
        // a warm start needs no iteration
        let again = constraints.clone();
        let mut step = b.clone();
        let primal = Primal { factor, compliance };
        assert_eq!(
            global_step(&mut constraints, &x, primal, &mut step, 400, None),
            0
        );
        assert_eq!(constraints, again);
        solved += usize::from(constraints.iter().any(|c| c.lambda > 0.0));
    }
    assert!(
        solved > 20,
        "most of the problems have active constraints: {solved}"
    );
}

#[test]
fn dual_problems_end_where_brute_force_does() {
    the_dual_problem_ends_where_brute_force_does::<2>();
    the_dual_problem_ends_where_brute_force_does::<3>();
}

#[test]
fn zones_are_connected_and_do_not_share_what_moves() {
    let mut random = Random(9);
    for case in 0..30 {
        let n = 60;
        let movable: Vec<bool> = (0..n).map(|_| random.next() > -0.4).collect();
        let count = 4 + case;
        let constraints: Vec<Constraint> = (0..count)
            .map(|_| constraint([0; 4].map(|_| random.below(n)), 1.0, 0.0))
            .collect();
        let mut zones = Zones::new(n);
        // twice: what is left of the first time must not matter
        zones.build(&constraints[..count / 2], &movable);
        zones.build(&constraints, &movable);
        let mut zone_of = vec![usize::MAX; n];
        let mut seen = vec![false; count];
        for z in 0..zones.len() {
            for (place, &v) in zones.vertices(z).iter().enumerate() {
                assert_eq!(
                    zone_of[v as usize],
                    usize::MAX,
                    "a vertex is in one zone, once"
                );
                assert!(movable[v as usize]);
                assert_eq!(zones.local(v) as usize, place);
                zone_of[v as usize] = z;
            }
            for &c in zones.constraints(z) {
                assert!(!std::mem::replace(&mut seen[c as usize], true));
            }
        }
        assert!(seen.iter().all(|&s| s));
        for z in 0..zones.len() {
            // a search from the first constraint reaches all of the zone
            let members = zones.constraints(z);
            let mut reached = vec![members[0]];
            let mut at = 0;
            while at < reached.len() {
                let slots = constraints[reached[at] as usize].slots;
                for &c in members {
                    let mut shared = constraints[c as usize].slots.iter();
                    let meets = shared.any(|s| movable[*s as usize] && slots.contains(s));
                    if meets && !reached.contains(&c) {
                        reached.push(c);
                    }
                }
                at += 1;
            }
            assert_eq!(reached.len(), members.len());
            for &c in members {
                for &s in &constraints[c as usize].slots {
                    if movable[s as usize] {
                        assert_eq!(zone_of[s as usize], z);
                    } else {
                        assert_eq!(zones.local(s), Zones::HELD);
                    }
                }
            }
        }
    }
}

/// A fan of triangles around vertex 0, which starts outside: one zone of `n` constraints.
fn fan(n: usize) -> (Vec<Constraint>, Vec<[f64; 2]>, Vec<bool>) {
    let mut x = vec![[1.5, 0.3]];
    for k in 0..n {
        let angle = std::f64::consts::TAU * k as f64 / n as f64;
        x.push([angle.cos(), angle.sin()]);
    }
    let ring = |k: usize| 1 + (k % n) as u32;
    let triangles =
        (0..n).map(|k| constraint([0, ring(k), ring(k + 1), ring(k + 1)], 1.0, 0.1 / n as f64));
    let movable = (0..=n).map(|v| v == 0).collect();
    (triangles.collect(), x, movable)
}

#[test]
fn a_vertex_finds_into_its_fan() {
    // by Cholesky's factorisation, and by conjugate gradients
    for n in [5, 120] {
        let (mut constraints, mut x, movable) = fan(n);
        let mut zones = Zones::new(x.len());
        let mut before = f64::INFINITY;
        for _ in 0..30 {
            let done = polish(&mut constraints, &mut zones, &movable, &mut x);
            assert!(done.zones <= 1 && done.after <= done.before && done.before <= before);
            before = done.after;
        }
        assert!(
            constraints.iter().all(|c| c.value(&x) > 0.0),
            "{n}: {:?}",
            x[0]
        );
        assert!(
            constraints
                .iter()
                .all(|c| (1e-4..=1e-1).contains(&c.damping))
        );
        // what is held has not moved
        assert_eq!(x[1], [1.0, 0.0]);
    }
}
