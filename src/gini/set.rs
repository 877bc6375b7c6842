//! The constraint set 𝒞 (§6).

use super::constraint::{Constraint, Key};
use super::elements::Elements;

/// No place.
const NONE: u32 = u32::MAX;

/// The constraints, in the order in which they came.
pub struct ConstraintSet {
    /// All of them.
    pub list: Vec<Constraint>,
    /// Of each element its place in the list.
    place: Vec<u32>,
}

impl ConstraintSet {
    /// Of no constraints, for so many elements.
    pub fn new(elements: usize) -> Self {
        Self {
            list: Vec::new(),
            place: vec![NONE; elements],
        }
    }

    /// Adds all elements below their η that are not in it yet (§6.1), of these values c. Returns how many there
    /// are below η.
    pub fn add_elements<const D: usize>(
        &mut self,
        elements: &Elements<D>,
        values: &[f64],
    ) -> usize {
        let mut below = 0;
        for (e, &value) in values.iter().enumerate() {
            if !(value >= elements.offset(e)) && elements.movable[e] {
                below += 1;
                if self.place[e] == NONE {
                    self.place[e] = self.list.len() as u32;
                    self.list.push(elements.constraint(e));
                }
            }
        }
        below
    }

    /// Removes what the dual problem found inactive: λ = 0 (§6.2).
    pub fn remove_inactive(&mut self) {
        self.retain(|constraint| constraint.lambda > 0.0);
    }

    /// Keeps some.
    pub fn retain(&mut self, keep: impl Fn(&Constraint) -> bool) {
        self.list.retain(keep);
        self.place.fill(NONE);
        for (place, constraint) in self.list.iter().enumerate() {
            if let Key::Element(e) = constraint.key {
                self.place[e as usize] = place as u32;
            }
        }
    }

    /// Removes all.
    pub fn clear(&mut self) {
        self.list.clear();
        self.place.fill(NONE);
    }

    /// Takes over the elements' offsets where they have changed.
    pub fn set_offsets<const D: usize>(&mut self, elements: &Elements<D>) {
        for constraint in &mut self.list {
            if let Key::Element(e) = constraint.key {
                constraint.offset = elements.offset(e as usize);
            }
        }
    }
}
