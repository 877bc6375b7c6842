//! Legacy VTK, as text and binary (big endian), of versions 1 to 5: UNSTRUCTURED_GRID and POLYDATA.
//! Data on points and cells are passed over.

use super::contents::Contents;
use super::scan::{Token, quote};
use super::values::{Encoding, Scalar, Values};
use super::write::{Elements, Line};
use super::{ParseError, ParseErrorKind};
use std::io::Write;

/// Lists of point indices: those of the cells, or of one kind of polydata.
struct Cells {
    indices: Vec<u32>,
    /// Where each list ends in `indices`.
    ends: Vec<usize>,
}

impl Cells {
    fn iter(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts
            .zip(&self.ends)
            .map(|(start, &end)| &self.indices[start..end])
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<Contents, ParseError> {
    let mut values = Values::new(bytes);
    let polydata = header(&mut values)?;
    let mut contents = Contents::default();
    let mut cells = None;
    let mut typed = false;
    while let Some(keyword) = keyword(&mut values) {
        let name = keyword.text.to_ascii_lowercase();
        match &name[..] {
            b"points" => points(&mut values, &mut contents)?,
            b"cells" if !polydata => cells = Some(read_cells(&mut values, &contents)?),
            b"cell_types" if !polydata => {
                let Some(cells) = cells.take() else {
                    let what = "the types of the cells come before the cells";
                    return Err(error(&values, keyword, ParseErrorKind::Syntax, what.into()));
                };
                cell_types(&mut values, &cells, &mut contents)?;
                typed = true;
            }
            b"polygons" if polydata => {
                let cells = read_cells(&mut values, &contents)?;
                for (number, polygon) in cells.iter().enumerate() {
                    let added = contents.face(&values, polygon);
                    added.map_err(|e| e.named("polygon", number))?;
                }
            }
            b"triangle_strips" if polydata => {
                for strip in read_cells(&mut values, &contents)?.iter() {
                    triangle_strip(&values, strip, &mut contents)?;
                }
            }
            b"vertices" | b"lines" if polydata => {
                read_cells(&mut values, &contents)?;
            }
            b"field" => field(&mut values)?,
            b"metadata" => {
                // Up to an empty line.
                values.scanner.skip_line();
                while !values.scanner.rest_of_line().trim_ascii().is_empty() {}
            }
            b"point_data" | b"cell_data" => break,
            _ => {
                let what = format!("{} does not belong here", quote(keyword.text));
                return Err(error(&values, keyword, ParseErrorKind::Syntax, what));
            }
        }
    }
    if cells.is_some() && !typed {
        let what = "the types of the cells (CELL_TYPES) are missing";
        return Err(values.scanner.ends(what));
    }
    Ok(contents)
}

/// An error at a word, which is text whatever the data are.
fn error(values: &Values, token: Token, kind: ParseErrorKind, what: String) -> ParseError {
    values.scanner.error(token.start, kind, what)
}

/// The word that begins a section.
fn keyword<'a>(values: &mut Values<'a>) -> Option<Token<'a>> {
    values.scanner.first_token()
}

/// A word in the line of a keyword.
fn word<'a>(values: &mut Values<'a>, what: &str) -> Result<Token<'a>, ParseError> {
    let missing = |values: &Values| values.scanner.ends(format!("{what} is missing"));
    values.scanner.token().ok_or_else(|| missing(values))
}

/// A count in the line of a keyword, and where it is.
fn count(values: &mut Values, what: &str) -> Result<(u64, usize), ParseError> {
    let token = word(values, what)?;
    Ok((values.scanner.parse_count(token, what)?, token.start))
}

/// A type of data in the line of a keyword.
fn scalar(values: &mut Values) -> Result<Scalar, ParseError> {
    let token = word(values, "the type of the data")?;
    Ok(match &token.text.to_ascii_lowercase()[..] {
        b"char" | b"signed_char" => Scalar::I8,
        b"unsigned_char" => Scalar::U8,
        b"short" => Scalar::I16,
        b"unsigned_short" => Scalar::U16,
        b"int" | b"vtktypeint32" => Scalar::I32,
        b"unsigned_int" | b"vtktypeuint32" => Scalar::U32,
        b"long" | b"vtktypeint64" | b"vtkidtype" => Scalar::I64,
        b"unsigned_long" | b"vtktypeuint64" => Scalar::U64,
        b"float" => Scalar::F32,
        b"double" => Scalar::F64,
        _ => {
            let what = format!("data of type {} are not read", quote(token.text));
            return Err(error(values, token, ParseErrorKind::Unsupported, what));
        }
    })
}

