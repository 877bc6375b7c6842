//! The relaxed problem with some integers fixed, on three levels (paper, §3.2): local Gauss–Seidel, then
//! conjugate gradients, then sparse Cholesky.

mod cholesky;
mod conjugate_gradients;
mod gauss_seidel;
mod system;
mod three_level;

pub use three_level::ThreeLevel;
