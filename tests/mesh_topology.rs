//! Topology and preparation: numbers known by hand, what is mended, every error there is.

mod mesh_common;

use foldfree::mesh::topology::{next, previous};
use foldfree::mesh::{MeshError, Shape, SurfaceMesh, Topology, generate, prepare};
use glam::DVec3;
use mesh_common::{both, double_torus, shuffled, voxels, without};

fn mesh(positions: &[[f64; 3]], simplices: &[[u32; 3]]) -> SurfaceMesh {
    SurfaceMesh {
        positions: positions.iter().copied().map(DVec3::from_array).collect(),
        simplices: simplices.to_vec(),
    }
}

/// Points in general position on a moment curve: any triangles of them have area.
fn on_curve(vertices: usize, simplices: &[[u32; 3]]) -> SurfaceMesh {
    let points = (0..vertices).map(|i| i as f64 + 1.0);
    let positions: Vec<[f64; 3]> = points.map(|t| [t, t * t, t * t * t / 10.0]).collect();
    mesh(&positions, simplices)
}

fn error(mesh: &SurfaceMesh) -> MeshError {
    prepare(mesh).unwrap_err()
}

#[test]
fn numbers_of_known_surfaces() {
    let cases = [
        // (mesh, components, loops, Euler characteristic, genus)
        (generate(Shape::Terrain, 500), 1, 1, 1, 0),
        (generate(Shape::Sphere, 500), 1, 0, 2, 0),
        (generate(Shape::Torus, 500), 1, 0, 0, 1),
        (double_torus(2), 1, 0, -2, 2),
        (
            voxels(
                &[
                    &["###", "#.#", "###"],
                    &["#.#", "...", "#.#"],
                    &["###", "#.#", "###"],
                ],
                1,
            ),
            1,
            0,
            -8,
            5,
        ),
        (
            without(&generate(Shape::Sphere, 500), |i, _| i == 0 || i == 400),
            1,
            2,
            0,
            0,
        ),
        (without(&double_torus(3), |i, _| i % 57 == 0), 1, 16, -18, 2),
        (
            both(
                &generate(Shape::Torus, 100),
                &generate(Shape::BumpyCap, 100),
            ),
            2,
            1,
            1,
            1,
        ),
    ];
    for (index, (mesh, components, loops, euler, genus)) in cases.into_iter().enumerate() {
        for seed in 0..4 {
            let mesh = if seed == 0 {
                mesh.clone()
            } else {
                shuffled(&mesh, seed)
            };
            let topology = Topology::new(&mesh).unwrap();
            assert_eq!(topology.components(), components, "case {index}");
            assert_eq!(topology.boundary_loops().len(), loops, "case {index}");
            assert_eq!(topology.euler_characteristic(), euler, "case {index}");
            assert_eq!(topology.genus(), genus, "case {index}");
            assert_eq!(topology.is_closed(), loops == 0);
            assert_eq!(topology.is_disk(), index == 0);
            assert_eq!(topology.faces(), mesh.simplices.len());
        }
    }
}

#[test]
fn corners_and_boundary() {
    let mesh = generate(Shape::BumpyCap, 600);
    let topology = Topology::new(&mesh).unwrap();
    let mut boundary_edges = 0;
    for corner in 0..3 * mesh.simplices.len() as u32 {
        assert_eq!(previous(next(corner)), corner);
        match topology.opposite(corner) {
            Some(across) => {
                assert_eq!(topology.opposite(across), Some(corner));
                assert_eq!(
                    topology.vertex(next(across)),
                    topology.vertex(previous(corner))
                );
                assert_eq!(
                    topology.vertex(previous(across)),
                    topology.vertex(next(corner))
                );
            }
            None => boundary_edges += 1,
        }
    }
    for vertex in 0..mesh.positions.len() as u32 {
        let start = topology.corner_of(vertex).unwrap();
        let mut count = 0;
        let mut at = Some(start);
        while let Some(corner) = at {
            assert_eq!(topology.vertex(corner), vertex);
            count += 1;
            at = topology.counter_clockwise(corner).filter(|&c| c != start);
        }
        let faces = mesh
            .simplices
            .iter()
            .filter(|s| s.contains(&vertex))
            .count();
        assert_eq!(count, faces);
    }
    let boundary = &topology.boundary_loops()[0];
    assert_eq!(boundary.len(), boundary_edges);
    assert_eq!(boundary[0], *boundary.iter().min().unwrap());
    for i in 0..boundary.len() {
        // The surface is to the left: some face runs along the boundary in its direction.
        let (a, b) = (boundary[i], boundary[(i + 1) % boundary.len()]);
        let runs = |s: &[u32; 3]| (0..3).any(|k| s[k] == a && s[(k + 1) % 3] == b);
        assert!(mesh.simplices.iter().any(runs));
        assert!(topology.is_boundary_vertex(a));
    }
}

