//! What the writers of several formats share.

use super::scan::write_number;
use crate::mesh::SimplicialMesh;
use glam::DVec3;
use std::io::Write;

/// A surface or a solid as the writers see it, so that they are compiled once.
#[derive(Clone, Copy)]
pub(super) struct Elements<'a> {
    /// One position a vertex.
    pub positions: &'a [DVec3],
    /// The vertices of one element behind those of the other.
    corners: &'a [u32],
    /// Vertices an element: 3 or 4.
    pub size: usize,
}

impl<'a, const N: usize> From<&'a SimplicialMesh<N>> for Elements<'a> {
    fn from(mesh: &'a SimplicialMesh<N>) -> Self {
        Self {
            positions: &mesh.positions,
            corners: mesh.simplices.as_flattened(),
            size: N,
        }
    }
}

impl Elements<'_> {
    /// The number of elements.
    pub fn count(&self) -> usize {
        self.corners.len() / self.size
    }

    /// Are the elements tetrahedra?
    pub fn is_solid(&self) -> bool {
        self.size == 4
    }

    /// The elements.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        self.corners.chunks_exact(self.size)
    }

    /// An empty buffer of about the size that a file needs.
    pub fn buffer(&self) -> Vec<u8> {
        Vec::with_capacity(64 * self.positions.len() + 10 * self.corners.len() + 256)
    }

    /// Writes the vertices, a line each.
    pub fn write_points(&self, out: &mut Vec<u8>, line: Line) {
        for (vertex, &position) in self.positions.iter().enumerate() {
            line.begin(out, vertex);
            write_point(out, position);
            line.end(out);
        }
    }

    /// Writes the elements, a line each; the index of the first vertex is `first`.
    pub fn write_elements(&self, out: &mut Vec<u8>, first: u64, line: Line) {
        for (number, element) in self.iter().enumerate() {
            line.begin(out, number);
            for (corner, &vertex) in element.iter().enumerate() {
                // Writing to a vector cannot fail.
                let _ = match corner {
                    0 => write!(out, "{}", u64::from(vertex) + first),
                    _ => write!(out, " {}", u64::from(vertex) + first),
                };
            }
            line.end(out);
        }
    }
}

/// What is in a line beside the item itself.
#[derive(Clone, Copy, Default)]
pub(super) struct Line<'a> {
    /// The number of the line's item, the first having this one.
    pub number_from: Option<usize>,
    /// Before the item, behind its number.
    pub before: &'a str,
    /// Behind the item.
    pub behind: &'a str,
}

impl Line<'_> {
    fn begin(&self, out: &mut Vec<u8>, number: usize) {
        if let Some(first) = self.number_from {
            // Writing to a vector cannot fail.
            let _ = write!(out, "{} ", number + first);
        }
        out.extend_from_slice(self.before.as_bytes());
    }

    fn end(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(self.behind.as_bytes());
        out.push(b'\n');
    }
}

/// Appends three coordinates with blanks between them.
pub(super) fn write_point(out: &mut Vec<u8>, point: DVec3) {
    for (axis, number) in point.to_array().into_iter().enumerate() {
        if axis > 0 {
            out.push(b' ');
        }
        write_number(out, number);
    }
}
