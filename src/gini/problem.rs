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

/// Are all vertices of the boundary of these elements (D + 1 `corners` each) held, so that pins determine the signed measure
/// of the image?
pub(super) fn is_enclosed<const D: usize>(corners: &[u32], is_held: &[bool]) -> bool {
    if is_held.iter().filter(|&&held| held).count() <= D {
        return false;
    }
    // facets with a vertex that moves, as sorted vertices, under their lowest: all of them must have two elements
    let facets = || {
        corners.chunks_exact(D + 1).flat_map(|simplex| {
            (0..=D).filter_map(|opposite| {
                let mut facet = [u32::MAX; 3];
                let others = (0..=D).filter(|&v| v != opposite);
                for (place, v) in facet.iter_mut().zip(others) {
                    *place = simplex[v];
                }
                facet[..D].sort_unstable();
                let moves = facet[..D].iter().any(|&v| !is_held[v as usize]);
                moves.then_some(facet)
            })
        })
    };
    let mut end = vec![0usize; is_held.len() + 1];
    facets().for_each(|f| end[f[0] as usize + 1] += 1);
    for v in 0..is_held.len() {
        end[v + 1] += end[v];
    }
    let begin = end.clone();
    let mut by_lowest = vec![[u32::MAX; 2]; end[is_held.len()]];
    for [lowest, a, b] in facets() {
        let place = &mut end[lowest as usize];
        by_lowest[*place] = [a, b];
        *place += 1;
    }
    begin.windows(2).all(|range| {
        let of_vertex = &mut by_lowest[range[0]..range[1]];
        of_vertex.sort_unstable();
        of_vertex
            .chunk_by(|a, b| a == b)
            .all(|same| same.len() == 2)
    })
}

/// The signed measure of the image of these elements: where the boundary is held, whatever the inside is like. With it the
/// largest rounding error it may have.
pub(super) fn image_measure<const D: usize>(corners: &[u32], points: &[[f64; D]]) -> (f64, f64) {
    let (mut sum, mut size) = (0.0, 0.0);
    for simplex in corners.chunks_exact(D + 1) {
        let at = |i: usize| points[simplex[i.min(D)] as usize];
        let measure = signed_measure(&[at(0), at(1), at(2), at(3)]);
        sum += measure;
        size += measure.abs();
    }
    (sum, 1e-12 * size)
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
