//! Random problems against an independent search: the reals by the KKT system (paper, equation 6), the
//! integers by plain recursion within the ellipsoid of the energy.

mod miqp;
mod random;

use foldfree::mixed_integer::{Problem, Rounding};
use miqp::solve;
use random::Random;

/// Solves a dense system with several right-hand sides in place, with pivoting.
fn gauss(a: &mut [Vec<f64>], b: &mut [Vec<f64>]) {
    let n = a.len();
    for j in 0..n {
        let pivot = (j..n)
            .max_by(|&p, &q| a[p][j].abs().total_cmp(&a[q][j].abs()))
            .expect("rows");
        a.swap(j, pivot);
        b.swap(j, pivot);
        let (pivot_a, pivot_b) = (a[j].clone(), b[j].clone());
        for i in (0..n).filter(|&i| i != j) {
            let f = a[i][j] / pivot_a[j];
            a[i].iter_mut().zip(&pivot_a).for_each(|(x, p)| *x -= f * p);
            b[i].iter_mut().zip(&pivot_b).for_each(|(x, p)| *x -= f * p);
        }
    }
    for j in 0..n {
        b[j].iter_mut().for_each(|x| *x /= a[j][j]);
    }
}

/// A problem in dense form: unknowns 0..r are real, the others integers.
struct Random8 {
    reals: usize,
    integers: usize,
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
    /// Rows with real unknowns, and rows without: coefficients, constant.
    real_rows: Vec<(Vec<f64>, f64)>,
    integer_rows: Vec<(Vec<f64>, f64)>,
}

impl Random8 {
    fn new(random: &mut Random) -> Self {
        let mut up_to =
            |n: usize| ((random.next() * 0.5 + 0.5) * (n as f64 + 1.0)) as usize % (n + 1);
        let (reals, integers) = (up_to(4), 1 + up_to(7));
        let real_count = up_to(reals.min(2));
        let integer_count = up_to(2.min(integers - 1));
        let n = reals + integers;
        let m: Vec<Vec<f64>> = (0..n)
            .map(|_| (0..n).map(|_| random.next()).collect())
            .collect();
        let dot = |i: usize, j: usize| (0..n).map(|k| m[i][k] * m[j][k]).sum::<f64>();
        let entry = |i, j| dot(i, j) + if i == j { 0.3 } else { 0.0 };
        let a = (0..n)
            .map(|i| (0..n).map(|j| entry(i, j)).collect())
            .collect();
        let b = (0..n).map(|_| 4.0 * random.next()).collect();
        let small = |random: &mut Random| (3.49 * random.next()).round();
        // a point with integers keeps every row, so that there always is one
        let mut point: Vec<f64> = (0..n).map(|_| small(random)).collect();
        point[..reals].iter_mut().for_each(|x| *x = random.next());
        let constant = |row: &[f64]| -row.iter().zip(&point).map(|(a, x)| a * x).sum::<f64>();
        let real_rows = (0..real_count).map(|_| {
            let row: Vec<f64> = (0..n)
                .map(|i| {
                    if i < reals {
                        random.next()
                    } else {
                        small(random)
                    }
                })
                .collect();
            let c = constant(&row);
            (row, c)
        });
        let real_rows: Vec<_> = real_rows.collect();
        let integer_rows = (0..integer_count).map(|_| {
            let mut row: Vec<f64> = (0..n)
                .map(|i| if i < reals { 0.0 } else { small(random) })
                .collect();
            if row.iter().all(|&a| a == 0.0) {
                row[reals] = 2.0;
            }
            let c = constant(&row);
            (row, c)
        });
        let integer_rows = integer_rows.collect();
        Self {
            reals,
            integers,
            a,
            b,
            real_rows,
            integer_rows,
        }
    }

    fn problem(&self) -> Problem {
        let n = self.b.len();
        let integers: Vec<u32> = (self.reals as u32..n as u32).collect();
        let mut builder = Problem::builder(n).linear(&self.b).integers(&integers);
        for (i, row) in self.a.iter().enumerate() {
            for (j, &a) in row.iter().enumerate() {
                builder.push_quadratic(i as u32, j as u32, a);
            }
        }
        for (row, constant) in self.integer_rows.iter().chain(&self.real_rows) {
            let terms: Vec<(u32, f64)> = (0..).zip(row.iter().copied()).collect();
            builder.push_constraint(&terms, *constant);
        }
        builder.build().expect("a problem")
    }

