//! Byte-level fuzzing of every reader: whatever the bytes, a sound mesh or an error with a place; no
//! panic, no hang, no memory by what a file merely claims.

mod mesh_encode;

use foldfree::mesh::SimplicialMesh;
use foldfree::mesh::io::{
    Format, ParseError, read, read_ele, read_node, read_solid, write_ele, write_node,
};
use foldfree::optim::Stopwatch;
use glam::DVec3;
use mesh_encode::{block, samples};
use proptest::prelude::*;
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

/// Remembers the largest piece of memory that this thread asked for.
struct Watched;

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

#[global_allocator]
static ALLOCATOR: Watched = Watched;

// SAFETY: all is left to the system's allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        LARGEST.with(|l| l.set(l.get().max(layout.size())));
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

/// No piece of memory is larger than so many times the file (a vertex of three bytes becomes one of 24).
const GROWTH: usize = 64;

/// What any answer has to be.
fn is_sound<const N: usize>(
    mesh: Result<&SimplicialMesh<N>, &ParseError>,
    bytes: &[u8],
) -> Result<(), TestCaseError> {
    match mesh {
        Ok(mesh) => {
            let n = mesh.positions.len() as u32;
            prop_assert!(mesh.simplices.iter().flatten().all(|&v| v < n));
            prop_assert!(mesh.positions.iter().all(|p| p.is_finite()));
        }
        Err(error) => {
            prop_assert!(error.line <= bytes.len() + 1);
            prop_assert!(error.column >= 1 && error.column <= bytes.len() + 1);
            prop_assert!(!error.what.is_empty() && error.what.len() < 1000);
        }
    }
    Ok(())
}

/// Reads as every format.
fn survives(bytes: &[u8]) -> Result<(), TestCaseError> {
    let clock = Stopwatch::start();
    LARGEST.set(0);
    for format in Format::ALL {
        let file = read(bytes, format);
        is_sound(file.as_ref().map(|f| &f.mesh), bytes)?;
        let notes = file.map(|f| f.notes).unwrap_or_default();
        prop_assert!(notes.len() <= 12 && notes.iter().all(|n| n.len() < 1000));
        let file = read_solid(bytes, format);
        is_sound(file.as_ref().map(|f| &f.mesh), bytes)?;
    }
    let nodes = read_node(bytes);
    if let Err(error) = &nodes {
        is_sound::<4>(Err(error), bytes)?;
    }
    for mut nodes in [nodes.unwrap_or_default(), Default::default()] {
        nodes.positions.resize(8, DVec3::ZERO);
        is_sound(read_ele(bytes, nodes).as_ref(), bytes)?;
    }
    let largest = LARGEST.get();
    prop_assert!(
        largest <= GROWTH * bytes.len() + 4096,
        "{} bytes at once",
        largest
    );
    prop_assert!(clock.seconds() < 10.0);
    Ok(())
}

/// Valid files of all formats.
fn files() -> Vec<Vec<u8>> {
    let mesh = block(1);
    let mut files: Vec<Vec<u8>> = samples(&mesh).into_iter().map(|s| s.bytes).collect();
    files.push(write_node(&mesh.positions));
    files.push(write_ele(&mesh.solid()));
    files
}

/// A change of a file.
#[derive(Debug, Clone)]
enum Change {
    Flip(prop::sample::Index, u8),
    Replace(prop::sample::Index, Vec<u8>),
    Delete(prop::sample::Index, usize),
    Insert(prop::sample::Index, Vec<u8>),
    Truncate(prop::sample::Index),
    /// Line, and where the copy goes.
    Duplicate(prop::sample::Index, prop::sample::Index),
    DeleteLine(prop::sample::Index),
    Swap(prop::sample::Index, prop::sample::Index),
}

