//! A decomposition of `Solid` that begins elsewhere is the same decomposition: wherever it begins, from that
//! of a neighbour, of something else altogether, or of nothing that is a rotation.

mod random;

use foldfree::space::{Solid, Space};
use random::Random;

type Columns = [[f64; 3]; 3];

fn columns(f: [f64; 9]) -> Columns {
    [0, 3, 6].map(|c| [f[c], f[c + 1], f[c + 2]])
}

fn largest(f: &[f64]) -> f64 {
    f.iter().fold(0.0, |a, x| a.max(x.abs()))
}

/// max |AᵀA − I|.
fn not_orthonormal(a: Columns) -> f64 {
    let mut most: f64 = 0.0;
    for i in 0..3 {
        for j in 0..3 {
            let dot: f64 = (0..3).map(|r| a[i][r] * a[j][r]).sum();
            most = most.max((dot - f64::from(u8::from(i == j))).abs());
        }
    }
    most
}

fn determinant([a, b, c]: Columns) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// A rotation by up to `angle` about anything.
fn rotation(random: &mut Random, angle: f64) -> [f64; 9] {
    let axis = glam::DVec3::from_array(random.many()).normalize_or(glam::DVec3::X);
    glam::DMat3::from_axis_angle(axis, angle * random.next()).to_cols_array()
}

