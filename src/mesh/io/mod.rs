//! Mesh files: one file a format, all from and to byte slices.

/// Why a file cannot be read, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[error("line {line}, column {column}: {what}")]
pub struct ParseError {
    /// 1-based line.
    pub line: usize,
    /// 1-based column (bytes).
    pub column: usize,
    /// What is wrong, in words.
    pub what: String,
}

impl ParseError {
    /// A short stable name of the error's kind.
    pub fn code(&self) -> &'static str {
        "parse"
    }
}