/// Bytes that mean something in some format.
fn fragment() -> impl Strategy<Value = Vec<u8>> {
    const WORDS: &[&str] = &[
        "0",
        "1",
        "2",
        "3",
        "4",
        "5",
        "10",
        "-1",
        " ",
        "\n",
        "\r",
        "\r\n",
        "#",
        "$",
        "nan",
        "inf",
        "1e999",
        "1e-999",
        "4294967295",
        "4294967296",
        "18446744073709551615",
        "99999999999999999999",
        "-9223372036854775808",
        "$EndNodes\n",
        "$Elements\n",
        "$EndX",
        "Vertices\n",
        "Triangles\n",
        "Tetrahedra\n",
        "End\n",
        "Hexahedra\n",
        "Dimension 2\n",
        "element x 18446744073709551615\n",
        "property list uchar uint x\n",
        "property char x\n",
        "end_header\n",
        "format ascii 1.0\n",
        "format binary_big_endian 1.0\n",
        "BINARY\n",
        "ASCII\n",
        "METADATA\n",
        "FIELD a 9999999999\n",
        "x 99999999999 99999999999 double\n",
        "OFFSETS vtktypeint64\n",
        "CONNECTIVITY vtktypeint64\n",
        "CELL_TYPES 1\n",
        "CELLS 1 4\n",
        "POLYGONS 1 4\n",
        "TRIANGLE_STRIPS 1 4\n",
        "endsolid\n",
        "solid\n",
        "endfacet\n",
        "\0\0\0\0",
        "\u{1}\0\0\0",
        "\u{7f}\u{7f}\u{7f}\u{7f}",
        "4.1 1 8\n",
        "2.2 1 8\n",
        "4.1 0 8\n",
    ];
    prop_oneof![
        4 => prop::sample::select(WORDS).prop_map(|word| word.as_bytes().to_vec()),
        1 => Just(vec![0xff; 8]),
        1 => Just(vec![0xff, 0xff, 0xff, 0x7f]),
        1 => prop::collection::vec(any::<u8>(), 1..9),
    ]
}

fn change() -> impl Strategy<Value = Change> {
    use prop::sample::Index;
    prop_oneof![
        (any::<Index>(), any::<u8>()).prop_map(|(i, b)| Change::Flip(i, b)),
        (any::<Index>(), fragment()).prop_map(|(i, b)| Change::Replace(i, b)),
        (any::<Index>(), 1..20usize).prop_map(|(i, n)| Change::Delete(i, n)),
        (any::<Index>(), fragment()).prop_map(|(i, b)| Change::Insert(i, b)),
        any::<Index>().prop_map(Change::Truncate),
        any::<(Index, Index)>().prop_map(|(i, j)| Change::Duplicate(i, j)),
        any::<Index>().prop_map(Change::DeleteLine),
        any::<(Index, Index)>().prop_map(|(i, j)| Change::Swap(i, j)),
    ]
}

/// Changes lines with their ends.
fn edit_lines(bytes: &mut Vec<u8>, edit: impl Fn(&mut Vec<Vec<u8>>)) {
    let lines = bytes.split_inclusive(|&b| b == b'\n');
    let mut lines: Vec<Vec<u8>> = lines.map(<[u8]>::to_vec).collect();
    edit(&mut lines);
    *bytes = lines.concat();
}

fn apply(change: &Change, bytes: &mut Vec<u8>) {
    if bytes.is_empty() {
        return;
    }
    let length = bytes.len();
    match change {
        Change::Flip(at, with) => bytes[at.index(length)] ^= with,
        Change::Replace(at, with) => {
            let at = at.index(length);
            let end = (at + with.len()).min(length);
            bytes.splice(at..end, with.iter().copied());
        }
        Change::Delete(at, count) => {
            let at = at.index(length);
            bytes.drain(at..(at + count).min(length));
        }
        Change::Insert(at, what) => {
            let at = at.index(length);
            bytes.splice(at..at, what.iter().copied());
        }
        Change::Truncate(at) => bytes.truncate(at.index(length)),
        Change::Duplicate(from, to) => edit_lines(bytes, |lines| {
            let line = lines[from.index(lines.len())].clone();
            lines.insert(to.index(lines.len() + 1), line);
        }),
        Change::DeleteLine(at) => edit_lines(bytes, |lines| {
            lines.remove(at.index(lines.len()));
        }),
        Change::Swap(a, b) => edit_lines(bytes, |lines| {
            let n = lines.len();
            lines.swap(a.index(n), b.index(n));
        }),
    }
}

