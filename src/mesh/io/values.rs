//! Values one after the other, as text or as binary numbers of either byte order: a format that has
//! both is read by one piece of code.

use super::scan::{Scanner, parse_integer, quote};
use super::{ParseError, ParseErrorKind};

/// How values are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// As words. Where items are lines, an item that is cut short is found in its own line.
    Text { lines: bool },
    /// As binary numbers.
    Binary { big_endian: bool },
}

/// The binary type of a value; as text all are words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// Bytes of a value.
    pub fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::I64 | Scalar::U64 | Scalar::F64 => 8,
        }
    }

    /// The value of as many bytes as it has, the last the most significant: a real number, and a whole
    /// one (saturating) if it is that.
    fn decode(self, bits: u64) -> (f64, Option<i64>) {
        let whole = |value: i64| (value as f64, Some(value));
        let real = |value: f64| {
            let is_whole = value.fract() == 0.0 && value.abs() < 1e15;
            (value, is_whole.then_some(value as i64))
        };
        match self {
            Scalar::I8 => whole((bits as i8).into()),
            Scalar::U8 => whole((bits as u8).into()),
            Scalar::I16 => whole((bits as i16).into()),
            Scalar::U16 => whole((bits as u16).into()),
            Scalar::I32 => whole((bits as i32).into()),
            Scalar::U32 => whole((bits as u32).into()),
            Scalar::I64 => whole(bits as i64),
            Scalar::U64 => whole(i64::try_from(bits).unwrap_or(i64::MAX)),
            Scalar::F32 => real(f32::from_bits(bits as u32).into()),
            Scalar::F64 => real(f64::from_bits(bits)),
        }
    }
}

/// A cursor over values.
pub(super) struct Values<'a> {
    /// The cursor over bytes.
    pub scanner: Scanner<'a>,
    /// How the values from here on are stored.
    pub encoding: Encoding,
    /// Where the last value was.
    last: usize,
}

