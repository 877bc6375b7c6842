//! Files: what is written reads back as the same bits, and no bytes make a reader panic or hang.

use foldfree::mesh::io::{CornerTexture, Format, read, write_obj, write_off};
use foldfree::mesh::{Shape, SurfaceMesh, generate};
use glam::{DVec2, DVec3};
use proptest::prelude::*;

fn config() -> ProptestConfig {
    ProptestConfig {
        cases: 512,
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1e3..1e3f64,
        proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL | proptest::num::f64::ZERO,
        Just(1e21),
        Just(-0.0),
    ]
}

fn mesh() -> impl Strategy<Value = (SurfaceMesh, CornerTexture)> {
    let positions = prop::collection::vec([coordinate(), coordinate(), coordinate()], 1..40);
    let texture = prop::collection::vec([coordinate(), coordinate()], 1..40);
    (positions, texture).prop_flat_map(|(positions, texture)| {
        let (n, m) = (positions.len() as u32, texture.len() as u32);
        let faces = prop::collection::vec(([0..n, 0..n, 0..n], [0..m, 0..m, 0..m]), 1..60);
        faces.prop_map(move |faces| {
            let mesh = SurfaceMesh {
                positions: positions.iter().copied().map(DVec3::from_array).collect(),
                simplices: faces.iter().map(|f| f.0).collect(),
            };
            let texture = CornerTexture {
                coordinates: texture.iter().copied().map(DVec2::from_array).collect(),
                corners: faces.iter().map(|f| f.1).collect(),
            };
            (mesh, texture)
        })
    })
}

/// −0 and 0 are equal to `==`: compare what they are made of.
fn bits(mesh: &SurfaceMesh) -> Vec<[u64; 3]> {
    mesh.positions
        .iter()
        .map(|p| p.to_array().map(f64::to_bits))
        .collect()
}

/// Bytes that look like a file: fragments of both formats in any order, and some noise.
fn fragments() -> impl Strategy<Value = Vec<u8>> {
    const WORDS: &[&str] = &[
        "v ",
        "vt ",
        "vn ",
        "f ",
        "f",
        "OFF",
        "COFF",
        "\n",
        "\r\n",
        "\r",
        "\\\n",
        "\\",
        "#",
        " ",
        "/",
        "//",
        "-",
        "+",
        "0",
        "1",
        "2",
        "3",
        "4",
        "9999999999999999999999",
        "1e308",
        "1e-400",
        "nan",
        "inf",
        ".",
        "e",
        "0 0 0\n",
        "1 0 0\n",
        "0 1 0\n",
        "3 0 1 2\n",
        "f 1 2 3 4\n",
        "f -1 -2 -3 -4\n",
        "v 1 2 3\n",
        "v 0 1 0\n",
        "v 5 5 5\n",
        "v 2 -1 0\n",
        "vt 1 1\n",
        "f 1/1 2/1 3/1\n",
        "4 3 0\n",
        "OFF 4 1 0\n",
        "5 0 1 2 3 0\n",
        "\u{feff}",
        "4294967295 ",
        "4294967296 ",
        "18446744073709551616 ",
        "é",
    ];
    let fragment = prop_oneof![
        20 => prop::sample::select(WORDS).prop_map(|word| word.as_bytes().to_vec()),
        1 => prop::collection::vec(any::<u8>(), 1..4),
    ];
    prop::collection::vec(fragment, 0..60).prop_map(|parts| parts.concat())
}

/// Reads as both formats; whatever is accepted must be sound, whatever is not must have a place.
fn survives(bytes: &[u8]) -> Result<(), TestCaseError> {
    for format in Format::ALL {
        match read(bytes, format) {
            Ok(file) => {
                let n = file.mesh.positions.len() as u32;
                prop_assert!(file.mesh.simplices.iter().flatten().all(|&v| v < n));
                prop_assert!(file.mesh.positions.iter().all(|p| p.is_finite()));
                if let Some(texture) = file.texture {
                    let m = texture.coordinates.len() as u32;
                    prop_assert_eq!(texture.corners.len(), file.mesh.simplices.len());
                    prop_assert!(texture.corners.iter().flatten().all(|&t| t < m));
                }
            }
            Err(error) => {
                // Only binary data have no lines.
                let binary = matches!(
                    format,
                    Format::Ply | Format::Stl | Format::Msh | Format::Vtk
                );
                prop_assert!(error.line >= 1 || binary);
                prop_assert!(error.line <= bytes.len() + 1);
                prop_assert!(error.column >= 1 && error.column <= bytes.len() + 1);
                prop_assert!(!error.what.is_empty());
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn obj_round_trip((mesh, texture) in mesh()) {
        let file = read(&write_obj(&mesh, Some(&texture)), Format::Obj).unwrap();
        prop_assert_eq!(bits(&file.mesh), bits(&mesh));
        prop_assert_eq!(&file.mesh, &mesh);
        prop_assert_eq!(file.texture, Some(texture));
        let file = read(&write_obj(&mesh, None), Format::Obj).unwrap();
        prop_assert_eq!(file.mesh, mesh);
        prop_assert_eq!(file.texture, None);
    }

    #[test]
    fn off_round_trip((mesh, _) in mesh()) {
        let file = read(&write_off(&mesh), Format::Off).unwrap();
        prop_assert_eq!(bits(&file.mesh), bits(&mesh));
        prop_assert_eq!(file.mesh, mesh);
        prop_assert!(file.notes.is_empty());
    }

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        survives(&bytes)?;
    }

    #[test]
    fn nearly_a_file(bytes in fragments()) {
        survives(&bytes)?;
    }

    #[test]
    fn a_file_with_some_bytes_changed(
        (mesh, texture) in mesh(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        end in any::<prop::sample::Index>(),
    ) {
        for mut bytes in [write_obj(&mesh, Some(&texture)), write_off(&mesh)] {
            for (index, byte) in &changes {
                let index = index.index(bytes.len());
                bytes[index] = *byte;
            }
            survives(&bytes)?;
            survives(&bytes[..end.index(bytes.len())])?;
        }
    }
}

#[test]
fn every_truncation_of_an_off_file_is_an_error() {
    let bytes = write_off(&generate(Shape::Terrain, 40));
    let whole = bytes.len() - 1; // the last line end may lack
    for end in 0..whole {
        let result = read(&bytes[..end], Format::Off);
        // Cutting digits off the very last index is all that may go unseen.
        if let Ok(file) = result {
            assert!(bytes[end..whole].iter().all(u8::is_ascii_digit));
            assert_eq!(
                file.mesh.simplices.len(),
                generate(Shape::Terrain, 40).simplices.len()
            );
        }
    }
}

#[test]
fn a_truncated_obj_file_names_a_line_or_lacks_faces() {
    let mesh = generate(Shape::Terrain, 40);
    let bytes = write_obj(&mesh, None);
    for end in 0..bytes.len() - 1 {
        if let Ok(file) = read(&bytes[..end], Format::Obj) {
            assert!(file.mesh.simplices.len() <= mesh.simplices.len());
        }
    }
}

#[test]
fn long_inputs_end_soon() {
    // One line, one token, one comment, one continued line, of a few megabytes each.
    for text in ["v ", "f 1", "# ", "\\\n", "1 ", "/", "-", "f 1 2 3 "] {
        let bytes = text.repeat((2 << 20) / text.len()).into_bytes();
        for format in Format::ALL {
            let _ = read(&bytes, format);
        }
    }
    let mut polygon = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf".to_vec();
    polygon.extend(b" 1 2 3 4 2".repeat(200_000));
    let _ = read(&polygon, Format::Obj);
}