#[test]
fn unreferenced_vertices_are_dropped() {
    let mesh = mesh(
        &[
            [9.0; 3],
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [8.0; 3],
            [0.0, 1.0, 0.0],
            [7.0; 3],
        ],
        &[[1, 2, 4]],
    );
    let prepared = prepare(&mesh).unwrap();
    assert_eq!(prepared.input_vertices, [1, 2, 4]);
    assert_eq!(prepared.mesh.simplices, [[0, 1, 2]]);
    assert_eq!(prepared.mesh.positions[2], DVec3::Y);
    assert_eq!(prepared.notes, ["3 unreferenced vertices dropped"]);
    assert_eq!(prepared.topology.euler_characteristic(), 1);
    assert_eq!(Topology::new(&mesh).unwrap().euler_characteristic(), 1);
    assert_eq!(Topology::new(&mesh).unwrap().corner_of(0), None);
}

#[test]
fn faces_are_turned_to_agree() {
    let clean = generate(Shape::Torus, 400);
    let mut mixed = clean.clone();
    for face in [3, 17, 18, 200] {
        mixed.simplices[face].swap(0, 1);
    }
    let clash = Topology::new(&mixed).unwrap_err();
    assert_eq!(clash.code(), "inconsistent-orientation");
    let prepared = prepare(&mixed).unwrap();
    let count = clean.simplices.len();
    let note = format!("4 faces of {count} turned round to agree with their neighbours");
    assert_eq!(prepared.notes, [note]);
    let canonical = |mesh: &SurfaceMesh| -> Vec<[u32; 3]> {
        let turn = |s: &[u32; 3]| {
            let lowest = (0..3).min_by_key(|&k| s[k]).unwrap();
            [s[lowest], s[(lowest + 1) % 3], s[(lowest + 2) % 3]]
        };
        mesh.simplices.iter().map(turn).collect()
    };
    assert_eq!(canonical(&prepared.mesh), canonical(&clean));
    assert_eq!(prepared.topology, Topology::new(&prepared.mesh).unwrap());
    // A whole component the other way round is left alone: nothing disagrees.
    let mut inside_out = clean.clone();
    inside_out.simplices.iter_mut().for_each(|s| s.swap(0, 1));
    assert!(prepare(&inside_out).unwrap().notes.is_empty());
    // Random sides, on a mesh of two components.
    let mut wild = both(&clean, &generate(Shape::Terrain, 300));
    let mut random = mesh_common::Random(3);
    for simplex in &mut wild.simplices {
        if random.next().is_multiple_of(2) {
            simplex.swap(1, 2);
        }
    }
    let prepared = prepare(&wild).unwrap();
    assert_eq!(prepared.notes.len(), 1);
    assert_eq!(prepared.topology, Topology::new(&prepared.mesh).unwrap());
}

