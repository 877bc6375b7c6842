//! The paper's meshes by composite majorization: the iterations that the authors' code (Shtengel et al. 2017,
//! in that of Brown & Narain 2021) needs to (1 + 1e-6) E*, and a little more, without an inverted iterate.
//!
//! The meshes are not part of the repository; where the folder `../shared/data/parameterization` is
//! missing, nothing is tested.

mod flattening;

use flattening::{Run, endless};
use foldfree::mesh::SurfaceMesh;
use foldfree::mesh::io::{Format, read};
use foldfree::parameterization::Method;
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

/// Most iterations of either method.
fn check(name: &str, optimum: f64, alone: usize, after_wrapd: usize) {
    let Some(mesh) = load(name) else {
        return;
    };
    for (method, most) in [(Method::Cm, alone), (Method::WrapdCm, after_wrapd)] {
        let bound = (1.0 + 1e-6) * optimum;
        let run = Run::new(&mesh, &endless(method));
        let run = run.while_true(|r| r.energy > bound || r.inverted > 0 || r.iteration == 0);
        let (last, from) = (run.last(), run.last().switched_at.unwrap_or(0));
        println!(
            "{name} {method:?}: {} iterations, {from} of WRAPD",
            last.iteration
        );
        assert!(
            last.iteration <= most,
            "{name} {method:?}: {}",
            last.iteration
        );
        for pair in run.reports[from..].windows(2) {
            assert!(pair[1].energy <= pair[0].energy && pair[1].energy.is_finite());
            assert_eq!(pair[1].inverted, 0, "{name} {method:?}");
        }
        assert!(run.parameterization.certificate().inverted.is_empty());
    }
}

#[test]
fn bull() {
    check("bull", 1.0128375275, 30, 20);
}

#[test]
fn hilbert() {
    check("hilbert", 1.0, 80, 20);
}

#[test]
fn horse() {
    check("horse", 1.0223209521, 60, 20);
}
