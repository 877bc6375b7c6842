//! Exact checks on a finished map: of a surface into the plane ([`Certificate`], below), or of a solid
//! in space ([`SolidCertificate`], whose module says what it proves).
//!
//! # What is proven
//! Signs of areas and meetings of edges are decided exactly, for every finite input, so what a
//! certificate claims of injectivity is a theorem about the numbers given, not an estimate. The map
//! is linear on every triangle, and:
//!
//! * **A disk, all triangles strictly positive, a boundary that does not meet itself ⇒ the map is a
//!   homeomorphism onto its image** (globally injective). Without inverted triangles the number of
//!   triangles over a point off the images of edges is the winding number of the boundary around it.
//!   A simple closed curve winds 0 or ±1 times around any point (Jordan), so no two triangles share
//!   inner points; and two different points with one image would have overlapping triangles around
//!   them.
//! * **Any other surface**, with several boundary loops, handles or pieces: the same argument needs
//!   that the winding numbers of all loops together never exceed 1. [`Certificate::sheets`] is their
//!   exact maximum (2 for a small disk laid on a large one, though no boundaries meet).
//! * **Local injectivity** needs more than positive triangles: those around a vertex may wind around
//!   it more than once ([`Certificate::overwound`], counted exactly).
//! * A closed surface has no map into the plane without inverted or degenerate triangles.
//!
//! The vertices of the seams of a cut mesh are separate vertices, and seams are boundary: the
//! claims are about the mesh as it was cut.
//!
//! # Orientation
//! A triangle is positive when its image turns counter-clockwise in the order of its vertices. If every
//! triangle is inverted the map is [`Certificate::mirrored`]: it is as injective as its mirror image,
//! and everything but `inverted` speaks of that mirror image (u negated).

mod corners;
mod crossings;
mod distortion;
mod predicates;
mod segments;
pub mod solid;
mod summary;
mod surface;
mod winding;

pub use corners::CornerMap;
pub use crossings::BoundaryCrossing;
pub use predicates::{orientation, orientation_of_tetrahedron};
pub use segments::CrossingKind;
pub(crate) use segments::{meet, meet_beyond};
pub use solid::SolidCertificate;

use crate::Error;
use crate::mesh::{MeshError, SurfaceMesh};
use crate::optim::BuildError;
use glam::DVec2;
use std::cmp::Ordering;
use surface::Surface;

/// Crossings kept in [`Certificate::boundary_crossings`].
const LISTED: usize = 1000;
/// Crossings after which the search ends.
const COUNTED: usize = 100_000;

/// What is known for certain of a map, and how much it distorts.
///
/// Numbers that do not exist (of a map with coordinates that are not finite, or of no triangles) are
/// NaN; NaN and infinity are `null` in JSON.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct Certificate {
    /// Number of triangles.
    pub elements: usize,
    /// Triangles whose image is turned over, in ascending order.
    pub inverted: Vec<u32>,
    /// Triangles whose image has no area or a coordinate that is not finite, in ascending order.
    pub degenerate: Vec<u32>,
    /// Is every triangle inverted? Then all that follows is about the mirror image of the map.
    pub mirrored: bool,
    /// Vertices around which the triangles wind more than once; empty while there are inverted or
    /// degenerate triangles.
    pub overwound: Vec<u32>,
    /// How many of these are inside the surface (branch points); the others are on its boundary, where
    /// the surface laps over itself beside the vertex.
    pub overwound_inside: usize,
    /// Edges that do not join two consistently oriented triangles, nor bound one.
    pub irregular_edges: usize,
    /// Edges of the boundary.
    pub boundary_edges: usize,
    /// Closed loops of the boundary; 0 when loops share a vertex.
    pub boundary_loops: usize,
    /// Is the surface a disk?
    pub is_disk: bool,
    /// Pairs of boundary edges that meet where they should not: the first 1000.
    pub boundary_crossings: Vec<BoundaryCrossing>,
    /// Number of such pairs, counted up to 100 000.
    pub boundary_crossing_count: usize,
    /// Largest number of triangles over one point; `None` unless all triangles are positive and the
    /// boundary does not meet itself.
    pub sheets: Option<u32>,
    /// Is the map injective around every point?
    pub locally_injective: bool,
    /// Is the map injective: a homeomorphism onto its image?
    pub globally_injective: bool,
    /// Symmetric Dirichlet energy ¼ Σ A (σ₁² + σ₁⁻² + σ₂² + σ₂⁻² − 4) + 1 with the surface scaled to unit
    /// area and the map by the same factor: 1 for an isometry, infinite with inverted triangles.
    pub symmetric_dirichlet: f64,
    /// Smallest signed singular value of any triangle.
    pub smallest_sigma: f64,
    /// Largest singular value of any triangle.
    pub largest_sigma: f64,
    /// Largest σ₁ / |σ₂| of any triangle: 1 for a conformal map.
    pub worst_anisotropy: f64,
    /// Triangles without area at rest: they have no singular values and are left out of the measures.
    pub flat_at_rest: usize,
}

