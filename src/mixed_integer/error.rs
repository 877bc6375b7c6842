//! What can be wrong with a mixed-integer problem.

// The fields of these variants are what the message of the variant says of them.
#![allow(missing_docs)]

use crate::optim::BuildError;

/// Why a mixed-integer problem cannot be read, built or solved. Rows, unknowns and integers are
/// numbered from 0, as they were given.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(untagged)]
#[non_exhaustive]
pub enum MixedIntegerError {
    /// A `.sys` file cannot be read.
    #[error("line {line}: {what}")]
    Parse { line: usize, what: String },
    /// An index of something that does not exist.
    #[error("{item} {position} names unknown {index}, but there are {unknowns} unknowns")]
    IndexOutOfRange {
        item: &'static str,
        position: usize,
        index: u64,
        unknowns: usize,
    },
    /// A coefficient of a constraint row that does not exist.
    #[error("coefficient {position} names constraint row {row}, but there are {rows} rows")]
    RowOutOfRange {
        position: usize,
        row: u32,
        rows: usize,
    },
    /// NaN or an infinity.
    #[error("{item} {position} is not finite")]
    NonFinite { item: &'static str, position: usize },
    /// The matrix of the energy is not symmetric.
    #[error(
        "the matrix is not symmetric: entry ({row}, {column}) is {value:e}, its mirror image {mirrored:e}"
    )]
    NotSymmetric {
        row: usize,
        column: usize,
        value: f64,
        mirrored: f64,
    },
    /// Shapes of arguments do not fit.
    #[error("{argument} has length {found}, expected {expected}")]
    WrongLength {
        argument: &'static str,
        expected: usize,
        found: usize,
    },
    /// An unknown was named as an integer twice.
    #[error("unknown {index} is named as an integer twice")]
    IntegerTwice { index: usize },
    /// The energy has no unique minimum where the constraints hold.
    #[error(
        "the matrix is not positive definite where the constraints hold (pivot: unknown {pivot})"
    )]
    NotPositiveDefinite { pivot: usize },
    /// A row that no real numbers can satisfy together with the others.
    #[error("constraint row {row} contradicts the others: it leaves 0 = {residual:e}")]
    Contradictory { row: usize, residual: f64 },
    /// A row that real numbers can satisfy, but no integers.
    #[error(
        "constraint row {row} has no integer solution: with integer coefficients that have no common divisor, its constant is {constant}"
    )]
    Infeasible { row: usize, constant: f64 },
    /// A row of integer unknowns alone, whose coefficients have no common measure.
    #[error(
        "constraint row {row} holds integers only, and the ratios of its coefficients are not rational numbers of moderate size"
    )]
    NotRational { row: usize },
    /// Integer coefficients grow so much in elimination that double precision could not hold them exactly, or
    /// not their squares beside the other entries of the reduced matrix.
    #[error("constraint row {row}: integer coefficients grow too large in elimination")]
    CoefficientsTooLarge { row: usize },
    /// More integers than the dense methods take.
    #[error(
        "{count} integers remain after elimination, and this rounding takes at most {limit}; greedy takes any number"
    )]
    TooManyIntegers { count: usize, limit: usize },
    /// An option is out of its range.
    #[error("option {option}: {what}")]
    InvalidOption { option: &'static str, what: String },
    /// The factor would not fit into memory.
    #[error("the factorisation needs {bytes} bytes, more than the {limit} allowed")]
    TooLarge { bytes: u64, limit: u64 },
}

impl MixedIntegerError {
    /// A short stable name of the error's kind.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Parse { .. } => "parse",
            Self::IndexOutOfRange { .. } | Self::RowOutOfRange { .. } => "index-out-of-range",
            Self::NonFinite { .. } => "non-finite",
            Self::NotSymmetric { .. } => "not-symmetric",
            Self::WrongLength { .. } => "wrong-length",
            Self::IntegerTwice { .. } => "integer-twice",
            Self::NotPositiveDefinite { .. } => "not-positive-definite",
            Self::Contradictory { .. } => "contradictory-row",
            Self::Infeasible { .. } => "infeasible-row",
            Self::NotRational { .. } => "not-rational-row",
            Self::CoefficientsTooLarge { .. } => "coefficients-too-large",
            Self::TooManyIntegers { .. } => "too-many-integers",
            Self::InvalidOption { .. } => "invalid-option",
            Self::TooLarge { .. } => "too-large",
        }
    }
}

impl From<BuildError> for MixedIntegerError {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::TooLarge { bytes, limit } => Self::TooLarge { bytes, limit },
            // the analysis of a pattern raises no other error
            other => Self::InvalidOption {
                option: "matrix",
                what: other.to_string(),
            },
        }
    }
}
