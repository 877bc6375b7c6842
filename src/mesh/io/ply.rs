//! PLY (Stanford polygons), as text and binary of either byte order: positions and faces; other
//! properties and elements are passed over.

use super::contents::Contents;
use super::scan::{Scanner, Token, quote};
use super::values::{Encoding, Scalar, Values};
use super::write::{Elements, Line};
use super::{ParseError, ParseErrorKind};
use std::io::Write;

/// A property of an element.
struct Property<'a> {
    name: &'a [u8],
    /// The type of a list's length; `None`: not a list.
    length: Option<Scalar>,
    /// The type of the value, or of the list's.
    scalar: Scalar,
}

/// A kind of element, as the header describes it.
struct Element<'a> {
    name: &'a [u8],
    count: u64,
    /// Where the header says so.
    at: usize,
    properties: Vec<Property<'a>>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Contents, ParseError> {
    let mut values = Values::new(bytes);
    let (encoding, elements) = header(bytes, &mut values)?;
    values.encoding = encoding;
    let mut contents = Contents::default();
    let mut has_vertices = false;
    for element in &elements {
        match element.name {
            b"vertex" => {
                read_vertices(&mut values, element, &mut contents)?;
                has_vertices = true;
            }
            b"face" if !has_vertices && element.count > 0 => {
                let what = "the faces come before the vertices: that is not read";
                let kind = ParseErrorKind::Unsupported;
                return Err(values.scanner.error(element.at, kind, what));
            }
            b"face" => read_faces(&mut values, element, &mut contents)?,
            _ => skip_elements(&mut values, element, &mut contents)?,
        }
    }
    Ok(contents)
}

/// The header, from the first line to the one that says end_header.
fn header<'a>(
    bytes: &'a [u8],
    values: &mut Values<'a>,
) -> Result<(Encoding, Vec<Element<'a>>), ParseError> {
    let scanner = &mut values.scanner;
    let first = scanner.rest_of_line();
    if first.trim_ascii() != b"ply" {
        let what = format!("a PLY file starts with ply, this one with {}", quote(first));
        return Err(scanner.error(0, ParseErrorKind::Syntax, what));
    }
    // Where lines end in a lone carriage return, a line feed behind the last of them is data.
    let lone_return = bytes[..scanner.position()].ends_with(b"\r");
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let Some(keyword) = scanner.first_token() else {
            return Err(scanner.ends("the header does not end (end_header is missing)"));
        };
        match keyword.text {
            b"format" => encoding = Some(format(scanner)?),
            b"comment" | b"obj_info" => {}
            b"element" => {
                let (Some(name), Some(count)) = (scanner.token(), scanner.token()) else {
                    return Err(scanner.ends("an element needs a name and a count"));
                };
                elements.push(Element {
                    name: name.text,
                    count: scanner.parse_count(count, "the number of elements")?,
                    at: count.start,
                    properties: Vec::new(),
                });
            }
            b"property" => {
                let Some(element) = elements.last_mut() else {
                    let what = "a property before the first element";
                    return Err(scanner.error(keyword.start, ParseErrorKind::Syntax, what));
                };
                element.properties.push(property(scanner)?);
            }
            b"end_header" if lone_return => {
                scanner.take(1);
                break;
            }
            b"end_header" => {
                scanner.rest_of_line();
                break;
            }
            other => {
                let what = format!("{} is not a word of a PLY header", quote(other));
                return Err(scanner.error(keyword.start, ParseErrorKind::Syntax, what));
            }
        }
        scanner.skip_line();
    }
    match encoding {
        Some(encoding) => Ok((encoding, elements)),
        None => Err(scanner.error(0, ParseErrorKind::Syntax, "the header names no format")),
    }
}

/// What is behind `format`.
fn format(scanner: &mut Scanner) -> Result<Encoding, ParseError> {
    let Some(word) = scanner.token() else {
        return Err(scanner.ends("the format is missing"));
    };
    match word.text {
        b"ascii" => Ok(Encoding::Text { lines: true }),
        b"binary_little_endian" => Ok(Encoding::Binary { big_endian: false }),
        b"binary_big_endian" => Ok(Encoding::Binary { big_endian: true }),
        other => {
            let what = format!("the format {} is not known", quote(other));
            Err(scanner.error(word.start, ParseErrorKind::Unsupported, what))
        }
    }
}

/// What is behind `property`: a type, or `list` and two types, and a name.
fn property<'a>(scanner: &mut Scanner<'a>) -> Result<Property<'a>, ParseError> {
    let missing = "a property needs a type and a name";
    let word = |scanner: &mut Scanner<'a>| scanner.token().ok_or_else(|| scanner.ends(missing));
    let mut token = word(scanner)?;
    let mut length = None;
    if token.text == b"list" {
        let of_length = word(scanner)?;
        length = Some(scalar(scanner, of_length)?);
        token = word(scanner)?;
    }
    Ok(Property {
        length,
        scalar: scalar(scanner, token)?,
        name: word(scanner)?.text,
    })
}