impl Certificate {
    /// Examines the map that takes vertex i of `rest` to `uv[i]` (one point a vertex, in the units of
    /// `rest`).
    ///
    /// # Panics
    /// If the arguments do not fit together; [`Certificate::try_of_map`] returns an error instead.
    pub fn of_map(rest: &SurfaceMesh, uv: &[DVec2]) -> Certificate {
        match Self::try_of_map(rest, uv) {
            Ok(certificate) => certificate,
            Err(error) => panic!("{error}"),
        }
    }

    /// Examines a map of unchecked origin. Any triangles and any numbers will do, as long as there is a
    /// point for every vertex ([`BuildError::WrongLength`]) and every triangle names vertices that exist
    /// ([`MeshError::IndexOutOfRange`]).
    pub fn try_of_map(rest: &SurfaceMesh, uv: &[DVec2]) -> Result<Certificate, Error> {
        check_arguments(rest, uv)?;
        let triangles = &rest.simplices;
        let (mut inverted, mut degenerate) = (Vec::new(), Vec::new());
        for (i, t) in triangles.iter().enumerate() {
            let [a, b, c] = t.map(|v| uv[v as usize]);
            match orientation(a, b, c) {
                Ordering::Greater => {}
                Ordering::Equal => degenerate.push(i as u32),
                Ordering::Less => inverted.push(i as u32),
            }
        }
        let mirrored = !inverted.is_empty() && inverted.len() == triangles.len();
        let flipped: Vec<DVec2>;
        let uv = if mirrored {
            flipped = uv.iter().map(|p| DVec2::new(-p.x, p.y)).collect();
            &flipped
        } else {
            uv
        };
        let positive =
            !triangles.is_empty() && degenerate.is_empty() && (inverted.is_empty() || mirrored);

        let surface = Surface::new(triangles, rest.positions.len());
        let finite = |e: &&[u32; 2]| e.iter().all(|&v| uv[v as usize].is_finite());
        let finite_edges: Vec<[u32; 2]> = surface.boundary.iter().filter(finite).copied().collect();
        let mut boundary_crossings = crossings::find(&finite_edges, uv, COUNTED);
        let boundary_crossing_count = boundary_crossings.len();
        boundary_crossings.truncate(LISTED);

        let regular = positive && surface.irregular_edges == 0;
        let overwound = if regular {
            winding::overwound_vertices(triangles, &surface.boundary, uv)
        } else {
            Vec::new()
        };
        let on_boundary = |v: &u32| surface.boundary.binary_search_by_key(v, |e| e[0]);
        let sheets = (regular && boundary_crossing_count == 0)
            .then(|| winding::sheets(&surface.boundary, uv).unsigned_abs() as u32);
        let measures = distortion::measure(rest, uv);
        Ok(Certificate {
            elements: triangles.len(),
            inverted,
            degenerate,
            mirrored,
            locally_injective: regular && overwound.is_empty(),
            overwound_inside: overwound.iter().filter(|v| on_boundary(v).is_err()).count(),
            overwound,
            irregular_edges: surface.irregular_edges,
            boundary_edges: surface.boundary.len(),
            boundary_loops: surface.boundary_loops,
            is_disk: surface.is_disk,
            boundary_crossings,
            boundary_crossing_count,
            sheets,
            globally_injective: sheets == Some(1),
            symmetric_dirichlet: measures.symmetric_dirichlet,
            smallest_sigma: measures.smallest_sigma,
            largest_sigma: measures.largest_sigma,
            worst_anisotropy: measures.worst_anisotropy,
            flat_at_rest: measures.flat_at_rest,
        })
    }
}

impl Certificate {
    /// Is no triangle inverted or degenerate (or every one inverted) and does no edge have two
    /// triangles on one side? Weaker than `locally_injective`: the triangles around a vertex may
    /// wind more than once.
    pub fn is_free_of_folds(&self) -> bool {
        let inverted = !self.inverted.is_empty() && !self.mirrored;
        self.elements > 0 && !inverted && self.degenerate.is_empty() && self.irregular_edges == 0
    }
}

fn check_arguments(rest: &SurfaceMesh, uv: &[DVec2]) -> Result<(), Error> {
    let vertices = rest.positions.len();
    if uv.len() != vertices {
        Err(BuildError::WrongLength {
            argument: "uv",
            expected: vertices,
            found: uv.len(),
        })?;
    }
    for (face, t) in rest.simplices.iter().enumerate() {
        if let Some(&index) = t.iter().find(|&&v| v as usize >= vertices) {
            Err(MeshError::IndexOutOfRange {
                face,
                index: index.into(),
                vertices,
            })?;
        }
    }
    Ok(())
}
