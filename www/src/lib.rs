//! The canvas of the foldfree page: the surface, the map, the convergence plot and the inspector.
//!
//! The solver is not here. The page's JavaScript runs it in a Worker and hands every iterate to this
//! crate as typed arrays; this crate keeps the iterates and draws the one that is asked for.
//!
//! The pure half (colours, cameras, history, scales, words) compiles natively and is tested there;
//! the drawing half is for the browser only.

pub mod camera;
pub mod colour;
pub mod distortion;
pub mod frames;
pub mod history;
pub mod layout;
pub mod outline;
pub mod scale;
pub mod solid;
pub mod words;

#[cfg(target_arch = "wasm32")]
mod canvas;
