//! Mesh files: one file a format, all from and to byte slices.
//!
//! The readers never panic, never allocate by a count that a file merely claims, and name the line
//! of what they cannot read.

mod error;
mod obj;
mod off;
mod polygon;
mod scan;
#[cfg(test)]
mod tests;
mod tetgen;

use super::{SurfaceMesh, counted};
pub use error::{ParseError, ParseErrorKind};
use glam::DVec2;
pub use tetgen::{Nodes, read_ele, read_node, write_ele, write_node};

/// A file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// Wavefront OBJ.
    Obj,
    /// Geomview OFF.
    Off,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 2] = [Format::Obj, Format::Off];

    /// The lower-case ending (`"obj"`).
    pub fn name(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Off => "off",
        }
    }

    /// The format of a file by its name or path, or by the bare ending (`"horse.obj"`,
    /// `"horse.OBJ.gz"`, `"obj"`).
    pub fn from_name(name: &str) -> Option<Format> {
        let lower = name.to_ascii_lowercase();
        let lower = lower.strip_suffix(".gz").unwrap_or(&lower);
        let ending = lower.rsplit('.').next()?;
        Format::ALL.into_iter().find(|f| f.name() == ending)
    }
}

/// Texture coordinates as files have them: one a corner, so that a vertex on a seam has several.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CornerTexture {
    /// The coordinates.
    pub coordinates: Vec<DVec2>,
    /// One triple a triangle of the mesh: indices into `coordinates`.
    pub corners: Vec<[u32; 3]>,
}

/// What a file held.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceFile {
    /// The mesh, its polygons triangulated; triangles in the order of the file's faces.
    pub mesh: SurfaceMesh,
    /// Texture coordinates, where every corner has them.
    pub texture: Option<CornerTexture>,
    /// What was done to the data or left out, in words.
    pub notes: Vec<String>,
}

/// Reads a file of a known format.
///
/// Indices are checked and coordinates are finite; whether the faces form a surface is left to
/// [`prepare`](super::prepare).
///
/// # Errors
/// [`ParseError`] with the line and column of the first thing that cannot be read.
pub fn read(bytes: &[u8], format: Format) -> Result<SurfaceFile, ParseError> {
    let fail = |kind, what: &str| Err(ParseError::at(bytes, 0, kind, what.to_string()));
    if bytes.is_empty() {
        return fail(ParseErrorKind::Empty, "the file is empty");
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        let what = "the file is compressed (gzip): decompress it first";
        return fail(ParseErrorKind::Unsupported, what);
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        let what = "the file is UTF-16 text: save it as plain text (ASCII or UTF-8)";
        return fail(ParseErrorKind::Unsupported, what);
    }
    match format {
        Format::Obj => obj::read(bytes),
        Format::Off => off::read(bytes),
    }
}

/// Writes an OBJ file; coordinates are written so that reading gives the same bits back.
pub fn write_obj(mesh: &SurfaceMesh, texture: Option<&CornerTexture>) -> Vec<u8> {
    obj::write(mesh, texture)
}

/// Writes an OFF file; coordinates are written so that reading gives the same bits back.
pub fn write_off(mesh: &SurfaceMesh) -> Vec<u8> {
    off::write(mesh)
}

/// Says what became of the polygons.
fn note_polygons(notes: &mut Vec<String>, polygons: usize, doubtful: usize) {
    if polygons > 0 {
        notes.push(format!("{} triangulated", counted(polygons, "polygon")));
    }
    if doubtful > 0 {
        notes.push(format!(
            "{} of them crossing itself or without area, so its triangles are doubtful",
            counted(doubtful, "polygon")
        ));
    }
}
