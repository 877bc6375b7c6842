//! Mesh files: one file a format, all from and to byte slices.
//!
//! The readers never panic, never allocate by a count that a file merely claims, and name the line
//! of what they cannot read.

mod contents;
mod error;
mod medit;
mod msh;
mod obj;
mod off;
mod ply;
mod polygon;
mod scan;
mod stl;
#[cfg(test)]
mod tests;
mod tetgen;
mod values;
mod vtk;
mod write;

use super::{SolidMesh, SurfaceMesh, counted};
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
    /// PLY (Stanford polygons).
    Ply,
    /// STL (stereolithography).
    Stl,
    /// MEDIT .mesh.
    Medit,
    /// Gmsh .msh.
    Msh,
    /// Legacy VTK.
    Vtk,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 7] = [
        Format::Obj,
        Format::Off,
        Format::Ply,
        Format::Stl,
        Format::Medit,
        Format::Msh,
        Format::Vtk,
    ];

    /// The lower-case ending (`"obj"`; of MEDIT `"mesh"`).
    pub fn name(self) -> &'static str {
        match self {
            Format::Obj => "obj",
            Format::Off => "off",
            Format::Ply => "ply",
            Format::Stl => "stl",
            Format::Medit => "mesh",
            Format::Msh => "msh",
            Format::Vtk => "vtk",
        }
    }

    /// Can a file of this format hold tetrahedra? (All can hold triangles.)
    pub fn holds_solids(self) -> bool {
        matches!(self, Format::Medit | Format::Msh | Format::Vtk)
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

/// What a file held.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SolidFile {
    /// The mesh; elements in the order of the file's.
    pub mesh: SolidMesh,
    /// What was left out, in words.
    pub notes: Vec<String>,
}

/// Reads the triangles of a file of a known format; polygons are triangulated, the vertices of a plane
/// file get z = 0.
///
/// Indices are checked and coordinates are finite; whether the faces form a surface is left to
/// [`prepare`](super::prepare). All vertices are kept, those of tetrahedra, too.
///
/// # Errors
/// [`ParseError`] with the line and column (in binary data: the byte) of the first thing that cannot be
/// read; [`ParseErrorKind::WrongElements`] if the file holds tetrahedra only.
pub fn read(bytes: &[u8], format: Format) -> Result<SurfaceFile, ParseError> {
    check_start(bytes)?;
    match format {
        Format::Obj => obj::read(bytes),
        Format::Off => off::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Ply | Format::Medit | Format::Msh | Format::Vtk => {
            contents(bytes, format)?.into_surface(bytes)
        }
    }
}

/// Reads the tetrahedra of a file of a known format.
///
/// Indices are checked and coordinates are finite; triangles, which in such a file are the boundary, are
/// left out.
///
/// # Errors
/// As [`read`]; [`ParseErrorKind::WrongElements`] if the file holds triangles only, or the format can
/// hold nothing else.
pub fn read_solid(bytes: &[u8], format: Format) -> Result<SolidFile, ParseError> {
    check_start(bytes)?;
    if !format.holds_solids() {
        let what = format!("a file of format {} holds no tetrahedra", format.name());
        let kind = ParseErrorKind::WrongElements;
        return Err(ParseError::at(bytes, 0, kind, what));
    }
    contents(bytes, format)?.into_solid(bytes)
}

/// Reads a format that holds positions and elements, nothing else of interest.
fn contents(bytes: &[u8], format: Format) -> Result<contents::Contents, ParseError> {
    match format {
        Format::Medit => medit::read(bytes),
        Format::Msh => msh::read(bytes),
        Format::Vtk => vtk::read(bytes),
        _ => ply::read(bytes),
    }
}

/// Says of bytes that belong to no format what they are.
fn check_start(bytes: &[u8]) -> Result<(), ParseError> {
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
    Ok(())
}

/// Writes a surface as text; coordinates are written so that reading gives the same bits back.
///
/// STL has no common vertices: reading welds them, and drops vertices of no triangle.
pub fn write(mesh: &SurfaceMesh, format: Format) -> Vec<u8> {
    match format {
        Format::Obj => obj::write(mesh, None),
        Format::Off => off::write(mesh),
        Format::Ply => ply::write(mesh.into()),
        Format::Stl => stl::write(mesh.into()),
        Format::Medit => medit::write(mesh.into()),
        Format::Msh => msh::write(mesh.into()),
        Format::Vtk => vtk::write(mesh.into()),
    }
}

/// Writes a solid as text; coordinates are written so that reading gives the same bits back. `None`:
/// the format does not [hold solids](Format::holds_solids). For .node and .ele see [`write_node`] and
/// [`write_ele`].
pub fn write_solid(mesh: &SolidMesh, format: Format) -> Option<Vec<u8>> {
    match format {
        Format::Medit => Some(medit::write(mesh.into())),
        Format::Msh => Some(msh::write(mesh.into())),
        Format::Vtk => Some(vtk::write(mesh.into())),
        _ => None,
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
