//! What is to be untangled.

use super::simplex::signed_measure;
use crate::certificate::{orientation, orientation_of_tetrahedron};
use crate::disjoint_sets::DisjointSets;
use crate::energy::Energy;
use crate::geometry::RestShape;
use crate::optim::{BuildError, Spring};
use crate::space::Space;
use crate::wrapd::elements::Shape;
use crate::wrapd::{External, Linear};
use glam::{DVec2, DVec3};
use std::cmp::Ordering;

/// A body of triangles in the plane or of tetrahedra in space, and where it starts.
#[derive(Debug, Clone, Copy)]
pub struct GiniProblem<'a> {
    /// Rest shapes: the orientation that elements are to have, and what energies compare with.
    pub rest: &'a RestShape,
    /// Start, vertices × dimension, interleaved. May be inverted or collapsed.
    pub start: &'a [f64],
    /// Where x̄ begins, if that is not the start: the primary solver may begin folded, or with a boundary that meets
    /// itself, what x must not where overlap counts. As long as the start; of pinned vertices it is not asked.
    pub primary: Option<&'a [f64]>,
    /// Vertices held where they start. There may be none: a component without pin or spring keeps its centroid.
    pub pins: &'a [u32],
    /// Springs on free vertices; their stiffness is relative to the largest diagonal entry of the Laplacian, times
    /// the option `target_stiffness` (κ).
    pub springs: &'a [Spring],
}

impl GiniProblem<'_> {
    /// The springs with stiffnesses as the energy's: of each its own, times κ, times the largest diagonal entry of the
    /// Laplacian.
    pub(crate) fn absolute_springs<S: Space, E: Energy<S>>(
        &self,
        energy: &E,
        target_stiffness: f64,
    ) -> Vec<Spring> {
        if self.springs.is_empty() {
            return Vec::new();
        }
        let k = Shape::of::<S, Linear, E>(energy).constants.rest_stiffness;
        let n = self.start.len() / S::DIM;
        let diagonal = self.rest.laplacian_diagonal(n);
        let unit = target_stiffness * k * diagonal.into_iter().fold(0.0, f64::max);
        let absolute = |s: &Spring| Spring {
            stiffness: unit * s.stiffness,
            ..*s
        };
        self.springs.iter().map(absolute).collect()
    }

    /// Checks that the parts fit together.
    pub(super) fn validate(&self, dimension: usize) -> Result<(), BuildError> {
        let external = External {
            springs: self.springs.to_vec(),
            ..Default::default()
        };
        let problem = crate::wrapd::Problem {
            rest: self.rest,
            start: self.start,
            pins: self.pins,
            external: Some(&external),
        };
        problem.validate_parts(dimension, dimension)?;
        if let Some(primary) = self.primary {
            let start = primary;
            crate::wrapd::Problem { start, ..problem }.validate_parts(dimension, dimension)?;
            if primary.len() != self.start.len() {
                return Err(BuildError::InvalidOption {
                    option: "primary",
                    what: format!(
                        "{} coordinates, and {} of the start",
                        primary.len(),
                        self.start.len()
                    ),
                });
            }
        }
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
    pub(crate) fn floating(&self, dimension: usize) -> Vec<Vec<u32>> {
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

/// The signed measure of the image, if pins determine it: all vertices of the boundary are held. It is the sum over
/// the elements (D + 1 `corners` each), whatever the inside is like. With it the largest rounding error it may have.
pub(super) fn held_measure<const D: usize>(
    corners: &[u32],
    is_held: &[bool],
    points: &[[f64; D]],
) -> Option<(f64, f64)> {
    let held = is_held.iter().filter(|&&held| held).count();
    if held <= D {
        return None;
    }
    // facets with a vertex that moves, as sorted vertices: all of them must have two elements
    let mut facets: Vec<[u32; 3]> = Vec::new();
    for simplex in corners.chunks_exact(D + 1) {
        for opposite in 0..=D {
            let mut facet = [u32::MAX; 3];
            let others = (0..=D).filter(|&v| v != opposite);
            for (place, v) in facet.iter_mut().zip(others) {
                *place = simplex[v];
            }
            if facet[..D].iter().any(|&v| !is_held[v as usize]) {
                facet.sort_unstable();
                facets.push(facet);
            }
        }
    }
    facets.sort_unstable();
    if facets.chunk_by(|a, b| a == b).any(|same| same.len() != 2) {
        return None;
    }
    let (mut sum, mut size) = (0.0, 0.0);
    for simplex in corners.chunks_exact(D + 1) {
        let at = |i: usize| points[simplex[i.min(D)] as usize];
        let measure = signed_measure(&[at(0), at(1), at(2), at(3)]);
        sum += measure;
        size += measure.abs();
    }
    Some((sum, 1e-12 * size))
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
