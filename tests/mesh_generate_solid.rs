//! The sample solids are what they say: in one piece, conforming, of the right size and volume, with
//! manifold boundaries and bounded angles; so is whatever isosurface stuffing fills.

mod mesh_common;

use foldfree::mesh::generate::{StuffingError, stuff};
use foldfree::mesh::{SolidMesh, SolidShape, SurfaceMesh, Topology, generate_solid};
use glam::DVec3;
use mesh_common::Random;
use proptest::prelude::*;
use std::collections::BTreeMap;

const IMPLICIT: [SolidShape; 3] = [SolidShape::Hand, SolidShape::Creature, SolidShape::Letters];

fn corners(mesh: &SolidMesh, tetrahedron: [u32; 4]) -> [DVec3; 4] {
    tetrahedron.map(|v| mesh.positions[v as usize])
}

fn volumes(mesh: &SolidMesh) -> Vec<f64> {
    let volume = |&t: &[u32; 4]| {
        let [a, b, c, d] = corners(mesh, t);
        (b - a).cross(c - a).dot(d - a) / 6.0
    };
    mesh.simplices.iter().map(volume).collect()
}

/// The least and the greatest dihedral angle, in degrees.
fn angles(mesh: &SolidMesh) -> (f64, f64) {
    let (mut least, mut greatest) = (180.0f64, 0.0f64);
    for &tetrahedron in &mesh.simplices {
        let p = corners(mesh, tetrahedron);
        for [i, j, k, l] in [
            [0, 1, 2, 3],
            [0, 2, 1, 3],
            [0, 3, 1, 2],
            [1, 2, 0, 3],
            [1, 3, 0, 2],
            [2, 3, 0, 1],
        ] {
            let edge = (p[j] - p[i]).normalize();
            let left = (p[k] - p[i]).reject_from_normalized(edge);
            let right = (p[l] - p[i]).reject_from_normalized(edge);
            let angle = left.angle_between(right).to_degrees();
            least = least.min(angle);
            greatest = greatest.max(angle);
        }
    }
    (least, greatest)
}

/// Checks that tetrahedra are positive and share whole faces, two a face at most, one on either side,
/// and that every vertex is used; gives the boundary, oriented outwards.
fn checked_boundary(mesh: &SolidMesh) -> SurfaceMesh {
    assert!(volumes(mesh).iter().all(|&volume| volume > 0.0));
    let mut used = vec![false; mesh.positions.len()];
    let mut faces: BTreeMap<[u32; 3], Vec<[u32; 3]>> = BTreeMap::new();
    for &[a, b, c, d] in &mesh.simplices {
        [a, b, c, d].iter().for_each(|&v| used[v as usize] = true);
        for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            let mut key = face;
            key.sort_unstable();
            faces.entry(key).or_default().push(face);
        }
    }
    assert!(used.iter().all(|&used| used), "an unused vertex");
    let mut boundary = Vec::new();
    for (key, sides) in faces {
        let even = |f: &[u32; 3]| (0..3).any(|k| [f[k], f[(k + 1) % 3], f[(k + 2) % 3]] == key);
        match sides[..] {
            [face] => boundary.push(face),
            [one, other] => assert_ne!(even(&one), even(&other), "both on one side of {key:?}"),
            _ => panic!("{} tetrahedra at face {key:?}", sides.len()),
        }
    }
    SurfaceMesh {
        positions: mesh.positions.clone(),
        simplices: boundary,
    }
}

/// The boundary is closed, every edge in two triangles and every vertex in one fan.
fn check_manifold(mesh: &SolidMesh) -> Topology {
    let boundary = checked_boundary(mesh);
    let topology = Topology::new(&boundary).expect("a manifold");
    assert!(topology.is_closed());
    topology
}

/// Pieces, two tetrahedra hanging together where they share a face.
fn pieces(mesh: &SolidMesh) -> usize {
    let mut faces: BTreeMap<[u32; 3], usize> = BTreeMap::new();
    let mut parents: Vec<usize> = (0..mesh.simplices.len()).collect();
    fn root(parents: &mut [usize], mut i: usize) -> usize {
        while parents[i] != i {
            parents[i] = parents[parents[i]];
            i = parents[i];
        }
        i
    }
    for (i, &[a, b, c, d]) in mesh.simplices.iter().enumerate() {
        for mut face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            face.sort_unstable();
            if let Some(&other) = faces.get(&face) {
                let (i, other) = (root(&mut parents, i), root(&mut parents, other));
                parents[i] = other;
            }
            faces.insert(face, i);
        }
    }
    (0..parents.len()).filter(|&i| parents[i] == i).count()
}

fn bounds(mesh: &SolidMesh) -> [DVec3; 2] {
    let start = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    mesh.positions
        .iter()
        .fold(start, |[low, high], &p| [low.min(p), high.max(p)])
}

