//! Places for vertices of a map: pulled there, held there, and what is refused.

use foldfree::Error;
use foldfree::mesh::{Shape, SurfaceMesh, generate};
use foldfree::optim::{BuildError, CancelToken, Solver, Status, run};
use foldfree::parameterization::{Landmark, Method, Parameterization, ParameterizationOptions};
use glam::DVec2;

/// A cap that does not lie flat, and corners of it.
fn cap() -> (SurfaceMesh, [u32; 4]) {
    let n = 12;
    let mut mesh = SurfaceMesh::default();
    for v in 0..(n + 1) * (n + 1) {
        let (x, y) = (
            (v % (n + 1)) as f64 / n as f64,
            (v / (n + 1)) as f64 / n as f64,
        );
        let height = 0.4 * (1.0 - (2.0 * x - 1.0).powi(2)) * (1.0 - (2.0 * y - 1.0).powi(2));
        mesh.positions.push(glam::DVec3::new(x, y, height));
    }
    for cell in 0..n * n {
        let a = (cell / n * (n + 1) + cell % n) as u32;
        let [b, c, d] = [a + 1, a + n as u32 + 1, a + n as u32 + 2];
        mesh.simplices.extend([[a, b, d], [a, d, c]]);
    }
    let n = n as u32;
    (mesh, [0, n, (n + 1) * (n + 1) - 1, (n + 1) * n])
}

/// The corners at the corners of a rectangle that is turned and somewhere else.
fn corners(vertices: [u32; 4], hard: bool) -> Vec<Landmark> {
    let places = [[0.0, 0.0], [1.3, 0.0], [1.3, 0.9], [0.0, 0.9]];
    let turn = DVec2::from_angle(2.0);
    let places = vertices.iter().zip(places);
    places
        .map(|(&vertex, p)| Landmark {
            vertex,
            uv: DVec2::new(7.0, -3.0) + turn.rotate(DVec2::from_array(p)),
            hard,
        })
        .collect()
}

fn solve(
    mesh: &SurfaceMesh,
    method: Method,
    landmarks: &[Landmark],
    stiffness: f64,
) -> Parameterization {
    let options = ParameterizationOptions {
        method,
        tolerance: 1e-9,
        max_iterations: 400,
        landmark_stiffness: stiffness,
        ..Default::default()
    };
    let mut map = Parameterization::with_landmarks(mesh, &options, landmarks).unwrap();
    let mut nothing = |_: &dyn Solver| {};
    let status = run(map.solver_mut(), &mut nothing, &CancelToken::default()).unwrap();
    assert!(
        matches!(status, Status::Converged(_)),
        "{method:?}: {status:?}"
    );
    assert!(map.certificate().inverted.is_empty(), "{method:?}");
    map
}

fn distance(map: &Parameterization, landmarks: &[Landmark]) -> f64 {
    let uv = map.uv();
    let away = landmarks
        .iter()
        .map(|l| uv[l.vertex as usize].distance(l.uv));
    away.fold(0.0, f64::max)
}

const METHODS: [Method; 4] = [Method::Wrapd, Method::Cm, Method::WrapdCm, Method::Slim];

#[test]
fn held_corners_stay_and_all_methods_agree() {
    let (mesh, vertices) = cap();
    let landmarks = corners(vertices, true);
    let free = solve(&mesh, Method::Cm, &[], 10.0).solver().report().energy;
    let mut energies = Vec::new();
    for method in METHODS {
        let map = solve(&mesh, method, &landmarks, 10.0);
        assert!(distance(&map, &landmarks) < 1e-13, "{method:?}");
        energies.push(map.solver().report().energy);
    }
    for energy in &energies {
        assert!(
            *energy > free + 1e-3,
            "the corners cost something: {energies:?}"
        );
        assert!((energy - energies[1]).abs() < 1e-5, "{energies:?}");
    }
}

#[test]
fn pulled_corners_come_nearer_the_harder_they_are_pulled() {
    let (mesh, vertices) = cap();
    let landmarks = corners(vertices, false);
    for method in METHODS {
        let [weak, strong] = [0.1, 1000.0]
            .map(|stiffness| distance(&solve(&mesh, method, &landmarks, stiffness), &landmarks));
        assert!(
            strong < 2e-3 && strong < 0.2 * weak,
            "{method:?}: {weak}, {strong}"
        );
        assert!(weak < 0.5, "{method:?}: {weak}");
    }
}

