//! Every derivative the solvers use, against dual numbers (exact to rounding) and against central
//! differences.

mod dual;
mod plane_oracle;
mod random;

use dual::{Dual, dual};
use foldfree::embedding::tutte;
use foldfree::energy::total::{deformation_gradient, spread, total};
use foldfree::energy::{Arap, Energy, NeoHookean, SymmetricDirichlet};
use foldfree::geometry::{RestShape, surface_area};
use foldfree::mesh::{Shape, generate, prepare};
use foldfree::space::{Lane, Plane, Solid, Space};
use plane_oracle::{Matrix, full, matrix, stretch_residual};
use random::Random;

/// Gradient and K_e of neo-Hookean elasticity, on either side of J = 0.1 and reflected.
#[test]
fn neo_hookean_in_the_singular_values() {
    let energy = NeoHookean::new(2.0, 0.4).unwrap();
    for s in [
        [1.3, 0.9, 0.7],
        [2.0, 1.0, 0.04],
        [1.1, 0.8, -0.3],
        [3.0, 2.0, 1.5],
    ] {
        let gradient = Energy::<Solid>::gradient(&energy, s);
        let mut hessian = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                let value = Energy::<Solid>::density(&energy, dual(s, i, j)).0;
                hessian[i][j] = value.eps1eps2;
                if j == i {
                    close(gradient[i], value.eps1, value.eps1.abs().max(1.0), 1e-13);
                }
            }
        }
        let [a, b, c] = hessian;
        let (values, _) = Solid::eigen::<f64>([a[0], b[1], c[2], a[1], a[2], b[2]]);
        let stiffness = Energy::<Solid>::effective_stiffness(&energy, s);
        close(stiffness, values[0], values[0].abs().max(1.0), 1e-12);
    }
}

/// Singular values over the orders of magnitude a run goes through, the smaller last.
fn stretches() -> Vec<[f64; 2]> {
    let mut random = Random(1);
    (0..500)
        .map(|_| {
            let mut s = random.many::<2>().map(|e| 10f64.powf(4.0 * e));
            s.sort_by(|a, b| b.total_cmp(a));
            s
        })
        .collect()
}

/// |a − b| relative to `scale`.
#[track_caller]
fn close(a: f64, b: f64, scale: f64, tolerance: f64) {
    assert!(
        (a - b).abs() <= tolerance * scale,
        "{a} and {b} differ by {:e} of {scale}",
        (a - b).abs() / scale
    );
}

/// ψ' and K_e (20) are the first derivative and the largest eigenvalue of the second one.
fn check_energy<E: Energy<Plane>>(energy: E) {
    for sigma in stretches() {
        let second = |i, j| energy.density::<Dual>(dual(sigma, i, j)).0;
        let gradient = energy.gradient(sigma);
        for i in 0..2 {
            let exact = second(i, i).eps1;
            // the two terms of ψ' cancel at σ = 1: errors are relative to the larger one
            let scale = 2.0 * sigma[i] + 2.0 * sigma[i].powi(-3);
            close(gradient[i], exact, scale, 1e-15 * 8.0);
            // central difference; its own error: third derivative h²/6, rounding ε ψ/h
            let h = 1e-5 * sigma[i];
            let at = |d: f64| {
                let mut s = sigma;
                s[i] += d;
                // the other axis would only add rounding
                s[1 - i] = 1.0;
                energy.density(s)
            };
            close(gradient[i], (at(h) - at(-h)) / (2.0 * h), scale, 1e-8);
        }
        let [a, b, d] = [(0, 0), (0, 1), (1, 1)].map(|(i, j)| second(i, j).eps1eps2);
        let largest = 0.5 * (a + d) + (0.25 * (a - d) * (a - d) + b * b).sqrt();
        close(energy.effective_stiffness(sigma), largest, largest, 1e-14);
    }
    close(
        energy.effective_stiffness([1.0, 1.0]),
        energy.constants().rest_stiffness,
        1.0,
        0.0,
    );
    close(
        energy.density([1.0, 1.0]),
        energy.constants().isometry,
        1.0,
        0.0,
    );
    assert_eq!(energy.gradient([1.0, 1.0]), [0.0, 0.0]);
}

