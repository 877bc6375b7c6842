//! Vertices with a place in the plane: pulled there, or held.

use crate::embedding::harmonic_extension;
use crate::geometry::RestShape;
use crate::optim::{BuildError, Spring};
use crate::wrapd::External;
use glam::DVec2;

/// A vertex of the input and where its image is to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// The vertex, as the input numbers them.
    pub vertex: u32,
    /// Where to, in the units of the input.
    pub uv: DVec2,
    /// Held there, or pulled there?
    pub hard: bool,
}

/// The same in the solver's numbers and units.
#[derive(Debug, Default)]
pub(super) struct Landmarks {
    /// Held vertices and their places.
    hard: Vec<(u32, DVec2)>,
    /// Pulled vertices and where to.
    soft: Vec<(u32, DVec2)>,
}

fn wrong(what: String) -> BuildError {
    BuildError::InvalidOption {
        option: "landmarks",
        what,
    }
}

impl Landmarks {
    /// `input_vertices` says which vertex of the input each of the disk's is; `scale` takes lengths of the input
    /// to those of the solver.
    ///
    /// # Errors
    /// `InvalidOption` names the vertex: out of range, twice, on no triangle, on a seam (where it has several
    /// images), or with a place that is not finite.
    pub fn new(
        landmarks: &[Landmark],
        vertices: usize,
        input_vertices: &[u32],
        scale: f64,
    ) -> Result<Self, BuildError> {
        let mut this = Self::default();
        let mut images = vec![None; vertices];
        let mut several = vec![false; vertices];
        for (image, &v) in input_vertices.iter().enumerate() {
            several[v as usize] = images[v as usize].replace(image as u32).is_some();
        }
        let mut seen = vec![false; vertices];
        for landmark in landmarks {
            let v = landmark.vertex as usize;
            if v >= vertices {
                let what = format!("vertex {v} of {vertices} (the first is 0)");
                return Err(wrong(what));
            }
            if core::mem::replace(&mut seen[v], true) {
                return Err(wrong(format!("vertex {v} has two places")));
            }
            if !landmark.uv.is_finite() {
                return Err(wrong(format!("the place of vertex {v} is not finite")));
            }
            let Some(image) = images[v] else {
                return Err(wrong(format!("vertex {v} is on no triangle")));
            };
            if several[v] {
                let what = format!("vertex {v} is on a seam, and so has several images");
                return Err(wrong(what));
            }
            let list = match landmark.hard {
                true => &mut this.hard,
                false => &mut this.soft,
            };
            list.push((image, scale * landmark.uv));
        }
        Ok(this)
    }

    pub fn is_empty(&self) -> bool {
        self.hard.is_empty() && self.soft.is_empty()
    }

    /// The held vertices.
    pub fn pins(&self) -> Vec<u32> {
        self.hard.iter().map(|&(v, _)| v).collect()
    }

    /// The springs, if any: k is `weight` times what the shape at rest holds a vertex with.
    pub fn external(&self, rest: &RestShape, vertices: usize, weight: f64) -> Option<External> {
        if self.soft.is_empty() {
            return None;
        }
        let diagonal = rest.laplacian_diagonal(vertices);
        let springs = self.soft.iter().map(|&(vertex, target)| Spring {
            vertex,
            stiffness: weight * diagonal[vertex as usize],
            target: [target.x, target.y, 0.0],
        });
        Some(External {
            springs: springs.collect(),
            ..External::default()
        })
    }

    /// Turns and shifts a start to where the landmarks are; then moves the held vertices to their places, and
    /// the others with them, harmonically.
    ///
    /// # Errors
    /// Of the linear solve.
    pub fn apply(&self, rest: &RestShape, map: &mut [DVec2]) -> Result<(), BuildError> {
        let all = || self.hard.iter().chain(&self.soft);
        let count = all().count() as f64;
        let mean = |p: &dyn Fn(&(u32, DVec2)) -> DVec2| all().map(p).sum::<DVec2>() / count;
        let from = mean(&|&(v, _)| map[v as usize]);
        let to = mean(&|&(_, place)| place);
        // the best rotation: the direction of Σ conj(a) b as complex numbers
        let turn = all().fold(DVec2::ZERO, |sum, &(v, place)| {
            let (a, b) = (map[v as usize] - from, place - to);
            sum + DVec2::new(a.dot(b), a.perp_dot(b))
        });
        let turn = turn.try_normalize().unwrap_or(DVec2::X);
        map.iter_mut()
            .for_each(|p| *p = to + turn.rotate(*p - from));
        if self.hard.is_empty() {
            return Ok(());
        }
        let moves: Vec<(u32, DVec2)> = self
            .hard
            .iter()
            .map(|&(v, place)| (v, place - map[v as usize]))
            .collect();
        let moved = harmonic_extension(rest, map.len(), &moves)?;
        map.iter_mut().zip(moved).for_each(|(p, by)| *p += by);
        // without rounding
        for &(v, place) in &self.hard {
            map[v as usize] = place;
        }
        Ok(())
    }
}
