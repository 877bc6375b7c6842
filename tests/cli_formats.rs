//! The commands on files of every format.
#![cfg(feature = "cli")]

mod cli_support;
mod mesh_encode;

use cli_support::Folder;
use foldfree::mesh::io::{
    Format, read, read_node, read_solid, write, write_ele, write_node, write_solid,
};
use mesh_encode::{block, samples};

const ENDINGS: [&str; 7] = ["obj", "off", "ply", "stl", "mesh", "msh", "vtk"];

#[test]
fn surfaces_are_flattened_and_checked_from_every_format() {
    let folder = Folder::new("formats");
    assert_eq!(Format::ALL.map(Format::name), ENDINGS);
    for ending in ENDINGS {
        for packed in ["", ".gz"] {
            let line = format!("generate terrain --triangles 200 --out t.{ending}{packed}");
            folder.foldfree(&line).ends(0);
        }
        let line = format!("parameterize t.{ending}.gz --out map.obj --threads 1");
        let ran = folder.foldfree(&line).ends(0);
        assert!(ran.stdout.contains("Converged"), "{ran:#?}");
        assert_eq!(ran.stdout.contains("welded"), ending == "stl", "{ran:#?}");
        folder
            .foldfree(&format!("check map.obj --rest t.{ending}"))
            .ends(0);
    }
    // A plane file is a map of the surface it is compared with.
    let flat = "MeshVersionFormatted 2\nDimension 2\nVertices 4\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n\
                Triangles 2\n1 2 3 0\n1 3 4 0\nEnd\n";
    folder.write("flat.mesh", flat);
    folder.foldfree("check flat.mesh --rest flat.mesh").ends(0);
    folder.write("folded.mesh", flat.replace("\n0 2 0", "\n2 0.5 0"));
    folder
        .foldfree("check folded.mesh --rest flat.mesh")
        .ends(2);
}

#[test]
fn solids_are_deformed_from_and_to_every_format() {
    let folder = Folder::new("solids");
    let mesh = block(2);
    let rest = mesh.solid();
    let mut start = rest.clone();
    start.positions[13].x += 0.1;
    let solids = ["mesh", "msh", "vtk"];
    for (stem, solid) in [("rest", &rest), ("start", &start)] {
        for ending in solids {
            let format = Format::from_name(ending).unwrap();
            folder.write(
                &format!("{stem}.{ending}"),
                write_solid(solid, format).unwrap(),
            );
        }
        folder.write(&format!("{stem}.node"), write_node(&solid.positions));
    }
    folder.write("rest.ele", write_ele(&rest));
    folder.write("pins.txt", "0\n1\n2\n");
    let run = "--pins pins.txt --iterations 3 --tolerance 0 --threads 1 --reference rest.msh";
    folder
        .foldfree(&format!(
            "deform --rest rest.node --init start.node {run} --out expected.node"
        ))
        .ends(2);
    let expected = read_node(&folder.read("expected.node")).unwrap().positions;
    assert_ne!(expected, start.positions);
    for ending in solids {
        let line = format!(
            "deform --rest rest.{ending} --init start.{ending} {run} --out out.{ending}.gz"
        );
        folder.foldfree(&line).ends(2);
        let mut bytes = Vec::new();
        let packed = folder.read(&format!("out.{ending}.gz"));
        std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(&packed[..]), &mut bytes)
            .unwrap();
        let out = read_solid(&bytes, Format::from_name(ending).unwrap())
            .unwrap()
            .mesh;
        assert_eq!(out.positions, expected);
        assert_eq!(out.simplices, rest.simplices);
    }
    // The surface alone.
    let line = format!("deform --rest rest.mesh --init start.node {run} --out out.ply");
    folder.foldfree(&line).ends(2);
    let surface = read(&folder.read("out.ply"), Format::Ply).unwrap().mesh;
    let boundary = rest.boundary().unwrap();
    assert_eq!(surface.simplices, boundary.mesh.simplices);
    let moved = boundary.vertices.iter().map(|&v| expected[v as usize]);
    assert_eq!(surface.positions, moved.collect::<Vec<_>>());
}

#[test]
fn the_wrong_kind_of_file_is_named() {
    let folder = Folder::new("wrong-kind");
    let mesh = block(1);
    folder.write(
        "solid.mesh",
        write_solid(&mesh.solid(), Format::Medit).unwrap(),
    );
    folder.write("surface.msh", write(&mesh.surface(), Format::Msh));
    folder.foldfree("parameterize solid.mesh").fails(&[
        "solid.mesh",
        "no triangles",
        "6 tetrahedra",
    ]);
    folder
        .foldfree("check solid.mesh")
        .fails(&["solid.mesh", "--rest"]);
    folder.foldfree("deform --init surface.msh").fails(&[
        "surface.msh",
        "no tetrahedra",
        "12 triangles",
    ]);
    folder
        .foldfree("deform --init surface.obj")
        .fails(&["surface.obj"]);
    folder
        .foldfree("deform --init a.glb")
        .fails(&["a.glb", ".node, .ele, .mesh, .msh, .vtk"]);
    folder
        .foldfree("deform --init solid.mesh --out out.glb")
        .fails(&["out.glb", "known"]);
    folder
        .foldfree("generate torus --out a.meshb")
        .fails(&["a.meshb", ".obj, .off, .ply, .stl, .mesh, .msh, .vtk"]);
    // Cut in the middle, every file is a complaint that names it, or has fewer faces.
    for sample in samples(&mesh) {
        let name = format!("cut.{}", sample.format.name());
        folder.write(&name, &sample.bytes[..sample.bytes.len() / 2]);
        folder
            .foldfree(&format!("parameterize {name}"))
            .fails(&[&name]);
    }
}
