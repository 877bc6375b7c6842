//! Every mesh format: round trips bit by bit, forms that other programs write, files of a few lines by
//! hand, and what is said of files that cannot be read.

mod mesh_encode;

use foldfree::mesh::io::{
    Format, ParseErrorKind, SolidFile, SurfaceFile, read, read_ele, read_node, read_solid, write,
    write_ele, write_node, write_solid,
};
use foldfree::mesh::{Shape, SolidMesh, SurfaceMesh, generate, prepare};
use glam::DVec3;
use mesh_encode::{Bytes, Mixed, block, samples};
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

/// (line, column, kind, message).
fn fails(bytes: impl AsRef<[u8]>, format: Format) -> (usize, usize, ParseErrorKind, String) {
    let error = read(bytes.as_ref(), format).unwrap_err();
    (error.line, error.column, error.kind, error.what)
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
                assert_eq!(fails(bytes, sample.format).2, ParseErrorKind::WrongElements);
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

const SQUARE: [[f64; 3]; 4] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
];

/// The unit square of two triangles, with these forms of line ends and blanks.
#[track_caller]
fn is_square(text: &str, format: Format) {
    let mac = text.replace('\n', "\r");
    let windows = text.replace('\n', "\r\n");
    let (first, rest) = text.split_once('\n').unwrap();
    let tabs = format!("{first}\n{}", rest.replace(' ', " \t "));
    for text in [text, &windows, &mac, &tabs, text.trim_end()] {
        let file = surface(text, format);
        let positions: Vec<[f64; 3]> = file.mesh.positions.iter().map(|p| p.to_array()).collect();
        assert_eq!(positions, SQUARE, "{text}");
        assert_eq!(file.mesh.simplices, [[0, 1, 2], [0, 2, 3]], "{text}");
    }
}

#[test]
fn medit_by_hand() {
    let plane =
        "MeshVersionFormatted 1\n\nDimension 2\n\nVertices 4\n0 0 1\n1.0e0 0 1\n1 1 1\n0. 1E+0 1\n";
    is_square(
        &format!("{plane}Triangles\n2\n1 2 3 0\n1 3 4 0\nEnd\n"),
        Format::Medit,
    );
    // No reference, no End, a comment, a polygon.
    let bare = "MeshVersionFormatted\n2\nDimension\n3\nVertices\n# four\n4\n0 0 0\n1 0 0 # x\n1 1 0\n0 1 0\n";
    is_square(
        &format!("{bare}Quadrilaterals\n1\n1 2 3 4 5\n"),
        Format::Medit,
    );
    is_square(
        &format!("{bare}Edges\n1\n1 2 0\nNormals 1\n0 nan 1\nTriangles\n2\n1 2 3\n1 3 4\n"),
        Format::Medit,
    );
    let other = format!("{bare}Hexahedra\n1\n1 2 3 4 1 2 3 4 0\nPrisms\n0\nTriangles\n1\n1 2 3\n");
    assert_eq!(
        surface(other, Format::Medit).notes,
        ["1 \"Hexahedra\" section passed over"]
    );
    // Vertices alone are a solid without elements: a start or a solution.
    let file = solid(bare, Format::Medit);
    assert_eq!(
        (file.mesh.positions.len(), file.mesh.simplices.len()),
        (4, 0)
    );
}

