//! What a flattening may not depend on: the unit of length, where the surface lies in space, and the
//! order of vertices and faces.
//!
//! All of these change the last bits of every number, and an iteration passes on what it is given:
//! energies agree to 1e-11 (measured: 1e-13), above rounding and far below what any real dependence would
//! show. Counts of inner iterations and reweighting are decisions
//! and must be the same.

mod flattening;

use flattening::{Run, endless};
use foldfree::mesh::{Shape, SurfaceMesh, generate};
use foldfree::parameterization::Method;
use glam::{DQuat, DVec3};

/// A small generator of pseudo-random numbers (SplitMix64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
    fn permutation(&mut self, n: usize) -> Vec<usize> {
        let mut list: Vec<usize> = (0..n).collect();
        for i in (1..n).rev() {
            list.swap(i, self.below(i + 1));
        }
        list
    }
}

fn scaled(mesh: &SurfaceMesh, factor: f64) -> SurfaceMesh {
    let mut mesh = mesh.clone();
    mesh.positions.iter_mut().for_each(|p| *p *= factor);
    mesh
}

fn moved(mesh: &SurfaceMesh) -> SurfaceMesh {
    let turn = DQuat::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 2.2);
    let mut mesh = mesh.clone();
    for p in &mut mesh.positions {
        *p = turn * *p + DVec3::new(3.0, -1.0, 7.0);
    }
    mesh
}

fn vertices_shuffled(mesh: &SurfaceMesh) -> SurfaceMesh {
    let order = Random(1).permutation(mesh.positions.len());
    let mut place = vec![0u32; order.len()];
    order
        .iter()
        .enumerate()
        .for_each(|(new, &old)| place[old] = new as u32);
    SurfaceMesh {
        positions: order.iter().map(|&v| mesh.positions[v]).collect(),
        simplices: mesh
            .simplices
            .iter()
            .map(|t| t.map(|v| place[v as usize]))
            .collect(),
    }
}

fn faces_shuffled(mesh: &SurfaceMesh) -> SurfaceMesh {
    let mut random = Random(2);
    let order = random.permutation(mesh.simplices.len());
    SurfaceMesh {
        positions: mesh.positions.clone(),
        simplices: order
            .iter()
            .map(|&t| {
                let mut t = mesh.simplices[t];
                t.rotate_left(random.below(3));
                t
            })
            .collect(),
    }
}

/// Runs both and compares them iteration by iteration, then what is certified of the last.
fn compare(name: &str, method: Method, mesh: &SurfaceMesh, other: &SurfaceMesh, steps: usize) {
    let a = Run::new(mesh, &endless(method)).steps(steps);
    let b = Run::new(other, &endless(method)).steps(steps);
    assert_eq!(
        a.parameterization.start_kind(),
        b.parameterization.start_kind()
    );
    // a step of a second-order method is the solution of a system of the condition of the Hessian
    let tolerance = match method {
        Method::Cm | Method::Slim | Method::WrapdCm => 1e-9,
        _ => 1e-11,
    };
    let mut worst = 0.0f64;
    for (a, b) in a.reports.iter().zip(&b.reports) {
        let k = a.iteration;
        let difference = (a.energy - b.energy).abs() / a.energy;
        if a.energy != b.energy {
            worst = worst.max(difference);
            assert!(
                difference <= tolerance,
                "{name} {method:?} {k}: {} {}",
                a.energy,
                b.energy
            );
        }
        let decisions = [a, b].map(|r| (r.inverted, r.lbfgs_iterations, r.reweighted));
        assert_eq!(
            decisions[0], decisions[1],
            "{name} {method:?}, iteration {k}"
        );
    }
    println!("{name} {method:?}: energies differ by at most {worst:e}");
    let [a, b] = [&a, &b].map(|r| r.parameterization.certificate());
    let counts = |c: &foldfree::certificate::Certificate| {
        (
            [
                c.elements,
                c.inverted.len(),
                c.degenerate.len(),
                c.overwound.len(),
            ],
            [
                c.boundary_edges,
                c.boundary_loops,
                c.boundary_crossing_count,
            ],
            [c.is_disk, c.locally_injective, c.globally_injective],
        )
    };
    assert_eq!(counts(&a), counts(&b), "{name} {method:?}");
    for (a, b) in [
        (a.symmetric_dirichlet, b.symmetric_dirichlet),
        (a.smallest_sigma, b.smallest_sigma),
        (a.largest_sigma, b.largest_sigma),
        (a.worst_anisotropy, b.worst_anisotropy),
    ] {
        assert!(
            a == b || (a - b).abs() <= 100.0 * tolerance * a.abs(),
            "{name} {method:?}: {a} and {b}"
        );
    }
}

