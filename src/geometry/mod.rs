//! Rest shapes, deformation gradients and Laplacians.

mod elimination;
mod laplacian;
mod rest;

pub use elimination::Elimination;
pub use laplacian::{cotangent_weights, uniform_weights};
pub use rest::{RestShape, surface_area, triangle_rest};
