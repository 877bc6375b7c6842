//! The predicates everything rests on: on which side of a line, or of a plane, is a point? Exact for
//! every finite input.

mod plane;
mod space;
mod wide;

pub(super) use plane::compare_points;
pub use plane::orientation;
pub use space::orientation_of_tetrahedron;