    /// All unknowns as P z + p: the reals at their best for the integers.
    fn response(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (r, k, m) = (self.reals, self.integers, self.real_rows.len());
        let mut kkt = vec![vec![0.0; r + m]; r + m];
        let mut rhs = vec![vec![0.0; k + 1]; r + m];
        for i in 0..r {
            kkt[i][..r].copy_from_slice(&self.a[i][..r]);
            for j in 0..k {
                rhs[i][j] = -self.a[i][r + j];
            }
            rhs[i][k] = self.b[i];
        }
        for (l, (row, constant)) in self.real_rows.iter().enumerate() {
            for i in 0..r {
                kkt[r + l][i] = row[i];
                kkt[i][r + l] = row[i];
            }
            for j in 0..k {
                rhs[r + l][j] = -row[r + j];
            }
            rhs[r + l][k] = -constant;
        }
        gauss(&mut kkt, &mut rhs);
        let mut p: Vec<Vec<f64>> = rhs[..r].iter().map(|row| row[..k].to_vec()).collect();
        let mut offset: Vec<f64> = rhs[..r].iter().map(|row| row[k]).collect();
        for j in 0..k {
            let mut row = vec![0.0; k];
            row[j] = 1.0;
            p.push(row);
            offset.push(0.0);
        }
        (p, offset)
    }

    /// The least energy of all feasible points with an energy below `limit`.
    fn optimum(&self, problem: &Problem, limit: f64) -> f64 {
        let k = self.integers;
        let (p, offset) = self.response();
        // E(z) = e + gᵀz + ½ zᵀSz by values of E
        let x_of = |z: &[f64]| -> Vec<f64> {
            let dot = |row: &Vec<f64>| row.iter().zip(z).map(|(a, b)| a * b).sum::<f64>();
            p.iter().zip(&offset).map(|(row, o)| dot(row) + o).collect()
        };
        let unit = |i: usize, j: usize| -> Vec<f64> {
            (0..k)
                .map(|l| f64::from(u8::from(l == i) + u8::from(l == j)))
                .collect()
        };
        let of = |z: &[f64]| problem.energy(&x_of(z));
        let zero = of(&vec![0.0; k]);
        let once: Vec<f64> = (0..k)
            .map(|i| {
                of(&(0..k)
                    .map(|l| f64::from(u8::from(l == i)))
                    .collect::<Vec<_>>())
            })
            .collect();
        let s: Vec<Vec<f64>> = (0..k)
            .map(|i| {
                (0..k)
                    .map(|j| of(&unit(i, j)) - once[i] - once[j] + zero)
                    .collect()
            })
            .collect();
        let g: Vec<f64> = (0..k).map(|i| once[i] - zero - 0.5 * s[i][i]).collect();
        let mut center: Vec<Vec<f64>> = g.iter().map(|g| vec![-g]).collect();
        gauss(&mut s.clone(), &mut center);
        let center: Vec<f64> = center.into_iter().map(|c| c[0]).collect();
        // S = L Lᵀ
        let mut l = vec![vec![0.0; k]; k];
        for i in 0..k {
            for j in 0..=i {
                let sum: f64 = (0..j).map(|t| l[i][t] * l[j][t]).sum();
                l[i][j] = if i == j {
                    (s[i][i] - sum).sqrt()
                } else {
                    (s[i][j] - sum) / l[j][j]
                };
            }
        }
        let mut best = f64::INFINITY;
        let budget = 2.0 * (limit - of(&center));
        let mut z = vec![0.0; k];
        self.visit(&l, &center, k, budget, &mut z, &mut |z| {
            let fits = |(row, c): &(Vec<f64>, f64)| {
                let sum: f64 = row[self.reals..].iter().zip(z).map(|(a, b)| a * b).sum();
                (sum + c).abs() < 1e-6
            };
            if self.integer_rows.iter().all(fits) {
                best = best.min(of(z));
            }
        });
        best
    }

