//! What cannot be flattened is an error that names the thing, and never a panic.

use foldfree::Error;
use foldfree::mesh::{MeshError, Shape, SurfaceMesh, generate};
use foldfree::optim::BuildError;
use foldfree::parameterization::{
    CutPolicy, EnergyKind, Method, Parameterization, ParameterizationOptions, Start,
};
use glam::DVec3;

const METHODS: [Method; 11] = [
    Method::Wrapd,
    Method::RAdmm,
    Method::WAdmm,
    Method::AdmmPd,
    Method::Cm,
    Method::WrapdCm,
    Method::Slim,
    Method::Arap,
    Method::Lscm,
    Method::Harmonic,
    Method::Tutte,
];

const STARTS: [Start; 6] = [
    Start::Automatic,
    Start::Harmonic,
    Start::Tutte,
    Start::Lscm,
    Start::Random,
    Start::Collapsed,
];

fn mesh(positions: &[[f64; 3]], simplices: &[[u32; 3]]) -> SurfaceMesh {
    SurfaceMesh {
        positions: positions.iter().map(|&p| DVec3::from_array(p)).collect(),
        simplices: simplices.to_vec(),
    }
}

/// The unit square in four triangles round its middle, vertex 4.
fn square() -> SurfaceMesh {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let positions = [&corners[..], &[[0.5, 0.5, 0.0]]].concat();
    mesh(&positions, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
}

fn new(mesh: &SurfaceMesh) -> Result<Parameterization, Error> {
    Parameterization::new(mesh, &ParameterizationOptions::default())
}

/// The mesh's error and its name.
#[track_caller]
fn refused(mesh: &SurfaceMesh, code: &str) -> MeshError {
    for method in METHODS {
        let options = ParameterizationOptions {
            method,
            ..Default::default()
        };
        let other = Parameterization::new(mesh, &options)
            .err()
            .map(|e| e.code());
        assert_eq!(other, Some(code), "{method:?}");
    }
    match new(mesh).err() {
        Some(Error::Mesh(error)) => {
            assert_eq!(error.code(), code);
            assert!(!error.to_string().is_empty());
            error
        }
        other => panic!("{other:?} instead of {code}"),
    }
}

#[test]
fn a_good_mesh_is_not_refused() {
    assert!(new(&square()).is_ok());
}

#[test]
fn nothing() {
    assert_eq!(
        refused(&SurfaceMesh::default(), "empty-mesh"),
        MeshError::Empty
    );
    refused(&mesh(&[[0.0; 3]; 4], &[]), "empty-mesh");
}

#[test]
fn coordinates_that_are_not_finite() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut mesh = square();
        mesh.positions[3].z = bad;
        let error = refused(&mesh, "non-finite-position");
        assert_eq!(error, MeshError::NonFinitePosition { vertex: 3 });
    }
}

#[test]
fn indices() {
    let mut mesh = square();
    mesh.simplices[2] = [2, 7, 4];
    let error = refused(&mesh, "index-out-of-range");
    let expected = MeshError::IndexOutOfRange {
        face: 2,
        index: 7,
        vertices: 5,
    };
    assert_eq!(error, expected);
    mesh.simplices[2] = [2, 4, 4];
    let error = refused(&mesh, "repeated-vertex");
    assert_eq!(error, MeshError::RepeatedVertex { face: 2, vertex: 4 });
}

#[test]
fn the_same_face_twice() {
    let mut mesh = square();
    mesh.simplices.push([4, 1, 2]);
    let error = refused(&mesh, "duplicate-face");
    assert_eq!(
        error,
        MeshError::DuplicateFace {
            first: 1,
            second: 4
        }
    );
}

#[test]
fn faces_without_area() {
    let mut flat = square();
    flat.positions[4] = DVec3::new(0.5, 0.0, 0.0);
    let error = refused(&flat, "degenerate-face");
    assert!(matches!(error, MeshError::DegenerateFace { face: 0, .. }));
    let mut line = square();
    line.positions.iter_mut().for_each(|p| *p = DVec3::X * p.x);
    refused(&line, "zero-area");
    let mut point = square();
    point.positions.fill(DVec3::ONE);
    refused(&point, "zero-area");
}

#[test]
fn not_a_surface() {
    let mut fin = square();
    fin.positions.push(DVec3::new(0.5, 0.5, 1.0));
    fin.simplices.push([0, 4, 5]);
    let error = refused(&fin, "non-manifold-edge");
    let expected = MeshError::NonManifoldEdge {
        vertices: [0, 4],
        faces: 3,
    };
    assert_eq!(error, expected);

    let mut bow_tie = square();
    bow_tie
        .positions
        .extend([DVec3::new(3.0, 0.0, 0.0), DVec3::new(3.0, 1.0, 0.0)]);
    bow_tie.simplices.push([1, 5, 6]);
    let error = refused(&bow_tie, "non-manifold-vertex");
    assert_eq!(error, MeshError::NonManifoldVertex { vertex: 1 });

    // a Möbius strip of five quads
    let mut strip = SurfaceMesh::default();
    for i in 0..5u32 {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 5.0).sin_cos();
        let (lift, out) = (std::f64::consts::PI * f64::from(i) / 5.0).sin_cos();
        for side in [-0.3, 0.3] {
            let radius = 1.0 + side * out;
            strip
                .positions
                .push(DVec3::new(radius * cos, radius * sin, side * lift));
        }
        let (a, b) = (2 * i, 2 * i + 1);
        let (c, d) = if i == 4 { (1, 0) } else { (a + 2, b + 2) };
        strip.simplices.extend([[a, c, b], [b, c, d]]);
    }
    let error = refused(&strip, "not-orientable");
    assert!(matches!(error, MeshError::NotOrientable { .. }));
}

