//! What a file of triangles, tetrahedra or both holds, and what becomes of it when a surface or a solid
//! is asked for.

use super::polygon::Faces;
use super::values::Values;
use super::{ParseError, ParseErrorKind, SolidFile, SurfaceFile};
use crate::mesh::{SolidMesh, SurfaceMesh, counted};
use glam::DVec3;

/// The most kinds of elements that are counted by name when they are passed over.
const MOST_NAMED: usize = 8;

/// The vertices and elements of a file.
#[derive(Default)]
pub(super) struct Contents {
    /// One position a vertex.
    pub positions: Vec<DVec3>,
    /// Triangles, and polygons as triangles.
    pub faces: Faces,
    /// Tetrahedra.
    pub tetrahedra: Vec<[u32; 4]>,
    /// What was passed over, and how many of it; in the order in which it was met.
    passed: Vec<(String, usize)>,
    /// How many others, when many kinds were met.
    passed_unnamed: usize,
}

impl Contents {
    /// A vertex by the index that was read last, the file's first vertex having index `first`.
    #[inline]
    pub fn vertex(&self, values: &Values, index: i64, first: i64) -> Result<u32, ParseError> {
        let count = self.positions.len();
        match index.checked_sub(first) {
            Some(v) if v >= 0 && (v as u64) < count as u64 => Ok(v as u32),
            _ => Err(values.error(
                ParseErrorKind::IndexOutOfRange,
                format!("vertex index {index} of {count} (the first is {first})"),
            )),
        }
    }

    /// Adds a face; `values` stand at its end.
    #[inline]
    pub fn face(&mut self, values: &Values, corners: &[u32]) -> Result<(), ParseError> {
        if corners.len() < 3 {
            let what = format!(
                "a face needs three vertices, this one has {}",
                corners.len()
            );
            return Err(values.error(ParseErrorKind::Syntax, what));
        }
        self.faces
            .push(corners, &self.positions)
            .map_err(|what| values.error(ParseErrorKind::TooLarge, what))
    }

    /// Counts elements that are passed over.
    pub fn pass(&mut self, what: &str, count: usize) {
        let others = self.passed.len() == MOST_NAMED;
        match self.passed.iter_mut().find(|(name, _)| name == what) {
            Some(passed) => passed.1 += count,
            None if others => self.passed_unnamed += count,
            None => self.passed.push((what.to_string(), count)),
        }
    }

    fn notes(&self) -> Vec<String> {
        let passed = self.passed.iter();
        let mut notes: Vec<String> = passed
            .map(|(what, count)| format!("{} passed over", counted(*count, what)))
            .collect();
        if self.passed_unnamed > 0 {
            let others = counted(self.passed_unnamed, "element");
            notes.push(format!("{others} of other kinds passed over"));
        }
        notes
    }

    /// The triangles.
    pub fn into_surface(self, bytes: &[u8]) -> Result<SurfaceFile, ParseError> {
        let mut notes = self.notes();
        let tetrahedra = counted(self.tetrahedra.len(), "tetrahedron");
        if self.faces.triangles.is_empty() && !self.tetrahedra.is_empty() {
            let what = format!("the file has no triangles, but {tetrahedra}: it is a solid");
            return Err(ParseError::at(
                bytes,
                0,
                ParseErrorKind::WrongElements,
                what,
            ));
        }
        if !self.tetrahedra.is_empty() {
            notes.push(format!("{tetrahedra} left out: a surface was asked for"));
        }
        self.faces.note(&mut notes);
        Ok(SurfaceFile {
            mesh: SurfaceMesh {
                positions: self.positions,
                simplices: self.faces.triangles,
            },
            texture: None,
            notes,
        })
    }

    /// The tetrahedra.
    pub fn into_solid(self, bytes: &[u8]) -> Result<SolidFile, ParseError> {
        let notes = self.notes();
        if self.tetrahedra.is_empty() && !self.faces.triangles.is_empty() {
            let triangles = counted(self.faces.triangles.len(), "triangle");
            let what = format!("the file has no tetrahedra, but {triangles}: it is a surface");
            return Err(ParseError::at(
                bytes,
                0,
                ParseErrorKind::WrongElements,
                what,
            ));
        }
        Ok(SolidFile {
            mesh: SolidMesh {
                positions: self.positions,
                simplices: self.tetrahedra,
            },
            notes,
        })
    }
}
