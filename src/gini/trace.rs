//! What the polisher goes through in a step, for those who want to see it.

use super::constraint::Key;
use super::solver::Gini;

/// x̂ before an iteration of the polisher, or after the last of a step, and what it works on.
#[derive(Debug, Clone, PartialEq)]
pub struct PolishState {
    /// Vertices × dimension, interleaved.
    pub positions: Vec<f64>,
    /// Elements that are inverted or flat, in floating point.
    pub inverted: usize,
    /// Constraints below their η.
    pub violated: usize,
    /// Of each element the zone of violated constraints that it is in, the first being 1; 0: in none.
    pub zones: Vec<u32>,
}

impl<const D: usize> Gini<D> {
    /// Keeps the polisher's states of every step from here on, or no more.
    pub fn set_trace(&mut self, on: bool) {
        self.trace = on.then(Vec::new);
    }

    /// The polisher's states in the newest step: one before each of its iterations, and one after the last. Empty
    /// before the first step, and where they are not kept.
    pub fn trace(&self) -> &[PolishState] {
        self.trace.as_deref().unwrap_or_default()
    }

    /// A step begins.
    pub(super) fn begin_trace(&mut self) {
        self.trace.iter_mut().for_each(Vec::clear);
    }

    /// Keeps x̂, of which no zones are known yet.
    pub(super) fn trace_state(&mut self, inverted: usize, violated: usize) {
        if let Some(trace) = &mut self.trace {
            let at = |&slot: &u32| self.trial[slot as usize];
            trace.push(PolishState {
                positions: self.slot.iter().flat_map(at).collect(),
                inverted,
                violated,
                zones: vec![0; self.order.len()],
            });
        }
    }

    /// Keeps the zones of the state that was kept last: those with violated constraints, as the polisher counts them.
    pub(super) fn trace_zones(&mut self) {
        let Some(state) = self.trace.as_mut().and_then(|trace| trace.last_mut()) else {
            return;
        };
        // x̂ has been polished since: what was violated is what was at the state that was kept
        let mut before = self.trial.clone();
        let kept = state.positions.as_chunks::<D>().0.iter();
        for (position, &slot) in kept.zip(&self.slot) {
            before[slot as usize] = *position;
        }
        let mut number = 0;
        for z in 0..self.zones.len() {
            let members = self.zones.constraints(z).iter();
            let members = members.map(|&c| &self.set.list[c as usize]);
            if !members.clone().any(|c| c.is_violated(&before)) {
                continue;
            }
            number += 1;
            for constraint in members {
                // contacts are no elements; those beside them are in the zone where they are violated, too
                if let Key::Element(e) = constraint.key {
                    state.zones[self.order[e as usize] as usize] = number;
                }
            }
        }
    }
}
