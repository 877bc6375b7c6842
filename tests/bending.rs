//! Quadratic bending: nothing where flat, the energy of a plate where bent, and neither orientation nor
//! numbering matters.

use foldfree::geometry::{RestShape, quadratic_bending, vertex_measures};
use foldfree::mesh::{MeshError, Shape, SurfaceMesh, generate};
use glam::{DMat3, DVec3};

/// A sheet of about unit area, of equilateral triangles, n a side.
fn lattice(n: usize) -> SurfaceMesh {
    let size = 1.0 / n as f64;
    sheet(n, |i, j| {
        let shift = 0.5 * (j % 2) as f64;
        let height = 0.75f64.sqrt();
        size * DVec3::new(i as f64 + shift, height * j as f64, 0.0)
    })
}

/// A unit square of squares, each divided in two.
fn squares(n: usize) -> SurfaceMesh {
    let size = 1.0 / n as f64;
    sheet(n, |i, j| size * DVec3::new(i as f64, j as f64, 0.0))
}

/// n × n quads whose diagonals alternate from row to row.
fn sheet(n: usize, place: impl Fn(usize, usize) -> DVec3) -> SurfaceMesh {
    let mut mesh = SurfaceMesh::default();
    for j in 0..=n {
        mesh.positions.extend((0..=n).map(|i| place(i, j)));
    }
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    for j in 0..n {
        for i in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.simplices.extend(match j % 2 {
                0 => [[a, b, d], [b, c, d]],
                _ => [[a, b, c], [a, c, d]],
            });
        }
    }
    mesh
}

/// ½ tr(XᵀBX), and BX.
fn energy(list: &[(u32, u32, f64)], x: &[DVec3]) -> (f64, Vec<DVec3>) {
    let mut force = vec![DVec3::ZERO; x.len()];
    for &(a, b, value) in list {
        force[a as usize] += value * x[b as usize];
        if a != b {
            force[b as usize] += value * x[a as usize];
        }
    }
    let twice: f64 = force.iter().zip(x).map(|(f, x)| f.dot(*x)).sum();
    (0.5 * twice, force)
}

fn bending(mesh: &SurfaceMesh, stiffness: f64) -> Vec<(u32, u32, f64)> {
    let rest = RestShape::of_surface(mesh, 1.0).unwrap();
    quadratic_bending(&rest, mesh.positions.len(), stiffness).unwrap()
}

/// Rolled up on a cylinder whose axis makes an angle with y.
fn rolled(mesh: &SurfaceMesh, angle: f64, radius: f64) -> Vec<DVec3> {
    let turn = DMat3::from_rotation_z(angle);
    let roll = |&p: &DVec3| {
        let p = turn * p;
        let (s, c) = (p.x / radius).sin_cos();
        DVec3::new(radius * s, p.y, radius * (1.0 - c))
    };
    mesh.positions.iter().map(roll).collect()
}

#[test]
fn flat_sheets_have_no_energy_and_no_force() {
    for mesh in [lattice(12), squares(9)] {
        let list = bending(&mesh, 1.0);
        let largest = list.iter().fold(0.0f64, |a, t| a.max(t.2.abs()));
        let shear = DMat3::from_cols(
            DVec3::new(1.2, 0.3, 0.1),
            DVec3::new(-0.4, 0.9, 2.0),
            DVec3::Z,
        );
        for map in [DMat3::IDENTITY, DMat3::from_rotation_x(1.0), shear] {
            let x: Vec<DVec3> = mesh.positions.iter().map(|&p| map * p + 3.0).collect();
            let (value, force) = energy(&list, &x);
            let rounding = 100.0 * f64::EPSILON * largest;
            assert!(value.abs() < x.len() as f64 * rounding, "{value:e}");
            for f in force {
                assert!(f.length() < rounding, "{f} of {largest}");
            }
        }
    }
}

#[test]
fn a_cylinder_has_the_energy_of_a_plate() {
    let (stiffness, radius) = (0.7, 0.8);
    for angle in [0.0, 0.3, 0.5, 1.0, 1.5] {
        let errors = [16, 32, 64].map(|n| {
            let mesh = lattice(n);
            let area: f64 = RestShape::of_surface(&mesh, 1.0)
                .unwrap()
                .measure
                .iter()
                .sum();
            let plate = 0.5 * stiffness * area / (radius * radius);
            let (value, _) = energy(&bending(&mesh, stiffness), &rolled(&mesh, angle, radius));
            (value / plate - 1.0).abs()
        });
        // what is missing are the hinges that the boundary has not got
        assert!(errors[2] < 0.03, "{angle}: {errors:?}");
        assert!(
            errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1],
            "{errors:?}"
        );
    }
    // squares are right along their sides
    let mesh = squares(64);
    for angle in [0.0, std::f64::consts::FRAC_PI_2] {
        let (value, _) = energy(&bending(&mesh, 2.0), &rolled(&mesh, angle, 1.0));
        assert!((value - 1.0).abs() < 0.03, "{angle}: {value}");
    }
}

#[test]
fn the_force_is_the_gradient_and_the_matrix_is_not_negative() {
    let mesh = lattice(6);
    let list = bending(&mesh, 1.0);
    let x = rolled(&mesh, 0.4, 0.3);
    let (value, force) = energy(&list, &x);
    assert!(value > 0.0);
    for v in [0, 8, 20] {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let at = |by: f64| {
                let mut moved = x.clone();
                moved[v] += by * axis;
                energy(&list, &moved).0
            };
            let slope = (at(1e-4) - at(-1e-4)) / 2e-4;
            assert!((slope - force[v].dot(axis)).abs() < 1e-7 * (1.0 + slope.abs()));
        }
    }
    // any positions: a sum of squares
    let crumpled: Vec<DVec3> = (0..x.len())
        .map(|i| {
            DVec3::new(
                (7.0 * i as f64).sin(),
                (11.0 * i as f64).cos(),
                0.1 * i as f64,
            )
        })
        .collect();
    assert!(energy(&list, &crumpled).0 > 0.0);
}

#[test]
fn orientation_and_numbering_do_not_matter() {
    let mesh = generate(Shape::BumpyCap, 400);
    let (value, _) = energy(&bending(&mesh, 1.0), &mesh.positions);
    let mut other = mesh.clone();
    for (t, simplex) in other.simplices.iter_mut().enumerate() {
        simplex.rotate_left(t % 3);
        if t % 2 == 0 {
            simplex.swap(0, 1);
        }
    }
    other.simplices.reverse();
    let (same, _) = energy(&bending(&other, 1.0), &mesh.positions);
    assert!((value / same - 1.0).abs() < 1e-12, "{value} {same}");
}

#[test]
fn an_edge_of_three_triangles_is_named() {
    let mesh = SurfaceMesh {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Y],
        simplices: vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    };
    let rest = RestShape::of_surface(&mesh, 1.0).unwrap();
    let error = quadratic_bending(&rest, 5, 1.0).unwrap_err();
    assert!(
        matches!(
            error,
            MeshError::NonManifoldEdge {
                vertices: [0, 1],
                faces: 3
            }
        ),
        "{error}"
    );
}

#[test]
fn vertices_share_the_area() {
    let mesh = squares(3);
    let rest = RestShape::of_surface(&mesh, 1.0).unwrap();
    let shares = vertex_measures(&rest, mesh.positions.len() + 1);
    assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    assert_eq!(shares.last(), Some(&0.0));
    // an inner vertex of six triangles
    assert!((shares[5] - 1.0 / 9.0).abs() < 1e-15, "{shares:?}");
}
