//! L-BFGS with a constant Laplacian as the first Hessian (Liu, Bouaziz & Kavan 2017, "Quasi-Newton
//! Methods for Real-Time Simulation of Hyperelastic Materials").
//!
//! One iteration: a direction by the recursion over the last m = 5 steps with H₀ = (Σ A k DᵀD)⁻¹, k the
//! stiffness of the material at rest, factored once; then halving from the full step until the energy
//! falls as Armijo's rule demands, or, where rounding decides what the energy does, the slope along the
//! step does as it would for a parabola that falls so (Hager & Zhang 2005). Elements are evaluated by the kernels of [`crate::wrapd`].

pub(crate) mod evaluation;
mod noise;
mod options;
mod solver;

pub use options::QuasiNewtonOptions;
pub use solver::QuasiNewton;