#[test]
fn medit_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Medit);
    let head = "MeshVersionFormatted 2\nDimension 3\n";
    let three = format!("{head}Vertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\n");
    let with = |rest: &str| format!("{three}{rest}");
    assert_eq!(at("").2, Empty);
    assert_eq!(at("# nothing\n").2, Empty);
    assert_eq!(at("Dimension 3\n").2, Syntax);
    assert_eq!(at("OFF\n3 1 0\n").2, Syntax);
    assert_eq!(at("MeshVersionFormatted 2\nVertices\n0\n").2, Syntax);
    assert_eq!(at("MeshVersionFormatted 2\nDimension 4\n").2, Unsupported);
    assert_eq!(at(head).2, Truncated);
    assert_eq!(at(&format!("{head}Triangles\n1\n1 2 3 0\n")).2, Unsupported);
    assert_eq!(at(&with("Vertices\n0\n")).2, Syntax);
    assert_eq!(at(&with("12 13\n")).2, Syntax);
    assert_eq!(
        at(&with("Triangles\n1\n1 2 4 0\n")),
        (
            10,
            5,
            IndexOutOfRange,
            "vertex index 4 of 3 (the first is 1)".into()
        )
    );
    assert_eq!(at(&with("Triangles\n1\n0 1 2 0\n")).2, IndexOutOfRange);
    assert_eq!(at(&with("Triangles\n1\n-1 1 2 0\n")).2, IndexOutOfRange);
    assert_eq!(
        at(&with("Triangles\n1\n1 2 9999999999999999999999\n")).2,
        IndexOutOfRange
    );
    assert_eq!(
        at(&with("Triangles\n1\n1 2 x 0\n")),
        (10, 5, Number, "expected a vertex index, found \"x\"".into())
    );
    assert_eq!(
        at(&with("Triangles\n1\n1 2\n3 0\n")),
        (10, 4, Truncated, "a vertex index is missing".into())
    );
    let text = three.replace("1 0 0 0", "1 nan 0 0");
    assert_eq!((at(&text).0, at(&text).1, at(&text).2), (6, 3, NonFinite));
    assert_eq!(at(&three.replace("1 0 0 0", "1 1e999 0 0")).2, NonFinite);
    assert_eq!(at(&three.replace("1 0 0 0", "1 0")).0, 6);
    let huge = format!("{head}Vertices\n4000000000\n0 0 0 0\n");
    assert_eq!((at(&huge).0, at(&huge).2), (4, TooLarge));
    assert_eq!(at(&with("Tetrahedra\n18446744073709551615\n")).2, TooLarge);
    assert_eq!(
        at(&with("Triangles\n9999999999999999999\n1 2 3 0")).2,
        TooLarge
    );
    assert_eq!(
        fails([1, 0, 0, 0, 2, 0, 0, 0], Format::Medit).2,
        Unsupported
    );
}

#[test]
fn msh_by_hand() {
    let head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    let nodes = "$Nodes\n4\n5 0 0 0\n70 1e0 0.0 0\n6 1 1 0\n9 0 1 0\n$EndNodes\n";
    let triangles = "$Elements\n3\n1 1 2 0 1 5 70\n2 2 2 99 2 5 70 6\n3 2 0 5 6 9\n$EndElements\n";
    is_square(&format!("{head}{nodes}{triangles}"), Format::Msh);
    is_square(
        &format!(
            "$Comments\n$Nodes\nMSH\n$EndComments\n{head}{nodes}$Elements\n1\n1 3 2 0 1 5 70 6 9\n$EndElements\n"
        ),
        Format::Msh,
    );
    is_square(
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n1 0 0 0\n1 0 0 0 0\n$EndEntities\n\
         $Nodes\n2 4 2 80\n0 1 0 1\n2\n0 0 0\n2 1 0 3\n80\n3\n4\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n\
         $Elements\n2 3 1 3\n1 1 1 1\n1 2 80\n2 1 2 2\n2 2 80 3\n3 2 3 4\n$EndElements\n",
        Format::Msh,
    );
    let quadratic = "$Elements\n2\n1 9 0 5 70 6 5 70 6\n2 2 0 5 70 6\n$EndElements\n";
    let file = surface(format!("{head}{nodes}{quadratic}"), Format::Msh);
    assert_eq!(file.notes, ["1 element of type 9 passed over"]);
    let tetrahedron = "$Elements\n1\n1 4 2 0 0 5 70 6 9\n$EndElements\n";
    let file = solid(format!("{head}{nodes}{tetrahedron}"), Format::Msh);
    assert_eq!(file.mesh.simplices, [[0, 1, 2, 3]]);
}

