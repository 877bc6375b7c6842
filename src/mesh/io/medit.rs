//! MEDIT .mesh as text, of dimension 2 (the plane z = 0) or 3: vertices, triangles, quadrilaterals and
//! tetrahedra; references are passed over, as are the other sections.

use super::contents::Contents;
use super::scan::quote;
use super::values::{Scalar, Values};
use super::write::{Elements, Line};
use super::{ParseError, ParseErrorKind};
use std::io::Write;

/// Sections that are passed over without a word: they do not add to the domain.
#[rustfmt::skip]
const QUIET: [&[u8]; 20] = [
    b"Edges", b"Corners", b"Ridges", b"RequiredVertices", b"RequiredEdges", b"RequiredTriangles",
    b"RequiredQuadrilaterals", b"Normals", b"NormalAtVertices", b"NormalAtTriangleVertices",
    b"NormalAtQuadrilateralVertices", b"Tangents", b"TangentAtVertices", b"TangentAtEdges",
    b"AngleOfCornerBound", b"Geometry", b"BoundingBox", b"Identifier", b"Iterations", b"Time",
];

pub(super) fn read(bytes: &[u8]) -> Result<Contents, ParseError> {
    let mut values = Values::new(bytes);
    if bytes.starts_with(&[1, 0, 0, 0]) || bytes.starts_with(&[0, 0, 0, 1]) {
        let what = "binary MEDIT (.meshb) is not read, only text";
        return Err(values.error(ParseErrorKind::Unsupported, what));
    }
    let mut contents = Contents::default();
    let mut dimension = None;
    let mut started = false;
    let mut has_vertices = false;
    loop {
        values.start_item();
        let Some(keyword) = values.scanner.token() else {
            break;
        };
        if !started && keyword.text != b"MeshVersionFormatted" {
            let what = format!(
                "a MEDIT file starts with MeshVersionFormatted, this one with {}",
                quote(keyword.text)
            );
            return Err(values.error(ParseErrorKind::Syntax, what));
        }
        let fail = |kind, what: &str| Err(values.error(kind, what));
        match keyword.text {
            b"MeshVersionFormatted" => {
                values.start_item();
                values.count(Scalar::I32, "the version")?;
                started = true;
            }
            b"Dimension" => {
                values.start_item();
                dimension = match values.count(Scalar::I32, "the dimension")? {
                    2 => Some(2),
                    3 => Some(3),
                    other => {
                        let what = format!("the dimension is {other}, only 2 and 3 are read");
                        return Err(values.error(ParseErrorKind::Unsupported, what));
                    }
                };
            }
            b"Vertices" => {
                let Some(dimension) = dimension else {
                    return fail(ParseErrorKind::Syntax, "the vertices come before Dimension");
                };
                if has_vertices {
                    return fail(ParseErrorKind::Syntax, "the vertices are there twice");
                }
                has_vertices = true;
                vertices(&mut values, dimension, &mut contents)?;
            }
            b"Triangles" | b"Quadrilaterals" | b"Tetrahedra" if !has_vertices => {
                return fail(ParseErrorKind::Unsupported, "elements before the vertices");
            }
            b"Triangles" => elements(&mut values, "triangles", 3, &mut contents)?,
            b"Quadrilaterals" => elements(&mut values, "quadrilaterals", 4, &mut contents)?,
            b"Tetrahedra" => elements(&mut values, "tetrahedra", 4, &mut contents)?,
            b"End" => break,
            other if other[0].is_ascii_alphabetic() => {
                values.scanner.skip_line();
                let holds_something = skip_numbers(&mut values);
                if holds_something && !QUIET.contains(&other) {
                    contents.pass(&format!("{} section", quote(other)), 1);
                }
            }
            other => {
                let what = format!(
                    "expected a keyword such as Vertices, found {}",
                    quote(other)
                );
                return Err(values.error(ParseErrorKind::Syntax, what));
            }
        }
    }
    if !started {
        return Err(values.error(ParseErrorKind::Empty, "the file has no vertices"));
    }
    if !has_vertices {
        return Err(values.error(ParseErrorKind::Truncated, "the file has no vertices"));
    }
    Ok(contents)
}

fn vertices(
    values: &mut Values,
    dimension: usize,
    contents: &mut Contents,
) -> Result<(), ParseError> {
    values.start_item();
    let count = values.claim(Scalar::I32, "vertices", 2 * dimension as u64, 0)?;
    values.end_item();
    contents.positions.reserve_exact(count);
    for _ in 0..count {
        values.start_item();
        contents
            .positions
            .push(values.point(Scalar::F64, dimension)?);
        values.end_item();
    }
    Ok(())
}

fn elements(
    values: &mut Values,
    items: &str,
    corners: usize,
    contents: &mut Contents,
) -> Result<(), ParseError> {
    values.start_item();
    let count = values.claim(Scalar::I32, items, 2 * corners as u64, 0)?;
    values.end_item();
    for _ in 0..count {
        values.start_item();
        let mut element = [0; 4];
        for corner in &mut element[..corners] {
            let index = values.integer(Scalar::I32, "a vertex index")?;
            *corner = contents.vertex(values, index, 1)?;
        }
        if items == "tetrahedra" {
            contents.tetrahedra.push(element);
        } else {
            contents.face(values, &element[..corners])?;
        }
        values.end_item();
    }
    Ok(())
}

/// Passes over lines until one begins with a keyword; whether there are more than one of them (the
/// first may be the section's count).
fn skip_numbers(values: &mut Values) -> bool {
    let mut lines = 0;
    loop {
        values.scanner.find_token();
        let start = values.scanner.clone();
        match values.scanner.token() {
            Some(token) if !token.text[0].is_ascii_alphabetic() => {
                lines += 1;
                values.scanner.skip_line();
            }
            _ => {
                values.scanner = start;
                return lines > 1;
            }
        }
    }
}

/// Writes the vertices and the elements, all with reference 0.
pub(super) fn write(mesh: Elements) -> Vec<u8> {
    let mut out = mesh.buffer();
    let line = Line {
        behind: " 0",
        ..Line::default()
    };
    // Writing to a vector cannot fail.
    let _ = writeln!(out, "MeshVersionFormatted 2\nDimension 3\nVertices");
    let _ = writeln!(out, "{}", mesh.positions.len());
    mesh.write_points(&mut out, line);
    let keyword = if mesh.is_solid() {
        "Tetrahedra"
    } else {
        "Triangles"
    };
    let _ = writeln!(out, "{keyword}\n{}", mesh.count());
    mesh.write_elements(&mut out, 1, line);
    out.extend_from_slice(b"End\n");
    out
}
