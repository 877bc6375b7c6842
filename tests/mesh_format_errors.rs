//! What is said of mesh files that cannot be read, and the place it names.

mod mesh_encode;

use foldfree::mesh::io::{Format, ParseErrorKind, read};
use glam::DVec3;
use mesh_encode::{Bytes, block};

/// (line, column, kind, message).
fn fails(bytes: impl AsRef<[u8]>, format: Format) -> (usize, usize, ParseErrorKind, String) {
    let error = read(bytes.as_ref(), format).unwrap_err();
    (error.line, error.column, error.kind, error.what)
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
