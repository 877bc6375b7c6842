//! One constraint c(x) ≥ η: what it is about, and its value and gradient.

use super::contact::{gap, gap_gradient, is_above, is_across};
use super::simplex::{Corners, corners, measure_gradient, signed_measure};
use crate::collision::Candidate;

/// What a constraint is about: its identity, which survives iterations, and with it λ and γ. All of them are about at
/// most four vertices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Key {
    /// The element at this place must not invert.
    Element(u32),
    /// The two must not pass through each other: the vertex (a slot) stays outside of the boundary face, in the plane of
    /// the boundary edge.
    Contact(Candidate),
}

impl Key {
    /// Is it about two parts of a boundary?
    pub fn is_contact(&self) -> bool {
        matches!(self, Key::Contact(_))
    }
}

/// How c depends on the positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Law {
    /// The signed measure of the simplex of the vertices, times this scale (1/length^(d−1)): of an element, or of the
    /// air between two edges.
    Measure {
        /// 2/s, s the boundary measure of the element at rest (§6), of air when it came up: gradients are near 1,
        /// whatever the size.
        scale: f64,
    },
    /// The height of the first vertex above the facet of the others (§6).
    Gap,
    /// How far the points that met are apart along the normal with which they did. Of pairs that collide on the way
    /// while the other laws see them on the right side again at its end: whoever meets has a negative distance then.
    Impact {
        /// The unit normal; in the plane the third component is 0.
        normal: [f64; 3],
        /// Of the points that met, one less the other, barycentric coordinates.
        weights: [f64; 4],
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
    /// What it is of a contact whenever it is not [`Law::Impact`].
    pub base: Law,
    /// η.
    pub offset: f64,
    /// The multiplier of the dual problem (10), by which the next one starts.
    pub lambda: f64,
    /// γ of the zone it was in last (13).
    pub damping: f64,
    /// A contact whose two parts did not collide any more when it was last looked at (§6.1).
    pub proximal: bool,
    /// A proximal contact whose parts are not opposite to each other: it does not count for now (§6.1).
    pub skipped: bool,
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
            Law::Gap => gap(p),
            Law::Impact { normal, weights } => {
                let mut sum = 0.0;
                for (p, w) in p.iter().zip(weights) {
                    for i in 0..D {
                        sum += w * normal[i] * p[i];
                    }
                }
                sum
            }
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
            Law::Gap => gap_gradient(p),
            Law::Impact { normal, weights } => {
                weights.map(|w| std::array::from_fn(|i| w * normal[i]))
            }
        }
    }

    /// Are the two parts of a contact opposite to each other: is no barycentric coordinate of the vertex's foot, or of
    /// the edges' nearest points, negative? Always true of elements.
    pub fn is_opposite<const D: usize>(&self, x: &[[f64; D]]) -> bool {
        let p = corners(x, &self.slots);
        match self.key {
            Key::Element(_) => true,
            Key::Contact(Candidate::VertexFacet { .. }) => is_above(&p),
            Key::Contact(Candidate::EdgeEdge { .. }) => is_across(&p),
        }
    }

    /// Is c < η, and does it count?
    #[inline]
    pub fn is_violated<const D: usize>(&self, x: &[[f64; D]]) -> bool {
        !self.skipped && self.value(x) < self.offset
    }
}
