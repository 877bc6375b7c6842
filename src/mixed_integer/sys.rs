//! The `.sys` text format: `n m k nnzA nnzC`, then nnzA triplets `i j a` of the full symmetric A, the n
//! entries of b, nnzC triplets `row column value` of the constraints, where column n is the constant
//! (row·x + c = 0), and the k integer unknowns. Indices begin at 0, line ends count as blanks.

use super::{MixedIntegerError as Error, Problem};

/// Words with the lines they stand in.
struct Words<'a> {
    bytes: &'a [u8],
    position: usize,
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        while let Some(&byte) = self.bytes.get(self.position) {
            if !byte.is_ascii_whitespace() {
                break;
            }
            self.line += usize::from(byte == b'\n');
            self.position += 1;
        }
        let rest = &self.bytes[self.position..];
        let length = rest
            .iter()
            .position(u8::is_ascii_whitespace)
            .unwrap_or(rest.len());
        self.position += length;
        (length > 0).then(|| &rest[..length])
    }

    #[cold]
    fn error(&self, what: String) -> Error {
        Error::Parse {
            line: self.line,
            what,
        }
    }

    fn parse<T: std::str::FromStr>(&mut self, item: &str, kind: &str) -> Result<T, Error> {
        let Some(word) = self.next() else {
            return Err(self.error(format!("the file ends where {item} is expected")));
        };
        let text = std::str::from_utf8(word).ok();
        text.and_then(|t| t.parse().ok()).ok_or_else(|| {
            let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
            let shown = shown.escape_debug();
            self.error(format!("{item}: expected {kind}, found \"{shown}\""))
        })
    }

    fn count(&mut self, item: &str) -> Result<usize, Error> {
        self.parse::<u32>(item, "a whole number up to 2^32 − 1")
            .map(|count| count as usize)
    }

    fn index(&mut self, item: &str, end: usize) -> Result<u32, Error> {
        let index = self.parse::<u32>(item, "a whole number up to 2^32 − 1")?;
        match (index as usize) < end {
            true => Ok(index),
            false => Err(self.error(format!("{item} is {index}, expected less than {end}"))),
        }
    }

    fn number(&mut self, item: &str) -> Result<f64, Error> {
        let number = self.parse::<f64>(item, "a number")?;
        match number.is_finite() {
            true => Ok(number),
            false => Err(self.error(format!("{item} is not finite"))),
        }
    }
}

impl Problem {
    /// Reads a problem in the `.sys` format (uncompressed).
    ///
    /// # Errors
    /// `Parse`, which names the line; everything that [`super::ProblemBuilder::build`] finds wrong.
    pub fn from_sys(bytes: &[u8]) -> Result<Self, Error> {
        let mut words = Words {
            bytes,
            position: 0,
            line: 1,
        };
        let unknowns = words.count("the number of unknowns")?;
        let rows = words.count("the number of constraint rows")?;
        let integers = words.count("the number of integers")?;
        let entries = words.count("the number of matrix entries")?;
        let coefficients = words.count("the number of coefficients")?;
        // a number takes two bytes at least, so that no count can make the memory overflow
        let numbers = [entries, entries, entries, unknowns, integers];
        let numbers = numbers.into_iter().chain([coefficients; 3]);
        let needed = 2 * numbers.map(|n| n as u64).sum::<u64>();
        let left = bytes.len() - words.position;
        if needed > left as u64 + 1 || rows > left {
            let what = format!(
                "the counts claim at least {needed} bytes and {rows} rows, but only {left} bytes follow"
            );
            return Err(words.error(what));
        }
        let mut builder = Self::builder(unknowns);
        for _ in 0..entries {
            let row = words.index("the row of a matrix entry", unknowns)?;
            let column = words.index("the column of a matrix entry", unknowns)?;
            builder.push_quadratic(row, column, words.number("a matrix entry")?);
        }
        let linear: Result<Vec<f64>, Error> = (0..unknowns)
            .map(|_| words.number("an entry of b"))
            .collect();
        builder = builder.linear(&linear?);
        let mut constants = vec![0.0; rows];
        let mut places: (Vec<u32>, Vec<u32>, Vec<f64>) = Default::default();
        for _ in 0..coefficients {
            let row = words.index("the row of a coefficient", rows)?;
            let column = words.index("the column of a coefficient", unknowns + 1)?;
            let value = words.number("a coefficient")?;
            if column as usize == unknowns {
                constants[row as usize] += value;
            } else {
                places.0.push(row);
                places.1.push(column);
                places.2.push(value);
            }
        }
        builder = builder.constraints(&places.0, &places.1, &places.2, &constants);
        let mut seen = vec![false; unknowns];
        for _ in 0..integers {
            let integer = words.index("an integer unknown", unknowns)?;
            if std::mem::replace(&mut seen[integer as usize], true) {
                return Err(words.error(format!("unknown {integer} is named as an integer twice")));
            }
            builder = builder.integer(integer);
        }
        if let Some(word) = words.next() {
            let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
            let what = format!("\"{}\" behind the end of the problem", shown.escape_debug());
            return Err(words.error(what));
        }
        builder.build()
    }
}
