//! What can be wrong with a mesh.

// The fields of these variants are what the message of the variant says of them.
#![allow(missing_docs)]

/// Why a mesh cannot be used, naming the element. Indices are 0-based.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum MeshError {
    /// No elements at all.
    #[error("the mesh has no faces")]
    Empty,
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NonFinitePosition { vertex: usize },
    /// An element (a face, or a tetrahedron of a solid) names a vertex that does not exist.
    #[error("element {face} names vertex {index}, but there are {vertices} vertices")]
    IndexOutOfRange {
        face: usize,
        index: u64,
        vertices: usize,
    },
    /// A face uses one vertex twice.
    #[error("face {face} uses vertex {vertex} twice")]
    RepeatedVertex { face: usize, vertex: u32 },
    /// Two faces have the same vertices.
    #[error("faces {first} and {second} have the same vertices")]
    DuplicateFace { first: usize, second: usize },
    /// A face has no area (relative to the whole surface).
    #[error("face {face} has no area ({area:e} of the surface)")]
    DegenerateFace { face: usize, area: f64 },
    /// All faces together have no area.
    #[error("the surface has no area")]
    ZeroArea,
    /// More than two faces meet in an edge.
    #[error("edge {}–{} belongs to {faces} faces", vertices[0], vertices[1])]
    NonManifoldEdge { vertices: [u32; 2], faces: usize },
    /// More than two tetrahedra meet in a face.
    #[error("face {}–{}–{} belongs to {tetrahedra} tetrahedra", vertices[0], vertices[1], vertices[2])]
    NonManifoldFace {
        vertices: [u32; 3],
        tetrahedra: usize,
    },
    /// The faces around a vertex do not form one fan.
    #[error("the faces around vertex {vertex} do not form one fan")]
    NonManifoldVertex { vertex: u32 },
    /// The surface has only one side (a Möbius strip is in it).
    #[error("the surface is one-sided: face {face} cannot be oriented consistently")]
    NotOrientable { face: usize },
    /// Two neighbours run along their common edge in the same direction.
    #[error("faces {} and {} are oriented against each other", faces[0], faces[1])]
    InconsistentOrientation { faces: [usize; 2] },
    /// The surface falls into several pieces.
    #[error("the surface has {components} separate components, one is needed")]
    SeveralComponents { components: usize },
    /// A disk is needed and cutting was refused.
    #[error(
        "the surface is not a disk (Euler characteristic {euler_characteristic}, {boundary_loops} boundary loops) and cutting was refused"
    )]
    NotADisk {
        euler_characteristic: i64,
        boundary_loops: usize,
    },
}

impl MeshError {
    /// A short stable name of the error's kind.
    pub fn code(&self) -> &'static str {
        match self {
            MeshError::Empty => "empty-mesh",
            MeshError::NonFinitePosition { .. } => "non-finite-position",
            MeshError::IndexOutOfRange { .. } => "index-out-of-range",
            MeshError::RepeatedVertex { .. } => "repeated-vertex",
            MeshError::DuplicateFace { .. } => "duplicate-face",
            MeshError::DegenerateFace { .. } => "degenerate-face",
            MeshError::ZeroArea => "zero-area",
            MeshError::NonManifoldEdge { .. } => "non-manifold-edge",
            MeshError::NonManifoldFace { .. } => "non-manifold-face",
            MeshError::NonManifoldVertex { .. } => "non-manifold-vertex",
            MeshError::NotOrientable { .. } => "not-orientable",
            MeshError::InconsistentOrientation { .. } => "inconsistent-orientation",
            MeshError::SeveralComponents { .. } => "several-components",
            MeshError::NotADisk { .. } => "not-a-disk",
        }
    }
}
