//! Mixed-integer problems that tests share.
#![allow(dead_code)]

use foldfree::mixed_integer::{
    MixedInteger, MixedIntegerError, MixedIntegerOptions, Problem, Rounding,
};
use foldfree::optim::CancelToken;

pub const ROUNDINGS: [Rounding; 4] = [
    Rounding::Direct,
    Rounding::Greedy,
    Rounding::TwoOpt,
    Rounding::Lattice,
];

pub fn options(rounding: Rounding) -> MixedIntegerOptions {
    MixedIntegerOptions {
        rounding,
        ..MixedIntegerOptions::default()
    }
}

/// A row: its terms and its constant.
pub type Row<'a> = (&'a [(u32, f64)], f64);

/// The point nearest to `goal` (A = 1) with these rows and integers.
pub fn nearest(goal: &[f64], rows: &[Row], integers: &[u32]) -> Problem {
    let mut builder = Problem::builder(goal.len()).linear(goal).integers(integers);
    for i in 0..goal.len() as u32 {
        builder.push_quadratic(i, i, 1.0);
    }
    for (terms, constant) in rows {
        builder.push_constraint(terms, *constant);
    }
    builder.build().expect("a problem")
}

pub fn solve(problem: &Problem, rounding: Rounding) -> Result<MixedInteger, MixedIntegerError> {
    solve_with(problem, options(rounding))
}

pub fn solve_with(
    problem: &Problem,
    options: MixedIntegerOptions,
) -> Result<MixedInteger, MixedIntegerError> {
    let mut solver = MixedInteger::new(problem.clone(), options)?;
    solver.run(|_| {}, &CancelToken::default())?;
    Ok(solver)
}

/// A vector field's integral on an s×s torus: u_j − u_i should be `pull` along rows and across them, and
/// jumps by an integer (one for each piece of each seam) where the grid closes: u_left + z = u_right. Like
/// a parametrization, with a few integers of global influence.
pub fn torus(size: u32, pieces: u32) -> Problem {
    let at = |i: u32, j: u32| i * (size + 1) + j;
    let vertices = (size + 1) * (size + 1);
    let integer = |side: u32, place: u32| vertices + side * pieces + place * pieces / (size + 1);
    let n = vertices + 2 * pieces;
    let mut builder = Problem::builder(n as usize);
    let mut linear = vec![0.0; n as usize];
    let mut edge = |a: u32, b: u32, pull: f64| {
        builder.push_quadratic(a, a, 1.0);
        builder.push_quadratic(b, b, 1.0);
        builder.push_quadratic(a, b, -1.0);
        builder.push_quadratic(b, a, -1.0);
        linear[b as usize] += pull;
        linear[a as usize] -= pull;
    };
    let wave = |i: u32, j: u32| 0.21 + 0.13 * (f64::from(3 * i + 5 * j)).sin();
    for i in 0..=size {
        for j in 0..size {
            edge(at(i, j), at(i, j + 1), wave(i, j));
            edge(at(j, i), at(j + 1, i), 0.7 * wave(j, i) - 0.3);
        }
    }
    for i in vertices..n {
        builder.push_quadratic(i, i, 1e-6);
    }
    let mut builder = builder
        .linear(&linear)
        .integers(&(vertices..n).collect::<Vec<_>>());
    builder.push_constraint(&[(at(size / 2, size / 2), 1.0)], 0.0);
    for i in 0..=size {
        let z = integer(0, i);
        builder.push_constraint(&[(at(i, 0), 1.0), (at(i, size), -1.0), (z, 1.0)], 0.0);
        let z = integer(1, i);
        builder.push_constraint(&[(at(0, i), 1.0), (at(size, i), -1.0), (z, 1.0)], 0.0);
    }
    builder.build().expect("a problem")
}

/// Period jumps on a grid: θ_j − θ_i + z_ij should be `κ`, an integer on every edge that closes a cycle, a
/// few angles held: many integers of local influence, like an orientation field.
pub fn field(size: u32) -> Problem {
    let at = |i: u32, j: u32| i * size + j;
    let vertices = size * size;
    let mut edges: Vec<(u32, u32)> = Vec::new();
    for i in 0..size {
        for j in 0..size {
            if j + 1 < size {
                edges.push((at(i, j), at(i, j + 1)));
            }
            if i + 1 < size {
                edges.push((at(i, j), at(i + 1, j)));
            }
        }
    }
    // rows are a tree together with the first column: there the jumps are 0
    let is_tree = |&(a, b): &(u32, u32)| b == a + 1 || a % size == 0;
    let integers = edges.iter().filter(|e| !is_tree(e)).count() as u32;
    let n = vertices + integers;
    let mut builder = Problem::builder(n as usize);
    let mut linear = vec![0.0; n as usize];
    let mut next = vertices;
    for (k, edge) in edges.iter().enumerate() {
        let kappa = 0.8 * (1.7 * k as f64 + 0.3 * (k * k % 97) as f64).sin();
        let mut terms = vec![(edge.1, 1.0), (edge.0, -1.0)];
        if !is_tree(edge) {
            terms.push((next, 1.0));
            next += 1;
        }
        for &(i, a) in &terms {
            linear[i as usize] += a * kappa;
            for &(j, b) in &terms {
                builder.push_quadratic(i, j, a * b);
            }
        }
    }
    let mut builder = builder
        .linear(&linear)
        .integers(&(vertices..n).collect::<Vec<_>>());
    builder.push_constraint(&[(0, 1.0)], 0.0);
    builder.push_constraint(&[(vertices - 1, 1.0)], -0.25);
    builder.build().expect("a problem")
}

/// A problem of the folder of shared problems, where it is there.
pub fn shared(name: &str) -> Option<Problem> {
    use std::io::Read;
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/data/miqp/");
    let bytes = std::fs::read(format!("{folder}{name}.sys.gz"))
        .or_else(|_| std::fs::read(format!("{folder}{name}.sys")))
        .ok()?;
    let mut text = Vec::new();
    match bytes.starts_with(&[0x1f, 0x8b]) {
        true => flate2::read::GzDecoder::new(bytes.as_slice())
            .read_to_end(&mut text)
            .map(|_| ())
            .expect("gzip"),
        false => text = bytes,
    }
    Some(Problem::from_sys(&text).expect("a problem"))
}