fn shapes() -> [SurfaceMesh; 2] {
    [
        generate(Shape::BumpyCap, 3_000),
        generate(Shape::Terrain, 2_000),
    ]
}

#[test]
fn the_unit_of_length() {
    for mesh in shapes() {
        for factor in [1e-3, 0.1, 8.0, 1e3] {
            compare("scale", Method::Wrapd, &mesh, &scaled(&mesh, factor), 30);
        }
        for method in [Method::AdmmPd, Method::WAdmm, Method::Arap, Method::Lscm] {
            compare("scale", method, &mesh, &scaled(&mesh, 1e3), 12);
        }
    }
}

#[test]
fn second_order_methods() {
    for mesh in shapes() {
        for method in [Method::Cm, Method::Slim] {
            compare("scale", method, &mesh, &scaled(&mesh, 1e3), 8);
            compare("moved", method, &mesh, &moved(&mesh), 8);
            compare("vertices", method, &mesh, &vertices_shuffled(&mesh), 8);
            compare("faces", method, &mesh, &faces_shuffled(&mesh), 8);
        }
    }
}

#[test]
fn a_power_of_four_changes_not_one_bit() {
    let mesh = generate(Shape::BumpyCap, 1_000);
    let run = |mesh: &SurfaceMesh| Run::new(mesh, &endless(Method::Wrapd)).steps(10);
    let (a, b) = (run(&mesh), run(&scaled(&mesh, 256.0)));
    assert_eq!(a.energies(), b.energies());
    let [a, b] = [a, b].map(|r| r.parameterization.uv());
    for (a, b) in a.iter().zip(b) {
        assert_eq!(*a * 256.0, b);
    }
}

#[test]
fn the_place_in_space() {
    for mesh in shapes() {
        compare("moved", Method::Wrapd, &mesh, &moved(&mesh), 30);
        for method in [
            Method::RAdmm,
            Method::AdmmPd,
            Method::Arap,
            Method::Harmonic,
        ] {
            compare("moved", method, &mesh, &moved(&mesh), 12);
        }
    }
}

#[test]
fn the_order_of_vertices() {
    for mesh in shapes() {
        compare(
            "vertices",
            Method::Wrapd,
            &mesh,
            &vertices_shuffled(&mesh),
            30,
        );
        for method in [Method::RAdmm, Method::AdmmPd, Method::Arap, Method::Tutte] {
            compare("vertices", method, &mesh, &vertices_shuffled(&mesh), 12);
        }
    }
}

#[test]
fn the_order_of_faces() {
    for mesh in shapes() {
        compare("faces", Method::Wrapd, &mesh, &faces_shuffled(&mesh), 30);
        for method in [Method::WAdmm, Method::AdmmPd, Method::Arap, Method::Lscm] {
            compare("faces", method, &mesh, &faces_shuffled(&mesh), 12);
        }
    }
}

/// Which faces come first on a cut mesh may change where it is cut, but not that it is flattened.
#[test]
fn a_closed_surface_is_flattened_however_it_is_numbered() {
    let mesh = generate(Shape::Torus, 2_000);
    let energy = |mesh: &SurfaceMesh| {
        let run = Run::new(mesh, &endless(Method::Wrapd)).steps(60);
        let certificate = run.parameterization.certificate();
        assert!(certificate.inverted.is_empty() && certificate.is_disk);
        run.last().energy
    };
    let first = energy(&mesh);
    let others = [
        vertices_shuffled(&mesh),
        faces_shuffled(&mesh),
        moved(&mesh),
        scaled(&mesh, 1e3),
    ];
    for other in others {
        let other = energy(&other);
        assert!((first - other).abs() < 0.02 * first, "{first} {other}");
    }
}
