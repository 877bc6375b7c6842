//! A cursor over the bytes of a text file: blanks, tokens, numbers, line ends.

use super::{ParseError, ParseErrorKind};

/// The cursor. Positions are byte offsets; lines are only counted when an error needs them.
#[derive(Clone)]
pub(super) struct Scanner<'a> {
    bytes: &'a [u8],
    position: usize,
    /// Does a backslash before the line end continue the line?
    continuations: bool,
}

/// A token and where it starts.
#[derive(Clone, Copy)]
pub(super) struct Token<'a> {
    pub text: &'a [u8],
    pub start: usize,
}

impl<'a> Scanner<'a> {
    /// A cursor at the start, behind a byte order mark if there is one.
    pub fn new(bytes: &'a [u8], continuations: bool) -> Self {
        let position = if bytes.starts_with(b"\xEF\xBB\xBF") {
            3
        } else {
            0
        };
        Self {
            bytes,
            position,
            continuations,
        }
    }

    /// Bytes left.
    pub fn remaining(&self) -> usize {
        self.bytes.len() - self.position
    }

    /// Bytes passed.
    pub fn position(&self) -> usize {
        self.position
    }

    /// The next bytes whatever they are, if there are so many.
    #[inline]
    pub fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let taken = self.bytes[self.position..].get(..length)?;
        self.position += length;
        Some(taken)
    }

    /// The rest of this line without its end, comments and all; moves behind its end.
    pub fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.position..];
        let length = rest
            .iter()
            .position(|b| matches!(b, b'\n' | b'\r'))
            .unwrap_or(rest.len());
        self.position += length;
        self.position += self.line_end(self.position).unwrap_or(0);
        &rest[..length]
    }

    /// Moves behind the next occurrence of these bytes; `None`: there is none.
    pub fn skip_past(&mut self, wanted: &[u8]) -> Option<()> {
        let rest = &self.bytes[self.position..];
        let at = rest.windows(wanted.len()).position(|w| w == wanted)?;
        self.position += at + wanted.len();
        Some(())
    }

    /// Moves to the next token, on this line or a later one.
    #[inline]
    pub fn find_token(&mut self) {
        if let Some(token) = self.first_token() {
            self.position = token.start;
        }
    }

    /// The line end at the cursor (after a backslash: the one it hides), as a number of bytes.
    fn line_end(&self, at: usize) -> Option<usize> {
        match self.bytes.get(at) {
            Some(b'\n') => Some(1),
            Some(b'\r') if self.bytes.get(at + 1) == Some(&b'\n') => Some(2),
            Some(b'\r') => Some(1),
            _ => None,
        }
    }

    /// Skips blanks within the line (and continued line ends).
    #[inline]
    fn skip_blanks(&mut self) {
        while let Some(&byte) = self.bytes.get(self.position) {
            match byte {
                b' ' | b'\t' | 0x0b | 0x0c => self.position += 1,
                b'\\' if self.continuations => match self.line_end(self.position + 1) {
                    Some(length) => self.position += 1 + length,
                    None => return,
                },
                _ => return,
            }
        }
    }

    /// The next token of this line, if there is one before the line's end or a comment.
    #[inline]
    pub fn token(&mut self) -> Option<Token<'a>> {
        self.skip_blanks();
        let start = self.position;
        // A comment begins where a token could: inside of one, as in 1.#QNAN, a # is part of it.
        if self.bytes.get(start) == Some(&b'#') {
            return None;
        }
        while let Some(&byte) = self.bytes.get(self.position) {
            match byte {
                b' ' | b'\t' | 0x0b | 0x0c | b'\n' | b'\r' => break,
                b'\\' if self.continuations && self.line_end(self.position + 1).is_some() => break,
                _ => self.position += 1,
            }
        }
        (self.position > start).then(|| Token {
            text: &self.bytes[start..self.position],
            start,
        })
    }

    /// Moves behind the end of this line.
    #[inline]
    pub fn skip_line(&mut self) {
        let mut comment = false;
        while let Some(&byte) = self.bytes.get(self.position) {
            match byte {
                b'\n' | b'\r' => {
                    self.position += self.line_end(self.position).unwrap_or(1);
                    return;
                }
                b'#' => {
                    comment = true;
                    self.position += 1;
                }
                // A comment ends with its line, whatever its last character.
                b'\\' if self.continuations && !comment => {
                    self.position += 1 + self.line_end(self.position + 1).unwrap_or(0);
                }
                _ => self.position += 1,
            }
        }
    }

    /// Skips empty lines and comments; the first token of the next line that has one.
    #[inline]
    pub fn first_token(&mut self) -> Option<Token<'a>> {
        loop {
            if let Some(token) = self.token() {
                return Some(token);
            }
            if self.remaining() == 0 {
                return None;
            }
            self.skip_line();
        }
    }

    /// An error at an offset.
    #[cold]
    pub fn error(&self, at: usize, kind: ParseErrorKind, what: impl Into<String>) -> ParseError {
        ParseError::at(self.bytes, at, kind, what.into())
    }

    /// A count that the file claims at an offset, held against what is left of it when an item takes
    /// `shortest` bytes (the last may lack its line end).
    pub fn check_claim(
        &self,
        at: usize,
        count: u64,
        items: &str,
        shortest: u64,
    ) -> Result<usize, ParseError> {
        let remaining = self.remaining() as u64;
        let needed = count.saturating_mul(shortest);
        if needed <= remaining + 1 && count < u64::from(u32::MAX) {
            return Ok(count as usize);
        }
        let kind = if remaining == 0 || needed < 4 * remaining {
            ParseErrorKind::Truncated
        } else {
            ParseErrorKind::TooLarge
        };
        let what = format!(
            "the file claims {count} {items}, the {remaining} bytes behind that cannot hold them"
        );
        Err(self.error(at, kind, what))
    }

    /// The error for a line that ends too early.
    #[cold]
    pub fn ends(&self, what: impl Into<String>) -> ParseError {
        self.error(self.position, ParseErrorKind::Truncated, what)
    }

    /// The next token as a finite number; `missing` says what it means that there is none.
    #[inline]
    pub fn number(&mut self, missing: &str) -> Result<f64, ParseError> {
        match self.token() {
            Some(token) => self.parse_number(token),
            None => Err(self.ends(missing)),
        }
    }

    /// A token as a finite number.
    #[inline]
    pub fn parse_number(&self, token: Token) -> Result<f64, ParseError> {
        let parsed = std::str::from_utf8(token.text)
            .ok()
            .and_then(|text| text.parse::<f64>().ok());
        match parsed {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => Err(self.error(
                token.start,
                ParseErrorKind::NonFinite,
                format!("coordinate {} is not finite", quote(token.text)),
            )),
            None if is_not_finite_word(token.text) => Err(self.error(
                token.start,
                ParseErrorKind::NonFinite,
                format!("coordinate {} is not finite", quote(token.text)),
            )),
            None => Err(self.error(
                token.start,
                ParseErrorKind::Number,
                format!("expected a number, found {}", quote(token.text)),
            )),
        }
    }

    /// A token as a count or 0-based index.
    pub fn parse_count(&self, token: Token, what: &str) -> Result<u64, ParseError> {
        match parse_integer(token.text) {
            Some(value) if value >= 0 => Ok(value as u64),
            _ => Err(self.error(
                token.start,
                ParseErrorKind::Number,
                format!("expected {what}, found {}", quote(token.text)),
            )),
        }
    }
}

