//! η, chosen automatically (§8.5 of the paper names it as future work).

use super::elements::Elements;

/// By how much η of an element is reduced.
const FACTOR: f64 = 0.25;

/// What it is not reduced below, relative to the rest measure.
const LEAST: f64 = 1e-9;

impl<const D: usize> Elements<D> {
    /// Reduces η of elements `chosen` by their values c, not below `least`. Returns how many were.
    pub fn back_off(&mut self, chosen: impl Iterator<Item = usize>, least: f64) -> usize {
        let least = least.max(LEAST);
        let mut count = 0;
        for e in chosen {
            let offset = &mut self.relative_offset[e];
            if *offset > least {
                *offset = (FACTOR * *offset).max(least);
                count += 1;
            }
        }
        count
    }
}