#[test]
fn msh_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Msh);
    let head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
    let nodes = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
    assert_eq!(at("\n").2, Truncated);
    assert_eq!(at("OFF\n").2, Syntax);
    assert_eq!(at("$NOD\n3\n").2, Unsupported);
    assert_eq!(at(nodes).2, Syntax);
    assert_eq!(at(head).2, Truncated);
    assert_eq!(at("$MeshFormat\n4 0 8\n$EndMeshFormat\n").2, Unsupported);
    assert_eq!(at("$MeshFormat\n2.2 2 8\n$EndMeshFormat\n").2, Syntax);
    assert_eq!(at("$MeshFormat\n4.1 1 4\n$EndMeshFormat\n").2, Unsupported);
    assert_eq!(at("$MeshFormat\n4.1 1 8\nabcd\n$EndMeshFormat\n").2, Syntax);
    assert_eq!(
        at(&format!("{head}$Elements\n0\n$EndElements\n")).2,
        Unsupported
    );
    assert_eq!(at(&format!("{head}{nodes}{nodes}")).2, Syntax);
    assert_eq!(at(&format!("{head}$Else\n1 2 3\n")).2, Truncated);
    assert_eq!(
        at(&format!("{head}{}", nodes.replace("3 0 1", "2 0 1"))).3,
        "node 2 is there twice"
    );
    assert_eq!(
        at(&format!("{head}{}", nodes.replace("3 0 1", "-3 0 1"))).2,
        Number
    );
    assert_eq!(
        at(&format!("{head}{}", nodes.replace("\n3\n", "\n4\n"))).0,
        9
    );
    assert_eq!(
        at(&format!("{head}{}", nodes.replace("\n3\n", "\n2\n"))).2,
        Syntax
    );
    assert_eq!(
        at(&format!(
            "{head}{}",
            nodes.replace("\n3\n", "\n3000000000\n")
        ))
        .2,
        TooLarge
    );
    let (line, column, kind, _) = at(&format!("{head}{}", nodes.replace("2 1 0 0", "2 1 inf 0")));
    assert_eq!((line, column, kind), (7, 5, NonFinite));
    assert_eq!(
        at(&format!(
            "{head}{nodes}$Elements\n1\n1 2 2 0 0 1 2 4\n$EndElements\n"
        )),
        (12, 15, IndexOutOfRange, "there is no node 4".into())
    );
    assert_eq!(
        at(&format!(
            "{head}{nodes}$Elements\n1\n1 2 99999999999 0 0 1 2 4\n$EndElements\n"
        ))
        .2,
        Truncated
    );
    // In binary data the byte and the element are named.
    let mut bytes = Bytes::new(false, "$MeshFormat\n2.2 1 8\n");
    bytes.i32(1);
    bytes.text("\n$EndMeshFormat\n$Nodes\n2\n");
    bytes.i32(1);
    bytes.point(DVec3::ONE);
    bytes.i32(2);
    let start = bytes.out.len();
    bytes.point(DVec3::new(0.0, f64::NAN, 0.0));
    let error = read(&bytes.out, Format::Msh).unwrap_err();
    assert_eq!(
        (error.line, error.column, error.kind),
        (0, start + 9, NonFinite)
    );
    let place = start + 9;
    assert_eq!(
        error.to_string(),
        format!("byte {place}: node 1: a coordinate is not finite")
    );
    let mesh = block(1);
    for (bytes, kind) in [
        (mesh_encode::msh2(&mesh, false), Unsupported),
        (mesh_encode::msh4(&mesh, false), Unsupported),
    ] {
        // The type 4 of the first element of that type is made unknown.
        let old = [4, 0, 0, 0, 6, 0, 0, 0];
        let at = bytes.windows(8).position(|w| w == old).unwrap();
        let mut bytes = bytes.clone();
        bytes[at] = 200;
        assert_eq!(read(&bytes, Format::Msh).unwrap_err().kind, kind);
    }
}

#[test]
fn vtk_by_hand() {
    let head = "# vtk DataFile Version 2.0\nPOINTS of a title\nASCII\nDATASET";
    let points = "POINTS 4 float\n0 0 0 1.0e0 0 0\n1 1 0\n0\n1 0\n";
    let poly = format!("{head} POLYDATA\n{points}");
    let grid = format!("{head} UNSTRUCTURED_GRID\n{points}");
    is_square(
        &format!("{poly}POLYGONS 2 8\n3 0 1 2 3 0 2 3\n"),
        Format::Vtk,
    );
    is_square(
        &format!(
            "{poly}VERTICES 1 2\n1 0\nLINES 1 3\n2 0 1\npolygons 1 5\n4 0 1 2 3\nCELL_DATA 1\n"
        ),
        Format::Vtk,
    );
    is_square(
        &format!(
            "{poly}METADATA\nINFORMATION 1\nNAME x\n\nPOLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n"
        ),
        Format::Vtk,
    );
    is_square(
        &format!("{grid}CELLS 2 8\n3 0 1 2 3 0 2 3\nCELL_TYPES 2\n5\n5\nPOINT_DATA 4\njunk"),
        Format::Vtk,
    );
    is_square(
        &format!("{grid}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n9\n"),
        Format::Vtk,
    );
    is_square(
        &format!("{grid}CELLS 1 5\n4 0 1 3 2\nCELL_TYPES 1\n8\n"),
        Format::Vtk,
    );
    let strip = surface(
        format!("{poly}TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n"),
        Format::Vtk,
    );
    assert_eq!(strip.mesh.simplices, [[0, 1, 3], [3, 1, 2]]);
    let other = format!("{grid}CELLS 2 9\n4 0 1 2 3 3 0 1 2\nCELL_TYPES 2\n14 5\n");
    assert_eq!(
        surface(other, Format::Vtk).notes,
        ["1 cell of type 14 passed over"]
    );
    let tetrahedron = format!("{grid}CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n");
    assert_eq!(
        solid(&tetrahedron, Format::Vtk).mesh.simplices,
        [[0, 1, 2, 3]]
    );
    assert_eq!(
        fails(tetrahedron, Format::Vtk).2,
        ParseErrorKind::WrongElements
    );
}

