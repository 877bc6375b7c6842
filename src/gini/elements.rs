//! The elements as constraints: corners, scales and offsets η, in the order of memory.

use super::constraint::{Constraint, Key, Law};
use super::simplex::{corners, signed_measure};
use crate::geometry::RestShape;
use crate::parallel;

/// Elements that are one piece of work.
const CHUNK: usize = 4096;

/// γ with which a zone begins (§5).
pub const FIRST_DAMPING: f64 = 1e-3;

/// All elements of the mesh.
pub struct Elements<const D: usize> {
    /// Slots of the corners; in the plane the fourth repeats the third.
    pub slots: Vec<[u32; 4]>,
    /// 2/s, s the boundary measure at rest.
    pub scale: Vec<f64>,
    /// Rest measure times scale: what c is at rest.
    pub rest: Vec<f64>,
    /// η/c at rest.
    pub relative_offset: Vec<f64>,
    /// Can it move at all?
    pub movable: Vec<bool>,
}

impl<const D: usize> Elements<D> {
    /// Of rest shapes in the order of memory, with slots; vertices for which `held` holds never move.
    pub fn new(rest: &RestShape, slot: &[u32], held: &[bool], offset: f64) -> Self {
        let mut this = Self {
            slots: Vec::with_capacity(rest.len()),
            scale: Vec::with_capacity(rest.len()),
            rest: Vec::with_capacity(rest.len()),
            relative_offset: vec![offset; rest.len()],
            movable: Vec::with_capacity(rest.len()),
        };
        for e in 0..rest.len() {
            let simplex = rest.simplex(e);
            let corner = |i: usize| slot[simplex[i.min(D)] as usize];
            this.slots
                .push([corner(0), corner(1), corner(2), corner(3)]);
            // the facet opposite to a corner measures k A |g|
            let facets = (0..=D).map(|v| rest.hat_product(e, v, v).sqrt());
            let boundary = D as f64 * rest.measure[e] * facets.sum::<f64>();
            this.scale.push(2.0 / boundary);
            this.rest.push(2.0 * rest.measure[e] / boundary);
            this.movable
                .push(simplex.iter().any(|&v| !held[slot[v as usize] as usize]));
        }
        this
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.slots.len()
    }

    /// c of every element.
    pub fn values(&self, x: &[[f64; D]], out: &mut [f64]) {
        parallel::for_each_chunk(out, CHUNK, |chunk, out| {
            let first = chunk * CHUNK;
            let elements = self.slots[first..].iter().zip(&self.scale[first..]);
            for (out, (slots, scale)) in out.iter_mut().zip(elements) {
                *out = scale * signed_measure(&corners(x, slots));
            }
        });
    }

    /// The constraint of an element.
    pub fn constraint(&self, e: usize) -> Constraint {
        let law = Law::Measure {
            scale: self.scale[e],
        };
        Constraint {
            key: Key::Element(e as u32),
            slots: self.slots[e],
            law,
            base: law,
            offset: self.offset(e),
            lambda: 0.0,
            damping: FIRST_DAMPING,
            proximal: false,
            skipped: false,
        }
    }

    /// η of an element.
    pub fn offset(&self, e: usize) -> f64 {
        self.relative_offset[e] * self.rest[e]
    }
}
