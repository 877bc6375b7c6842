//! Wavefront OBJ: `v`, `vt` and `f` are read, `vn` and everything else is passed over.

use super::polygon::{Outcome, too_large, triangulate};
use super::scan::{Scanner, Token, parse_integer, quote, write_number};
use super::{CornerTexture, ParseError, ParseErrorKind, SurfaceFile};
use crate::mesh::{SurfaceMesh, counted};
use glam::{DVec2, DVec3};
use std::io::Write;

/// No texture coordinate at this corner.
const NONE: u32 = u32::MAX;

/// Statements that are passed over without a word.
#[rustfmt::skip]
const IGNORED: [&[u8]; 33] = [
    b"vn", b"vp", b"g", b"o", b"s", b"l", b"p", b"usemtl", b"mtllib", b"usemap", b"maplib", b"mg",
    b"cstype", b"deg", b"bmat", b"step", b"curv", b"curv2", b"surf", b"parm", b"trim", b"hole",
    b"scrv", b"sp", b"end", b"con", b"bevel", b"c_interp", b"d_interp", b"lod", b"shadow_obj",
    b"trace_obj", b"call",
];

/// Indices into one list, checked even where the list's elements come after their use.
struct Indices {
    what: &'static str,
    /// Uses of elements that did not exist yet, each larger than all before it: if any is out of
    /// range in the end, the first such is in here.
    forward: Vec<(u64, usize)>,
}

impl Indices {
    /// An index of the file (1-based, or negative: from the end) as a 0-based one.
    #[inline]
    fn resolve(
        &mut self,
        scanner: &Scanner,
        index: i64,
        count: usize,
        at: usize,
    ) -> Result<u32, ParseError> {
        if index > 0 && index as u64 <= count as u64 {
            return Ok((index - 1) as u32);
        }
        let what = self.what;
        let out_of_range = |what| scanner.error(at, ParseErrorKind::IndexOutOfRange, what);
        if index == 0 {
            let what = format!("{what} index 0 (indices start at 1)");
            return Err(out_of_range(what));
        }
        if index < 0 {
            // Relative to what has been read so far.
            if index.unsigned_abs() > count as u64 {
                return Err(out_of_range(format!("{what} index {index} of {count}")));
            }
            return Ok((count as i64 + index) as u32);
        }
        let index = index as u64;
        if self
            .forward
            .last()
            .is_none_or(|&(largest, _)| index > largest)
        {
            self.forward.push((index, at));
        }
        // Indices that do not fit are out of range in any case: `finish` says so.
        Ok((index - 1).min(u64::from(NONE - 1)) as u32)
    }

    fn finish(&self, scanner: &Scanner, count: usize) -> Result<(), ParseError> {
        match self
            .forward
            .iter()
            .find(|&&(index, _)| index > count as u64)
        {
            Some(&(index, at)) => {
                let what = format!("{} index {index} of {count}", self.what);
                Err(scanner.error(at, ParseErrorKind::IndexOutOfRange, what))
            }
            None => Ok(()),
        }
    }
}

/// A polygon of more than three corners, so far as a fan among the triangles.
struct Polygon {
    first_triangle: usize,
    corners: usize,
    at: usize,
}

struct Reader<'a> {
    scanner: Scanner<'a>,
    file: SurfaceFile,
    texture: CornerTexture,
    vertex_indices: Indices,
    texture_indices: Indices,
    polygons: Vec<Polygon>,
    /// Corners with and without texture coordinates were seen.
    textured: [bool; 2],
    loop_buffer: Vec<[u32; 2]>,
    unknown: Option<(usize, String)>,
}

pub(super) fn read(bytes: &[u8]) -> Result<SurfaceFile, ParseError> {
    let indices = |what| Indices {
        what,
        forward: Vec::new(),
    };
    let mut reader = Reader {
        scanner: Scanner::new(bytes, true),
        file: SurfaceFile::default(),
        texture: CornerTexture::default(),
        vertex_indices: indices("vertex"),
        texture_indices: indices("texture"),
        polygons: Vec::new(),
        textured: [false; 2],
        loop_buffer: Vec::new(),
        unknown: None,
    };
    while let Some(keyword) = reader.scanner.first_token() {
        reader.statement(keyword)?;
        reader.scanner.skip_line();
    }
    reader.finish()
}

