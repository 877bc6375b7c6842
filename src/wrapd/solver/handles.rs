//! What may be changed between steps, and per-element fields.

use super::{BLOCK, Block, Wrapd};
use crate::optim::{Deformer, Field, SolveError, Spring, Status};
use crate::parallel;

impl Deformer for Wrapd {
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError> {
        let (dimension, unknowns) = (self.shape.dimension, self.gradient.len());
        for (vertex, point) in positions {
            let at = self.slot[*vertex as usize] as usize * dimension;
            assert!(at >= unknowns, "vertex {vertex} is not pinned");
            self.x[at..at + dimension].copy_from_slice(&point[..dimension]);
        }
        parallel::in_pool(|| {
            let terms = self.terms.as_mut();
            assert!(terms.is_some() || springs.is_empty(), "no external terms");
            if terms.is_some_and(|terms| terms.set_springs(springs, &self.slot)) {
                self.refactor(self.report.iteration)?;
            }
            self.look();
            self.publish();
            self.counted_from = self.report.iteration;
            self.report.status = Status::Running;
            Ok(())
        })
    }

    fn field(&self, field: Field) -> Vec<f32> {
        self.by_element(|block, e| self.elements.field(block, e, field))
    }
}

impl Wrapd {
    /// Begins anew at these positions, by vertex; weights and factor stay.
    pub(crate) fn restart(&mut self, positions: &[f64]) {
        let dimension = self.shape.dimension;
        for (position, &slot) in positions.chunks_exact(dimension).zip(&self.slot) {
            self.x[slot as usize * dimension..][..dimension].copy_from_slice(position);
        }
        // Z and U are set anew in the first iterations
        self.report.iteration = 0;
        self.counted_from = 0;
        self.history.clear();
        parallel::in_pool(|| {
            self.look();
            self.publish();
        });
        self.report.status = Status::Running;
    }

    /// One value an element, in the input's order.
    pub(super) fn by_element(&self, value: impl Fn(&Block, usize) -> f32) -> Vec<f32> {
        let mut values = vec![0.0; self.order.len()];
        for (place, &element) in self.order.iter().enumerate() {
            values[element as usize] = value(&self.blocks[place / BLOCK], place % BLOCK);
        }
        values
    }
}
