//! Meshes: containers, topology, cutting, files and generators.

mod error;
pub mod io;

pub use error::MeshError;
use glam::DVec3;

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
