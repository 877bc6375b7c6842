//! What is done after a step that a few triangles have cut short.

use super::Newton;
use super::search::Found;

/// A step shorter than this was cut short.
const SHORT: f64 = 0.5;

impl Newton {
    /// After a short step moves vertices one by one, in `trial`, if that lowers the energy.
    pub(super) fn mend(&mut self, found: Found) -> Found {
        let Some(relaxation) = self.relaxation.as_ref().filter(|_| found.step < SHORT) else {
            return found;
        };
        let unknowns = self.unknowns;
        self.direction[..unknowns].copy_from_slice(&self.trial[..unknowns]);
        relaxation.relax(&mut self.trial);
        let value = self.evaluation.at(&self.trial, &mut self.trial_gradient);
        if value.energy <= found.value.energy {
            return Found { value, ..found };
        }
        self.trial[..unknowns].copy_from_slice(&self.direction[..unknowns]);
        let value = self.evaluation.at(&self.trial, &mut self.trial_gradient);
        Found { value, ..found }
    }
}