#[test]
fn solids_are_whole_conforming_and_of_the_size_asked_for() {
    for shape in SolidShape::ALL {
        for wanted in [0, 300, 500, 700, 1_000, 2_000, 5_000, 20_000] {
            let mesh = generate_solid(shape, wanted);
            let name = format!("{} {wanted}", shape.name());
            let topology = check_manifold(&mesh);
            assert_eq!(pieces(&mesh), 1, "{name}");
            // One closed surface, or a hole inside would be a second one.
            assert_eq!(topology.components(), 1, "{name}");
            let [low, high] = bounds(&mesh);
            assert!((low + high).abs().max_element() < 3e-7, "{name}: centred");
            let width = (high - low).max_element();
            let solid = !IMPLICIT.contains(&shape);
            assert!((0.8..2.6).contains(&width), "{name}: {width} wide");
            let count = mesh.simplices.len();
            let (least, greatest) = angles(&mesh);
            println!("{name}: {count} tetrahedra, angles {least:.1} to {greatest:.1}");
            if wanted >= 500 {
                let tolerance = if shape == SolidShape::Disk { 0.2 } else { 0.15 };
                let ratio = count as f64 / wanted as f64;
                assert!((ratio - 1.0).abs() <= tolerance, "{name}: {count}");
                let range = if solid { 25.0..130.0 } else { 10.7..164.8 };
                assert!(range.contains(&least), "{name}: {least}");
                assert!(range.contains(&greatest), "{name}: {greatest}");
            }
        }
    }
}

#[test]
fn volumes_are_right() {
    for (shape, exact) in [
        (SolidShape::Bar, 0.5),
        (SolidShape::Beam, 2.0 / 36.0),
        (SolidShape::Box, 8.0),
    ] {
        for wanted in [500, 3_000] {
            let volume: f64 = volumes(&generate_solid(shape, wanted)).iter().sum();
            // Coordinates are rounded to 1e-7.
            assert!((volume / exact - 1.0).abs() < 1e-6, "{shape:?}: {volume}");
        }
    }
    // Inscribed in the cylinder, with an error of second order in the width of a ring.
    let exact = 0.2 * std::f64::consts::PI;
    let error = |wanted| {
        let volume: f64 = volumes(&generate_solid(SolidShape::Disk, wanted))
            .iter()
            .sum();
        (exact - volume) / exact
    };
    let errors = [500, 4_000, 32_000].map(error);
    println!("disk: relative errors {errors:?}");
    assert!(errors[0] < 1e-2 && errors[1] < errors[0] / 3.0 && errors[2] < errors[1] / 3.0);
    assert!(errors[2] > 0.0);
    // An implicit solid: finer ones differ by less and less.
    for shape in IMPLICIT {
        let volume = |wanted| volumes(&generate_solid(shape, wanted)).iter().sum::<f64>();
        let [coarse, middle, fine] = [4_000, 12_000, 36_000].map(volume);
        println!("{}: volumes {coarse} {middle} {fine}", shape.name());
        assert!((middle - fine).abs() < (coarse - fine).abs(), "{shape:?}");
        assert!((middle / fine - 1.0).abs() < 0.03, "{shape:?}");
    }
}

#[test]
fn implicit_solids_have_the_genus_of_their_figure() {
    // A hand and a creature are balls, and so are the letters: their crossbar closes no ring.
    for shape in IMPLICIT {
        let topology = check_manifold(&generate_solid(shape, 15_000));
        assert_eq!(topology.genus(), 0, "{shape:?}");
    }
}

fn ball(radius: f64) -> impl Fn(DVec3) -> f64 {
    move |p| p.length() - radius
}

#[test]
fn stuffing_a_ball_converges() {
    let exact = 4.0 / 3.0 * std::f64::consts::PI;
    let bounds = [DVec3::splat(-1.0), DVec3::splat(1.0)];
    let errors = [0.4, 0.2, 0.1].map(|spacing| {
        let mesh = stuff(ball(1.0), bounds, spacing).unwrap();
        let topology = check_manifold(&mesh);
        assert_eq!((topology.components(), topology.genus()), (1, 0));
        let boundary = checked_boundary(&mesh);
        for &v in boundary.simplices.as_flattened() {
            let radius = mesh.positions[v as usize].length();
            assert!((radius - 1.0).abs() < 1e-8, "{radius}");
        }
        1.0 - volumes(&mesh).iter().sum::<f64>() / exact
    });
    println!("relative errors {errors:?}");
    // Second order: halving the spacing divides the error by about four.
    assert!(errors[1] < errors[0] / 3.0 && errors[2] < errors[1] / 3.0 && errors[2] > 0.0);
}

