//! STL, as text and binary: triangles without common vertices, which are welded where all bits of the
//! coordinates agree (−0 and 0 count as equal).

use super::scan::{Scanner, Token, quote};
use super::values::{Encoding, Scalar, Values};
use super::write::{Elements, write_point};
use super::{ParseError, ParseErrorKind, SurfaceFile};
use crate::mesh::{SurfaceMesh, counted};
use glam::DVec3;

/// Bytes before the triangles of a binary file: a title, then their number.
const TITLE: usize = 80;
/// Bytes of a binary triangle: normal, three corners, two bytes without a meaning.
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<SurfaceFile, ParseError> {
    let corners = if is_text(bytes) {
        read_text(bytes)?
    } else {
        read_binary(bytes)?
    };
    if corners.len() >= u32::MAX as usize {
        let what = format!("{} triangles are too many", corners.len() / 3);
        return Err(ParseError::at(bytes, 0, ParseErrorKind::TooLarge, what));
    }
    Ok(weld(&corners))
}

/// Binary files may begin with "solid", too: then their length gives them away, or a zero byte.
fn is_text(bytes: &[u8]) -> bool {
    let claimed = bytes.get(TITLE..TITLE + 4).map(|count| {
        let count = count.iter().rev().fold(0, |n, &b| n << 8 | u64::from(b));
        count * TRIANGLE as u64 + TITLE as u64 + 4
    });
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = start.trim_ascii_start();
    let begins = start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid");
    begins && claimed != Some(bytes.len() as u64) && !bytes[..bytes.len().min(512)].contains(&0)
}

fn read_binary(bytes: &[u8]) -> Result<Vec<DVec3>, ParseError> {
    let mut values = Values::new(bytes);
    values.encoding = Encoding::Binary { big_endian: false };
    values.skip(Scalar::U8, TITLE as u64, "the title")?;
    let count = values.claim(Scalar::U32, "triangles", 0, TRIANGLE as u64)?;
    let mut corners = Vec::with_capacity(3 * count);
    for number in 0..count {
        let within = |e: ParseError| e.within("triangle", number);
        values.skip(Scalar::F32, 3, "a normal").map_err(within)?;
        for _ in 0..3 {
            corners.push(values.point(Scalar::F32, 3).map_err(within)?);
        }
        values
            .skip(Scalar::U16, 1, "the end of a triangle")
            .map_err(within)?;
    }
    if values.scanner.remaining() > 0 {
        values.start_item();
        let what = format!(
            "{} bytes behind the last triangle",
            values.scanner.remaining()
        );
        return Err(values.error(ParseErrorKind::Syntax, what));
    }
    Ok(corners)
}

/// Where a text file stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    Outside,
    Solid,
    Facet,
    Loop,
    /// Behind a facet's loop.
    Closed,
}

fn read_text(bytes: &[u8]) -> Result<Vec<DVec3>, ParseError> {
    let mut scanner = Scanner::new(bytes, false);
    let mut corners: Vec<DVec3> = Vec::new();
    // Corners before the current loop.
    let mut started = 0;
    let mut place = Place::Outside;
    while let Some(token) = scanner.first_token() {
        let word = token.text.to_ascii_lowercase();
        place = match (&word[..], place) {
            (b"solid", Place::Outside) => Place::Solid,
            (b"facet", Place::Solid) => Place::Facet,
            (b"outer", Place::Facet) => Place::Loop,
            (b"vertex", Place::Loop) => {
                let missing = "a vertex needs three coordinates";
                let mut position = [0.0; 3];
                for coordinate in &mut position {
                    *coordinate = scanner.number(missing)?;
                }
                corners.push(position.into());
                Place::Loop
            }
            (b"endloop", Place::Loop) => {
                let found = corners.len() - started;
                if found != 3 {
                    let what = format!("a facet of STL has three vertices, this one {found}");
                    return Err(scanner.error(token.start, ParseErrorKind::Syntax, what));
                }
                started = corners.len();
                Place::Closed
            }
            (b"endfacet", Place::Closed) => Place::Solid,
            (b"endsolid", Place::Solid) => Place::Outside,
            _ => return Err(misplaced(&scanner, token)),
        };
        scanner.skip_line();
    }
    if place != Place::Outside {
        return Err(scanner.ends("the file ends within a solid (endsolid is missing)"));
    }
    Ok(corners)
}

fn misplaced(scanner: &Scanner, token: Token) -> ParseError {
    let what = format!("{} does not belong here", quote(token.text));
    scanner.error(token.start, ParseErrorKind::Syntax, what)
}

/// The triangles of the corners, three by three; vertices in the order in which they first come.
fn weld(corners: &[DVec3]) -> SurfaceFile {
    // Adding zero makes −0 into 0.
    let key = |corner: u32| {
        (corners[corner as usize] + DVec3::ZERO)
            .to_array()
            .map(f64::to_bits)
    };
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.sort_unstable_by_key(|&corner| (key(corner), corner));
    // Each corner's first equal.
    let mut first: Vec<u32> = vec![0; corners.len()];
    for run in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &corner in run {
            first[corner as usize] = run[0];
        }
    }
    let mut positions: Vec<DVec3> = Vec::new();
    // From here on the vertex of a corner, once it is known.
    for corner in 0..first.len() {
        let equal = first[corner] as usize;
        first[corner] = if equal == corner {
            positions.push(corners[corner]);
            positions.len() as u32 - 1
        } else {
            first[equal]
        };
    }
    let mut notes = Vec::new();
    if positions.len() < corners.len() {
        notes.push(format!(
            "{} welded to {}",
            counted(corners.len(), "corner"),
            counted(positions.len(), "vertex")
        ));
    }
    SurfaceFile {
        mesh: SurfaceMesh {
            positions,
            simplices: first.as_chunks::<3>().0.to_vec(),
        },
        texture: None,
        notes,
    }
}

/// Writes a surface as text, so that coordinates keep all their digits.
pub(super) fn write(mesh: Elements) -> Vec<u8> {
    let mut out = Vec::with_capacity(200 * mesh.count() + 64);
    out.extend_from_slice(b"solid foldfree\n");
    for triangle in mesh.iter() {
        let [a, b, c] = [0, 1, 2].map(|k| mesh.positions[triangle[k] as usize]);
        out.extend_from_slice(b"facet normal ");
        write_point(&mut out, normal(a, b, c));
        out.extend_from_slice(b"\nouter loop\n");
        for corner in [a, b, c] {
            out.extend_from_slice(b"vertex ");
            write_point(&mut out, corner);
            out.push(b'\n');
        }
        out.extend_from_slice(b"endloop\nendfacet\n");
    }
    out.extend_from_slice(b"endsolid foldfree\n");
    out
}

/// The unit normal; zero where there is none.
fn normal(a: DVec3, b: DVec3, c: DVec3) -> DVec3 {
    // Scaled, so that the product of tiny or huge sides is neither zero nor infinite; halved before, so
    // that differences are finite.
    let (u, v) = (b * 0.5 - a * 0.5, c * 0.5 - a * 0.5);
    let scale = u.abs().max(v.abs()).max_element();
    if scale == 0.0 {
        return DVec3::ZERO;
    }
    (u / scale).cross(v / scale).normalize_or_zero()
}