#[test]
fn vtk_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Vtk);
    let head = "# vtk DataFile Version 2.0\ntitle\nASCII\nDATASET";
    let points = "POINTS 3 float\n0 0 0\n1 0 0\n0 1 0\n";
    let poly = |rest: &str| format!("{head} POLYDATA\n{points}{rest}");
    let grid = |rest: &str| format!("{head} UNSTRUCTURED_GRID\n{points}{rest}");
    assert_eq!(at("ply\n").2, Syntax);
    assert_eq!(at("# vtk DataFile Version 2.0\n").2, Truncated);
    assert_eq!(at(&head.replace("ASCII", "EBCDIC")).2, Syntax);
    assert_eq!(at(head).2, Truncated);
    assert_eq!(at(&format!("{head} STRUCTURED_POINTS\n")).2, Unsupported);
    assert_eq!(
        at(&format!("{head} POLYDATA\nPOINTS 3 bit\n")).2,
        Unsupported
    );
    assert_eq!(at(&poly(points)).2, Syntax);
    assert_eq!(at(&poly("CELLS 1 4\n3 0 1 2\n")).2, Syntax);
    assert_eq!(
        at(&poly("POLYGONS 1 4\n3 0 1 3\n")),
        (
            10,
            7,
            IndexOutOfRange,
            "vertex index 3 of 3 (the first is 0)".into()
        )
    );
    assert_eq!(at(&poly("POLYGONS 1 4\n3 0 -1 2\n")).2, IndexOutOfRange);
    assert_eq!(at(&poly("POLYGONS 1 4\n4 0 1 2 0\n")).2, Syntax);
    let two = at(&poly("POLYGONS 1 3\n2 0 1\n"));
    assert_eq!(
        two.3,
        "polygon 0: a face needs three vertices, this one has 2"
    );
    assert_eq!(at(&poly("POLYGONS 1 4\n3 0 1")).2, Truncated);
    assert_eq!(at(&poly("POLYGONS 1 4000000000\n3 0 1 2\n")).2, TooLarge);
    assert_eq!(
        at(&poly("POLYGONS 3 3\nOFFSETS vtktypeint64\n0 3 2\n")).2,
        IndexOutOfRange
    );
    assert_eq!(
        at(&poly("POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nWHAT x\n")).2,
        Truncated
    );
    assert_eq!(at(&grid("CELLS 1 4\n3 0 1 2\n")).2, Truncated);
    assert_eq!(at(&grid("CELL_TYPES 1\n5\n")).2, Syntax);
    assert_eq!(
        at(&grid("CELLS 1 4\n3 0 1 2\nCELL_TYPES 2\n5 5\n")).2,
        Syntax
    );
    assert_eq!(
        at(&grid("CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n")).3,
        "cell 0: a cell of type 10 has 4 points, this one 3"
    );
    let nan = poly("").replace("1 0 0", "1 -nan 0");
    assert_eq!((at(&nan).0, at(&nan).2), (7, NonFinite));
    let mut bytes = mesh_encode::vtk(&block(1), false);
    bytes.truncate(200);
    let error = read(&bytes, Format::Vtk).unwrap_err();
    assert_eq!(error.kind, Truncated, "{error}");
}

