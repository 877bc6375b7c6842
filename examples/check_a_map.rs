//! Checks maps exactly: a strip rolled out along an arc, with one vertex moved, and turned too far.
//!
//! `cargo run --example check_a_map`

use foldfree::certificate::Certificate;
use foldfree::mesh::SurfaceMesh;
use glam::{DVec2, DVec3};

/// A flat strip of `n` quads, and its map to an arc of that many radians.
fn strip(n: u32, angle: f64) -> (SurfaceMesh, Vec<DVec2>) {
    let mut mesh = SurfaceMesh::default();
    let mut uv = Vec::new();
    for i in 0..=n {
        let t = f64::from(i) / f64::from(n);
        for width in [-0.1, 0.1] {
            mesh.positions.push(DVec3::new(5.0 * t, -width, 0.0));
            uv.push(DVec2::from_angle(angle * t) * (1.0 + width));
        }
    }
    for i in 0..n {
        let [a, b, c, d] = [2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2];
        mesh.simplices.extend([[a, b, c], [a, c, d]]);
    }
    (mesh, uv)
}

fn main() {
    let (mesh, uv) = strip(100, 5.0);
    println!("An arc: {}\n", Certificate::of_map(&mesh, &uv).summary());

    let mut folded = uv.clone();
    folded[100] = DVec2::new(0.9, 0.0);
    let certificate = Certificate::of_map(&mesh, &folded);
    println!("One vertex moved: {}", certificate.summary());
    println!("Inverted triangles: {:?}\n", certificate.inverted);

    let (mesh, uv) = strip(100, 7.0);
    let certificate = Certificate::of_map(&mesh, &uv);
    println!("More than a full turn: {}", certificate.summary());
    for crossing in certificate.boundary_crossings.iter().take(3) {
        println!("  {:?}: edges {:?}", crossing.kind, crossing.edges);
    }
}
