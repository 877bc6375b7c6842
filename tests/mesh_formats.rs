//! Every mesh format: round trips bit by bit, and forms that other programs write.

mod mesh_encode;

use foldfree::mesh::io::{
    Format, ParseErrorKind, SolidFile, SurfaceFile, read, read_ele, read_node, read_solid, write,
    write_ele, write_node, write_solid,
};
use foldfree::mesh::{Shape, SurfaceMesh, generate, prepare};
use glam::DVec3;
use mesh_encode::{Mixed, block, samples};
use proptest::prelude::*;

/// −0 and 0 are equal to `==`: compare what they are made of.
fn bits(positions: &[DVec3]) -> Vec<[u64; 3]> {
    let positions = positions.iter();
    positions.map(|p| p.to_array().map(f64::to_bits)).collect()
}

#[track_caller]
fn same<const N: usize>(
    found: &foldfree::mesh::SimplicialMesh<N>,
    expected: &foldfree::mesh::SimplicialMesh<N>,
    name: &str,
) {
    assert_eq!(bits(&found.positions), bits(&expected.positions), "{name}");
    assert_eq!(found.simplices, expected.simplices, "{name}");
}

/// The corners of the triangles: what STL keeps.
fn soup(mesh: &SurfaceMesh) -> Vec<DVec3> {
    let corners = mesh.simplices.as_flattened().iter();
    corners.map(|&v| mesh.positions[v as usize]).collect()
}

fn surface(text: impl AsRef<[u8]>, format: Format) -> SurfaceFile {
    read(text.as_ref(), format).unwrap()
}

fn solid(text: impl AsRef<[u8]>, format: Format) -> SolidFile {
    read_solid(text.as_ref(), format).unwrap()
}

#[test]
fn every_form_of_every_format_gives_the_same_mesh() {
    for n in [1, 3] {
        let mesh = block(n);
        for sample in samples(&mesh) {
            let (name, bytes) = (sample.name, &sample.bytes);
            if name == "binary stl" {
                let rounded = |p: DVec3| p.as_vec3().as_dvec3();
                let found = soup(&surface(bytes, Format::Stl).mesh);
                let expected: Vec<DVec3> = soup(&mesh.surface()).into_iter().map(rounded).collect();
                assert_eq!(found, expected);
            } else if name == "stl" {
                let file = surface(bytes, Format::Stl);
                assert_eq!(bits(&soup(&file.mesh)), bits(&soup(&mesh.surface())));
                // The vertices within the block are lost, the others are welded again.
                let vertices = mesh.solid().boundary().unwrap().vertices.len();
                assert_eq!(file.mesh.positions.len(), vertices);
                let corners = 3 * mesh.triangles.len();
                assert_eq!(
                    file.notes,
                    [format!("{corners} corners welded to {vertices} vertices")]
                );
            } else if name.starts_with("solid") {
                let error = read(bytes, sample.format).unwrap_err();
                assert_eq!(error.kind, ParseErrorKind::WrongElements);
            } else {
                same(&surface(bytes, sample.format).mesh, &mesh.surface(), name);
            }
            match read_solid(bytes, sample.format) {
                Ok(file) if name.starts_with("mixed") || name.starts_with("solid") => {
                    same(&file.mesh, &mesh.solid(), name);
                    assert!(file.notes.is_empty(), "{name}: {:?}", file.notes);
                }
                Err(error) => assert_eq!(error.kind, ParseErrorKind::WrongElements, "{name}"),
                Ok(_) => panic!("{name} has no tetrahedra"),
            }
        }
    }
}

#[test]
fn what_is_left_out_is_said() {
    let mesh = block(1);
    for sample in samples(&mesh)
        .iter()
        .filter(|s| s.name.starts_with("mixed"))
    {
        let notes = surface(&sample.bytes, sample.format).notes;
        assert_eq!(
            notes,
            ["6 tetrahedra left out: a surface was asked for"],
            "{}",
            sample.name
        );
    }
    let error = read(
        &write_solid(&mesh.solid(), Format::Msh).unwrap(),
        Format::Msh,
    )
    .unwrap_err();
    assert_eq!(
        error.what,
        "the file has no triangles, but 6 tetrahedra: it is a solid"
    );
    let error = read_solid(&write(&mesh.surface(), Format::Vtk), Format::Vtk).unwrap_err();
    assert_eq!(
        error.what,
        "the file has no tetrahedra, but 12 triangles: it is a surface"
    );
    let error = read_solid(b"OFF\n", Format::Off).unwrap_err();
    assert_eq!(error.what, "a file of format off holds no tetrahedra");
    for format in Format::ALL {
        assert_eq!(
            write_solid(&mesh.solid(), format).is_some(),
            format.holds_solids()
        );
    }
    let ply = mesh_encode::ply(&mesh, true);
    assert_eq!(
        surface(&ply, Format::Ply).notes,
        ["2 \"camera\" elements passed over"]
    );
}

