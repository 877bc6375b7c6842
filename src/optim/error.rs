//! Errors of building and stepping a solver.

// The fields of these variants are what the message of the variant says of them.
#![allow(missing_docs)]

/// Why a solver could not be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum BuildError {
    /// A rest element has no measure.
    #[error("element {index} is degenerate: its measure is {measure:e}")]
    DegenerateElement { index: usize, measure: f64 },
    /// A rest element is turned inside out, unlike its neighbours.
    #[error("element {index} is inverted at rest: its measure is {measure:e}")]
    InvertedRestElement { index: usize, measure: f64 },
    /// The solver needs an injective start.
    #[error("the start has {inverted} inverted elements, and this method needs none")]
    NotInjectiveStart { inverted: usize },
    /// The start has inverted elements, and the method keeps to starts that have none.
    #[error(
        "the start has {inverted} inverted or degenerate elements, the first of them element {first}: this method only keeps maps free of inversions that are so; untangle the start first"
    )]
    InvertedStart { inverted: usize, first: usize },
    /// The boundary of the start meets itself. Facets by their vertices; of edges in the plane the second is given
    /// twice. At most 1000 pairs.
    #[error(
        "the boundary of the start meets itself: {}{} pairs of facets, the first {:?} and {:?}; with the option flow (--flow) it is first parted by mean curvature flow", if pairs.len() < crate::gini::MOST_PAIRS { "" } else { "at least " }, pairs.len(), pairs[0][0], pairs[0][1]
    )]
    IntersectingStart { pairs: Vec<[[u32; 3]; 2]> },
    /// The boundary of the start still meets itself after mean curvature flow. Facets by their vertices, as above.
    #[error(
        "the boundary of the start still meets itself after {steps} steps of mean curvature flow: {pairs} pairs of facets, the first {:?} and {:?}", first[0], first[1]
    )]
    NotFlowedApart {
        steps: usize,
        pairs: usize,
        first: [[u32; 3]; 2],
    },
    /// A facet of more than two elements, so that there is no boundary.
    #[error("{elements} elements share the facet of vertices {vertices:?}")]
    NonManifoldFacet { vertices: [u32; 3], elements: usize },
    /// An option is out of its range.
    #[error("option {option}: {what}")]
    InvalidOption { option: &'static str, what: String },
    /// Shapes of arguments do not fit.
    #[error("{argument} has length {found}, expected {expected}")]
    WrongLength {
        argument: &'static str,
        expected: usize,
        found: usize,
    },
    /// A system matrix is not positive definite.
    #[error("the system matrix is not positive definite (pivot {pivot})")]
    NotPositiveDefinite { pivot: usize },
    /// The factor would not fit into memory.
    #[error("the factorisation needs {bytes} bytes, more than the {limit} allowed")]
    TooLarge { bytes: u64, limit: u64 },
}

impl BuildError {
    /// A short stable name of the error's kind.
    pub fn code(&self) -> &'static str {
        match self {
            BuildError::DegenerateElement { .. } => "degenerate-element",
            BuildError::InvertedRestElement { .. } => "inverted-rest-element",
            BuildError::NotInjectiveStart { .. } | BuildError::InvertedStart { .. } => {
                "not-injective-start"
            }
            BuildError::IntersectingStart { .. } => "intersecting-start",
            BuildError::NotFlowedApart { .. } => "not-flowed-apart",
            BuildError::NonManifoldFacet { .. } => "non-manifold-facet",
            BuildError::InvalidOption { .. } => "invalid-option",
            BuildError::WrongLength { .. } => "wrong-length",
            BuildError::NotPositiveDefinite { .. } => "not-positive-definite",
            BuildError::TooLarge { .. } => "too-large",
        }
    }
}

/// Why a step failed. `positions()` keep the last finite iterate; the solver itself is not to be
/// stepped any further.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum SolveError {
    /// A refactorisation met a non-positive pivot.
    #[error("iteration {iteration}: the system matrix lost positive definiteness (pivot {pivot})")]
    NotPositiveDefinite { iteration: usize, pivot: usize },
    /// Moved handles inverted elements, and the method cannot begin there.
    #[error("iteration {iteration}: {inverted} elements are inverted, and this method needs none")]
    NotInjective { iteration: usize, inverted: usize },
    /// The iterate is no longer finite.
    #[error("iteration {iteration}: vertex {vertex} is no longer finite")]
    NonFinite { iteration: usize, vertex: usize },
}

impl SolveError {
    /// A short stable name of the error's kind.
    pub fn code(&self) -> &'static str {
        match self {
            SolveError::NotPositiveDefinite { .. } => "not-positive-definite",
            SolveError::NotInjective { .. } => "not-injective",
            SolveError::NonFinite { .. } => "non-finite",
        }
    }
}
