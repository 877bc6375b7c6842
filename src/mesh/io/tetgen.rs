//! Vertices and tetrahedra in the text forms of .node and .ele: a header with counts, then one line an
//! item that begins with its index. Indices count from 0 or from 1, whichever the first vertex has.
//! Attributes and boundary markers are passed over.

use super::scan::{Scanner, quote, write_number};
use super::{ParseError, ParseErrorKind};
use crate::mesh::SolidMesh;
use glam::DVec3;
use std::io::Write;

/// The vertices of a .node file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Nodes {
    /// One position a vertex.
    pub positions: Vec<DVec3>,
    /// The index the file gives its first vertex: 0 or 1.
    pub first: u64,
}

/// The header: the number of items, after which `second` says what the next number is to be, and which
/// values it may have.
fn header(
    scanner: &mut Scanner,
    items: &str,
    second: &str,
    allowed: u64,
    shortest: u64,
) -> Result<usize, ParseError> {
    let Some(token) = scanner.first_token() else {
        let what = format!("the file has no {items}");
        return Err(scanner.error(0, ParseErrorKind::Empty, what));
    };
    let start = token.start;
    let count = scanner.parse_count(token, &format!("the number of {items}"))?;
    let Some(token) = scanner.token() else {
        return Err(scanner.ends(format!("{second} is missing")));
    };
    if scanner.parse_count(token, second)? != allowed {
        let what = format!("{second} is {}, only {allowed} is read", quote(token.text));
        return Err(scanner.error(token.start, ParseErrorKind::Unsupported, what));
    }
    scanner.skip_line();
    scanner.check_claim(start, count, items, shortest)
}

/// The index a line begins with, which must be `expected`.
fn index(
    scanner: &mut Scanner,
    item: &str,
    number: usize,
    count: usize,
    first: Option<u64>,
) -> Result<u64, ParseError> {
    let Some(token) = scanner.first_token() else {
        return Err(scanner.ends(format!("the file ends behind {item} {number} of {count}")));
    };
    let found = scanner.parse_count(token, &format!("the index of a {item}"))?;
    let first = first.unwrap_or(found);
    if first > 1 || found != first + number as u64 {
        let what = match number {
            0 => format!("the first {item} has index {found}, not 0 or 1"),
            _ => format!(
                "{item} {found} stands where {} belongs",
                first + number as u64
            ),
        };
        return Err(scanner.error(token.start, ParseErrorKind::Syntax, what));
    }
    Ok(first)
}

/// Reads a .node file.
///
/// # Errors
/// [`ParseError`] with the line and column of the first thing that cannot be read.
pub fn read_node(bytes: &[u8]) -> Result<Nodes, ParseError> {
    let mut scanner = Scanner::new(bytes, false);
    let count = header(&mut scanner, "vertices", "the dimension", 3, 8)?;
    let mut nodes = Nodes::default();
    let mut first = None;
    nodes.positions.reserve_exact(count);
    for number in 0..count {
        first = Some(index(&mut scanner, "vertex", number, count, first)?);
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            *coordinate = scanner.number("a vertex needs three coordinates")?;
        }
        nodes.positions.push(DVec3::from_array(position));
        scanner.skip_line();
    }
    nodes.first = first.unwrap_or(0);
    Ok(nodes)
}

/// Reads an .ele file that belongs to these vertices.
///
/// # Errors
/// As [`read_node`].
pub fn read_ele(bytes: &[u8], nodes: Nodes) -> Result<SolidMesh, ParseError> {
    let mut scanner = Scanner::new(bytes, false);
    let corners = "the number of vertices of a tetrahedron";
    let count = header(&mut scanner, "tetrahedra", corners, 4, 10)?;
    let vertices = nodes.positions.len() as u64;
    let mut simplices = Vec::with_capacity(count);
    let mut first = None;
    for number in 0..count {
        first = Some(index(&mut scanner, "tetrahedron", number, count, first)?);
        let mut tetrahedron = [0u32; 4];
        for corner in &mut tetrahedron {
            let Some(token) = scanner.token() else {
                return Err(scanner.ends("a tetrahedron needs four vertices"));
            };
            let vertex = scanner.parse_count(token, "a vertex index")?;
            match vertex.checked_sub(nodes.first) {
                Some(v) if v < vertices => *corner = v as u32,
                _ => {
                    let what = format!(
                        "vertex index {vertex} of {vertices} (the first is {})",
                        nodes.first
                    );
                    return Err(scanner.error(token.start, ParseErrorKind::IndexOutOfRange, what));
                }
            }
        }
        simplices.push(tetrahedron);
        scanner.skip_line();
    }
    Ok(SolidMesh {
        positions: nodes.positions,
        simplices,
    })
}

/// Writes a .node file, indices from 0; reading it gives the same bits back.
pub fn write_node(positions: &[DVec3]) -> Vec<u8> {
    let mut out = Vec::with_capacity(64 * positions.len());
    // Writing to a vector cannot fail.
    let _ = writeln!(out, "{} 3 0 0", positions.len());
    for (vertex, position) in positions.iter().enumerate() {
        let _ = write!(out, "{vertex}");
        for number in position.to_array() {
            out.push(b' ');
            write_number(&mut out, number);
        }
        out.push(b'\n');
    }
    out
}

/// Writes an .ele file, indices from 0.
pub fn write_ele(mesh: &SolidMesh) -> Vec<u8> {
    let mut out = Vec::with_capacity(32 * mesh.simplices.len());
    let _ = writeln!(out, "{} 4 0", mesh.simplices.len());
    for (element, [a, b, c, d]) in mesh.simplices.iter().enumerate() {
        let _ = writeln!(out, "{element} {a} {b} {c} {d}");
    }
    out
}
