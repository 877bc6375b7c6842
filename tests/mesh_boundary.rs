//! The surface of a solid: what is in it, which way it faces, and what it is not made of.

mod mesh_common;
mod mesh_encode;

use foldfree::mesh::{MeshError, SolidMesh, prepare};
use glam::DVec3;
use mesh_common::Random;
use mesh_encode::block;

fn solid(simplices: &[[u32; 4]]) -> SolidMesh {
    let n = simplices.iter().flatten().max().map_or(0, |v| v + 1);
    let position = |v: u32| DVec3::new(v.into(), f64::from(v * v % 7), f64::from(v * v * v % 11));
    SolidMesh {
        positions: (0..n).map(position).collect(),
        simplices: simplices.to_vec(),
    }
}

fn volume(mesh: &SolidMesh) -> f64 {
    let of = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(c - a).dot(d - a) / 6.0
    };
    mesh.simplices.iter().map(of).sum()
}

#[test]
fn one_tetrahedron() {
    let mesh = SolidMesh {
        positions: vec![DVec3::ONE, DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
        simplices: vec![[1, 2, 3, 4]],
    };
    assert!(volume(&mesh) > 0.0);
    let boundary = mesh.boundary().unwrap();
    assert_eq!(boundary.vertices, [1, 2, 3, 4]);
    assert_eq!(boundary.tetrahedra, [0; 4]);
    assert_eq!(boundary.mesh.positions, mesh.positions[1..]);
    let centre = DVec3::splat(0.25);
    for triangle in &boundary.mesh.simplices {
        let [a, b, c] = triangle.map(|v| boundary.mesh.positions[v as usize]);
        assert!((b - a).cross(c - a).dot(a - centre) > 0.0, "{triangle:?}");
    }
}

#[test]
fn the_volume_within_is_that_of_the_elements() {
    for n in 1..5 {
        let mesh = block(n).solid();
        let boundary = mesh.boundary().unwrap();
        assert_eq!(boundary.mesh.simplices.len() as u32, 12 * n * n);
        assert_eq!(boundary.mesh.positions.len() as u32, 6 * n * n + 2);
        // The divergence theorem, from a corner: the block is far from the origin.
        let origin = mesh.positions[0];
        let flux = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| boundary.mesh.positions[v as usize] - origin);
            a.dot(b.cross(c)) / 6.0
        };
        let enclosed: f64 = boundary.mesh.simplices.iter().map(flux).sum();
        let expected = (0.3 * f64::from(n)).powi(3);
        assert!((enclosed - expected).abs() < 1e-8 * expected, "{enclosed}");
        assert!((volume(&mesh) - expected).abs() < 1e-8 * expected);
        // It is a closed surface, consistently oriented already.
        let prepared = prepare(&boundary.mesh).unwrap();
        assert!(prepared.notes.is_empty(), "{:?}", prepared.notes);
        assert_eq!(prepared.topology.euler_characteristic(), 2);
        assert!(prepared.topology.boundary_loops().is_empty());
        for (triangle, &t) in boundary.mesh.simplices.iter().zip(&boundary.tetrahedra) {
            let corners = mesh.simplices[t as usize];
            let original = triangle.map(|v| boundary.vertices[v as usize]);
            assert!(original.iter().all(|v| corners.contains(v)));
        }
        assert!(boundary.tetrahedra.is_sorted());
        assert!(boundary.vertices.is_sorted());
    }
}

#[test]
fn the_order_of_elements_and_vertices_does_not_matter() {
    let mesh = block(3).solid();
    let key = |mesh: &SolidMesh| {
        let boundary = mesh.boundary().unwrap();
        let corners = |t: &[u32; 3]| {
            let mut points = t.map(|v| boundary.mesh.positions[v as usize].to_array());
            let least = (0..3).min_by(|&i, &j| points[i].partial_cmp(&points[j]).unwrap());
            points.rotate_left(least.unwrap());
            points.map(|p| p.map(f64::to_bits))
        };
        let mut triangles: Vec<_> = boundary.mesh.simplices.iter().map(corners).collect();
        triangles.sort_unstable();
        triangles
    };
    let mut random = Random(7);
    let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    random.shuffle(&mut order);
    let mut shuffled = mesh.clone();
    for (old, &new) in order.iter().enumerate() {
        shuffled.positions[new as usize] = mesh.positions[old];
    }
    for tetrahedron in &mut shuffled.simplices {
        // An even permutation of the corners as well.
        let [a, b, c, d] = tetrahedron.map(|v| order[v as usize]);
        *tetrahedron = [[a, b, c, d], [b, c, a, d], [d, c, b, a]][random.next() as usize % 3];
    }
    random.shuffle(&mut shuffled.simplices);
    assert_eq!(key(&shuffled), key(&mesh));
    assert_eq!(mesh.boundary(), mesh.boundary());
}

#[test]
fn cavities_have_a_surface_of_their_own() {
    let mut mesh = block(3).solid();
    // The cell in the middle: six tetrahedra in the order of the cells.
    let middle = 6 * (1 + 3 * (1 + 3));
    mesh.simplices.drain(middle..middle + 6);
    let prepared = prepare(&mesh.boundary().unwrap().mesh).unwrap();
    assert_eq!(prepared.topology.components(), 2);
    assert_eq!(prepared.mesh.simplices.len(), 12 * 9 + 12);
}

#[test]
fn what_is_not_a_solid_is_named() {
    let error = |simplices: &[[u32; 4]]| solid(simplices).boundary().unwrap_err();
    assert_eq!(error(&[]), MeshError::Empty);
    assert_eq!(
        error(&[[0, 1, 2, 3], [4, 5, 6, 4]]),
        MeshError::RepeatedVertex { face: 1, vertex: 4 }
    );
    let three = error(&[[0, 1, 2, 3], [0, 2, 1, 4], [5, 1, 0, 2]]);
    assert_eq!(
        three,
        MeshError::NonManifoldFace {
            vertices: [0, 1, 2],
            tetrahedra: 3
        }
    );
    assert_eq!(three.code(), "non-manifold-face");
    assert_eq!(three.to_string(), "face 0–1–2 belongs to 3 tetrahedra");
    let mut mesh = solid(&[[0, 1, 2, 3]]);
    mesh.positions.truncate(3);
    assert_eq!(
        mesh.boundary().unwrap_err(),
        MeshError::IndexOutOfRange {
            face: 0,
            index: 3,
            vertices: 3
        }
    );
}