#[test]
fn cutting_refused() {
    let refusing = ParameterizationOptions {
        cut: CutPolicy::Refuse,
        ..Default::default()
    };
    let mut ring = generate(Shape::Torus, 300);
    for (shape, euler, loops) in [(Shape::Torus, 0, 0), (Shape::Sphere, 2, 0)] {
        let mesh = generate(shape, 300);
        let expected = MeshError::NotADisk {
            euler_characteristic: euler,
            boundary_loops: loops,
        };
        let error = Parameterization::new(&mesh, &refusing).err();
        assert_eq!(error, Some(Error::Mesh(expected)));
        let cut = new(&mesh).unwrap();
        assert!(cut.seam_edges() > 0 && !cut.notes().is_empty());
    }
    // a torus with a hole is no disk either
    ring.simplices.pop();
    let error = Parameterization::new(&ring, &refusing)
        .err()
        .map(|e| e.code());
    assert_eq!(error, Some("not-a-disk"));
    // and a disk needs no cut
    assert!(Parameterization::new(&square(), &refusing).is_ok());
}

#[test]
fn extreme_units_work_or_are_refused() {
    for exponent in [-300, -200, -160, -100, -60, -3, 3, 60, 100, 160, 200, 300] {
        let mut mesh = generate(Shape::Terrain, 100);
        mesh.positions
            .iter_mut()
            .for_each(|p| *p *= 10f64.powi(exponent));
        match new(&mesh) {
            Ok(mut p) => {
                let report = p.step().unwrap();
                assert!(report.energy.is_finite(), "1e{exponent}: {report:?}");
                assert!(p.uv().iter().all(|p| p.is_finite()));
            }
            Err(error) => {
                assert!(exponent.abs() > 60, "1e{exponent}: {error}");
                println!("1e{exponent}: {error}");
            }
        }
    }
}

#[test]
fn options_out_of_range() {
    for tolerance in [f64::NAN, -1e-9, f64::INFINITY, f64::NEG_INFINITY] {
        let options = ParameterizationOptions {
            tolerance,
            ..Default::default()
        };
        assert!(options.validate().is_err());
        for method in METHODS {
            let options = ParameterizationOptions {
                method,
                ..options.clone()
            };
            let error = Parameterization::new(&square(), &options).err();
            let named = matches!(
                &error,
                Some(Error::Build(BuildError::InvalidOption {
                    option: "tolerance",
                    ..
                }))
            );
            assert!(named, "{error:?}");
            assert_eq!(error.map(|e| e.code()), Some("invalid-option"));
        }
    }
}

/// The smallest meshes, by every method from every start.
#[test]
fn the_smallest_meshes() {
    let triangle = mesh(
        &[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 1.0]],
        &[[0, 1, 2]],
    );
    let mut pair = square();
    pair.simplices = vec![[0, 1, 2], [0, 2, 3]];
    let tetrahedron = mesh(
        &[
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ],
        &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
    );
    for (name, mesh) in [("triangle", triangle), ("pair", pair), ("square", square())] {
        for method in METHODS {
            for start in STARTS {
                for energy in [EnergyKind::SymmetricDirichlet, EnergyKind::Arap] {
                    let options = ParameterizationOptions {
                        method,
                        start,
                        energy,
                        ..Default::default()
                    };
                    let mut p = match Parameterization::new(&mesh, &options) {
                        Ok(p) => p,
                        // starts that these do not take, and an energy
                        Err(Error::Build(
                            BuildError::NotInjectiveStart { .. }
                            | BuildError::InvalidOption {
                                option: "energy", ..
                            },
                        )) if matches!(method, Method::Cm | Method::Slim | Method::WrapdCm)
                            && (energy == EnergyKind::Arap
                                || [Start::Random, Start::Collapsed].contains(&start)) =>
                        {
                            continue;
                        }
                        Err(e) => panic!("{name} {method:?} {start:?}: {e}"),
                    };
                    for _ in 0..20 {
                        p.step()
                            .unwrap_or_else(|e| panic!("{name} {method:?} {start:?}: {e}"));
                    }
                    assert!(p.uv().iter().all(|p| p.is_finite()));
                }
            }
        }
    }
    for method in METHODS {
        let options = ParameterizationOptions {
            method,
            ..Default::default()
        };
        let mut p = Parameterization::new(&tetrahedron, &options).unwrap();
        p.step().unwrap();
        assert!(p.uv().iter().all(|p| p.is_finite()), "{method:?}");
    }
}
