//! What may be changed between steps, and per-element fields.

use super::Lim;
use crate::optim::{Deformer, Field, SolveError, Spring, Status};
use crate::parallel;

impl Deformer for Lim {
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError> {
        for (vertex, point) in positions {
            let slot = self.slot[*vertex as usize];
            let handles = &mut self.constraints.handles;
            let place = handles.binary_search_by_key(&slot, |handle| handle.slot);
            let place = place.unwrap_or_else(|_| panic!("vertex {vertex} is not pinned"));
            handles[place].target = *point;
        }
        let by_slot = springs.iter().map(|spring| {
            let vertex = self.slot[spring.vertex as usize];
            Spring { vertex, ..*spring }
        });
        self.constraints.springs = by_slot.collect();
        self.constraints.restart();
        self.constraints.hold_arrived(&self.x);
        parallel::in_pool(|| self.look());
        self.constraints.remember_sub_targets();
        self.report.lim = Some(self.parameters(0.0, 0.0));
        self.quiet = 0;
        self.counted_from = self.report.iteration;
        self.report.status = Status::Running;
        Ok(())
    }

    fn field(&self, field: Field) -> Vec<f32> {
        self.objective
            .elements
            .field(self.objective.law, &self.x, field)
    }

    fn sub_targets(&self) -> Vec<(u32, [f64; 3])> {
        let mut vertices = vec![0u32; self.slot.len()];
        for (vertex, &slot) in self.slot.iter().enumerate() {
            vertices[slot as usize] = vertex as u32;
        }
        let waiting = self.constraints.handles.iter().filter(|h| !h.arrived);
        waiting
            .map(|handle| (vertices[handle.slot as usize], handle.led_to))
            .collect()
    }
}