#[test]
fn ply_by_hand() {
    let head = "ply\nformat ascii 1.0\ncomment made by hand\n";
    let vertex = "element vertex 4\nproperty float x\nproperty float32 y\nproperty double z\n";
    let face = "element face 2\nproperty list uchar int vertex_index\nend_header\n";
    let body = "0 0 0\n1 0 0\n1e0 1.0 0\n0 1 0\n";
    is_square(
        &format!("{head}{vertex}{face}{body}3 0 1 2\n3 0 2 3\n"),
        Format::Ply,
    );
    is_square(
        &format!(
            "{head}element edge 1\nproperty int a\n{vertex}{face}7\n{body}\n3 0 1 2\n3 0 2 3\n"
        ),
        Format::Ply,
    );
    let one = face.replace("face 2", "face 1");
    is_square(
        &format!("{head}{vertex}{one}{body}4 0 1 2 3\n"),
        Format::Ply,
    );
    let points = format!("{head}{vertex}end_header\n{body}");
    assert!(surface(points, Format::Ply).mesh.simplices.is_empty());
    // Where lines end in a carriage return alone, a line feed is data.
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n\
         property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n"
    );
    let data = [10, 0, 0, 1, 0, 0, 0, 13, 0, 3, 0, 1, 2];
    for header in [
        header.clone(),
        header.replace('\n', "\r"),
        header.replace('\n', "\r\n"),
    ] {
        let file = surface([header.as_bytes(), &data].concat(), Format::Ply);
        assert_eq!(file.mesh.positions[0], DVec3::new(10.0, 0.0, 0.0));
        assert_eq!(file.mesh.positions[2], DVec3::new(0.0, 13.0, 0.0));
        assert_eq!(file.mesh.simplices, [[0, 1, 2]]);
    }
}

#[test]
fn ply_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Ply);
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let file = format!("{head}{body}");
    assert!(read(file.as_bytes(), Format::Ply).is_ok());
    assert_eq!(at("play\n").2, Syntax);
    assert_eq!(at("ply\n").2, Truncated);
    assert_eq!(at("ply\nend_header\n").2, Syntax);
    assert_eq!(at("ply\nproperty int x\n").2, Syntax);
    assert_eq!(at(&file.replace("ascii", "morse")).2, Unsupported);
    assert_eq!(at(&file.replace("float z", "quad z")).2, Unsupported);
    assert_eq!(
        at(&file.replace("float z", "float w")).3,
        "the vertices have no property \"z\""
    );
    assert_eq!(at(&file.replace("vertex_indices", "vertices")).2, Syntax);
    assert_eq!(at(&file.replace("property float y", "nonsense")).0, 5);
    assert_eq!(at(&file.replace("float x", "list uchar float x")).2, Syntax);
    assert_eq!(
        at(&file.replace("3 0 1 2", "3 0 1 3")),
        (
            13,
            7,
            IndexOutOfRange,
            "vertex index 3 of 3 (the first is 0)".into()
        )
    );
    assert_eq!(at(&file.replace("3 0 1 2", "3 0 1")).2, Truncated);
    assert_eq!(at(&file.replace("3 0 1 2", "2 0 1")).2, Syntax);
    assert_eq!(at(&file.replace("3 0 1 2", "-3 0 1 2")).2, Number);
    let (line, column, kind, _) = at(&file.replace("1 0 0\n", "1 0 NaN\n"));
    assert_eq!((line, column, kind), (11, 5, NonFinite));
    assert_eq!(at(&file.replace("vertex 3", "vertex 13")).2, Truncated);
    assert_eq!(
        at(&file.replace("vertex 3", "vertex 9999999999999999999")).2,
        TooLarge
    );
    assert_eq!(
        at(&file.replace("face 1", "face 9999999999999999999")).2,
        TooLarge
    );
    // Binary: every truncation is an error that names the byte.
    let bytes = mesh_encode::ply(&block(1), false);
    let header = bytes
        .windows(11)
        .position(|w| w == b"end_header\n")
        .unwrap()
        + 11;
    for end in header..bytes.len() {
        let error = read(&bytes[..end], Format::Ply).unwrap_err();
        assert!(matches!(error.kind, Truncated | TooLarge), "{error}");
    }
    let mut bytes = bytes;
    let last = bytes.len() - 10;
    bytes[last..last + 4].copy_from_slice(&(-1i32).to_le_bytes());
    let error = read(&bytes, Format::Ply).unwrap_err();
    assert_eq!(
        (error.line, error.column, error.kind),
        (0, last + 1, IndexOutOfRange)
    );
    assert!(
        error.what.starts_with("face 11: vertex index -1 of 8"),
        "{error}"
    );
}