impl<'a> Values<'a> {
    /// A cursor at the start of a file, at first over lines of text.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self {
            scanner: Scanner::new(bytes, false),
            encoding: Encoding::Text { lines: true },
            last: 0,
        }
    }

    /// Moves to the first value of an item, in text.
    #[inline]
    pub fn start_item(&mut self) {
        if let Encoding::Text { .. } = self.encoding {
            self.scanner.find_token();
        }
        self.last = self.scanner.position();
    }

    /// Passes over what else is in the line of an item, in text that has lines.
    #[inline]
    pub fn end_item(&mut self) {
        if self.encoding == (Encoding::Text { lines: true }) {
            self.scanner.skip_line();
        }
    }

    /// The next word of text.
    #[inline]
    fn word(&mut self, lines: bool, what: &str) -> Result<super::scan::Token<'a>, ParseError> {
        let token = if lines {
            self.scanner.token()
        } else {
            self.scanner.first_token()
        };
        match token {
            Some(token) => {
                self.last = token.start;
                Ok(token)
            }
            None => Err(self.scanner.ends(format!("{what} is missing"))),
        }
    }

    /// The next binary number.
    #[inline]
    fn binary(
        &mut self,
        scalar: Scalar,
        big_endian: bool,
        what: &str,
    ) -> Result<(f64, Option<i64>), ParseError> {
        self.last = self.scanner.position();
        let Some(bytes) = self.scanner.take(scalar.size()) else {
            return Err(self.ends(what));
        };
        let shift = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        Ok(scalar.decode(if big_endian {
            bytes.iter().fold(0, shift)
        } else {
            bytes.iter().rev().fold(0, shift)
        }))
    }

    /// The next value as a finite number; `what` it is to be.
    #[inline]
    pub fn real(&mut self, scalar: Scalar, what: &str) -> Result<f64, ParseError> {
        match self.encoding {
            Encoding::Text { lines } => {
                let token = self.word(lines, what)?;
                self.scanner.parse_number(token)
            }
            Encoding::Binary { big_endian } => match self.binary(scalar, big_endian, what)?.0 {
                value if value.is_finite() => Ok(value),
                _ => Err(self.error(ParseErrorKind::NonFinite, format!("{what} is not finite"))),
            },
        }
    }

    /// The next value as a whole number; `what` it is to be.
    #[inline]
    pub fn integer(&mut self, scalar: Scalar, what: &str) -> Result<i64, ParseError> {
        let (value, found) = match self.encoding {
            Encoding::Text { lines } => {
                let token = self.word(lines, what)?;
                (parse_integer(token.text), token.text)
            }
            Encoding::Binary { big_endian } => {
                let (value, whole) = self.binary(scalar, big_endian, what)?;
                if whole.is_none() {
                    let what = format!("expected {what}, found {value}");
                    return Err(self.error(ParseErrorKind::Number, what));
                }
                (whole, &b""[..])
            }
        };
        value.ok_or_else(|| {
            let what = format!("expected {what}, found {}", quote(found));
            self.error(ParseErrorKind::Number, what)
        })
    }

    /// The next value as a count or a tag that is not negative.
    pub fn count(&mut self, scalar: Scalar, what: &str) -> Result<u64, ParseError> {
        let value = self.integer(scalar, what)?;
        u64::try_from(value).map_err(|_| {
            let what = format!("expected {what}, found {value}");
            self.error(ParseErrorKind::Number, what)
        })
    }

    /// The next value as a count of items, held against what is left of the file when an item takes
    /// so many bytes: at the least as text, and as binary numbers.
    pub fn claim(
        &mut self,
        scalar: Scalar,
        items: &str,
        text: u64,
        binary: u64,
    ) -> Result<usize, ParseError> {
        let count = self.count(scalar, &format!("the number of {items}"))?;
        self.check_claim(count, items, text, binary)
    }

    /// The count that was read last, held against what is left of the file as [`Self::claim`] does.
    pub fn check_claim(
        &self,
        count: u64,
        items: &str,
        text: u64,
        binary: u64,
    ) -> Result<usize, ParseError> {
        let shortest = match self.encoding {
            Encoding::Text { .. } => text,
            Encoding::Binary { .. } => binary,
        };
        self.scanner.check_claim(self.last, count, items, shortest)
    }

    /// A point of so many coordinates of this type; what is left out is zero.
    #[inline]
    pub fn point(&mut self, scalar: Scalar, dimension: usize) -> Result<glam::DVec3, ParseError> {
        let mut point = [0.0; 3];
        for coordinate in point.iter_mut().take(dimension) {
            *coordinate = self.real(scalar, "a coordinate")?;
        }
        Ok(point.into())
    }

    /// Passes over so many values.
    pub fn skip(&mut self, scalar: Scalar, count: u64, what: &str) -> Result<(), ParseError> {
        match self.encoding {
            Encoding::Text { lines } => {
                for _ in 0..count {
                    self.word(lines, what)?;
                }
                Ok(())
            }
            Encoding::Binary { .. } => {
                let length = count.saturating_mul(scalar.size() as u64);
                let length = usize::try_from(length).unwrap_or(usize::MAX);
                match self.scanner.take(length) {
                    Some(_) => Ok(()),
                    None => Err(self.ends(what)),
                }
            }
        }
    }

    /// The error for a file that ends where `what` is to be.
    #[cold]
    fn ends(&self, what: &str) -> ParseError {
        let what = format!("the file ends where {what} is to be");
        ParseError::in_binary(self.scanner.position(), ParseErrorKind::Truncated, what)
    }

    /// An error at the last value, or at the start of an item of which none has been read.
    #[cold]
    pub fn error(&self, kind: ParseErrorKind, what: impl Into<String>) -> ParseError {
        match self.encoding {
            Encoding::Text { .. } => self.scanner.error(self.last, kind, what),
            Encoding::Binary { .. } => ParseError::in_binary(self.last, kind, what.into()),
        }
    }
}