/// Without a hard or a soft place for anything else, one or two fix a map up to a motion.
#[test]
fn few_landmarks_cost_nothing() {
    let (mesh, vertices) = cap();
    let free = solve(&mesh, Method::Cm, &[], 10.0).solver().report().energy;
    for hard in [true, false] {
        let landmarks = &corners(vertices, hard)[..1];
        for method in METHODS {
            let map = solve(&mesh, method, landmarks, 10.0);
            let energy = map.solver().report().energy;
            assert!(
                (energy - free).abs() < 1e-5,
                "{method:?}: {energy} and {free}"
            );
            assert!(distance(&map, landmarks) < 1e-3, "{method:?}");
        }
    }
}

/// The same problem turned, shifted, scaled: the same map.
#[test]
fn units_and_motions_change_nothing() {
    let (mesh, vertices) = cap();
    let landmarks = corners(vertices, true);
    let map = solve(&mesh, Method::WrapdCm, &landmarks, 10.0).uv();
    let (turn, shift, scale) = (DVec2::from_angle(-0.7), DVec2::new(1e3, 20.0), 1e3);
    let moved = |p: DVec2| scale * turn.rotate(p) + shift;
    let mut large = mesh.clone();
    large.positions.iter_mut().for_each(|p| *p *= scale);
    let landmarks: Vec<Landmark> = landmarks
        .iter()
        .map(|l| Landmark {
            uv: moved(l.uv),
            ..*l
        })
        .collect();
    let other = solve(&large, Method::WrapdCm, &landmarks, 10.0).uv();
    for (a, b) in map.iter().zip(&other) {
        assert!(moved(*a).distance(*b) < 1e-4 * scale, "{a} and {b}");
    }
}

#[track_caller]
fn refused(mesh: &SurfaceMesh, method: Method, landmarks: &[Landmark], part: &str) {
    let options = ParameterizationOptions {
        method,
        ..Default::default()
    };
    match Parameterization::with_landmarks(mesh, &options, landmarks) {
        Err(Error::Build(BuildError::InvalidOption { option, what })) => {
            assert_eq!(option, "landmarks");
            assert!(what.contains(part), "{what}");
        }
        other => panic!("{:?}", other.map(|_| ())),
    }
}

#[test]
fn bad_landmarks_are_refused_by_name() {
    let (mut mesh, vertices) = cap();
    let [first, second, ..] = corners(vertices, true)[..] else {
        unreachable!()
    };
    let at = |vertex| Landmark { vertex, ..first };
    refused(&mesh, Method::Wrapd, &[at(400)], "vertex 400 of 169");
    refused(
        &mesh,
        Method::Wrapd,
        &[first, second, first],
        "vertex 0 has two",
    );
    let nowhere = Landmark {
        uv: DVec2::new(f64::NAN, 0.0),
        ..second
    };
    refused(&mesh, Method::Wrapd, &[nowhere], "vertex 12 is not finite");
    refused(&mesh, Method::Lscm, &[first], "ADMM methods");
    mesh.positions.push(glam::DVec3::ZERO);
    refused(
        &mesh,
        Method::Wrapd,
        &[at(169)],
        "vertex 169 is on no triangle",
    );

    // a sphere is slit
    let sphere = generate(Shape::Sphere, 300);
    let landmarks: Vec<Landmark> = (0..sphere.positions.len() as u32).map(at).collect();
    refused(&sphere, Method::Wrapd, &landmarks, "on a seam");
}

/// Places that fold the surface: refused by those that cannot unfold it, without a word of advice lost.
#[test]
fn folding_places() {
    let (mesh, vertices) = cap();
    let mut landmarks = corners(vertices, true);
    // two neighbours change places
    for (vertex, by) in [(84, 0.05), (85, -0.05)] {
        landmarks.push(Landmark {
            vertex,
            uv: DVec2::new(7.0, -3.0) + DVec2::from_angle(2.0).rotate(DVec2::new(0.65 + by, 0.45)),
            hard: true,
        });
    }
    let options = ParameterizationOptions {
        method: Method::Cm,
        ..Default::default()
    };
    let refused = Parameterization::with_landmarks(&mesh, &options, &landmarks);
    assert!(matches!(
        refused.map(|_| ()),
        Err(Error::Build(BuildError::NotInjectiveStart { .. }))
    ));
}