#[test]
fn symmetric_dirichlet_in_the_singular_values() {
    check_energy(SymmetricDirichlet);
}

#[test]
fn arap_in_the_singular_values() {
    check_energy(Arap);
}

/// ½‖sym(F) − P‖²_F, F by columns, P in the space's own coordinates.
fn distance<L: Lane>(f: [L; 4], p: [L; 3]) -> L {
    let (s, _) = Plane::polar(f);
    let difference = [s[0] - p[0], s[1] - p[1], s[2] - p[2]];
    Plane::symmetric_norm_squared(difference) * s[0].lift(0.5)
}

/// F = rotation · diag(σ₁, σ₂) · rotation, by columns.
fn with_stretches(sigma: [f64; 2], left: f64, right: f64) -> [f64; 4] {
    let rotation = |angle: f64| {
        let (s, c) = angle.sin_cos();
        Matrix::new(c, -s, s, c)
    };
    let m = rotation(left) * Matrix::new(sigma[0], 0.0, 0.0, sigma[1]) * rotation(right);
    [m[(0, 0)], m[(1, 0)], m[(0, 1)], m[(1, 1)]]
}

fn residual(f: [f64; 4], p: [f64; 3]) -> [f64; 4] {
    let (_, polar) = Plane::polar(f);
    Plane::stretch_residual(f, polar, p)
}

#[test]
fn the_forces_of_the_global_step() {
    let mut random = Random(2);
    let mut reflected = 0;
    for _ in 0..2000 {
        let f = random.many::<4>();
        let p = random.many::<3>();
        let m = residual(f, p);
        // |α| is what (15) divides by; rounding is amplified by its reciprocal
        let alpha = 0.5 * ((f[0] + f[3]).hypot(f[1] - f[2]));
        reflected += usize::from(f[0] * f[3] < f[1] * f[2]);
        let scale = 1.0 + alpha.recip();
        // (13)–(16) written out with another library's SVD
        let paper = stretch_residual(&matrix(f), &full(p));
        for k in 0..4 {
            let exact = distance(dual(f, k, k), p.map(|p| Dual(p.into()))).0.eps1;
            close(m[k], exact, scale, 2e-14);
            close(m[k], paper[(k % 2, k / 2)], scale, 1e-13);
            let h = 1e-4 * alpha;
            let at = |d: f64| {
                let mut f = f;
                f[k] += d;
                distance(f, p)
            };
            // third derivatives are of the order |α|⁻²
            let error = 1e-7 * (1.0 + alpha.recip()) + 1e-15 / h;
            close(m[k], (at(h) - at(-h)) / (2.0 * h), 1.0, error);
        }
    }
    assert!((800..1200).contains(&reflected));
}

#[test]
fn the_forces_where_the_rotation_is_not_defined() {
    // σ₁ = −σ₂: a reflection, in exact and in rounded numbers, and F = 0
    let p = [0.7, -0.2, 0.4];
    let exactly = [[1.0, 0.0, 0.0, -1.0], [0.0, 1.0, 1.0, 0.0], [0.0; 4]];
    for f in exactly {
        let m = residual(f, p);
        assert!(m.iter().all(|m| m.abs() < 10.0), "{f:?}: {m:?}");
    }
    for i in 0..100 {
        let f = with_stretches([1.0, -1.0], 0.1 * i as f64, 1.0);
        assert!(residual(f, p).iter().all(|m| m.is_finite()), "{f:?}");
    }
    // at P = sym(F) there is no force, however reflected: the quotient is 0/0 there
    for i in 0..100 {
        let f = with_stretches([1.0, -1.0 + 1e-13], 0.1 * i as f64, 1.0);
        let (s, _) = Plane::polar(f);
        let m = residual(f, s);
        assert!(m.iter().all(|m| m.abs() < 1e-12), "{f:?}: {m:?}");
    }
}