impl Reader<'_> {
    #[inline]
    fn statement(&mut self, keyword: Token) -> Result<(), ParseError> {
        match keyword.text {
            b"v" => {
                // A fourth number (a weight) or six (a colour) are passed over.
                let missing = "a vertex needs three coordinates";
                let x = self.scanner.number(missing)?;
                let y = self.scanner.number(missing)?;
                let z = self.scanner.number(missing)?;
                self.file.mesh.positions.push(DVec3::new(x, y, z));
            }
            b"vt" => {
                let missing = "a texture coordinate needs a number";
                let u = self.scanner.number(missing)?;
                let v = match self.scanner.token() {
                    Some(token) => self.scanner.parse_number(token)?,
                    None => 0.0,
                };
                self.texture.coordinates.push(DVec2::new(u, v));
            }
            b"f" | b"fo" => self.face(keyword.start)?,
            text if IGNORED.contains(&text) => {}
            text if text[0].is_ascii_alphabetic() && text.is_ascii() => {
                let unknown = self.unknown.get_or_insert_with(|| (0, quote(text)));
                unknown.0 += 1;
            }
            text => {
                return Err(self.scanner.error(
                    keyword.start,
                    ParseErrorKind::Syntax,
                    format!(
                        "an OBJ statement starts with a keyword such as v or f, not with {}",
                        quote(text)
                    ),
                ));
            }
        }
        Ok(())
    }

    #[inline]
    fn face(&mut self, at: usize) -> Result<(), ParseError> {
        let mut corners = std::mem::take(&mut self.loop_buffer);
        corners.clear();
        while let Some(token) = self.scanner.token() {
            corners.push(self.corner(token)?);
        }
        if corners.len() < 3 {
            let what = format!(
                "a face needs three vertices, this one has {}",
                corners.len()
            );
            return Err(self.scanner.ends(what));
        }
        if corners.len() > 3 {
            self.polygons.push(Polygon {
                first_triangle: self.file.mesh.simplices.len(),
                corners: corners.len(),
                at,
            });
        }
        for pair in corners[1..].windows(2) {
            let triangle = [corners[0], pair[0], pair[1]];
            self.file.mesh.simplices.push(triangle.map(|c| c[0]));
            self.texture.corners.push(triangle.map(|c| c[1]));
        }
        self.loop_buffer = corners;
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    fn corner(&mut self, token: Token) -> Result<[u32; 2], ParseError> {
        let mut result = [0, NONE];
        let mut start = 0;
        for part in 0.. {
            let rest = &token.text[start..];
            let length = rest.iter().position(|&b| b == b'/').unwrap_or(rest.len());
            let text = &rest[..length];
            let at = token.start + start;
            let index = parse_integer(text);
            match (part, index) {
                (0, Some(index)) => {
                    let count = self.file.mesh.positions.len();
                    result[0] = self
                        .vertex_indices
                        .resolve(&self.scanner, index, count, at)?;
                }
                (1, Some(index)) => {
                    let count = self.texture.coordinates.len();
                    result[1] = self
                        .texture_indices
                        .resolve(&self.scanner, index, count, at)?;
                }
                (2, Some(_)) => {}
                (1 | 2, None) if text.is_empty() => {}
                _ => {
                    return Err(self.scanner.error(
                        at,
                        ParseErrorKind::Number,
                        format!(
                            "expected a corner such as 7, 7/7, 7//7 or 7/7/7, found {}",
                            quote(token.text)
                        ),
                    ));
                }
            }
            if length == rest.len() {
                break;
            }
            start += length + 1;
        }
        self.textured[usize::from(result[1] != NONE)] = true;
        Ok(result)
    }

    fn finish(mut self) -> Result<SurfaceFile, ParseError> {
        let (vertices, faces) = (&self.file.mesh.positions, &self.file.mesh.simplices);
        if vertices.is_empty() && faces.is_empty() {
            return Err(self.scanner.ends_empty());
        }
        self.vertex_indices.finish(&self.scanner, vertices.len())?;
        self.texture_indices
            .finish(&self.scanner, self.texture.coordinates.len())?;
        self.triangulate()?;
        let notes = &mut self.file.notes;
        if self.textured == [true, true] {
            notes.push("some corners have no texture coordinates, so none are used".to_string());
        }
        if let Some((count, keyword)) = self.unknown {
            notes.push(format!(
                "{} passed over, the first a {keyword}",
                counted(count, "unknown statement")
            ));
        }
        if self.textured == [false, true] {
            self.file.texture = Some(self.texture);
        }
        Ok(self.file)
    }

    /// Replaces the provisional fans of the polygons.
    fn triangulate(&mut self) -> Result<(), ParseError> {
        let mut points = Vec::new();
        let mut corners: Vec<[u32; 2]> = Vec::new();
        let mut triangles = Vec::new();
        let mut doubtful = 0;
        for polygon in &self.polygons {
            let range = polygon.first_triangle..polygon.first_triangle + polygon.corners - 2;
            let faces = &mut self.file.mesh.simplices[range.clone()];
            let texture = &mut self.texture.corners[range];
            corners.clear();
            corners.push([faces[0][0], texture[0][0]]);
            corners.push([faces[0][1], texture[0][1]]);
            corners.extend(faces.iter().zip(texture.iter()).map(|(f, t)| [f[2], t[2]]));
            points.clear();
            points.extend(
                corners
                    .iter()
                    .map(|c| self.file.mesh.positions[c[0] as usize]),
            );
            match triangulate(&points, &mut triangles) {
                Outcome::Clean => {}
                Outcome::Doubtful => doubtful += 1,
                Outcome::TooLarge => {
                    let what = too_large(polygon.corners);
                    return Err(self
                        .scanner
                        .error(polygon.at, ParseErrorKind::TooLarge, what));
                }
            }
            for (i, triangle) in triangles.iter().enumerate() {
                faces[i] = triangle.map(|k| corners[k as usize][0]);
                texture[i] = triangle.map(|k| corners[k as usize][1]);
            }
        }
        super::note_polygons(&mut self.file.notes, self.polygons.len(), doubtful);
        Ok(())
    }
}

