//! The sum of every room's error, for callers that cross several rooms.

use crate::mesh::{MeshError, io::ParseError};
use crate::mixed_integer::MixedIntegerError;
use crate::optim::{BuildError, SolveError};

/// Any error of this crate. Each variant wraps the typed error of the room that raised it.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// The mesh is not what the task needs.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The solver could not be built.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A step failed.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A mixed-integer problem is wrong, or has no solution.
    #[error(transparent)]
    MixedInteger(#[from] MixedIntegerError),
}

impl Error {
    /// A short stable name of the error's kind (`"non-manifold-edge"`), the same on the command line,
    /// in reports and as the `code` of the JavaScript error.
    pub fn code(&self) -> &'static str {
        match self {
            Error::Parse(e) => e.code(),
            Error::Mesh(e) => e.code(),
            Error::Build(e) => e.code(),
            Error::Solve(e) => e.code(),
            Error::MixedInteger(e) => e.code(),
        }
    }
}