#[test]
fn no_force_where_the_stretch_is_as_wished_and_none_from_rotations() {
    for (i, sigma) in stretches().into_iter().enumerate() {
        for sign in [1.0, -1.0] {
            let sigma = [sigma[0], sign * sigma[1]];
            let f = with_stretches(sigma, i as f64, 0.3);
            let (s, _) = Plane::polar(f);
            let largest = residual(f, s).iter().fold(0.0, |a: f64, m| a.max(m.abs()));
            let limit = 1e-14 * sigma[0] * (1.0 + sigma[0] / (sigma[0] + sigma[1]).abs());
            assert!(largest <= limit, "{sigma:?}: {largest:e}");
        }
    }
}

/// The gradient of a whole map, coordinate by coordinate.
fn check_total<E: Energy<Plane>>(energy: E, rest: &RestShape, x: &[f64], tolerance: f64) {
    let gradient = total::<Plane, E>(energy, rest, x).gradient;
    let largest = gradient.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
    assert!(largest > 1e-3);
    for i in 0..x.len() {
        let h = 1e-6;
        let at = |d: f64| {
            let mut x = x.to_vec();
            x[i] += d;
            total::<Plane, E>(energy, rest, &x).energy
        };
        close(
            gradient[i],
            (at(h) - at(-h)) / (2.0 * h),
            largest,
            tolerance,
        );
    }
}

/// A cap of about sixty triangles, scaled to unit area.
fn small_cap() -> (RestShape, Vec<f64>) {
    let prepared = prepare(&generate(Shape::BumpyCap, 60)).unwrap();
    let mesh = &prepared.mesh;
    let rest = RestShape::of_surface(mesh, surface_area(mesh).sqrt().recip()).unwrap();
    let map = tutte(mesh, &rest, &prepared.topology.boundary_loops()[0]).unwrap();
    let x = map.iter().flat_map(|p| [p.x, p.y]).collect();
    (rest, x)
}

#[test]
fn the_gradient_of_a_map() {
    let (rest, x) = small_cap();
    check_total(SymmetricDirichlet, &rest, &x, 1e-7);
    check_total(Arap, &rest, &x, 1e-7);
    // ARAP has a value for folded maps too
    let mut random = Random(3);
    let folded: Vec<f64> = x.iter().map(|_| random.next()).collect();
    assert!(total::<Plane, _>(Arap, &rest, &folded).inverted > 10);
    check_total(Arap, &rest, &folded, 1e-6);
    let report = total::<Plane, _>(SymmetricDirichlet, &rest, &folded);
    assert_eq!(report.energy, f64::INFINITY);
}

#[test]
fn spreading_forces_is_the_transpose_of_the_deformation_gradient() {
    let (rest, x) = small_cap();
    let mut random = Random(4);
    for e in 0..rest.len() {
        let m = random.many::<4>();
        let f = deformation_gradient::<Plane>(&rest, &x, e);
        let mut forces = vec![0.0; x.len()];
        spread::<Plane>(&rest, e, m, 1.0, &mut forces);
        let left: f64 = f.iter().zip(m).map(|(f, m)| f * m).sum();
        let right: f64 = forces.iter().zip(&x).map(|(g, x)| g * x).sum();
        let size: f64 = forces.iter().zip(&x).map(|(g, x)| (g * x).abs()).sum();
        close(left, right, size, 1e-14);
        // and translations do not count
        for i in 0..2 {
            let sum: f64 = forces.iter().skip(i).step_by(2).sum();
            let size: f64 = forces.iter().skip(i).step_by(2).map(|g| g.abs()).sum();
            close(sum, 0.0, size, 1e-15);
        }
    }
}