#[test]
fn stl_by_hand() {
    let facet = |a: &str, b: &str, c: &str| {
        format!(
            "facet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n"
        )
    };
    let square = [
        facet("0 0 0", "1 0 0", "1 1 0"),
        facet("-0.0 0 -0", "1e0 1 0", "0 1 0"),
    ];
    let text = format!(
        "solid a name # 7\n{}{}endsolid a name\n",
        square[0], square[1]
    );
    is_square(&text, Format::Stl);
    is_square(&text.to_uppercase(), Format::Stl);
    is_square(
        &format!(
            "solid\n{}endsolid\n\n  solid b\n{}endsolid",
            square[0], square[1]
        ),
        Format::Stl,
    );
    assert_eq!(
        surface(&text, Format::Stl).notes,
        ["6 corners welded to 4 vertices"]
    );
    // Almost equal is not equal.
    let apart = text.replace("1e0 1 0", "1.0000000000000002 1 0");
    assert_eq!(surface(apart, Format::Stl).mesh.positions.len(), 5);
    // A triangle whose corners are welded is for `prepare` to name, as in any format.
    let flat = format!(
        "solid\n{}{}endsolid\n",
        square[0],
        facet("0 0 0", "0 0 0", "0 1 0")
    );
    let error = prepare(&surface(flat, Format::Stl).mesh).unwrap_err();
    assert_eq!(error.to_string(), "face 1 uses vertex 0 twice");
    // Normals of tiny, huge and degenerate triangles are finite.
    for scale in [1e-300, 1.0, 1e300] {
        let mut mesh = block(1).surface();
        mesh.simplices.push([0, 0, 1]);
        mesh.positions
            .iter_mut()
            .for_each(|p| *p = (*p - DVec3::Z * 1e6) * scale);
        let text = String::from_utf8(write(&mesh, Format::Stl)).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
        assert_eq!(text.matches("normal 0 0 0\n").count(), 1);
        assert_eq!(soup(&surface(&text, Format::Stl).mesh), soup(&mesh));
    }
}

#[test]
fn stl_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Stl);
    let text = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n";
    assert!(read(text.as_bytes(), Format::Stl).is_ok());
    assert_eq!(at(&text.replace("vertex 1 0 0\n", "")).0, 6);
    assert_eq!(
        at(&text.replace("vertex 1 0 0\n", "vertex 1 0 0\nvertex 1 0 0\n")).2,
        Syntax
    );
    assert_eq!(at(&text.replace("outer loop\n", "")).0, 3);
    assert_eq!(at(&text.replace("endsolid x\n", "")).2, Truncated);
    assert_eq!(
        at(&text.replace("endloop", "end")).3,
        "\"end\" does not belong here"
    );
    let (line, column, kind, _) = at(&text.replace("1 0 0", "1 nan 0"));
    assert_eq!((line, column, kind), (5, 10, NonFinite));
    assert_eq!(at("hello").2, Truncated);
    let bytes = mesh_encode::stl(&block(1));
    for end in 84..bytes.len() {
        let (line, _, kind, _) = fails(&bytes[..end], Format::Stl);
        assert_eq!(kind, if line == 0 { Truncated } else { kind });
    }
    assert_eq!(fails([&bytes[..], b"x"].concat(), Format::Stl).2, Syntax);
    let mut huge = vec![0; 200];
    huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(fails(&huge, Format::Stl).2, TooLarge);
    let mut nan = bytes;
    nan[84 + 50 + 12..84 + 50 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = read(&nan, Format::Stl).unwrap_err();
    assert_eq!(
        error.to_string(),
        "byte 147: triangle 1: a coordinate is not finite"
    );
}

#[test]
fn one_based_and_zero_based_nodes() {
    for first in [0u64, 1] {
        let lines = SQUARE
            .iter()
            .enumerate()
            .map(|(i, [x, y, _])| format!("{} {x} {y} {}\r\n", i as u64 + first, i % 2));
        let node = format!("# four\n4 3 0 0\n{}", lines.collect::<String>());
        let ele = format!(
            "1 4 0\n{first} {first} {} {} {}",
            first + 1,
            first + 2,
            first + 3
        );
        let nodes = read_node(node.as_bytes()).unwrap();
        let solid: SolidMesh = read_ele(ele.as_bytes(), nodes).unwrap();
        assert_eq!(solid.simplices, [[0, 1, 2, 3]]);
    }
}

/// The meshes of `../shared/data/untangle`, which are not part of the repository; where the folder is
/// missing, nothing is tested.
#[test]
fn meshes_of_others_are_read() {
    let folder =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/untangle");
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
