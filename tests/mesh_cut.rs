//! Whatever connected surface goes in, a disk comes out, and everything can be traced back.

mod mesh_common;

use foldfree::mesh::{Cut, Shape, SurfaceMesh, Topology, cut_to_disk, generate, prepare};
use mesh_common::{both, double_torus, jitter, shuffled, voxels, without};
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Cuts, checks all that a cut promises, and returns it with the length of its seams.
fn cut(mesh: &SurfaceMesh) -> (Cut, f64) {
    let topology = Topology::new(mesh).unwrap();
    let cut = cut_to_disk(mesh, &topology).unwrap();
    // Each triangle is the input's, in its place.
    assert_eq!(cut.mesh.simplices.len(), mesh.simplices.len());
    assert_eq!(cut.mesh.positions.len(), cut.source_vertices.len());
    for (new, old) in cut.mesh.simplices.iter().zip(&mesh.simplices) {
        assert_eq!(new.map(|v| cut.source_vertices[v as usize]), *old);
    }
    for (position, &source) in cut.mesh.positions.iter().zip(&cut.source_vertices) {
        assert_eq!(*position, mesh.positions[source as usize]);
    }
    let originals = 0..mesh.positions.len() as u32;
    assert!(
        originals
            .clone()
            .eq(cut.source_vertices[..originals.len()].iter().copied())
    );
    // A disk, whose every vertex is used.
    let disk = prepare(&cut.mesh).unwrap();
    assert!(disk.topology.is_disk());
    assert!(disk.notes.is_empty());
    // Its boundary is the old one and both sides of every seam.
    let old_boundary: usize = topology.boundary_loops().iter().map(Vec::len).sum();
    let boundary = &disk.topology.boundary_loops()[0];
    assert_eq!(boundary.len(), old_boundary + 2 * cut.seam_edges.len());
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for i in 0..boundary.len() {
        let ends = [boundary[i], boundary[(i + 1) % boundary.len()]];
        let [a, b] = ends.map(|v| cut.source_vertices[v as usize]);
        *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
    }
    let doubled: Vec<[u32; 2]> = sides
        .into_iter()
        .filter(|s| s.1 == 2)
        .map(|s| s.0)
        .collect();
    assert_eq!(doubled, cut.seam_edges);
    // No spurs: a seam ends only on the boundary (or, on a sphere, at the two ends of its slit).
    let mut degrees: BTreeMap<u32, usize> = BTreeMap::new();
    for vertex in cut.seam_edges.iter().flatten() {
        *degrees.entry(*vertex).or_default() += 1;
    }
    let loose = degrees
        .iter()
        .filter(|&(&v, &degree)| degree == 1 && !topology.is_boundary_vertex(v))
        .count();
    let sphere = topology.is_closed() && topology.genus() == 0;
    assert_eq!(loose, if sphere { 2 } else { 0 });
    let length =
        |&[a, b]: &[u32; 2]| mesh.positions[a as usize].distance(mesh.positions[b as usize]);
    let length = cut.seam_edges.iter().map(length).sum();
    (cut, length)
}

#[test]
fn a_disk_is_left_alone() {
    for shape in [
        Shape::BumpyCap,
        Shape::Terrain,
        Shape::SpiralRamp,
        Shape::HilbertStrip,
    ] {
        let mesh = generate(shape, 1_000);
        let (cut, _) = cut(&mesh);
        assert_eq!(cut.mesh, mesh);
        assert!(cut.seam_edges.is_empty());
    }
}

#[test]
fn spheres_are_slit_from_end_to_end() {
    let (_, length) = cut(&generate(Shape::Sphere, 5_000));
    assert!((3.0..3.7).contains(&length), "{length}");
    let (_, length) = cut(&generate(Shape::RoundedCube, 5_000));
    assert!((3.5..6.0).contains(&length), "{length}");
    // A rod: along all of its length.
    let (_, length) = cut(&voxels(&[&["##########"]], 2));
    assert!((10.0..13.0).contains(&length), "{length}");
}

#[test]
fn the_smallest_closed_surfaces() {
    let mut tetrahedron = generate(Shape::Sphere, 20);
    tetrahedron.positions.truncate(4);
    tetrahedron.simplices = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let (two_edges, _) = cut(&tetrahedron);
    assert_eq!(two_edges.seam_edges.len(), 2);
    // Möbius's (Császár's) torus: seven vertices, every two joined.
    let mut torus = generate(Shape::Torus, 100);
    torus.positions.truncate(7);
    torus.simplices = (0..7)
        .flat_map(|i| [[i, (i + 1) % 7, (i + 3) % 7], [i, (i + 3) % 7, (i + 2) % 7]])
        .collect();
    assert_eq!(Topology::new(&torus).unwrap().genus(), 1);
    cut(&torus);
    for layers in [
        &[&["###", "#.#", "###"][..]][..],
        &[&["##"], &["##"]],
        &[&["#"]],
    ] {
        cut(&voxels(layers, 1));
    }
}

