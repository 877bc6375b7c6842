//! What is to be untangled.

use crate::certificate::{orientation, orientation_of_tetrahedron};
use crate::disjoint_sets::DisjointSets;
use crate::geometry::RestShape;
use crate::optim::{BuildError, Spring};
use crate::wrapd::External;
use glam::{DVec2, DVec3};
use std::cmp::Ordering;

/// A body of triangles in the plane or of tetrahedra in space, and where it starts.
#[derive(Debug, Clone, Copy)]
pub struct GiniProblem<'a> {
    /// Rest shapes: the orientation that elements are to have, and what energies compare with.
    pub rest: &'a RestShape,
    /// Start, vertices × dimension, interleaved. May be inverted or collapsed.
    pub start: &'a [f64],
    /// Vertices held where they start. There may be none: a component without pin or spring keeps its centroid.
    pub pins: &'a [u32],
    /// Springs on free vertices; their stiffness is relative to the largest diagonal entry of the Laplacian, times
    /// the option `target_stiffness` (κ).
    pub springs: &'a [Spring],
}

impl GiniProblem<'_> {
    /// Checks that the parts fit together.
    pub(super) fn validate(&self, dimension: usize, external: &External) -> Result<(), BuildError> {
        let problem = crate::wrapd::Problem {
            rest: self.rest,
            start: self.start,
            pins: self.pins,
            external: Some(external),
        };
        problem.validate_parts(dimension, dimension)?;
        let n = self.start.len() / dimension;
        let mut is_held = vec![false; n];
        self.pins.iter().for_each(|&p| is_held[p as usize] = true);
        if self.rest.vertices.iter().all(|&v| is_held[v as usize]) {
            return Err(BuildError::InvalidOption {
                option: "pins",
                what: "hold all vertices: there is nothing to solve for".into(),
            });
        }
        Ok(())
    }

    /// The connected components that nothing holds, each by its vertices in ascending order.
    pub(super) fn floating(&self, dimension: usize) -> Vec<Vec<u32>> {
        let n = self.start.len() / dimension;
        let mut sets = DisjointSets::new(n);
        let mut used = vec![false; n];
        for e in 0..self.rest.len() {
            let simplex = self.rest.simplex(e);
            for &v in simplex {
                used[v as usize] = true;
                sets.join(simplex[0], v);
            }
        }
        let mut is_held = vec![false; n];
        let springs = self.springs.iter().map(|s| s.vertex);
        for v in self.pins.iter().copied().chain(springs) {
            is_held[sets.find(v) as usize] = true;
        }
        let mut number = vec![u32::MAX; n];
        let mut components: Vec<Vec<u32>> = Vec::new();
        for v in 0..n as u32 {
            let root = sets.find(v) as usize;
            if !used[v as usize] || is_held[root] {
                continue;
            }
            if number[root] == u32::MAX {
                number[root] = components.len() as u32;
                components.push(Vec::new());
            }
            components[number[root] as usize].push(v);
        }
        components
    }
}

/// The elements that are not strictly positive, in ascending order: exact, whatever the solver thinks of its
/// values.
pub fn not_positive(dimension: usize, corners: &[u32], x: &[f64]) -> Vec<u32> {
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
    let elements = corners.chunks_exact(dimension + 1).enumerate();
    elements
        .filter(|(_, corners)| !is_positive(corners))
        .map(|(e, _)| e as u32)
        .collect()
}