#[test]
fn errors_name_the_element() {
    let square = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    assert_eq!(error(&SurfaceMesh::default()), MeshError::Empty);
    assert_eq!(error(&mesh(&square, &[])), MeshError::Empty);
    assert_eq!(
        error(&mesh(&square, &[[0, 1, 2], [0, 2, 4]])),
        MeshError::IndexOutOfRange {
            face: 1,
            index: 4,
            vertices: 4
        }
    );
    assert_eq!(
        error(&mesh(&square, &[[0, 1, 2], [2, 3, 2]])),
        MeshError::RepeatedVertex { face: 1, vertex: 2 }
    );
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut points = square;
        points[2][1] = bad;
        assert_eq!(
            error(&mesh(&points, &[[0, 1, 2]])),
            MeshError::NonFinitePosition { vertex: 2 }
        );
    }
    for again in [[0, 2, 3], [2, 3, 0], [3, 2, 0]] {
        assert_eq!(
            error(&mesh(&square, &[[0, 1, 2], [0, 2, 3], again])),
            MeshError::DuplicateFace {
                first: 1,
                second: 2
            }
        );
    }
    assert_eq!(
        error(&mesh(&square, &[[0, 1, 2], [2, 1, 0]])),
        MeshError::DuplicateFace {
            first: 0,
            second: 1
        }
    );
    assert_eq!(
        error(&on_curve(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]])),
        MeshError::NonManifoldEdge {
            vertices: [0, 1],
            faces: 3
        }
    );
    // Two triangles that touch in a vertex, and two fans of a closed surface that do.
    assert_eq!(
        error(&on_curve(5, &[[0, 1, 2], [2, 3, 4]])),
        MeshError::NonManifoldVertex { vertex: 2 }
    );
    let tetrahedron = |a, b, c, d| [[a, c, b], [a, b, d], [b, c, d], [c, a, d]];
    let two = [tetrahedron(1, 2, 3, 4), tetrahedron(4, 5, 6, 7)].concat();
    // (vertex 0 is unreferenced: the name is the input's)
    assert_eq!(
        error(&on_curve(8, &two)),
        MeshError::NonManifoldVertex { vertex: 4 }
    );
    let moebius: Vec<[u32; 3]> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    assert_eq!(error(&on_curve(5, &moebius)).code(), "not-orientable");
}

#[test]
fn areas_are_relative() {
    // A face whose vertices lie on a line, at any scale and far from the origin.
    for (scale, shift) in [
        (1.0, 0.0),
        (1e-3, 0.0),
        (1e3, 0.0),
        (1e-200, 0.0),
        (1e200, 0.0),
        (1.0, 1e6),
    ] {
        let place = |x: f64, y: f64| [x * scale + shift, y * scale, 0.0];
        let points = [
            place(0.0, 0.0),
            place(2.0, 0.0),
            place(0.0, 2.0),
            place(1.0, 1.0),
        ];
        let good = mesh(&points, &[[0, 1, 3], [0, 3, 2]]);
        assert!(prepare(&good).is_ok(), "{scale} {shift}");
        let flat = mesh(&points, &[[0, 1, 3], [0, 3, 2], [1, 2, 3]]);
        match error(&flat) {
            MeshError::DegenerateFace { face: 2, area } => assert!(area < 1e-14),
            other => panic!("{other:?}"),
        }
        let line = [
            place(0.0, 0.0),
            place(1.0, 0.0),
            place(3.0, 0.0),
            place(7.0, 0.0),
        ];
        assert_eq!(
            error(&mesh(&line, &[[0, 1, 2], [1, 2, 3]])),
            MeshError::ZeroArea
        );
        let point = [place(0.3, 0.7); 3];
        assert_eq!(error(&mesh(&point, &[[0, 1, 2]])), MeshError::ZeroArea);
    }
    let slanted = [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.7, 0.7, 0.7]];
    assert_eq!(error(&mesh(&slanted, &[[0, 1, 2]])), MeshError::ZeroArea);
    assert_eq!(
        error(&mesh(&[[0.0; 3]; 3], &[[0, 1, 2]])),
        MeshError::ZeroArea
    );
}

#[test]
fn one_vertex_of_a_hundred_thousand_faces() {
    // Neither the fan of one vertex nor an edge of very many faces takes long.
    let n = 100_000u32;
    let ring = |i: u32| 1 + i % n;
    let mut fan = on_curve(1, &[]);
    for i in 0..n {
        let (s, c) = (f64::from(i) / f64::from(n) * std::f64::consts::TAU).sin_cos();
        fan.positions.push(DVec3::new(c, s, 0.0));
        fan.simplices.push([0, ring(i), ring(i + 1)]);
    }
    fan.positions[0] = DVec3::ZERO;
    assert!(prepare(&fan).unwrap().topology.is_disk());
    let book: Vec<[u32; 3]> = (0..n).map(|i| [0, 1, i + 2]).collect();
    let mut book = on_curve(n as usize + 2, &book);
    book.positions
        .iter_mut()
        .enumerate()
        .for_each(|(i, p)| *p = DVec3::new(i as f64, (i * i % 1009) as f64, 1.0));
    book.positions[0] = DVec3::ZERO;
    let found = Topology::new(&book).unwrap_err();
    assert_eq!(
        found,
        MeshError::NonManifoldEdge {
            vertices: [0, 1],
            faces: n as usize
        }
    );
}