/// Matrices (by columns) of every kind, of size about 1.
fn matrices(random: &mut Random) -> Vec<[f64; 9]> {
    let mut out = Vec::new();
    for round in 0..60 {
        let a: [f64; 9] = random.many();
        out.push(a);
        // near a rotation
        let r = rotation(random, 3.0);
        out.push(std::array::from_fn(|i| r[i] + 1e-3 * a[i]));
        out.push(r);
        // with given stretches: reflected, equal, of ranks two and one, nearly so
        let stretches = [
            [1.0, 0.5, -0.2],
            [1.0, 1.0, -1.0],
            [1.0, 0.7, 0.7],
            [1.0, 0.3, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1e-9, 1e-12],
            [1.0, 1e-3, -1e-3],
        ][round % 7];
        let (u, v) = (rotation(random, 3.0), rotation(random, 3.0));
        out.push(std::array::from_fn(|i| {
            let (column, row) = (i / 3, i % 3);
            (0..3)
                .map(|k| u[3 * k + row] * stretches[k] * v[3 * k + column])
                .sum()
        }));
    }
    out.push([0.0; 9]);
    out.push([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
    out
}

/// Where a decomposition of F may be asked to begin.
fn guesses(random: &mut Random, f: [f64; 9]) -> Vec<(&'static str, [f64; 9])> {
    let near = std::array::from_fn(|i| f[i] * (1.0 + 1e-3 * random.next()));
    let stale: [f64; 9] = random.many();
    let of = |f| Solid::guess(Solid::polar_near(f, Solid::no_guess()).1);
    vec![
        ("its own", of(f)),
        ("of a neighbour", of(near)),
        ("of another", of(stale)),
        ("any rotation", rotation(random, 3.0)),
        (
            "another order",
            [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0],
        ),
    ]
}

/// F scaled by `size`, decomposed from a guess: a decomposition to rounding, sorted, both factors proper
/// rotations, the reflection on the last σ, the σ those of a cold start. Returns the next guess.
#[track_caller]
fn check(f: [f64; 9], size: f64, guess: [f64; 9], what: &str) -> [f64; 9] {
    let f = f.map(|x| x * size);
    let (cold, ..) = Solid::svd(f);
    let (stretch, polar) = Solid::polar_near(f, guess);
    let (sigma, (u, v)) = Solid::svd_of_polar(f, polar);
    let scale = largest(&f).max(f64::MIN_POSITIVE);
    let what = format!("{what}: {f:?} from {guess:?}: {sigma:?} {u:?} {v:?}");
    let back = Solid::from_svd(sigma, (u, v));
    let symmetric = Solid::from_eigen(sigma, v);
    for (a, b) in back.iter().zip(&f) {
        assert!((a - b).abs() <= 1e-14 * scale, "{what}");
    }
    for (a, b) in stretch.iter().zip(&symmetric) {
        assert!((a - b).abs() <= 1e-14 * scale, "{what}");
    }
    assert!(
        not_orthonormal(u) <= 1e-14 && not_orthonormal(v) <= 1e-14,
        "{what}"
    );
    assert!(determinant(u) > 0.0 && determinant(v) > 0.0, "{what}");
    // equal ones may be in any order of their last bits
    let slack = 1e-15 * scale;
    assert!(
        sigma[0] + slack >= sigma[1] && sigma[1] + slack >= sigma[2].abs(),
        "{what}"
    );
    assert!(sigma[1] >= 0.0, "{what}");
    for (warm, cold) in sigma.iter().zip(&cold) {
        // of a σ that is 0 the sign is rounding's, too
        assert!((warm - cold).abs() <= 4e-15 * scale, "{what}: {cold:e}");
    }
    Solid::guess(polar)
}

const SIZES: [f64; 5] = [1.0, 1e-3, 1e-150, 1e150, 1e300];

#[test]
fn singular_values_from_anywhere() {
    let mut random = Random(1);
    for f in matrices(&mut random) {
        for (name, guess) in guesses(&mut random, f) {
            for size in SIZES {
                check(f, size, guess, name);
            }
        }
    }
}

/// The guess is handed on from one decomposition to the next, thousands of times: its columns stay
/// orthonormal, also where they were not quite.
#[test]
fn a_chain_of_decompositions_does_not_drift() {
    let mut random = Random(2);
    let mut f: [f64; 9] = random.many();
    let mut guess = rotation(&mut random, 3.0).map(|x| x * (1.0 + 1e-9));
    for round in 0..5000 {
        let jump = if round % 500 == 499 { 1.0 } else { 1e-2 };
        f = std::array::from_fn(|i| f[i] + jump * random.next() - 1e-3 * f[i]);
        guess = check(f, 1.0, guess, "chain");
        assert!(not_orthonormal(columns(guess)) <= 1e-14, "{round}");
    }
}

/// Eigenvalues of a symmetric matrix (xx, yy, zz, xy, xz, yz) from the frame of any F.
#[test]
fn eigenvalues_from_anywhere() {
    let mut random = Random(3);
    for f in matrices(&mut random) {
        let [a, b, c] = columns(f);
        // also one that shares its eigenvectors with F, as P does near convergence
        let (_, polar) = Solid::polar(f);
        let (sigma, (_, v)) = Solid::svd_of_polar(f, polar);
        let own = Solid::from_eigen(sigma.map(|s| s + 0.1 * random.next()), v);
        for s in [
            [a[0], b[1], c[2], a[1], a[2], b[2]],
            [a[0], a[0], a[0], 0.0, 0.0, 0.0],
            [a[0], a[0], b[1], 1e-9 * a[1], 0.0, 0.0],
            own,
        ] {
            for (name, guess) in guesses(&mut random, f) {
                // the frame of an F whose V is the guess
                let from = Solid::from_svd([3.0, 2.0, 1.0], (columns(guess), columns(guess)));
                let (_, frame) = Solid::polar_near(from, guess);
                for size in [1.0, 1e-120, 1e120] {
                    let s = s.map(|x| x * size);
                    let scale = largest(&s).max(f64::MIN_POSITIVE);
                    let (cold, _) = Solid::eigen(s);
                    let (values, v) = Solid::eigen_near(s, frame);
                    let what = format!("{name}: {s:?}: {values:?} {v:?}");
                    let back = Solid::from_eigen(values, v);
                    for (a, b) in back.iter().zip(&s) {
                        assert!((a - b).abs() <= 2e-14 * scale, "{what}");
                    }
                    assert!(not_orthonormal(v) <= 1e-14, "{what}");
                    assert!(determinant(v) > 0.0, "{what}");
                    assert!(values[0] >= values[1] && values[1] >= values[2], "{what}");
                    for (warm, cold) in values.iter().zip(&cold) {
                        assert!((warm - cold).abs() <= 1e-14 * scale, "{what}: {cold:e}");
                    }
                }
            }
        }
    }
}
