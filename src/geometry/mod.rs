//! Rest shapes, deformation gradients, Laplacians and bending.

mod bending;
mod elimination;
mod laplacian;
mod rest;
mod seen;

pub use bending::{quadratic_bending, vertex_measures};
pub use elimination::Elimination;
pub use laplacian::{cotangent_weights, uniform_weights};
pub use rest::{RestShape, surface_area, triangle_rest};
pub(crate) use seen::seen_part;