impl Scanner<'_> {
    fn ends_empty(&self) -> ParseError {
        let what = "the file has neither vertices nor faces";
        self.error(0, ParseErrorKind::Empty, what)
    }
}

pub(super) fn write(mesh: &SurfaceMesh, texture: Option<&CornerTexture>) -> Vec<u8> {
    let mut out = Vec::with_capacity(64 * mesh.positions.len() + 24 * mesh.simplices.len());
    let mut line = |keyword: &str, numbers: &[f64]| {
        out.extend_from_slice(keyword.as_bytes());
        for &number in numbers {
            out.push(b' ');
            write_number(&mut out, number);
        }
        out.push(b'\n');
    };
    for position in &mesh.positions {
        line("v", &position.to_array());
    }
    for coordinate in texture.iter().flat_map(|t| &t.coordinates) {
        line("vt", &coordinate.to_array());
    }
    for (index, triangle) in mesh.simplices.iter().enumerate() {
        let [a, b, c] = triangle.map(|v| u64::from(v) + 1);
        // Writing to a vector cannot fail.
        let _ = match texture.and_then(|t| t.corners.get(index)) {
            Some(corners) => {
                let [s, t, u] = corners.map(|v| u64::from(v) + 1);
                writeln!(out, "f {a}/{s} {b}/{t} {c}/{u}")
            }
            None => writeln!(out, "f {a} {b} {c}"),
        };
    }
    out
}