/// `FOLDFREE_FUZZ_CASES` asks for more.
fn config() -> ProptestConfig {
    let wanted = std::env::var("FOLDFREE_FUZZ_CASES").ok();
    ProptestConfig {
        cases: wanted.and_then(|n| n.parse().ok()).unwrap_or(2000),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        survives(&bytes)?;
    }

    #[test]
    fn any_bytes_behind_a_header(
        file in any::<prop::sample::Index>(),
        end in any::<prop::sample::Index>(),
        parts in prop::collection::vec(fragment(), 0..40),
    ) {
        let files = files();
        let file = &files[file.index(files.len())];
        let mut bytes = file[..end.index(file.len().min(400))].to_vec();
        bytes.extend(parts.concat());
        survives(&bytes)?;
    }

    #[test]
    fn changed_files(
        file in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..6),
    ) {
        let files = files();
        let mut bytes = files[file.index(files.len())].clone();
        for change in &changes {
            apply(change, &mut bytes);
        }
        survives(&bytes)?;
    }
}

#[test]
fn every_truncation_of_every_file() {
    for file in files() {
        for end in 0..file.len() {
            survives(&file[..end]).unwrap();
        }
    }
}

#[test]
fn no_size_that_is_claimed_is_believed() {
    // Any run of digits, and any four or eight bytes, made huge.
    for file in files() {
        for at in 0..file.len() {
            let mut bytes = file.clone();
            if bytes[at].is_ascii_digit() {
                bytes.splice(at..at + 1, *b"987654321987");
                survives(&bytes).unwrap();
            } else {
                for huge in [&b"\xff\xff\xff\x7f"[..], &b"\x7f\xff\xff\xff"[..]] {
                    let end = (at + 4).min(bytes.len());
                    bytes.splice(at..end, huge.iter().copied());
                    survives(&bytes).unwrap();
                }
            }
        }
    }
}

#[test]
fn long_files_end_soon() {
    let mut starts: Vec<Vec<u8>> = files()
        .into_iter()
        .map(|f| f[..f.len().min(120)].to_vec())
        .collect();
    starts.push(b"MeshVersionFormatted 2\nDimension 3\n".to_vec());
    starts.push(b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".to_vec());
    starts.push(b"ply\nformat ascii 1.0\n".to_vec());
    starts.push(
        b"# vtk DataFile Version 3.0\n\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\n".to_vec(),
    );
    for start in &starts {
        for filling in [
            "1 ",
            "\n",
            "#",
            "x",
            "A\n1\n",
            "$A\n$EndA\n",
            "element a 0\n",
            "METADATA\n\n",
            "\0",
            "solid\nendsolid\n",
        ] {
            let mut bytes = start.clone();
            bytes.extend(filling.as_bytes().repeat((1 << 18) / filling.len()));
            survives(&bytes).unwrap();
        }
    }
    // As many names of sections and elements as fit.
    let names = |prefix: &str, suffix: &str| -> Vec<u8> {
        (0..20_000).fold(prefix.as_bytes().to_vec(), |mut text, i| {
            text.extend(format!("A{i}{suffix}").bytes());
            text
        })
    };
    survives(&names(
        "MeshVersionFormatted 2\nDimension 3\nVertices 0\n",
        " 1\n1\n",
    ))
    .unwrap();
    let header: String = (0..20_000)
        .map(|i| format!("element e{i} 1\nproperty char x\n"))
        .collect();
    let ply = format!(
        "ply\nformat ascii 1.0\n{header}end_header\n{}",
        "7\n".repeat(20_000)
    );
    survives(ply.as_bytes()).unwrap();
}