/// The first three lines and the kind of data set: is it polydata?
fn header(values: &mut Values) -> Result<bool, ParseError> {
    let first = values.scanner.rest_of_line();
    let lower = first.to_ascii_lowercase();
    if !lower.starts_with(b"# vtk datafile") {
        let what = format!(
            "a VTK file starts with \"# vtk DataFile Version\", this one with {}",
            quote(first)
        );
        return Err(values.scanner.error(0, ParseErrorKind::Syntax, what));
    }
    values.scanner.rest_of_line();
    let missing = |values: &Values, what: &str| values.scanner.ends(what);
    let Some(token) = keyword(values) else {
        return Err(missing(values, "ASCII or BINARY is missing"));
    };
    values.encoding = match &token.text.to_ascii_uppercase()[..] {
        b"ASCII" => Encoding::Text { lines: false },
        b"BINARY" => Encoding::Binary { big_endian: true },
        _ => {
            let what = format!("expected ASCII or BINARY, found {}", quote(token.text));
            return Err(error(values, token, ParseErrorKind::Syntax, what));
        }
    };
    let Some(token) = keyword(values) else {
        return Err(missing(values, "DATASET is missing"));
    };
    if !token.text.eq_ignore_ascii_case(b"DATASET") {
        let what = format!("expected DATASET, found {}", quote(token.text));
        return Err(error(values, token, ParseErrorKind::Syntax, what));
    }
    let kind = word(values, "the kind of data set")?;
    match &kind.text.to_ascii_uppercase()[..] {
        b"POLYDATA" => Ok(true),
        b"UNSTRUCTURED_GRID" => Ok(false),
        _ => {
            let what = format!(
                "a data set {} is not read (UNSTRUCTURED_GRID and POLYDATA are)",
                quote(kind.text)
            );
            Err(error(values, kind, ParseErrorKind::Unsupported, what))
        }
    }
}

fn points(values: &mut Values, contents: &mut Contents) -> Result<(), ParseError> {
    let (claimed, at) = count(values, "the number of points")?;
    if !contents.positions.is_empty() {
        let what = "the points are there twice";
        return Err(values.scanner.error(at, ParseErrorKind::Syntax, what));
    }
    let scalar = scalar(values)?;
    values.scanner.skip_line();
    let shortest = match values.encoding {
        Encoding::Text { .. } => 6,
        Encoding::Binary { .. } => 3 * scalar.size() as u64,
    };
    let count = values
        .scanner
        .check_claim(at, claimed, "points", shortest)?;
    contents.positions.reserve_exact(count);
    for number in 0..count {
        let point = values.point(scalar, 3);
        contents
            .positions
            .push(point.map_err(|e| e.within("point", number))?);
    }
    Ok(())
}

/// Lists of indices, in the form of version 5 (offsets and indices apart) or the older one (each list
/// begins with its length).
fn read_cells(values: &mut Values, contents: &Contents) -> Result<Cells, ParseError> {
    let (lists, lists_at) = count(values, "the number of lists")?;
    let (numbers, numbers_at) = count(values, "the number of indices")?;
    values.scanner.skip_line();
    let before = values.scanner.clone();
    let offsets = values
        .scanner
        .first_token()
        .is_some_and(|t| t.text.eq_ignore_ascii_case(b"OFFSETS"));
    if offsets {
        return read_offsets(values, contents, [lists, numbers], [lists_at, numbers_at]);
    }
    values.scanner = before;
    let shortest = match values.encoding {
        Encoding::Text { .. } => 2,
        Encoding::Binary { .. } => 4,
    };
    let scanner = &values.scanner;
    let numbers = scanner.check_claim(numbers_at, numbers, "indices", shortest)?;
    let lists = scanner.check_claim(lists_at, lists, "lists of indices", shortest)?;
    let mut cells = Cells {
        indices: Vec::with_capacity(numbers.saturating_sub(lists)),
        ends: Vec::with_capacity(lists),
    };
    for number in 0..lists {
        let within = |e: ParseError| e.within("list", number);
        let length = values
            .count(Scalar::I32, "the length of a list")
            .map_err(within)?;
        // The lengths of the lists count as well.
        let left = numbers.saturating_sub(cells.indices.len() + number + 1);
        if length > left as u64 {
            let what = format!("a list of {length} where {left} more indices are claimed");
            return Err(within(values.error(ParseErrorKind::Syntax, what)));
        }
        for _ in 0..length {
            let index = point_index(values, Scalar::I32, contents).map_err(within)?;
            cells.indices.push(index);
        }
        cells.ends.push(cells.indices.len());
    }
    Ok(cells)
}

