//! The paper's meshes: as few iterations as the authors' code needs, and the same energies.
//!
//! The meshes are not part of the repository; where the folder `../shared/data/parameterization` is
//! missing, nothing is tested. Iterations and energies are those of the authors' code (Brown &
//! Narain 2021, github.com/georgbrown/wrapd-2d), with 15 % to spare.

mod flattening;

use flattening::Run;
use foldfree::mesh::SurfaceMesh;
use foldfree::mesh::io::{Format, read};
use foldfree::parameterization::ParameterizationOptions;
use std::io::Read;
use std::path::Path;

fn load(name: &str) -> Option<SurfaceMesh> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/parameterization");
    let Ok(compressed) = std::fs::read(folder.join(format!("{name}.obj.gz"))) else {
        println!("skipped: {name} is not in {}", folder.display());
        return None;
    };
    let mut bytes = Vec::new();
    flate2::read::GzDecoder::new(&compressed[..])
        .read_to_end(&mut bytes)
        .unwrap();
    Some(read(&bytes, Format::Obj).unwrap().mesh)
}

/// `percent`, `millionth`: most iterations to 1.01 E* and to (1 + 1e-6) E*.
fn check(name: &str, optimum: f64, percent: usize, millionth: usize) {
    let Some(mesh) = load(name) else {
        return;
    };
    let options = ParameterizationOptions {
        tolerance: 1e-12,
        max_iterations: 5000,
        ..Default::default()
    };
    let run = Run::new(&mesh, &options);
    let run = run.while_true(|r| {
        let there = r.inverted == 0 && r.energy <= (1.0 + 1e-6) * optimum;
        !there && r.iteration <= millionth
    });
    let counts = [1e-2, 1e-6].map(|d| run.reaches((1.0 + d) * optimum));
    println!(
        "{name}: {counts:?} iterations, energy {}",
        run.last().energy
    );
    assert!(
        counts[0].is_some_and(|k| k <= percent),
        "{name}: {counts:?}"
    );
    assert!(
        counts[1].is_some_and(|k| k <= millionth),
        "{name}: {counts:?}"
    );

    // the energy is that of the certificate, which is computed from scratch in the input's units
    let last = run.last();
    let certificate = run.parameterization.certificate();
    assert!(
        (last.energy - optimum).abs() <= 1e-6 * optimum,
        "{}",
        last.energy
    );
    assert!((certificate.symmetric_dirichlet - last.energy).abs() <= 1e-9);
    assert!(last.inverted == 0 && certificate.inverted.is_empty());
    assert!(certificate.degenerate.is_empty() && certificate.locally_injective);
}

#[test]
fn bull() {
    check("bull", 1.0128375275, 8, 150);
}

#[test]
fn hilbert() {
    check("hilbert", 1.0, 26, 400);
}

#[test]
fn horse() {
    check("horse", 1.0223209521, 7, 69);
}
