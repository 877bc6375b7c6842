//! The body's energy and barrier, with gradient, at positions by slot.

use super::elements::{Elements, Law, Sums};
use crate::parallel;
use crate::wrapd::external::Terms;

/// Vertices that are gathered as one piece of work.
const VERTICES: usize = 1024;

/// E + β Σ φ of (2).
pub struct Objective {
    /// The sums over the elements.
    pub elements: Box<dyn Elements>,
    /// What they are made of.
    pub law: Law,
    dimension: usize,
    /// Forces at the corners.
    forces: Vec<f64>,
    /// Where each slot's corners begin, and the corners.
    begin: Vec<u32>,
    corners: Vec<u32>,
    /// The quadratic form of a Laplacian energy.
    form: Option<Terms>,
    /// Positions at rest, by slot, and the displacements from there.
    rest: Vec<f64>,
    displacement: Vec<f64>,
}

impl Objective {
    /// Of `rest.len() / dimension` vertices.
    pub fn new(
        elements: Box<dyn Elements>,
        law: Law,
        dimension: usize,
        form: Option<Terms>,
        rest: Vec<f64>,
    ) -> Self {
        let n = rest.len() / dimension;
        let mut begin = vec![0u32; n + 1];
        for &slot in elements.corners() {
            begin[slot as usize + 1] += 1;
        }
        for v in 0..n {
            begin[v + 1] += begin[v];
        }
        let mut next = begin.clone();
        let mut corners = vec![0; elements.corners().len()];
        for (corner, &slot) in elements.corners().iter().enumerate() {
            let place = &mut next[slot as usize];
            corners[*place as usize] = corner as u32;
            *place += 1;
        }
        Self {
            forces: vec![0.0; corners.len() * dimension],
            elements,
            law,
            dimension,
            begin,
            corners,
            displacement: vec![0.0; if form.is_some() { rest.len() } else { 0 }],
            form,
            rest,
        }
    }

    /// Energy and barrier.
    pub fn value(&mut self, x: &[f64]) -> Sums {
        let mut sums = self.elements.value(self.law, x);
        sums.energy += self.quadratic(x);
        sums
    }

    /// The same with singular values, and the gradient.
    pub fn gradient(&mut self, x: &[f64], gradient: &mut [f64]) -> Sums {
        let mut sums = self.elements.gradient(self.law, x, &mut self.forces);
        sums.energy += self.quadratic(x);
        match self.dimension {
            2 => self.gather::<2>(gradient),
            _ => self.gather::<3>(gradient),
        }
        sums
    }

    /// Evaluates the quadratic form, whose gradient it keeps.
    fn quadratic(&mut self, x: &[f64]) -> f64 {
        let Some(form) = &mut self.form else {
            return 0.0;
        };
        let displaced = self.displacement.iter_mut().zip(x.iter().zip(&self.rest));
        displaced.for_each(|(u, (x, rest))| *u = x - rest);
        form.evaluate(&self.displacement);
        form.energy
    }

    fn gather<const D: usize>(&self, gradient: &mut [f64]) {
        let forces = self.forces.as_chunks::<D>().0;
        let form = self
            .form
            .as_ref()
            .map(|form| form.gradient.as_chunks::<D>().0);
        parallel::for_each_chunk(gradient, VERTICES * D, |chunk, out| {
            for (local, g) in out.as_chunks_mut::<D>().0.iter_mut().enumerate() {
                let v = chunk * VERTICES + local;
                *g = form.map_or([0.0; D], |form| form[v]);
                let corners = self.begin[v] as usize..self.begin[v + 1] as usize;
                for &corner in &self.corners[corners] {
                    for (g, force) in g.iter_mut().zip(&forces[corner as usize]) {
                        *g += force;
                    }
                }
            }
        });
    }
}
