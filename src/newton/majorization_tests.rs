//! The closed form of composite majorization against the eigensystems, and against differences of energies.

use super::curvature::{Curvature, OnCorners, Projected, Share, stride};
use super::majorization::CompositeMajorization;
use crate::energy::{Arap, Energy, SymmetricDirichlet};
use crate::geometry::RestShape;
use crate::space::{Plane, Solid, Space};
use crate::wrapd::Linear;
use crate::wrapd::block::{BLOCK, Block};
use crate::wrapd::elements::Shape;
use crate::wrapd::layout::build_blocks;
use core::marker::PhantomData;

/// Pseudo-random numbers in −1..1 (SplitMix64).
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

/// One element of this rest shape, with this F.
fn block<S: Space, E: Energy<S>>(energy: &E, inverse: &[f64], measure: f64, f: &[f64]) -> Block {
    let rest = RestShape {
        stretches: S::STRETCHES,
        vertices: (0..=S::STRETCHES as u32).collect(),
        inverse: inverse.to_vec(),
        measure: vec![measure],
    };
    let slot: Vec<u32> = (0..=S::STRETCHES as u32).collect();
    let shape = Shape::of::<S, Linear, E>(energy);
    let mut block = build_blocks(&rest, &slot, &shape).remove(0);
    for (row, f) in block.gradient.iter_mut().zip(f) {
        row[0] = *f;
    }
    block
}

fn matrix(curvature: &dyn Curvature, block: &Block, d: usize, kept: f64) -> Vec<Vec<f64>> {
    let mut entries = vec![0.0; stride(d)];
    curvature.fill(block, 1, kept, &mut entries);
    full(&entries, d)
}

/// That of a triangle without unbalanced stress, along curves.
fn turning(block: &Block, resistance: f64, negative: f64) -> Vec<Vec<f64>> {
    let mut entries = vec![0.0; stride(2)];
    let share = Share {
        resistance,
        negative,
    };
    CompositeMajorization.fill_turning(block, &[0.0; BLOCK], 1, share, &mut entries);
    full(&entries, 2)
}

/// The matrix of one element.
fn full(entries: &[f64], d: usize) -> Vec<Vec<f64>> {
    let n = d * (d + 1);
    let mut out = vec![vec![0.0; n]; n];
    let mut blocks = entries.chunks_exact(d * d);
    for u in 0..=d {
        for v in 0..=u {
            let block = blocks.next().unwrap();
            for i in 0..d {
                for j in 0..d {
                    out[u * d + i][v * d + j] = block[i * d + j];
                    out[v * d + j][u * d + i] = block[i * d + j];
                }
            }
        }
    }
    out
}

fn product(m: &[Vec<f64>], y: &[f64]) -> f64 {
    let row = |row: &Vec<f64>| row.iter().zip(y).map(|(a, b)| a * b).sum::<f64>();
    m.iter().zip(y).map(|(r, y)| y * row(r)).sum()
}

/// R(angle) diag(a, b) R(turn), by columns.
fn gradient(angle: f64, [a, b]: [f64; 2], turn: f64) -> [f64; 4] {
    let ((s, c), (p, q)) = (angle.sin_cos(), turn.sin_cos());
    [
        c * a * q + s * b * p,
        s * a * q - c * b * p,
        c * a * p - s * b * q,
        s * a * p + c * b * q,
    ]
}

const STRETCHES: [[f64; 2]; 9] = [
    [1.0, 1.0],
    [0.7, 0.7],
    [3.0, 3.0 * (1.0 - 1e-9)],
    [1.0, 1.0 - 1e-15],
    [2.0, 0.5],
    [30.0, 1e-4],
    [0.6, 0.2],
    [1e3, 900.0],
    [1.1, 0.95],
];

