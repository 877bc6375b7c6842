//! Do the boundaries of moving bodies meet? For triangles in the plane (D = 2, their boundary edges) and tetrahedra
//! (D = 3, their boundary faces).
//!
//! * [`Boundary`]: facets, edges and vertices of a boundary, oriented outward.
//! * [`BroadPhase`]: a tree of boxes around facets that move, refitted as they move elsewhere, and the pairs of
//!   vertices, edges and faces that come near each other.
//! * [`time_of_impact`]: continuous collision detection of one pair that moves linearly; never misses.
//! * [`intersections`]: which facets of a boundary that stands still meet, by exact predicates.
//! * [`overlaps`]: what lies inside another body though no boundaries meet, by exact predicates.
//!
//! All lists come sorted; nothing depends on the number of threads.

mod boundary;
mod broad;
mod ccd;
mod intersection;
mod overlap;
mod separation;
pub(crate) mod vector;

pub use boundary::{Boundary, BoundaryError};
pub use broad::{BroadPhase, Candidate};
pub use ccd::{Impact, Pair, impact, time_of_impact};
pub use intersection::intersections;
pub use overlap::overlaps;