/// The form of version 5, behind the word OFFSETS.
fn read_offsets(
    values: &mut Values,
    contents: &Contents,
    [offsets, numbers]: [u64; 2],
    [offsets_at, numbers_at]: [usize; 2],
) -> Result<Cells, ParseError> {
    let of_offsets = scalar(values)?;
    values.scanner.skip_line();
    let shortest = |values: &Values, scalar: Scalar| match values.encoding {
        Encoding::Text { .. } => 2,
        Encoding::Binary { .. } => scalar.size() as u64,
    };
    let size = shortest(values, of_offsets);
    let offsets = values
        .scanner
        .check_claim(offsets_at, offsets, "offsets", size)?;
    let mut ends: Vec<usize> = Vec::with_capacity(offsets);
    for number in 0..offsets {
        let offset = values.count(of_offsets, "an offset")?;
        let last = ends.last().map_or(0, |&e| e as u64);
        if offset < last || offset > numbers || (number == 0 && offset != 0) {
            let what = format!("offset {offset} behind {last}, of {numbers} indices");
            return Err(values
                .error(ParseErrorKind::IndexOutOfRange, what)
                .within("offset", number));
        }
        ends.push(offset as usize);
    }
    if !ends.is_empty() {
        ends.remove(0);
    }
    let found = keyword(values);
    if !found.is_some_and(|t| t.text.eq_ignore_ascii_case(b"CONNECTIVITY")) {
        let what = "CONNECTIVITY is missing behind the offsets";
        return Err(values.scanner.ends(what));
    }
    let of_indices = scalar(values)?;
    values.scanner.skip_line();
    let size = shortest(values, of_indices);
    let numbers = values
        .scanner
        .check_claim(numbers_at, numbers, "indices", size)?;
    let mut indices = Vec::with_capacity(numbers);
    for number in 0..numbers {
        let index = point_index(values, of_indices, contents);
        indices.push(index.map_err(|e| e.within("index", number))?);
    }
    Ok(Cells { indices, ends })
}

fn point_index(
    values: &mut Values,
    scalar: Scalar,
    contents: &Contents,
) -> Result<u32, ParseError> {
    let index = values.integer(scalar, "a point index")?;
    contents.vertex(values, index, 0)
}

fn cell_types(
    values: &mut Values,
    cells: &Cells,
    contents: &mut Contents,
) -> Result<(), ParseError> {
    let (types, at) = count(values, "the number of types")?;
    if types != cells.ends.len() as u64 {
        let what = format!("{types} types of {} cells", cells.ends.len());
        return Err(values.scanner.error(at, ParseErrorKind::Syntax, what));
    }
    values.scanner.skip_line();
    for (number, corners) in cells.iter().enumerate() {
        let within = |e: ParseError| e.named("cell", number);
        let kind = values
            .count(Scalar::I32, "the type of a cell")
            .map_err(within)?;
        let needed = match kind {
            5 => 3,
            8..=10 => 4,
            _ => corners.len(),
        };
        if corners.len() != needed {
            let what = format!(
                "a cell of type {kind} has {needed} points, this one {}",
                corners.len()
            );
            return Err(within(values.error(ParseErrorKind::Syntax, what)));
        }
        match kind {
            // Empty cells, points and lines.
            0..=4 => Ok(()),
            5 | 7 | 9 => contents.face(values, corners),
            6 => triangle_strip(values, corners, contents),
            8 => contents.face(values, &[0, 1, 3, 2].map(|k: usize| corners[k])),
            10 => {
                let corner = |k: usize| corners[k];
                contents.tetrahedra.push([0, 1, 2, 3].map(corner));
                Ok(())
            }
            _ => {
                contents.pass(&format!("cell of type {kind}"), 1);
                Ok(())
            }
        }
        .map_err(within)?;
    }
    Ok(())
}

/// Every other triangle of a strip is turned the other way.
fn triangle_strip(
    values: &Values,
    strip: &[u32],
    contents: &mut Contents,
) -> Result<(), ParseError> {
    for (number, corners) in strip.windows(3).enumerate() {
        let [a, b, c] = [corners[0], corners[1], corners[2]];
        let triangle = if number % 2 == 0 {
            [a, b, c]
        } else {
            [b, a, c]
        };
        contents.face(values, &triangle)?;
    }
    Ok(())
}

/// Arrays of data that belong to the whole.
fn field(values: &mut Values) -> Result<(), ParseError> {
    word(values, "the name of a field")?;
    let (arrays, _) = count(values, "the number of arrays")?;
    for _ in 0..arrays {
        let Some(_name) = keyword(values) else {
            return Err(values.scanner.ends("an array of a field is missing"));
        };
        let (components, _) = count(values, "the number of components")?;
        let (tuples, _) = count(values, "the number of tuples")?;
        let scalar = scalar(values)?;
        values.scanner.skip_line();
        values.skip(
            scalar,
            components.saturating_mul(tuples),
            "an array of a field",
        )?;
    }
    Ok(())
}

/// Writes a surface as polydata, a solid as an unstructured grid, as text.
pub(super) fn write(mesh: Elements) -> Vec<u8> {
    let mut out = mesh.buffer();
    let (kind, cells) = if mesh.is_solid() {
        ("UNSTRUCTURED_GRID", "CELLS")
    } else {
        ("POLYDATA", "POLYGONS")
    };
    let count = mesh.count();
    // Writing to a vector cannot fail.
    let _ = writeln!(
        out,
        "# vtk DataFile Version 3.0\nfoldfree\nASCII\nDATASET {kind}\nPOINTS {} double",
        mesh.positions.len()
    );
    mesh.write_points(&mut out, Line::default());
    let _ = writeln!(out, "{cells} {count} {}", count * (mesh.size + 1));
    let line = Line {
        before: if mesh.is_solid() { "4 " } else { "3 " },
        ..Line::default()
    };
    mesh.write_elements(&mut out, 0, line);
    if mesh.is_solid() {
        let _ = writeln!(out, "CELL_TYPES {count}");
        out.extend(b"10\n".repeat(count));
    }
    out
}
