//! Exact checks on a deformed solid.
//!
//! # What is proven
//! The map takes the rest shape to the deformed one and is linear on every tetrahedron. Signs of volumes,
//! and the order of directions around edges and vertices, are decided exactly for every finite input, so
//! what a certificate claims is a theorem about the numbers given.
//!
//! A tetrahedron is *positive* if its volume has the sign that it has at rest; in which order its vertices
//! are given does not matter. The tetrahedra are to form a manifold at rest: every face has one of them on
//! a side, those of an edge form one ring or one fan, those of a vertex hang together by faces. If so and
//! all are positive, then [`SolidCertificate::locally_injective`] holds exactly when **the tetrahedra around
//! any vertex, taken together, are mapped injectively**; it follows that every point of the solid, inside
//! or on its boundary, has a neighbourhood that is mapped injectively.
//!
//! * *Faces*: the two tetrahedra of a face are on different sides of it, being positive.
//! * *Edges*: the dihedral angles of a ring add up to a multiple of a full turn. Once is what is wanted;
//!   a ring that goes around more often, and a fan that reaches its own beginning or beyond, are
//!   [`SolidCertificate::overwound_edges`].
//! * *Vertices inside*: the link of a vertex v (the faces opposite to v of its tetrahedra) is a closed
//!   connected surface, and its map to the sphere of directions from the image of v is a local
//!   homeomorphism: in its triangles as they are positive, across their edges by what was said of faces, at
//!   their corners by what was said of edges. A local homeomorphism between closed surfaces is a
//!   covering, and the sphere is covered by nothing connected but itself, once. So every direction is
//!   taken once, and the tetrahedra around v do not overlap: nothing more has to be checked.
//! * *Vertices on the boundary*: the link is a connected surface with boundary loops. If the image of each
//!   loop is a simple curve ([`SolidCertificate::overwound_vertices`] are where one is not), close each loop
//!   by the part of the sphere on its other side: the closed surface made in this way is mapped by a
//!   local homeomorphism as before, so once and for all directions at most one tetrahedron.
//!
//! Conversely, at an overwound edge or vertex two tetrahedra overlap, or two faces of the boundary touch
//! beyond what they share.
//!
//! # What is not
//! That distant parts of the solid do not overlap. For that its boundary must not meet itself. If it does
//! not, and the boundary is one connected surface, a locally injective map is injective: the number of
//! points mapped to a place changes only across the image of the boundary, by one, and is 0 far away.
//!
//! A solid all of whose tetrahedra are inverted ([`SolidCertificate::mirrored`]) may be as injective as its
//! mirror image is, but no deformation leads there without flattening it: it counts as folded.

mod arcs;
mod links;
mod rings;
mod sigma;
mod summary;
mod winding;

use super::predicates::orientation_of_tetrahedron;
use crate::Error;
use crate::mesh::{MeshError, SolidMesh};
use crate::optim::BuildError;
use glam::DVec3;
use rings::Rings;
use std::cmp::Ordering;

/// What is known for certain of a deformed solid, and how much it is stretched.
///
/// Numbers that do not exist (with coordinates that are not finite, or without tetrahedra) are NaN; NaN
/// and infinity are `null` in JSON. Lists are in ascending order, vertices within an edge or face too.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct SolidCertificate {
    /// Number of tetrahedra.
    pub elements: usize,
    /// Tetrahedra whose volume has another sign than at rest.
    pub inverted: Vec<u32>,
    /// Tetrahedra without volume once deformed, or with a coordinate that is not finite.
    pub degenerate: Vec<u32>,
    /// Tetrahedra without volume at rest (or with a coordinate that is not finite there), for which there
    /// is no telling whether they are inverted. All that follows leaves them out.
    pub flat_at_rest: Vec<u32>,
    /// Is every tetrahedron inverted: is the solid its mirror image?
    pub mirrored: bool,
    /// Faces of the boundary.
    pub boundary_faces: usize,
    /// Faces of three or more tetrahedra, or with two that lie on the same side of it at rest.
    pub irregular_faces: Vec<[u32; 3]>,
    /// Edges whose tetrahedra form more than one ring or fan.
    pub irregular_edges: Vec<[u32; 2]>,
    /// Vertices whose tetrahedra do not all hang together by faces.
    pub irregular_vertices: Vec<u32>,
    /// Edges around which the tetrahedra go more than once, or, if the edge is on the boundary, a full turn
    /// or more; empty while there are inverted or degenerate tetrahedra. Irregular edges are not looked at.
    pub overwound_edges: Vec<[u32; 2]>,
    /// How many of these are inside the solid.
    pub overwound_inside: usize,
    /// Vertices of the boundary beside which the boundary meets itself: where two of the faces around the
    /// vertex, which share no edge there, do. Empty while there are inverted or degenerate tetrahedra.
    /// Vertices that are irregular or on irregular edges or faces are not looked at.
    pub overwound_vertices: Vec<u32>,
    /// Is the map injective around every point, inside and on the boundary? Proven for all tetrahedra of
    /// every vertex together.
    pub locally_injective: bool,
    /// Smallest signed singular value of any tetrahedron, in floating point but for its sign.
    pub smallest_sigma: f64,
    /// Largest singular value of any tetrahedron, in floating point.
    pub largest_sigma: f64,
}