#[test]
fn handles_are_cut_by_short_loops() {
    // A torus needs its meridian (0.8 π) and a longitude (inside 1.2 π).
    let (_, length) = cut(&generate(Shape::Torus, 10_000));
    let shortest = (0.8 + 1.2) * std::f64::consts::PI;
    assert!(
        (0.95 * shortest..1.2 * shortest).contains(&length),
        "{length}"
    );
    // Two holes of a unit block: four loops of four units each would do.
    let (_, length) = cut(&double_torus(6));
    assert!((10.0..19.0).contains(&length), "{length}");
    let frame: &[&str] = &["###", "#.#", "###"];
    let posts: &[&str] = &["#.#", "...", "#.#"];
    let (_, length) = cut(&voxels(&[frame, posts, frame], 4));
    assert!(length < 45.0, "{length}");
}

#[test]
fn boundaries_are_joined_by_short_arcs() {
    // A tube: one arc, straight along it.
    let tube = without(&voxels(&[&["########"]], 3), |_, c| {
        c.x == 0.0 || c.x == 8.0
    });
    let (tube_cut, length) = cut(&tube);
    assert!((length - 8.0).abs() < 1e-9, "{length}");
    assert_eq!(tube_cut.seam_edges.len(), 24);
    // A plate with nine holes, in a row near one side: nine short bridges.
    let near = |x: f64, hole: f64| (x - hole).abs() < 0.02;
    let plate = without(&generate(Shape::Terrain, 20_000), |_, c| {
        (1..10).any(|i| near(c.x, -1.0 + 0.2 * f64::from(i))) && near(c.y, 0.9)
    });
    let topology = Topology::new(&plate).unwrap();
    assert_eq!(topology.boundary_loops().len(), 10);
    let (_, length) = cut(&plate);
    assert!(length < 9.0 * 0.14, "{length}");
    // Handles and holes together.
    let (mixed, _) = cut(&without(&double_torus(4), |i, _| i % 91 == 0));
    assert!(!mixed.seam_edges.is_empty());
    // A torus with one triangle missing needs no arc to it from elsewhere: both loops start there.
    cut(&without(&generate(Shape::Torus, 3_000), |i, _| i == 1_234));
}

#[test]
fn several_components_are_refused() {
    let mesh = both(&generate(Shape::Torus, 100), &generate(Shape::Torus, 100));
    let error = cut_to_disk(&mesh, &Topology::new(&mesh).unwrap()).unwrap_err();
    assert_eq!(error.code(), "several-components");
}

#[test]
fn the_order_of_vertices_and_faces_does_not_matter() {
    let holes = without(&generate(Shape::Torus, 2_000), |i, _| i == 100 || i == 900);
    for mut mesh in [double_torus(4), generate(Shape::Sphere, 2_000), holes] {
        jitter(&mut mesh, 0.01);
        let (first, length) = cut(&mesh);
        for seed in 1..6 {
            let (other, other_length) = cut(&shuffled(&mesh, seed));
            assert_eq!(first.seam_edges.len(), other.seam_edges.len());
            assert!(
                (length - other_length).abs() < 1e-9,
                "{length} {other_length}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    /// Any manifold blob of cubes, with any faces missing.
    #[test]
    fn random_surfaces(
        cells in prop::collection::vec(any::<bool>(), 36),
        missing in prop::collection::vec(any::<prop::sample::Index>(), 0..5),
        n in 1i64..3,
    ) {
        let rows: Vec<String> = cells
            .chunks(4)
            .map(|row| row.iter().map(|&c| if c { '#' } else { '.' }).collect())
            .collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let layers: Vec<&[&str]> = rows.chunks(3).collect();
        let mut mesh = voxels(&layers, n);
        for index in missing {
            if mesh.simplices.len() > 1 {
                mesh.simplices.remove(index.index(mesh.simplices.len()));
            }
        }
        if let Ok(prepared) = prepare(&mesh) {
            // Of several components, each alone.
            for component in 0..prepared.topology.components() as u32 {
                let labels = prepared.topology.face_components();
                let one = without(&prepared.mesh, |face, _| labels[face] != component);
                cut(&one);
            }
        }
    }
}