    /// Calls `found` for all integers with |Lᵀ(z − c)|² ≤ budget.
    fn visit(
        &self,
        l: &[Vec<f64>],
        c: &[f64],
        level: usize,
        budget: f64,
        z: &mut Vec<f64>,
        found: &mut dyn FnMut(&[f64]),
    ) {
        if level == 0 {
            return found(z);
        }
        let i = level - 1;
        let above: f64 = (i + 1..z.len()).map(|j| l[j][i] * (z[j] - c[j])).sum();
        let middle = c[i] - above / l[i][i];
        let reach = budget.max(0.0).sqrt() / l[i][i];
        let mut value = (middle - reach).ceil();
        while value <= middle + reach {
            z[i] = value;
            let d = l[i][i] * (value - middle);
            self.visit(l, c, i, budget - d * d, z, found);
            value += 1.0;
        }
    }
}

#[test]
fn two_thousand_random_problems_agree_with_brute_force() {
    // waking threads takes longer than any of these problems
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a pool").install(two_thousand_random_problems);
}

fn two_thousand_random_problems() {
    let mut random = Random(7);
    // above the optimum, relative to what integers cost at all
    let mut gaps = [const { Vec::new() }; 3];
    let mut changed = 0;
    for number in 0..2000 {
        let dense = Random8::new(&mut random);
        let problem = dense.problem();
        let lattice = solve(&problem, Rounding::Lattice).expect("feasible");
        let report = lattice.report();
        assert!(
            report.proven && report.violation < 1e-9,
            "{number}: {report:?}"
        );
        changed += usize::from(report.changes_of_integers > 0);
        let scale = 1.0 + report.energy.abs();
        let optimum = dense.optimum(&problem, report.energy + 1e-7 * scale);
        assert!(
            (report.energy - optimum).abs() < 1e-9 * scale,
            "{number}: {} against {optimum}",
            report.energy
        );
        let bound = report.lower_bound.expect("proven");
        assert!(
            bound <= optimum + 1e-12 * scale,
            "{number}: {bound} above {optimum}"
        );
        assert!(report.energy - bound < 1e-4 * scale, "{number}: {report:?}");
        let roundings = [Rounding::Direct, Rounding::Greedy, Rounding::TwoOpt];
        for (rounding, gaps) in roundings.into_iter().zip(&mut gaps) {
            let solver = solve(&problem, rounding).expect("feasible");
            assert!(solver.report().violation < 1e-9, "{number} {rounding:?}");
            let integral = problem
                .integers()
                .iter()
                .all(|&i| solver.solution()[i as usize].fract() == 0.0);
            assert!(integral, "{number} {rounding:?}");
            let gap = solver.report().energy - optimum;
            assert!(
                gap > -1e-9 * scale,
                "{number} {rounding:?}: better than the optimum by {gap}"
            );
            let cost = optimum - report.relaxed_energy;
            gaps.push(if gap < 1e-9 * scale { 0.0 } else { gap / cost });
        }
    }
    let mut optimal = Vec::new();
    for (name, gaps) in ["direct", "greedy", "two-opt"].iter().zip(&mut gaps) {
        gaps.sort_by(f64::total_cmp);
        let at = |part: f64| gaps[(part * gaps.len() as f64) as usize];
        let zeros = gaps.iter().filter(|&&g| g == 0.0).count();
        println!(
            "{name}: optimal {zeros} of 2000; above the optimum, of what integers cost: median {:.3}, 75 % {:.3}, 90 % {:.3}, 99 % {:.3}",
            at(0.5),
            at(0.75),
            at(0.9),
            at(0.99)
        );
        optimal.push(zeros);
    }
    let mean = |gaps: &[f64]| gaps.iter().map(|g| g.min(100.0)).sum::<f64>() / gaps.len() as f64;
    let means = [mean(&gaps[0]), mean(&gaps[1]), mean(&gaps[2])];
    println!("means, each at most 100: {means:?}; with unimodular changes: {changed}");
    assert!(means[2] <= means[1] && means[1] <= means[0], "{means:?}");
    assert!(
        optimal[2] >= optimal[1] && optimal[1] >= optimal[0],
        "{optimal:?}"
    );
    assert!(
        changed > 100,
        "rows without a coefficient ±1 have to be among them: {changed}"
    );
}
