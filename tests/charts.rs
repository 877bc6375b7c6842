//! Several pieces in one call, and surfaces with holes.

use foldfree::mesh::{Shape, SurfaceMesh, generate};
use foldfree::optim::{CancelToken, Solver, Status, run};
use foldfree::parameterization::{
    CutPolicy, EnergyKind, Method, Parameterization, ParameterizationOptions,
};
use glam::DVec3;

/// A hemisphere-like grid of n × n cells without those for which `hole` holds.
fn dome(n: usize, height: f64, hole: impl Fn(usize, usize) -> bool) -> SurfaceMesh {
    let mut mesh = SurfaceMesh::default();
    let at = |i: usize| 2.0 * i as f64 / n as f64 - 1.0;
    for v in 0..(n + 1) * (n + 1) {
        let (x, y) = (at(v % (n + 1)), at(v / (n + 1)));
        let z = height * (1.0 - 0.5 * (x * x + y * y)) + 0.05 * (3.0 * x * y).sin();
        mesh.positions.push(DVec3::new(x, y, z));
    }
    for cell in (0..n * n).filter(|&c| !hole(c % n, c / n)) {
        let a = (cell / n * (n + 1) + cell % n) as u32;
        let [b, c, d] = [a + 1, a + n as u32 + 1, a + n as u32 + 2];
        mesh.simplices.extend([[a, b, d], [a, d, c]]);
    }
    mesh
}

/// Pieces side by side in one mesh.
fn together(pieces: &[&SurfaceMesh]) -> SurfaceMesh {
    let mut all = SurfaceMesh::default();
    for piece in pieces {
        let first = all.positions.len() as u32;
        all.positions.extend(&piece.positions);
        let shifted = piece.simplices.iter().map(|t| t.map(|v| first + v));
        all.simplices.extend(shifted);
    }
    all
}

fn options(method: Method, cut: CutPolicy) -> ParameterizationOptions {
    ParameterizationOptions {
        method,
        cut,
        tolerance: 1e-10,
        max_iterations: 2000,
        ..Default::default()
    }
}

fn solve(mesh: &SurfaceMesh, options: &ParameterizationOptions) -> Parameterization {
    let mut map = Parameterization::new(mesh, options).unwrap();
    let mut nothing = |_: &dyn Solver| {};
    let status = run(map.solver_mut(), &mut nothing, &CancelToken::default()).unwrap();
    assert!(matches!(status, Status::Converged(_)), "{status:?}");
    map
}

const METHODS: [Method; 5] = [
    Method::Wrapd,
    Method::Cm,
    Method::WrapdCm,
    Method::Slim,
    Method::Arap,
];

/// Each chart ends where it would end alone, and none lies on another.
#[test]
fn charts_are_as_good_as_alone() {
    let none = |_: usize, _: usize| false;
    let pieces = [dome(8, 0.9, none), dome(10, 0.4, none), dome(5, 1.5, none)];
    let all = together(&pieces.iter().collect::<Vec<_>>());
    for method in METHODS {
        let settings = options(method, CutPolicy::Cut);
        let map = solve(&all, &settings);
        assert_eq!(map.charts().len(), 3);
        assert_eq!(map.input_vertices().len(), all.positions.len());
        let certificate = map.certificate();
        if method != Method::Arap {
            assert!(
                certificate.globally_injective,
                "{method:?}: {}",
                certificate.summary()
            );
        }
        let (mut sum, mut area) = (0.0, 0.0);
        for piece in &pieces {
            let alone = solve(piece, &settings).certificate();
            let measure: f64 = foldfree::geometry::surface_area(piece);
            sum += measure * alone.symmetric_dirichlet;
            area += measure;
        }
        let got = certificate.symmetric_dirichlet;
        assert!(
            (got - sum / area).abs() < 1e-5,
            "{method:?}: {got} and {}",
            sum / area
        );
    }
}