fn scalar(scanner: &Scanner, token: Token) -> Result<Scalar, ParseError> {
    Ok(match token.text {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        other => {
            let what = format!("the type {} is not known", quote(other));
            return Err(scanner.error(token.start, ParseErrorKind::Unsupported, what));
        }
    })
}

impl Element<'_> {
    /// The property of one of these names, a list or not.
    fn find(&self, names: &[&[u8]], list: bool) -> Option<usize> {
        self.properties
            .iter()
            .position(|p| names.contains(&p.name) && p.length.is_some() == list)
    }

    /// The count, held against what is left of the file: no property takes less than a byte, which in
    /// text has a blank or the line's end behind it.
    fn check_count(&self, values: &Values, items: &str) -> Result<usize, ParseError> {
        let properties = self.properties.iter();
        let shortest: u64 = properties
            .map(|p| match values.encoding {
                Encoding::Text { .. } => 2,
                Encoding::Binary { .. } => p.length.unwrap_or(p.scalar).size() as u64,
            })
            .sum();
        values
            .scanner
            .check_claim(self.at, self.count, items, shortest.max(1))
    }
}

/// Passes over a property.
fn skip(values: &mut Values, property: &Property) -> Result<(), ParseError> {
    let count = match property.length {
        Some(length) => values.count(length, "the length of a list")?,
        None => 1,
    };
    values.skip(property.scalar, count, "a property")
}

fn read_vertices(
    values: &mut Values,
    element: &Element,
    contents: &mut Contents,
) -> Result<(), ParseError> {
    let mut axes = [0; 3];
    for (axis, name) in axes.iter_mut().zip([b"x", b"y", b"z"]) {
        let Some(found) = element.find(&[name], false) else {
            let what = format!("the vertices have no property {}", quote(name));
            let kind = ParseErrorKind::Syntax;
            return Err(values.scanner.error(element.at, kind, what));
        };
        *axis = found;
    }
    let count = element.check_count(values, "vertices")?;
    contents.positions.reserve(count);
    for number in 0..count {
        values.start_item();
        let mut position = [0.0; 3];
        for (index, property) in element.properties.iter().enumerate() {
            match axes.iter().position(|&a| a == index) {
                Some(axis) => {
                    position[axis] = values
                        .real(property.scalar, "a coordinate")
                        .map_err(|e| e.within("vertex", number))?;
                }
                None => skip(values, property).map_err(|e| e.within("vertex", number))?,
            }
        }
        contents.positions.push(position.into());
        values.end_item();
    }
    Ok(())
}

fn read_faces(
    values: &mut Values,
    element: &Element,
    contents: &mut Contents,
) -> Result<(), ParseError> {
    let Some(list) = element.find(&[b"vertex_indices", b"vertex_index"], true) else {
        let what = "the faces have no list vertex_indices";
        let kind = ParseErrorKind::Syntax;
        return Err(values.scanner.error(element.at, kind, what));
    };
    let count = element.check_count(values, "faces")?;
    let mut corners = Vec::new();
    for number in 0..count {
        values.start_item();
        for (index, property) in element.properties.iter().enumerate() {
            match property.length {
                Some(length) if index == list => {
                    read_corners(values, length, property.scalar, contents, &mut corners)
                }
                _ => skip(values, property),
            }
            .map_err(|e| e.within("face", number))?;
        }
        values.end_item();
    }
    Ok(())
}

/// The list of one face's vertices.
fn read_corners(
    values: &mut Values,
    length: Scalar,
    scalar: Scalar,
    contents: &mut Contents,
    corners: &mut Vec<u32>,
) -> Result<(), ParseError> {
    corners.clear();
    for _ in 0..values.count(length, "the number of a face's vertices")? {
        let index = values.integer(scalar, "a vertex index")?;
        corners.push(contents.vertex(values, index, 0)?);
    }
    contents.face(values, corners)
}

fn skip_elements(
    values: &mut Values,
    element: &Element,
    contents: &mut Contents,
) -> Result<(), ParseError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    let name = format!("{} element", quote(element.name));
    let count = element.check_count(values, &format!("{name}s"))?;
    for number in 0..count {
        values.start_item();
        for property in &element.properties {
            skip(values, property).map_err(|e| e.within(&name, number))?;
        }
        values.end_item();
    }
    contents.pass(&name, count);
    Ok(())
}

/// Writes a surface as text, coordinates as double.
pub(super) fn write(mesh: Elements) -> Vec<u8> {
    let mut out = mesh.buffer();
    // Writing to a vector cannot fail.
    let _ = write!(
        out,
        "ply\nformat ascii 1.0\nelement vertex {}\n\
         property double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.count()
    );
    mesh.write_points(&mut out, Line::default());
    let line = Line {
        before: "3 ",
        ..Line::default()
    };
    mesh.write_elements(&mut out, 0, line);
    out
}
