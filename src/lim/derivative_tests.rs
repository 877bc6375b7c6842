//! First and second derivatives against central differences.

use super::barrier::Barrier;
use super::curvature::{frozen, projected};
use super::density::{density, stress};
use super::elements::Law;
use super::inversion::{add_barrier, determinant};
use super::{LimEnergy, LimHessian};
use crate::energy::hessian::Square;
use crate::space::{Components, Plane, Solid, Space};

const STEP: f64 = 1e-5;

const LAW: Law = Law {
    energy: LimEnergy::Arap,
    hessian: LimHessian::Projected,
    beta: 0.3,
};

/// Orientation-preserving matrices, some of them strongly compressed.
fn samples<S: Space>() -> Vec<S::Gradient<f64>> {
    let k = S::STRETCHES;
    let mut state = 7u64;
    let mut next = move || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    let mut all = Vec::new();
    while all.len() < 60 {
        let f = S::Gradient::from_fn(|c| f64::from(u8::from(c / k == c % k)) + 1.4 * next());
        if determinant::<S>(f).0 > 0.03 {
            all.push(f);
        }
    }
    all
}

fn moved<S: Space>(f: S::Gradient<f64>, at: usize, by: f64) -> S::Gradient<f64> {
    S::Gradient::from_fn(|c| f.at(c) + if c == at { by } else { 0.0 })
}

fn value<S: Space>(law: Law, barrier: &Barrier, f: S::Gradient<f64>) -> f64 {
    0.7 * density::<S>(law.energy, f) + law.beta * barrier.at(determinant::<S>(f).0).value
}

fn gradient<S: Space>(law: Law, barrier: &Barrier, f: S::Gradient<f64>) -> S::Gradient<f64> {
    let (j, cofactors) = determinant::<S>(f);
    let slope = law.beta * barrier.at(j).slope;
    let (_, p) = stress::<S>(law.energy, f, S::svd(f));
    S::Gradient::from_fn(|c| 0.7 * p.at(c) + slope * cofactors.at(c))
}

/// Differences of the gradient.
fn differences<S: Space>(law: Law, barrier: &Barrier, f: S::Gradient<f64>) -> Square {
    let n = S::STRETCHES * S::STRETCHES;
    let mut out = [[0.0; 9]; 9];
    for a in 0..n {
        let at = |by: f64| gradient::<S>(law, barrier, moved::<S>(f, a, by));
        let (plus, minus) = (at(STEP), at(-STEP));
        for b in 0..n {
            out[b][a] = (plus.at(b) - minus.at(b)) / (2.0 * STEP);
        }
    }
    out
}

fn apart(a: &Square, b: &Square) -> f64 {
    let size = b
        .as_flattened()
        .iter()
        .fold(1.0, |m: f64, x| m.max(x.abs()));
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0, |m: f64, (a, b)| m.max((a - b).abs())) / size
}

fn check<S: Space>() {
    let barrier = Barrier::new(1e-3, 1.0);
    for energy in LimEnergy::ALL {
        let law = Law { energy, ..LAW };
        for f in samples::<S>() {
            let shown = f.as_slice();
            let g = gradient::<S>(law, &barrier, f);
            for a in 0..S::STRETCHES * S::STRETCHES {
                let at = |by: f64| value::<S>(law, &barrier, moved::<S>(f, a, by));
                let difference = (at(STEP) - at(-STEP)) / (2.0 * STEP);
                let size = 1.0 + g.as_slice().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                assert!(
                    (difference - g.at(a)).abs() < 1e-6 * size,
                    "{energy:?} {shown:?}"
                );
            }
            let expected = differences::<S>(law, &barrier, f);
            // all that is negative kept: the second derivatives themselves
            let exact = projected::<S>(law, 0.7, &barrier, f, 1.0);
            assert!(apart(&exact, &expected) < 1e-5, "{energy:?} {shown:?}");
            let turns = match energy {
                LimEnergy::Arap => true,
                LimEnergy::Lscm => S::STRETCHES == 3,
                _ => false,
            };
            let mut rigid = frozen::<S>(energy, f).map(|row| row.map(|h| 0.7 * h));
            add_barrier::<S>(&barrier, law.beta, f, &mut rigid);
            if !turns {
                assert!(apart(&rigid, &expected) < 1e-5, "{energy:?} {shown:?}");
            }
            // stiffer, and positive semidefinite, along any direction
            let convex = projected::<S>(law, 0.7, &barrier, f, 0.0);
            for d in samples::<S>().iter().take(10) {
                let along = |h: &Square| -> f64 {
                    let d = d.as_slice();
                    (0..d.len())
                        .map(|a| (0..d.len()).map(|b| d[a] * h[a][b] * d[b]).sum::<f64>())
                        .sum()
                };
                let scale = 1e-9 * along(&convex).abs().max(1.0);
                assert!(along(&convex) > -scale, "{energy:?} {shown:?}");
                assert!(
                    along(&convex) > along(&exact) - scale,
                    "{energy:?} {shown:?}"
                );
                assert!(
                    along(&rigid) > along(&exact) - scale,
                    "{energy:?} {shown:?}"
                );
            }
        }
    }
}

#[test]
fn derivatives_in_the_plane() {
    check::<Plane>();
}

#[test]
fn derivatives_in_space() {
    check::<Solid>();
}

#[test]
fn the_barrier_is_that_of_the_paper() {
    let (wall, reach) = (0.01, 0.6);
    let barrier = Barrier::new(wall, reach);
    // (4) with s = Γ (m − ε), m = 1
    let s = reach * (1.0 - wall);
    for j in [0.0101, 0.02, 0.1, 0.3, 0.5, 0.6] {
        let x: f64 = j - wall;
        let g = x.powi(3) / s.powi(3) - 3.0 * x.powi(2) / s.powi(2) + 3.0 * x / s;
        let expected = if x < s { g.recip() - 1.0 } else { 0.0 };
        let found = barrier.at(j).value;
        assert!((found - expected).abs() < 1e-9 * (1.0 + expected), "{j}");
    }
    assert_eq!(barrier.at(wall).value, f64::INFINITY);
    assert_eq!(barrier.at(f64::NAN).value, f64::INFINITY);
    assert_eq!(barrier.at(1.0).value, 0.0);
}
