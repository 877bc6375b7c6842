//! The sample shapes are what they say: clean, of the right topology and size, well shaped.

use foldfree::mesh::{Shape, SurfaceMesh, generate, prepare};

fn area(mesh: &SurfaceMesh, simplex: [u32; 3]) -> f64 {
    let [a, b, c] = simplex.map(|v| mesh.positions[v as usize]);
    0.5 * (b - a).cross(c - a).length()
}

/// 1 for an equilateral triangle, 0 for a degenerate one.
fn quality(mesh: &SurfaceMesh, simplex: [u32; 3]) -> f64 {
    let [a, b, c] = simplex.map(|v| mesh.positions[v as usize]);
    let squares = a.distance_squared(b) + b.distance_squared(c) + c.distance_squared(a);
    4.0 * 3f64.sqrt() * area(mesh, simplex) / squares
}

#[test]
fn shapes_are_clean_and_of_the_size_asked_for() {
    for shape in Shape::ALL {
        for wanted in [0, 100, 2_000, 20_000, 100_000] {
            let mesh = generate(shape, wanted);
            let prepared = prepare(&mesh).unwrap_or_else(|e| panic!("{shape:?} {wanted}: {e}"));
            assert!(
                prepared.notes.is_empty(),
                "{shape:?} {wanted}: {:?}",
                prepared.notes
            );
            assert_eq!(prepared.mesh, mesh);
            let topology = &prepared.topology;
            assert_eq!(topology.components(), 1);
            let (euler, loops) = match shape {
                Shape::Torus => (0, 0),
                Shape::Sphere | Shape::RoundedCube => (2, 0),
                _ => (1, 1),
            };
            assert_eq!(topology.euler_characteristic(), euler, "{shape:?} {wanted}");
            assert_eq!(topology.boundary_loops().len(), loops, "{shape:?} {wanted}");
            if wanted >= 2_000 {
                let count = mesh.simplices.len() as f64;
                let ratio = count / wanted as f64;
                // The strip grows by whole quads across.
                let coarse = shape == Shape::HilbertStrip && wanted < 20_000;
                let range = if coarse { 0.7..1.3 } else { 0.85..1.15 };
                assert!(range.contains(&ratio), "{shape:?} {wanted}: {count}");
                let worst = mesh
                    .simplices
                    .iter()
                    .map(|&s| quality(&mesh, s))
                    .fold(1.0, f64::min);
                let mean = mesh
                    .simplices
                    .iter()
                    .map(|&s| quality(&mesh, s))
                    .sum::<f64>()
                    / count;
                println!(
                    "{} {count}: worst quality {worst:.3}, mean {mean:.3}",
                    shape.name()
                );
                assert!(worst > 0.25, "{shape:?} {wanted}: {worst}");
                assert!(mean > 0.75, "{shape:?} {wanted}: {mean}");
            }
        }
    }
}

#[test]
fn closed_shapes_face_outwards_and_open_ones_upwards() {
    for shape in Shape::ALL {
        let mesh = generate(shape, 3_000);
        let mut volume = 0.0;
        let mut up = 0.0;
        for &simplex in &mesh.simplices {
            let [a, b, c] = simplex.map(|v| mesh.positions[v as usize]);
            volume += a.dot(b.cross(c)) / 6.0;
            up += (b - a).cross(c - a).z;
        }
        match shape {
            Shape::Torus | Shape::Sphere | Shape::RoundedCube => assert!(volume > 1.0, "{shape:?}"),
            Shape::Sheet | Shape::RoundSheet | Shape::Grid => {
                assert!(mesh.positions.iter().all(|p| p.z == 0.0));
                assert!(up > 0.0);
            }
            // Rolled onto a cylinder round the y axis, outside out.
            Shape::HilbertStrip => assert!(volume > 0.0),
            _ => assert!(up > 0.0, "{shape:?}"),
        }
    }
}

#[test]
fn the_hilbert_strip_is_developable() {
    // Every interior vertex has its angles sum to a full turn.
    let mesh = generate(Shape::HilbertStrip, 32_000);
    let prepared = prepare(&mesh).unwrap();
    let mut angles = vec![0.0; mesh.positions.len()];
    for &simplex in &mesh.simplices {
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[simplex[(i + k) % 3] as usize]);
            angles[simplex[i] as usize] += (b - a).angle_between(c - a);
        }
    }
    for (vertex, angle) in angles.iter().enumerate() {
        if !prepared.topology.is_boundary_vertex(vertex as u32) {
            assert!((angle - std::f64::consts::TAU).abs() < 1e-4);
        }
    }
    let edges: usize = prepared.topology.boundary_loops()[0].len();
    println!("{} triangles, {edges} boundary edges", mesh.simplices.len());
}

#[test]
fn names_and_words() {
    for shape in Shape::ALL {
        assert_eq!(Shape::from_name(shape.name()), Some(shape));
        assert!(shape.describe().ends_with('.') && !shape.title().is_empty());
    }
    assert_eq!(Shape::from_name("teapot"), None);
    assert_eq!(
        generate(Shape::Terrain, 5_000),
        generate(Shape::Terrain, 5_000)
    );
}
