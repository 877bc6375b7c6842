//! Mesh files of a few lines, in the forms that people and programs write.

mod mesh_encode;

use foldfree::mesh::io::{
    Format, ParseErrorKind, SolidFile, SurfaceFile, read, read_ele, read_node, read_solid, write,
};
use foldfree::mesh::{SolidMesh, SurfaceMesh, prepare};
use glam::DVec3;
use mesh_encode::block;

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
    let error = read(tetrahedron.as_bytes(), Format::Vtk).unwrap_err();
    assert_eq!(error.kind, ParseErrorKind::WrongElements);
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
    let header =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n\
         property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n"
        .to_string();
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