#[test]
fn generated_surfaces_come_back() {
    for shape in Shape::ALL {
        let mesh = generate(shape, 300);
        for format in Format::ALL {
            let file = surface(write(&mesh, format), format);
            if format == Format::Stl {
                assert_eq!(bits(&soup(&file.mesh)), bits(&soup(&mesh)));
                let prepared = prepare(&file.mesh).unwrap();
                let original = prepare(&mesh).unwrap();
                assert_eq!(
                    prepared.topology.euler_characteristic(),
                    original.topology.euler_characteristic()
                );
            } else {
                same(&file.mesh, &mesh, format.name());
                assert!(file.notes.is_empty());
            }
        }
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1e3..1e3f64,
        proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
        Just(1e21),
        Just(-0.0),
    ]
}

fn mixed() -> impl Strategy<Value = Mixed> {
    let positions = prop::collection::vec([coordinate(), coordinate(), coordinate()], 2..30);
    positions.prop_flat_map(|positions| {
        let n = positions.len() as u32;
        let triangles = prop::collection::vec([0..n, 0..n, 0..n], 1..30);
        let tetrahedra = prop::collection::vec([0..n, 0..n, 0..n, 0..n], 1..30);
        (triangles, tetrahedra).prop_map(move |(triangles, tetrahedra)| Mixed {
            positions: positions.iter().copied().map(DVec3::from_array).collect(),
            triangles,
            tetrahedra,
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 256,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_mesh_comes_back_bit_by_bit(mesh in mixed()) {
        for sample in samples(&mesh) {
            let (name, bytes) = (sample.name, &sample.bytes);
            if name == "stl" {
                // −0 may become 0.
                prop_assert_eq!(soup(&surface(bytes, Format::Stl).mesh), soup(&mesh.surface()));
            } else if name != "binary stl" && !name.starts_with("solid") {
                same(&surface(bytes, sample.format).mesh, &mesh.surface(), name);
            }
            if name.starts_with("mixed") || name.starts_with("solid") {
                same(&solid(bytes, sample.format).mesh, &mesh.solid(), name);
            }
        }
        let nodes = read_node(&write_node(&mesh.positions)).unwrap();
        same(&read_ele(&write_ele(&mesh.solid()), nodes).unwrap(), &mesh.solid(), "node, ele");
    }
}

/// The meshes of `../shared/data/untangle`, which are not part of the repository; where the folder is
/// missing, nothing is tested.
#[test]
fn meshes_of_others_are_read() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/untangle");
    // (name, vertices, triangles, tetrahedra, inverted at the start)
    let expected = [
        ("bar12k", 2541, 0, 12000, 4502),
        ("bar30k", 6171, 0, 30000, 104),
        ("wrench", 14798, 0, 50122, 322),
        ("elephant_2k", 1105, 1796, 0, 786),
        ("elephant_30k", 15193, 28736, 0, 14038),
    ];
    for (name, vertices, triangles, tetrahedra, inverted) in expected {
        for stem in ["rest", "init"] {
            let path = folder.join(name).join(format!("{stem}.mesh.gz"));
            let Ok(file) = std::fs::File::open(&path) else {
                println!("skipped: {} is not there", path.display());
                continue;
            };
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(file), &mut bytes)
                .unwrap();
            let flipped = if triangles > 0 {
                let mesh = surface(&bytes, Format::Medit).mesh;
                assert_eq!(
                    (mesh.positions.len(), mesh.simplices.len()),
                    (vertices, triangles)
                );
                assert!(read_solid(&bytes, Format::Medit).is_err());
                let corner = |v: u32| mesh.positions[v as usize];
                let area =
                    |&[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).z;
                mesh.simplices.iter().filter(|t| area(t) <= 0.0).count()
            } else {
                let mesh = solid(&bytes, Format::Medit).mesh;
                assert_eq!(
                    (mesh.positions.len(), mesh.simplices.len()),
                    (vertices, tetrahedra)
                );
                assert!(read(&bytes, Format::Medit).is_err());
                let corner = |v: u32| mesh.positions[v as usize];
                let volume = |&[a, b, c, d]: &[u32; 4]| {
                    let [u, v, w] = [b, c, d].map(|k| corner(k) - corner(a));
                    u.cross(v).dot(w)
                };
                mesh.simplices.iter().filter(|t| volume(t) <= 0.0).count()
            };
            let expected = if stem == "rest" { 0 } else { inverted };
            // Many elements have no volume at all: rounding decides which side they are on.
            assert!(flipped.abs_diff(expected) <= 1, "{name}/{stem}: {flipped}");
        }
    }
}