impl SolidCertificate {
    /// Examines the map that takes vertex i of `rest` to `positions[i]`.
    ///
    /// # Panics
    /// If the arguments do not fit together; [`SolidCertificate::try_of_solid`] returns an error instead.
    pub fn of_solid(rest: &SolidMesh, positions: &[DVec3]) -> Self {
        match Self::try_of_solid(rest, positions) {
            Ok(certificate) => certificate,
            Err(error) => panic!("{error}"),
        }
    }

    /// Examines a map of unchecked origin. Any tetrahedra and any numbers will do, as long as there is a
    /// position for every vertex ([`BuildError::WrongLength`]) and every tetrahedron names vertices that
    /// exist ([`MeshError::IndexOutOfRange`]).
    ///
    /// # Errors
    /// These two.
    pub fn try_of_solid(rest: &SolidMesh, positions: &[DVec3]) -> Result<Self, Error> {
        check_arguments(rest, positions)?;
        let (mut inverted, mut degenerate, mut flat_at_rest) = (Vec::new(), Vec::new(), Vec::new());
        // With a volume, and turned to be positive at rest.
        let mut tetrahedra = Vec::with_capacity(rest.simplices.len());
        let (mut smallest_sigma, mut largest_sigma) = (f64::INFINITY, 0.0f64);
        for (i, &t) in rest.simplices.iter().enumerate() {
            let before = t.map(|v| rest.positions[v as usize]);
            let after = t.map(|v| positions[v as usize]);
            let sign = |[a, b, c, d]: [DVec3; 4]| orientation_of_tetrahedron(a, b, c, d);
            let (at_rest, image) = (sign(before), sign(after));
            if at_rest.is_eq() {
                flat_at_rest.push(i as u32);
                continue;
            }
            let image = match at_rest {
                Ordering::Less => image.reverse(),
                _ => image,
            };
            match image {
                Ordering::Greater => {}
                Ordering::Equal => degenerate.push(i as u32),
                Ordering::Less => inverted.push(i as u32),
            }
            let [a, b, c, d] = t;
            tetrahedra.push(if at_rest.is_gt() { t } else { [a, b, d, c] });
            let (smallest, largest) = sigma::extremes(before, after, image);
            // Unlike `min` and `max` these keep a NaN.
            if !(smallest_sigma <= smallest) && !smallest_sigma.is_nan() {
                smallest_sigma = smallest;
            }
            if !(largest_sigma >= largest) && !largest_sigma.is_nan() {
                largest_sigma = largest;
            }
        }
        if tetrahedra.is_empty() {
            (smallest_sigma, largest_sigma) = (f64::NAN, f64::NAN);
        }
        let positive = inverted.is_empty() && degenerate.is_empty();
        let rings = Rings::new(&tetrahedra, positions.len());
        let overwound = match positive {
            true => winding::overwound(&rings, positions),
            false => Vec::new(),
        };
        let overwound_vertices = match positive {
            true => overwound_vertices(&rings, positions),
            false => Vec::new(),
        };
        let is_manifold = rings.irregular_faces.is_empty()
            && rings.irregular_edges.is_empty()
            && rings.irregular_vertices.is_empty();
        let locally_injective = !tetrahedra.is_empty()
            && flat_at_rest.is_empty()
            && positive
            && is_manifold
            && overwound.is_empty()
            && overwound_vertices.is_empty();
        Ok(Self {
            elements: rest.simplices.len(),
            mirrored: !inverted.is_empty() && inverted.len() == rest.simplices.len(),
            inverted,
            degenerate,
            flat_at_rest,
            boundary_faces: rings.boundary.len(),
            overwound_edges: overwound.iter().map(|ring| ring.ends).collect(),
            overwound_inside: overwound.iter().filter(|ring| ring.closed).count(),
            overwound_vertices,
            irregular_faces: rings.irregular_faces,
            irregular_edges: rings.irregular_edges,
            irregular_vertices: rings.irregular_vertices,
            locally_injective,
            smallest_sigma,
            largest_sigma,
        })
    }

    /// Is no tetrahedron inverted or degenerate, none without volume at rest, and does no face have two
    /// tetrahedra on one side? Weaker than `locally_injective`: the tetrahedra around an edge may go around
    /// it more than once.
    pub fn is_free_of_folds(&self) -> bool {
        self.elements > 0
            && self.inverted.is_empty()
            && self.degenerate.is_empty()
            && self.flat_at_rest.is_empty()
            && self.irregular_faces.is_empty()
    }
}

fn overwound_vertices(rings: &Rings, positions: &[DVec3]) -> Vec<u32> {
    let mut skip = vec![false; positions.len()];
    let irregular = rings.irregular_vertices.iter();
    irregular
        .chain(rings.irregular_edges.iter().flatten())
        .chain(rings.irregular_faces.iter().flatten())
        .for_each(|&v| skip[v as usize] = true);
    links::overwound(&rings.boundary, |v| skip[v as usize], positions)
}

fn check_arguments(rest: &SolidMesh, positions: &[DVec3]) -> Result<(), Error> {
    let vertices = rest.positions.len();
    if positions.len() != vertices {
        Err(BuildError::WrongLength {
            argument: "positions",
            expected: vertices,
            found: positions.len(),
        })?;
    }
    for (face, t) in rest.simplices.iter().enumerate() {
        if let Some(&index) = t.iter().find(|&&v| v as usize >= vertices) {
            let index = index.into();
            Err(MeshError::IndexOutOfRange {
                face,
                index,
                vertices,
            })?;
        }
    }
    Ok(())
}
