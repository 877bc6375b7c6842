//! What may be changed between steps, and per-element fields.

use super::Newton;
use crate::optim::{Deformer, Field, SolveError, Spring, Status};
use crate::parallel;

impl Deformer for Newton {
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError> {
        let dimension = self.evaluation.shape.dimension;
        for (vertex, point) in positions {
            let at = self.slot[*vertex as usize] as usize * dimension;
            assert!(at >= self.unknowns, "vertex {vertex} is not pinned");
            let at = *vertex as usize * dimension;
            self.positions[at..at + dimension].copy_from_slice(&point[..dimension]);
        }
        let terms = self.evaluation.terms.as_mut();
        assert!(terms.is_some() || springs.is_empty(), "no external terms");
        // the matrix is filled anew in every step
        if let Some(terms) = terms {
            terms.set_springs(springs, &self.slot);
        }
        parallel::in_pool(|| self.look());
        self.counted_from = self.report.iteration;
        self.report.status = Status::Running;
        Ok(())
    }

    fn field(&self, field: Field) -> Vec<f32> {
        self.evaluation.field(field)
    }
}
