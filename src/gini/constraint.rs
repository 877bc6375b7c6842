//! One constraint c(x) ≥ η: what it is about, and its value and gradient.

use super::simplex::{Corners, corners, measure_gradient, signed_measure};

/// What a constraint is about: its identity, which survives iterations, and with it λ and γ.
///
/// Contacts, once they come, are further kinds: a vertex with a face (in the plane: with an edge), an edge with an
/// edge. All of them are about at most four vertices, as an element is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// The element at this place must not invert.
    Element(u32),
}

/// How c depends on the positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// The signed measure of the simplex of the vertices, times this scale (1/length^(d−1)).
    Measure {
        /// 2/s, s the boundary measure of the element at rest (§6): gradients are near 1, whatever the size.
        scale: f64,
    },
}

/// c(x) ≥ η on at most four vertices. All in the unit of a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Constraint {
    /// What it is about.
    pub key: Key,
    /// Slots of its vertices; one that is not needed repeats the one before.
    pub slots: [u32; 4],
    /// What c is.
    pub law: Law,
    /// η.
    pub offset: f64,
    /// The multiplier of the dual problem (10), by which the next one starts.
    pub lambda: f64,
    /// γ of the zone it was in last (13).
    pub damping: f64,
}

impl Constraint {
    /// c(x).
    #[inline]
    pub fn value<const D: usize>(&self, x: &[[f64; D]]) -> f64 {
        self.value_at(&corners(x, &self.slots))
    }

    /// c of these corners.
    #[inline]
    pub fn value_at<const D: usize>(&self, p: &Corners<D>) -> f64 {
        match self.law {
            Law::Measure { scale } => scale * signed_measure(p),
        }
    }

    /// ∇c of these corners.
    #[inline]
    pub fn gradient_at<const D: usize>(&self, p: &Corners<D>) -> [[f64; D]; 4] {
        match self.law {
            Law::Measure { scale } => {
                let mut g = measure_gradient(p);
                g.iter_mut().flatten().for_each(|g| *g *= scale);
                g
            }
        }
    }
}