/// One chart is what it always was.
#[test]
fn triangles_and_vertices_are_those_of_the_input() {
    let (a, b) = (generate(Shape::Torus, 400), generate(Shape::BumpyCap, 300));
    let all = together(&[&a, &b]);
    let map = Parameterization::new(&all, &options(Method::Tutte, CutPolicy::Cut)).unwrap();
    let source = map.input_vertices();
    assert_eq!(map.mesh().simplices.len(), all.simplices.len());
    for (triangle, input) in map.mesh().simplices.iter().zip(&all.simplices) {
        assert_eq!(triangle.map(|v| source[v as usize]), *input);
        for &v in triangle {
            let from = all.positions[source[v as usize] as usize];
            assert_eq!(map.mesh().positions[v as usize], from);
        }
    }
    assert!(map.seam_edges() > 0, "the torus is cut");
    let note = "2 pieces, a chart for each, cut along";
    assert!(
        map.notes().iter().any(|n| n.starts_with(note)),
        "{:?}",
        map.notes()
    );
}

#[test]
fn charts_refuse_what_one_of_them_refuses() {
    let all = together(&[
        &generate(Shape::BumpyCap, 200),
        &generate(Shape::Sphere, 200),
    ]);
    let refused = Parameterization::new(&all, &options(Method::Wrapd, CutPolicy::Refuse));
    assert_eq!(refused.map(|_| ()).unwrap_err().code(), "not-a-disk");
}

/// Eyes and a mouth.
fn mask(n: usize) -> SurfaceMesh {
    dome(n, 1.2, |i, j| {
        let (x, y) = (12 * i / n, 12 * j / n);
        (y == 7 || y == 8) && (x == 2 || x == 3 || x == 8 || x == 9)
            || y == 3 && (4..8).contains(&x)
    })
}

#[test]
fn holes_are_kept_where_they_may_be() {
    let mesh = mask(24);
    for method in METHODS {
        let map = solve(&mesh, &options(method, CutPolicy::KeepHoles));
        assert_eq!(map.seam_edges(), 0);
        assert_eq!(map.mesh().positions.len(), map.input_vertices().len());
        let certificate = map.certificate();
        assert_eq!(certificate.boundary_loops, 4);
        assert!(certificate.inverted.is_empty() && certificate.locally_injective);
        if method != Method::Arap {
            assert!(
                certificate.globally_injective,
                "{method:?}: {}",
                certificate.summary()
            );
        }
        assert!(
            map.notes().contains(&"3 holes kept".to_string()),
            "{:?}",
            map.notes()
        );
    }
    // uncut it has to stretch more, around the holes
    let cut = solve(&mesh, &options(Method::WrapdCm, CutPolicy::Cut));
    assert!(cut.seam_edges() > 0);
    let whole = solve(&mesh, &options(Method::WrapdCm, CutPolicy::KeepHoles));
    let energy = |map: &Parameterization| map.solver().report().energy;
    assert!(energy(&cut) < energy(&whole) && energy(&whole) < 1.5);
}

/// Tutte's map of a surface with holes is an embedding, whatever the triangles are like.
#[test]
fn tutte_with_holes_is_an_embedding() {
    for n in [12, 24, 36] {
        let mesh = mask(n);
        let map = Parameterization::new(&mesh, &options(Method::Tutte, CutPolicy::KeepHoles));
        let certificate = map.unwrap();
        let mut certificate = certificate;
        certificate.step().unwrap();
        let certificate = certificate.certificate();
        assert!(certificate.globally_injective, "{}", certificate.summary());
    }
}

/// What has a handle is cut, and its holes with it.
#[test]
fn handles_are_cut_all_the_same() {
    let mut torus = generate(Shape::Torus, 800);
    torus.simplices.drain(10..14);
    let map = solve(&torus, &options(Method::WrapdCm, CutPolicy::KeepHoles));
    assert!(map.seam_edges() > 0);
    assert!(map.certificate().is_disk);
}

/// The order of pieces and their places in space change nothing but the order of the charts.
#[test]
fn order_and_place_change_nothing() {
    let none = |_: usize, _: usize| false;
    let (a, mut b) = (dome(7, 0.8, none), dome(9, 0.3, none));
    let settings = ParameterizationOptions {
        energy: EnergyKind::SymmetricDirichlet,
        ..options(Method::WrapdCm, CutPolicy::Cut)
    };
    let one = solve(&together(&[&a, &b]), &settings);
    b.positions
        .iter_mut()
        .for_each(|p| *p += DVec3::new(3.0, -8.0, 0.25));
    let two = solve(&together(&[&b, &a]), &settings);
    let energy = |map: &Parameterization| map.solver().report().energy;
    assert!((energy(&one) - energy(&two)).abs() < 1e-9);
}