/// The words other programs write for numbers that are none ("-nan(ind)", "1.#QNAN", "1.#INF").
fn is_not_finite_word(text: &[u8]) -> bool {
    let text = text.strip_prefix(b"-").unwrap_or(text);
    let starts =
        |word: &[u8]| text.len() >= word.len() && text[..word.len()].eq_ignore_ascii_case(word);
    starts(b"nan") || starts(b"inf") || starts(b"1.#")
}

/// A whole number, saturating; `None` if it is none.
#[inline]
pub(super) fn parse_integer(text: &[u8]) -> Option<i64> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0i64;
    for &digit in digits {
        if !digit.is_ascii_digit() {
            return None;
        }
        value = value
            .saturating_mul(10)
            .saturating_add(i64::from(digit - b'0'));
    }
    Some(if negative { -value } else { value })
}

/// A token for a message: shortened, unprintable characters escaped.
pub(super) fn quote(text: &[u8]) -> String {
    let shown = String::from_utf8_lossy(&text[..text.len().min(40)]);
    let dots = if text.len() > 40 { "…" } else { "" };
    format!("\"{}{dots}\"", shown.escape_debug())
}

/// Appends a number in its shortest form that reads back as the same bits.
pub(super) fn write_number(out: &mut Vec<u8>, value: f64) {
    use std::io::Write;
    let start = out.len();
    // Writing to a vector cannot fail.
    let _ = write!(out, "{value:?}");
    if out[start..].ends_with(b".0") {
        out.truncate(out.len() - 2);
    }
}