#[test]
fn stuffing_does_not_depend_on_the_scale_or_the_place() {
    // Powers of two: the same bits. Otherwise the same but for rounding.
    let blob = Blob::new(7, 6);
    let plain = blob.fill(0.17, 1.0, DVec3::ZERO);
    for (scale, shift, tolerance) in [
        (1024.0, DVec3::ZERO, 0.0),
        (1.0 / 64.0, DVec3::ZERO, 0.0),
        (1e-6, DVec3::ZERO, 1e-7),
        (3.7e5, DVec3::ZERO, 1e-7),
        (1.0, DVec3::new(12.3, -4.5, 67.8), 1e-7),
    ] {
        let mesh = blob.fill(0.17, scale, shift);
        assert_eq!(mesh.simplices, plain.simplices, "{scale} {shift}");
        for (p, q) in mesh.positions.iter().zip(&plain.positions) {
            let error = ((*p - shift) / scale - *q).length();
            assert!(error <= tolerance, "{scale} {shift}: {error}");
        }
    }
}

#[test]
fn stuffing_refuses_nonsense() {
    let unit = [DVec3::ZERO, DVec3::ONE];
    let fill = |bounds, spacing| stuff(ball(1.0), bounds, spacing);
    for spacing in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = fill(unit, spacing).unwrap_err();
        assert!(matches!(error, StuffingError::Spacing { .. }), "{error}");
    }
    for bounds in [
        [DVec3::ONE, DVec3::ZERO],
        [DVec3::ZERO, DVec3::INFINITY],
        [DVec3::NAN, DVec3::ONE],
    ] {
        assert_eq!(fill(bounds, 0.1), Err(StuffingError::Bounds));
    }
    for spacing in [1e-4, 1e-300] {
        let error = fill(unit, spacing).unwrap_err();
        assert!(matches!(error, StuffingError::TooFine { .. }), "{error}");
    }
    // Nothing inside, and a solid that is larger than its bounds.
    assert_eq!(stuff(|_| 1.0, unit, 0.1), Ok(SolidMesh::default()));
    assert_eq!(stuff(|_| f64::NAN, unit, 0.1), Ok(SolidMesh::default()));
    let block = stuff(ball(50.0), unit, 0.25).unwrap();
    check_manifold(&block);
}

#[test]
fn names_and_words() {
    for shape in SolidShape::ALL {
        assert_eq!(SolidShape::from_name(shape.name()), Some(shape));
        assert!(shape.describe().ends_with('.') && !shape.title().is_empty());
        // The command line takes both kinds by name.
        assert_eq!(foldfree::mesh::Shape::from_name(shape.name()), None);
        assert_eq!(generate_solid(shape, 900), generate_solid(shape, 900));
    }
    assert_eq!(SolidShape::from_name("teapot"), None);
}

/// Balls and capsules at random, smoothly joined: thin necks, near misses and all.
struct Blob {
    capsules: Vec<(DVec3, DVec3, f64)>,
    blend: f64,
}

impl Blob {
    fn new(seed: u64, count: usize) -> Self {
        let mut random = Random(seed);
        let mut unit = || (random.next() >> 11) as f64 / (1u64 << 53) as f64;
        let mut point = || DVec3::new(unit(), unit(), unit()) * 1.6 - 0.8;
        let ends: Vec<[DVec3; 2]> = (0..count).map(|_| [point(), point()]).collect();
        Self {
            capsules: ends
                .into_iter()
                .map(|[a, b]| (a, b, 0.03 + 0.27 * unit()))
                .collect(),
            blend: 0.01 + 0.2 * unit(),
        }
    }

    fn value(&self, p: DVec3) -> f64 {
        let mut value = f64::INFINITY;
        for &(a, b, radius) in &self.capsules {
            let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            let distance = p.distance(a.lerp(b, along)) - radius;
            let overlap = (self.blend - (value - distance).abs()).max(0.0);
            value = value.min(distance) - overlap * overlap / (4.0 * self.blend);
        }
        value
    }

    /// Fills it, larger by `scale` and moved by `shift`.
    fn fill(&self, spacing: f64, scale: f64, shift: DVec3) -> SolidMesh {
        let bounds = [-1.2, 1.2].map(|c| DVec3::splat(c) * scale + shift);
        let f = |p: DVec3| self.value((p - shift) / scale) * scale;
        stuff(f, bounds, spacing * scale).unwrap()
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn stuffed_blobs_conform_with_bounded_angles_and_manifold_boundaries(
        seed in any::<u64>(),
        count in 1usize..8,
        spacing in 0.08f64..0.5,
    ) {
        let mesh = Blob::new(seed, count).fill(spacing, 1.0, DVec3::ZERO);
        if mesh.simplices.is_empty() {
            return Ok(());
        }
        check_manifold(&mesh);
        let (least, greatest) = angles(&mesh);
        prop_assert!(least > 10.7 && greatest < 164.8, "{least} to {greatest}");
    }
}
