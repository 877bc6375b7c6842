//! The five problems of the ABCD set (Naitsat, Zhu & Zeevi 2020) with default options.
//!
//! They are not part of the repository; where the folder `../shared/data/untangle` is missing, the test says so
//! and passes.

use foldfree::certificate::{orientation, orientation_of_tetrahedron};
use foldfree::deformation::{Material, Untangling};
use foldfree::gini::GiniOptions;
use foldfree::mesh::io::{Format, read, read_solid};
use foldfree::optim::Status;
use std::fs;
use std::io::Read;
use std::path::Path;

fn unpacked(path: &Path) -> Vec<u8> {
    let bytes = fs::read(path).expect("readable");
    let mut text = Vec::new();
    flate2::read::MultiGzDecoder::new(&bytes[..])
        .read_to_end(&mut text)
        .expect("gzip");
    text
}

fn untangle(folder: &Path, in_plane: bool) -> usize {
    let [rest, init] = ["rest", "init"].map(|f| unpacked(&folder.join(format!("{f}.mesh.gz"))));
    let pins = fs::read_to_string(folder.join("pins.txt")).expect("pins");
    let pins: Vec<u32> = pins
        .lines()
        .map(|l| l.trim().parse().expect("an index"))
        .collect();
    let options = GiniOptions::default();
    let (mut untangling, elements) = if in_plane {
        let mesh = |bytes: &[u8]| read(bytes, Format::Medit).expect("a mesh").mesh;
        let (rest, init) = (mesh(&rest), mesh(&init).positions);
        let made = Untangling::of_plane(&rest, &init, &pins, &[], Material::Arap, &options);
        let corners: Vec<Vec<u32>> = rest.simplices.iter().map(|t| t.to_vec()).collect();
        (made.expect("built"), corners)
    } else {
        let mesh = |bytes: &[u8]| read_solid(bytes, Format::Medit).expect("a solid").mesh;
        let (rest, init) = (mesh(&rest), mesh(&init).positions);
        let made = Untangling::of_solid(&rest, &init, &pins, &[], Material::Arap, &options);
        let corners: Vec<Vec<u32>> = rest.simplices.iter().map(|t| t.to_vec()).collect();
        (made.expect("built"), corners)
    };
    let start = untangling.positions();
    while untangling.solver().status() == Status::Running {
        untangling.step().expect("steps");
    }
    let x = untangling.positions();
    for &pin in &pins {
        assert_eq!(x[pin as usize], start[pin as usize], "pins stay");
    }
    // the orientation of all elements is that of the first
    let sign = |c: &[u32]| {
        let at = |i: usize| x[c[i] as usize];
        match in_plane {
            true => orientation(at(0).truncate(), at(1).truncate(), at(2).truncate()),
            false => orientation_of_tetrahedron(at(0), at(1), at(2), at(3)),
        }
    };
    let first = sign(&elements[0]);
    assert!(first.is_ne());
    elements.iter().filter(|c| sign(c) != first).count()
}

#[test]
fn the_five_published_problems_are_untangled() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/untangle");
    if !folder.is_dir() {
        eprintln!("{} is not there: nothing is tested", folder.display());
        return;
    }
    for (name, in_plane) in [
        ("elephant_2k", true),
        ("elephant_30k", true),
        ("bar12k", false),
        ("bar30k", false),
        ("wrench", false),
    ] {
        assert_eq!(untangle(&folder.join(name), in_plane), 0, "{name}");
    }
}
