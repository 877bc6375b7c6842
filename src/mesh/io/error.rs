//! Why a file cannot be read, and where.

/// What kind of trouble a [`ParseError`] is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ParseErrorKind {
    /// Nothing in the file.
    Empty,
    /// The file, or a line of it, ends too early.
    Truncated,
    /// Something that does not belong where it stands.
    Syntax,
    /// Not a number where one is needed.
    Number,
    /// NaN, an infinity, or a number too large for double precision.
    NonFinite,
    /// An index of something that does not exist.
    IndexOutOfRange,
    /// A variant of the format that is not read.
    Unsupported,
    /// More elements than the file can hold or the reader takes.
    TooLarge,
    /// Triangles only where tetrahedra were asked for, or the other way round.
    WrongElements,
}

impl ParseErrorKind {
    /// A short stable name (`"index-out-of-range"`).
    pub fn name(self) -> &'static str {
        match self {
            ParseErrorKind::Empty => "empty",
            ParseErrorKind::Truncated => "truncated",
            ParseErrorKind::Syntax => "syntax",
            ParseErrorKind::Number => "number",
            ParseErrorKind::NonFinite => "non-finite",
            ParseErrorKind::IndexOutOfRange => "index-out-of-range",
            ParseErrorKind::Unsupported => "unsupported",
            ParseErrorKind::TooLarge => "too-large",
            ParseErrorKind::WrongElements => "wrong-elements",
        }
    }
}

/// Why a file cannot be read, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error, serde::Serialize)]
#[error("{}: {what}", self.place())]
pub struct ParseError {
    /// 1-based line; 0 in the binary part of a file.
    pub line: usize,
    /// 1-based column (bytes); in the binary part of a file the byte, the file's first being 1.
    pub column: usize,
    /// What is wrong, in words.
    pub what: String,
    /// What kind of trouble it is.
    pub kind: ParseErrorKind,
}

impl ParseError {
    /// A short stable name of the error's kind.
    pub fn code(&self) -> &'static str {
        "parse"
    }

    fn place(&self) -> String {
        match self.line {
            0 => format!("byte {}", self.column),
            line => format!("line {line}, column {}", self.column),
        }
    }

    /// The error at a byte offset of binary data.
    #[cold]
    pub(super) fn in_binary(offset: usize, kind: ParseErrorKind, what: String) -> Self {
        Self {
            line: 0,
            column: offset + 1,
            what,
            kind,
        }
    }

    /// Names the item that is being read, where no line does.
    #[cold]
    pub(super) fn within(self, item: &str, number: usize) -> Self {
        match self.line {
            0 => self.named(item, number),
            _ => self,
        }
    }

    /// Names the item that is being read.
    #[cold]
    pub(super) fn named(mut self, item: &str, number: usize) -> Self {
        self.what = format!("{item} {number}: {}", self.what);
        self
    }

    /// The error at a byte offset: counts the lines up to it.
    pub(super) fn at(bytes: &[u8], offset: usize, kind: ParseErrorKind, what: String) -> Self {
        let before = &bytes[..offset.min(bytes.len())];
        let mut line = 1;
        let mut start = 0;
        for (index, &byte) in before.iter().enumerate() {
            let lone_return = byte == b'\r' && bytes.get(index + 1) != Some(&b'\n');
            if byte == b'\n' || lone_return {
                line += 1;
                start = index + 1;
            }
        }
        Self {
            line,
            column: before.len() - start + 1,
            what,
            kind,
        }
    }
}
