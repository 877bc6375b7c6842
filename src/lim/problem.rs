//! What is to be deformed.

use crate::certificate::{orientation, orientation_of_tetrahedron};
use crate::geometry::RestShape;
use crate::optim::BuildError;
use glam::{DVec2, DVec3};
use std::cmp::Ordering;

/// A body of triangles in the plane or of tetrahedra in space.
#[derive(Debug, Clone, Copy)]
pub struct LimProblem<'a> {
    /// Rest shapes in the coordinates of `rest_positions`.
    pub rest: &'a RestShape,
    /// Positions at rest, vertices × dimension, interleaved.
    pub rest_positions: &'a [f64],
    /// Start, vertices × dimension. Without inverted elements, if there is a barrier.
    pub start: &'a [f64],
    /// Handles: vertices that are held where they start, until they are given other targets.
    pub handles: &'a [u32],
}

impl LimProblem<'_> {
    /// Checks that the parts fit together.
    pub(super) fn validate(&self, dimension: usize) -> Result<(), BuildError> {
        let problem = crate::wrapd::Problem {
            rest: self.rest,
            start: self.start,
            pins: self.handles,
            external: None,
        };
        problem.validate_parts(dimension, dimension)?;
        if self.rest_positions.len() != self.start.len() {
            return Err(BuildError::WrongLength {
                argument: "rest positions",
                expected: self.start.len(),
                found: self.rest_positions.len(),
            });
        }
        Ok(())
    }
}

/// Elements that are inverted or degenerate: how many, and the first of them. Exact. Positions and corners by
/// vertex or by slot.
pub fn inverted(dimension: usize, corners: &[u32], x: &[f64]) -> (usize, Option<usize>) {
    let is_positive = |corners: &[u32]| match dimension {
        2 => {
            let points = x.as_chunks::<2>().0;
            let at = |c: usize| DVec2::from_array(points[corners[c] as usize]);
            orientation(at(0), at(1), at(2)) == Ordering::Greater
        }
        _ => {
            let points = x.as_chunks::<3>().0;
            let at = |c: usize| DVec3::from_array(points[corners[c] as usize]);
            orientation_of_tetrahedron(at(0), at(1), at(2), at(3)) == Ordering::Greater
        }
    };
    let (mut count, mut first) = (0, None);
    for (e, corners) in corners.chunks_exact(dimension + 1).enumerate() {
        if !is_positive(corners) {
            count += 1;
            first = first.or(Some(e));
        }
    }
    (count, first)
}
