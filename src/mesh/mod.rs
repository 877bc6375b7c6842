//! Meshes: the container, its topology, cutting, files and generators.
//!
//! ```text
//! bytes ──io──▶ SurfaceMesh ──prepare──▶ clean, oriented, with its Topology ──cut──▶ disk
//! generate ─────────▲
//! ```

pub mod cut;
mod error;
pub mod generate;
pub mod io;
mod prepare;
pub mod topology;

pub use cut::{Cut, cut_to_disk};
pub use error::MeshError;
pub use generate::{Shape, SolidShape, generate, generate_solid};
use glam::DVec3;
pub use prepare::{Prepared, prepare};
pub use topology::Topology;

/// A mesh of simplices with `N` vertices each (3: triangles, 4: tetrahedra) and positions in space.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SimplicialMesh<const N: usize> {
    /// One position a vertex.
    pub positions: Vec<DVec3>,
    /// One simplex an element: indices into `positions`; triangles run counter-clockwise seen from
    /// outside.
    pub simplices: Vec<[u32; N]>,
}

/// A triangle mesh in space.
pub type SurfaceMesh = SimplicialMesh<3>;

/// A tetrahedral mesh; an element (a, b, c, d) has positive volume: det [b−a, c−a, d−a] > 0.
pub type SolidMesh = SimplicialMesh<4>;

/// "1 face", "2 faces": a count and its noun.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    if count == 1 {
        format!("1 {noun}")
    } else if let Some(stem) = noun.strip_suffix("ex") {
        format!("{count} {stem}ices")
    } else {
        format!("{count} {noun}s")
    }
}
