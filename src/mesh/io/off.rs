//! Geomview OFF in its text forms: OFF, COFF, NOFF, STOFF and their combinations.
//!
//! Normals, colours and texture coordinates behind the three coordinates of a vertex and colours
//! behind a face are passed over.

use super::polygon::Faces;
use super::scan::{Scanner, Token, parse_integer, quote, write_number};
use super::{ParseError, ParseErrorKind, SurfaceFile};
use crate::mesh::SurfaceMesh;
use glam::DVec3;
use std::io::Write;

pub(super) fn read(bytes: &[u8]) -> Result<SurfaceFile, ParseError> {
    let mut scanner = Scanner::new(bytes, false);
    let (vertices, faces) = header(&mut scanner)?;
    let mut file = SurfaceFile::default();
    read_vertices(&mut scanner, vertices, &mut file.mesh)?;
    read_faces(&mut scanner, faces, &mut file)?;
    if let Some(token) = scanner.first_token() {
        let what = format!("{} behind the last face", quote(token.text));
        return Err(scanner.error(token.start, ParseErrorKind::Syntax, what));
    }
    Ok(file)
}

/// The keyword, if there is one, and the counts of vertices and faces.
fn header(scanner: &mut Scanner) -> Result<(usize, usize), ParseError> {
    let Some(mut token) = scanner.first_token() else {
        let what = "the file has neither vertices nor faces";
        return Err(scanner.error(0, ParseErrorKind::Empty, what));
    };
    if parse_integer(token.text).is_none() {
        check_keyword(scanner, token)?;
        // The counts may follow on the keyword's line or on the next.
        token = match scanner.token() {
            Some(token) => token,
            None => match scanner.first_token() {
                Some(token) => token,
                None => return Err(scanner.ends("the counts of vertices and faces are missing")),
            },
        };
        if token.text == b"BINARY" {
            let what = "binary OFF is not read, only text";
            return Err(scanner.error(token.start, ParseErrorKind::Unsupported, what));
        }
    }
    let start = token.start;
    let vertices = scanner.parse_count(token, "the number of vertices")?;
    let Some(token) = scanner.token() else {
        return Err(scanner.ends("the number of faces is missing"));
    };
    let faces = scanner.parse_count(token, "the number of faces")?;
    // The number of edges, if given, is not used.
    if let Some(token) = scanner.token() {
        scanner.parse_count(token, "the number of edges")?;
    }
    if let Some(token) = scanner.token() {
        let what = format!("{} behind the counts", quote(token.text));
        return Err(scanner.error(token.start, ParseErrorKind::Syntax, what));
    }
    scanner.skip_line();
    // The shortest vertex is "0 0 0\n", the shortest face "3 0 0 0\n"; the last may lack its end.
    let needed = vertices
        .saturating_mul(6)
        .saturating_add(faces.saturating_mul(8));
    let remaining = scanner.remaining() as u64;
    if needed > remaining + 1 {
        let kind = if remaining == 0 || needed < 4 * remaining {
            ParseErrorKind::Truncated
        } else {
            ParseErrorKind::TooLarge
        };
        let what = format!(
            "the header claims {vertices} vertices and {faces} faces, the {remaining} bytes behind it cannot hold them"
        );
        return Err(scanner.error(start, kind, what));
    }
    Ok((vertices as usize, faces as usize))
}

/// `[ST][C][N]OFF`; the four- and n-dimensional forms are not read.
fn check_keyword(scanner: &Scanner, token: Token) -> Result<(), ParseError> {
    let error = |kind, what| Err(scanner.error(token.start, kind, what));
    let Some(prefix) = token.text.strip_suffix(b"OFF") else {
        let what = format!(
            "an OFF file starts with OFF, this one with {}",
            quote(token.text)
        );
        return error(ParseErrorKind::Syntax, what);
    };
    let rest = prefix.strip_prefix(b"ST").unwrap_or(prefix);
    let rest = rest.strip_prefix(b"C").unwrap_or(rest);
    let rest = rest.strip_prefix(b"N").unwrap_or(rest);
    if rest.is_empty() {
        return Ok(());
    }
    let what = format!(
        "{} is not read (OFF, COFF, NOFF, STOFF are)",
        quote(token.text)
    );
    error(ParseErrorKind::Unsupported, what)
}

fn read_vertices(
    scanner: &mut Scanner,
    count: usize,
    mesh: &mut SurfaceMesh,
) -> Result<(), ParseError> {
    // The header was held against the size of the file.
    mesh.positions.reserve_exact(count);
    for index in 0..count {
        let Some(token) = scanner.first_token() else {
            return Err(scanner.ends(format!("the file ends behind vertex {index} of {count}")));
        };
        let missing = "a vertex needs three coordinates";
        let x = scanner.parse_number(token)?;
        let y = scanner.number(missing)?;
        let z = scanner.number(missing)?;
        mesh.positions.push(DVec3::new(x, y, z));
        scanner.skip_line();
    }
    Ok(())
}

fn read_faces(
    scanner: &mut Scanner,
    count: usize,
    file: &mut SurfaceFile,
) -> Result<(), ParseError> {
    let vertices = file.mesh.positions.len();
    let mut corners: Vec<u32> = Vec::new();
    let mut faces = Faces::default();
    faces.triangles.reserve_exact(count);
    for index in 0..count {
        let Some(token) = scanner.first_token() else {
            return Err(scanner.ends(format!("the file ends behind face {index} of {count}")));
        };
        let at = token.start;
        let size = scanner.parse_count(token, "the number of a face's vertices")?;
        if size < 3 {
            let what = format!("a face needs three vertices, this one has {size}");
            return Err(scanner.error(at, ParseErrorKind::Syntax, what));
        }
        corners.clear();
        for corner in 0..size {
            let Some(token) = scanner.token() else {
                let what = format!("a face of {size} vertices names only {corner}");
                return Err(scanner.ends(what));
            };
            let vertex = scanner.parse_count(token, "a vertex index")?;
            if vertex >= vertices as u64 {
                let what = format!("vertex index {vertex} of {vertices} (the first is 0)");
                return Err(scanner.error(token.start, ParseErrorKind::IndexOutOfRange, what));
            }
            corners.push(vertex as u32);
        }
        scanner.skip_line();
        let too_large = |what| scanner.error(at, ParseErrorKind::TooLarge, what);
        faces
            .push(&corners, &file.mesh.positions)
            .map_err(too_large)?;
    }
    faces.note(&mut file.notes);
    file.mesh.simplices = faces.triangles;
    Ok(())
}

pub(super) fn write(mesh: &SurfaceMesh) -> Vec<u8> {
    let mut out = Vec::with_capacity(64 * mesh.positions.len() + 24 * mesh.simplices.len());
    // Writing to a vector cannot fail.
    let _ = writeln!(
        out,
        "OFF\n{} {} 0",
        mesh.positions.len(),
        mesh.simplices.len()
    );
    for position in &mesh.positions {
        for (axis, number) in position.to_array().into_iter().enumerate() {
            if axis > 0 {
                out.push(b' ');
            }
            write_number(&mut out, number);
        }
        out.push(b'\n');
    }
    for [a, b, c] in &mesh.simplices {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    out
}