#[test]
fn the_closed_form_is_that_of_the_eigensystem() {
    let mut random = Random(1);
    let projected = OnCorners::<Plane, _>(Projected(SymmetricDirichlet), PhantomData);
    for stretch in STRETCHES {
        for _ in 0..20 {
            let inverse =
                [random.next(), random.next(), random.next(), random.next()].map(|x| 3.0 * x);
            let f = gradient(3.0 * random.next(), stretch, 3.0 * random.next());
            let block = block::<Plane, _>(&SymmetricDirichlet, &inverse, 0.3, &f);
            for kept in [0.0, 0.4, 1.0] {
                let a = matrix(&CompositeMajorization, &block, 2, kept);
                let b = matrix(&projected, &block, 2, kept);
                let size = b.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
                for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
                    assert!((a - b).abs() <= 1e-8 * size, "{stretch:?} {kept}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn it_is_semidefinite_and_no_less_than_the_hessian() {
    let mut random = Random(2);
    let mut negative = 0;
    for stretch in STRETCHES {
        for _ in 0..20 {
            let inverse = [random.next(), random.next(), random.next(), random.next()];
            let f = gradient(3.0 * random.next(), stretch, 3.0 * random.next());
            let block = block::<Plane, _>(&SymmetricDirichlet, &inverse, 1.0, &f);
            let convex = matrix(&CompositeMajorization, &block, 2, 0.0);
            let exact = matrix(&CompositeMajorization, &block, 2, 1.0);
            let size = convex
                .iter()
                .flatten()
                .fold(0.0, |m: f64, x| m.max(x.abs()));
            for _ in 0..30 {
                let y: [f64; 6] = core::array::from_fn(|_| random.next());
                let (c, e) = (product(&convex, &y), product(&exact, &y));
                assert!(c >= -1e-12 * size, "{stretch:?}: {c} of {size}");
                assert!(c - e >= -1e-12 * size, "{stretch:?}: {c} {e} of {size}");
                negative += usize::from(e < 0.0);
            }
        }
    }
    assert!(negative > 0, "the Hessian was never indefinite");
}

/// Second differences of the energy along a motion of the corners.
fn second_difference<S: Space, E: Energy<S>>(energy: E, b: &Block, f: &[f64], y: &[f64]) -> f64 {
    let (d, h) = (S::DIM, 1e-4);
    let moved = |t: f64| {
        let f = <S::Gradient<f64> as crate::space::Components<f64>>::from_fn(|c| {
            let (column, i) = (c / d, c % d);
            let g = |v: usize| b.inverse[column * d + v - 1][0];
            let change: f64 = (1..=d).map(|v| (y[v * d + i] - y[i]) * g(v)).sum();
            f[c] + t * change
        });
        b.measure[0][0] * energy.density(S::svd(f).0)
    };
    (moved(h) - 2.0 * moved(0.0) + moved(-h)) / (h * h)
}

#[test]
fn exact_matrices_are_second_derivatives() {
    let mut random = Random(3);
    for stretch in [[1.0, 1.0], [1.3, 0.8], [0.7, 0.6], [2.0, 0.9]] {
        for _ in 0..10 {
            let inverse = [random.next(), random.next(), random.next(), random.next()];
            let f = gradient(3.0 * random.next(), stretch, 3.0 * random.next());
            let b = block::<Plane, _>(&SymmetricDirichlet, &inverse, 0.5, &f);
            let exact = matrix(&CompositeMajorization, &b, 2, 1.0);
            let size = exact.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
            let y: [f64; 6] = core::array::from_fn(|_| random.next());
            let expected = second_difference::<Plane, _>(SymmetricDirichlet, &b, &f, &y);
            let found = product(&exact, &y);
            assert!(
                (found - expected).abs() <= 1e-4 * size,
                "{found} {expected}"
            );
        }
    }
    let of_tetrahedra = OnCorners::<Solid, _>(Projected(Arap), PhantomData);
    for _ in 0..30 {
        let inverse: [f64; 9] = core::array::from_fn(|_| random.next());
        let f: [f64; 9] =
            core::array::from_fn(|c| f64::from(u8::from(c % 4 == 0)) + 0.4 * random.next());
        let b = block::<Solid, _>(&Arap, &inverse, 0.5, &f);
        let exact = matrix(&of_tetrahedra, &b, 3, 1.0);
        let size = exact.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
        let y: [f64; 12] = core::array::from_fn(|_| random.next());
        let expected = second_difference::<Solid, _>(Arap, &b, &f, &y);
        let found = product(&exact, &y);
        assert!(
            (found - expected).abs() <= 1e-4 * size,
            "{found} {expected}"
        );
    }
}

/// F̂(t) of [`super::turns`]: F + t D, turned back from where its part without D's turn has not gone, and on.
fn turned(f: [f64; 4], change: [f64; 4], t: f64) -> [f64; 4] {
    let [a, c, b, d] = f;
    let alpha = [a + d, c - b];
    let rate = [change[0] + change[3], change[1] - change[2]];
    let square = alpha[0] * alpha[0] + alpha[1] * alpha[1];
    let omega = (alpha[0] * rate[1] - alpha[1] * rate[0]) / square;
    let (sin, cos) = (omega * t).sin_cos();
    let quarter = [-c, a, -d, b];
    let within: [f64; 4] = core::array::from_fn(|i| f[i] + t * (change[i] - omega * quarter[i]));
    let turn = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y];
    let ([a, c], [b, d]) = (turn(within[0], within[1]), turn(within[2], within[3]));
    [a, c, b, d]
}

#[test]
fn a_triangle_that_turns_freely_has_the_second_derivative_along_its_curve() {
    let mut random = Random(4);
    for stretch in [[1.0, 1.0], [1.3, 0.8], [0.7, 0.6], [2.0, 0.9], [0.5, 0.3]] {
        for _ in 0..20 {
            let inverse = [random.next(), random.next(), random.next(), random.next()];
            let f = gradient(3.0 * random.next(), stretch, 3.0 * random.next());
            let b = block::<Plane, _>(&SymmetricDirichlet, &inverse, 0.5, &f);
            let free = turning(&b, 0.0, 0.0);
            let y: [f64; 6] = core::array::from_fn(|_| random.next());
            let change: [f64; 4] = core::array::from_fn(|k| {
                let (column, i) = (k / 2, k % 2);
                let moved = |v: usize| (y[2 * v + i] - y[i]) * inverse[2 * column + v - 1];
                moved(1) + moved(2)
            });
            let at = |t: f64| -> f64 {
                let f = turned(f, change, t);
                let stretches: [f64; 2] = <Plane as Space>::svd(f).0;
                0.5 * Energy::<Plane>::density(&SymmetricDirichlet, stretches)
            };
            let h = 1e-4;
            let expected = (at(h) - 2.0 * at(0.0) + at(-h)) / (h * h);
            let found = product(&free, &y);
            let size = free.iter().flatten().fold(1.0, |m: f64, x| m.max(x.abs()));
            assert!(
                (found - expected).abs() <= 1e-4 * size,
                "{stretch:?}: {found} {expected}"
            );
        }
    }
}

#[test]
fn a_triangle_that_turns_freely_resists_no_turn_and_is_semidefinite() {
    let mut random = Random(5);
    for stretch in STRETCHES {
        let inverse = [random.next(), random.next(), random.next(), random.next()];
        let f = gradient(3.0 * random.next(), stretch, 3.0 * random.next());
        let b = block::<Plane, _>(&SymmetricDirichlet, &inverse, 1.0, &f);
        let free = turning(&b, 0.0, 0.0);
        let size = free.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        // edges from the first corner: F M, M the inverse of the inverse
        let [p, q, r, s] = inverse;
        let determinant = p * s - q * r;
        let edge = |x: f64, y: f64| {
            [
                (f[0] * x + f[2] * y) / determinant,
                (f[1] * x + f[3] * y) / determinant,
            ]
        };
        let ([ax, ay], [bx, by]) = (edge(s, -q), edge(-r, p));
        let turn = [0.0, 0.0, -ay, ax, -by, bx];
        let long: f64 = turn.iter().map(|x| x * x).sum();
        assert!(product(&free, &turn).abs() <= 1e-11 * size * long);
        for resistance in [0.0, 0.1, 0.7, 1.0] {
            let m = turning(&b, resistance, 0.0);
            let (exact, indefinite) = (turning(&b, 1.0, 1.0), turning(&b, resistance, 1.0));
            for _ in 0..30 {
                let y: [f64; 6] = core::array::from_fn(|_| random.next());
                assert!(product(&m, &y) >= -1e-12 * size);
                let mean =
                    resistance * product(&exact, &y) + (1.0 - resistance) * product(&free, &y);
                let found = product(&indefinite, &y);
                assert!((found - mean).abs() <= 1e-12 * size, "{found} {mean}");
            }
        }
    }
}
