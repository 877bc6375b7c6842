//! What the readers take, and where they say what they do not take.

use super::polygon::{Outcome, triangulate};
use super::*;
use glam::DVec3;

fn obj(text: &str) -> SurfaceFile {
    read(text.as_bytes(), Format::Obj).unwrap()
}

fn off(text: &str) -> SurfaceFile {
    read(text.as_bytes(), Format::Off).unwrap()
}

/// (line, column, kind, message).
fn fails(bytes: impl AsRef<[u8]>, format: Format) -> (usize, usize, ParseErrorKind, String) {
    let error = read(bytes.as_ref(), format).unwrap_err();
    assert_eq!(error.code(), "parse");
    (error.line, error.column, error.kind, error.what)
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

#[test]
fn obj_corner_forms() {
    for face in [
        "f 1 2 3",
        "f 1//1 2//1 3//1",
        "f 1// 2 3/",
        "f -3 -2 -1",
        "  f\t1  2 3 # all",
    ] {
        let file = obj(&format!("{TRIANGLE}vn 0 0 1\n{face}\n"));
        assert_eq!(file.mesh.simplices, [[0, 1, 2]], "{face}");
        assert_eq!(file.mesh.positions[1], DVec3::X);
        assert_eq!(file.texture, None);
        assert!(file.notes.is_empty());
    }
    for face in [
        "f 1/3 2/2 3/1",
        "f 1/3/1 2/2/1 3/1/1",
        "f -3/-1/-1 -2/-2/-1 -1/-3/-1",
    ] {
        let file = obj(&format!(
            "{TRIANGLE}vt 0 0\nvt 0.5\nvt 1 1 7\nvn 0 0 1\n{face}"
        ));
        let texture = file.texture.unwrap();
        assert_eq!(texture.corners, [[2, 1, 0]], "{face}");
        assert_eq!(texture.coordinates[1], DVec2::new(0.5, 0.0));
    }
}

#[test]
fn obj_line_forms() {
    let plain = obj(&format!("{TRIANGLE}f 1 2 3\n"));
    let crlf = format!("\u{feff}# a comment\\\r\n\r\n{TRIANGLE}f 1 2 3").replace("\r\n", "\n");
    assert_eq!(obj(&crlf.replace('\n', "\r\n")).mesh, plain.mesh);
    assert_eq!(obj(&crlf.replace('\n', "\r")).mesh, plain.mesh);
    let continued = "v 0 0 \\\n 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0 1.0\nf 1 \\\r\n2 3\\\n\n";
    assert_eq!(obj(continued).mesh, plain.mesh);
    // Faces may come before their vertices.
    assert_eq!(obj(&format!("f 1 2 3\n{TRIANGLE}")).mesh, plain.mesh);
    let rest = "mtllib C:\\x\\y.mtl\no a\ng b c\ns off\nusemtl m\nl 1 2\np 1\n";
    let file = obj(&format!("{rest}{TRIANGLE}f 1 2 3\n"));
    assert_eq!((file.mesh, file.notes.len()), (plain.mesh.clone(), 0));
    let file = obj(&format!("{TRIANGLE}f 1 2 3\nfrobnicate 3\nxyzzy\n"));
    assert_eq!(
        file.notes,
        ["2 unknown statements passed over, the first a \"frobnicate\""]
    );
}

#[test]
fn obj_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Obj);
    assert_eq!(at("").2, Empty);
    assert_eq!(at("# nothing\n\n").2, Empty);
    let text = |rest: &str| format!("{TRIANGLE}{rest}\n");
    assert_eq!(
        at(&text("f 1 2 90")),
        (4, 7, IndexOutOfRange, "vertex index 90 of 3".into())
    );
    assert_eq!(
        at(&format!("f 1 2 5\nf 9 9 9\n{TRIANGLE}")),
        (1, 7, IndexOutOfRange, "vertex index 5 of 3".into())
    );
    assert_eq!(at(&text("f 1 -4 2")).3, "vertex index -4 of 3");
    assert_eq!(
        at(&text("f 1 0 2")).3,
        "vertex index 0 (indices start at 1)"
    );
    assert_eq!(at(&text("f 1 2 99999999999999999999")).2, IndexOutOfRange);
    assert_eq!(
        at(&text("f 1 2 4294967297")).3,
        "vertex index 4294967297 of 3"
    );
    assert_eq!(
        at(&text("vt 0 0\nf 1/1 2/7 3/1")),
        (5, 9, IndexOutOfRange, "texture index 7 of 1".into())
    );
    for word in [
        "nan",
        "NaN",
        "inf",
        "-Infinity",
        "1e999",
        "-nan(ind)",
        "1.#QNAN",
    ] {
        let (line, column, kind, _) = at(&text(&format!("v 0 {word} 0")));
        assert_eq!((line, column, kind), (4, 5, NonFinite), "{word}");
    }
    assert_eq!(
        at(&text("v 0 1,5 0")),
        (4, 5, Number, "expected a number, found \"1,5\"".into())
    );
    assert_eq!(
        at("v 0 0 0\r\nv 1 0"),
        (2, 6, Truncated, "a vertex needs three coordinates".into())
    );
    assert_eq!(at(&text("f 1 2")).2, Truncated);
    assert_eq!(at(&text("f 1/1/1/1 2 3")).2, Number);
    assert_eq!(at(&text("f 1 2 three")).2, Number);
    assert_eq!(at(&text("f 1 2 \u{fffd}\u{1}")).2, Number);
    assert_eq!(at("<!DOCTYPE html>").2, Syntax);
    assert_eq!(at("OFF\n3 1 0\n0 0 0").2, Syntax);
    assert_eq!(fails([0x1f, 0x8b, 8, 0], Format::Obj).2, Unsupported);
    assert_eq!(fails([0xff, 0xfe, b'v', 0], Format::Obj).2, Unsupported);
    assert_eq!(
        fails([b'v', b' ', 0xc0, b' ', b'0', b' ', b'0'], Format::Obj).2,
        Number
    );
}

#[test]
fn off_forms() {
    let body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let expected = off(&format!("OFF\n3 1 3\n{body}")).mesh;
    assert_eq!(expected.simplices, [[0, 1, 2]]);
    for text in [
        format!("OFF 3 1 0\n{body}"),
        format!("3 1 0\n{body}"),
        format!("# hello\nOFF # really\n\n# counts\n3 1\n\n{body}\n# the end\n"),
        "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 0 0 1\n\n0 1 0 1 1 1 1\n3 0 1 2 0.5 0.5 0.5"
            .into(),
        "NOFF\r\n3 1 0\r\n0 0 0 0 0 1\r\n1 0 0 0 0 1\r\n0 1 0 0 0 1\r\n3 0 1 2\r\n".into(),
        "STCNOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 7".into(),
    ] {
        assert_eq!(off(&text).mesh, expected, "{text}");
    }
    let quad = off("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    assert_eq!(quad.mesh.simplices, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(quad.notes, ["1 polygon triangulated"]);
}

#[test]
fn off_errors_name_the_place() {
    use ParseErrorKind::*;
    let at = |text: &str| fails(text, Format::Off);
    let body = "0 0 0\n1 0 0\n0 1 0\n";
    assert_eq!(at("").2, Empty);
    assert_eq!(at("# only a comment").2, Empty);
    assert_eq!(at("OFF\n").2, Truncated);
    assert_eq!(at("OFF\n3\n").2, Truncated);
    assert_eq!(at("PLY\n3 1 0").2, Syntax);
    assert_eq!(at("OFF BINARY\nxxxx").2, Unsupported);
    assert_eq!(at("4OFF\n1 1 1\n").2, Unsupported);
    assert_eq!(at("OFF\n-3 1 0\n").2, Number);
    assert_eq!(at(&format!("OFF\n3 1 0 9\n{body}")).2, Syntax);
    assert_eq!(
        at(&format!("OFF\n3 1 0\n{body}3 0 1 3\n")),
        (
            6,
            7,
            IndexOutOfRange,
            "vertex index 3 of 3 (the first is 0)".into()
        )
    );
    assert_eq!(at(&format!("OFF\n3 1 0\n{body}3 0 -1 2\n")).2, Number);
    assert_eq!(at(&format!("OFF\n3 1 0\n{body}2 0 1 2\n")).2, Syntax);
    assert_eq!(at(&format!("OFF\n3 1 0\n{body}4 0 1 2\n")).2, Truncated);
    assert_eq!(
        at(&format!("OFF\n3 1 0\n{body}4000000000 0 1 2\n")).2,
        Truncated
    );
    assert_eq!(at("OFF\n2 0 0\n0 0 0\n0 0\n").2, Truncated);
    assert_eq!(at("OFF\n2 0 0\n0 0 0\n0 nan 0\n").2, NonFinite);
    let long = "0.000 0.000 0.000\n".repeat(3);
    assert_eq!(
        at(&format!("OFF\n5 1 0\n{long}")),
        (6, 1, Truncated, "the file ends behind vertex 3 of 5".into())
    );
    let (line, column, kind, what) = at("OFF\n3000000000 6000000000 0\n0 0 0\n");
    assert_eq!((line, column, kind), (2, 1, TooLarge));
    assert!(what.contains("3000000000 vertices"));
    assert_eq!(
        at("OFF 18446744073709551615 99999999999999999999 0\n0 0 0\n").2,
        TooLarge
    );
    assert_eq!(
        at(&format!("OFF\n3 1 0\n{body}3 0 1 2\n3 0 1 2\n")).2,
        Syntax
    );
}

#[test]
fn formats_by_name() {
    for name in ["obj", "a.obj", "/x.y/HORSE.OBJ", "horse.obj.gz"] {
        assert_eq!(Format::from_name(name), Some(Format::Obj), "{name}");
    }
    assert_eq!(Format::from_name("b.off"), Some(Format::Off));
    assert_eq!(Format::from_name("b.MESH.gz"), Some(Format::Medit));
    for format in Format::ALL {
        assert_eq!(Format::from_name(format.name()), Some(format));
    }
    assert_eq!(Format::from_name("b.meshb"), None);
    assert_eq!(Format::from_name(""), None);
}

/// Area and outcome of a triangulated plane polygon, lifted into an inclined plane.
fn split(points: &[[f64; 2]]) -> (Outcome, f64, f64) {
    let lift = |&[x, y]: &[f64; 2]| DVec3::new(3.0, -7.0, 2.0) + DVec3::new(x, 0.6 * y, 0.8 * y);
    let lifted: Vec<DVec3> = points.iter().map(lift).collect();
    let mut triangles = Vec::new();
    let outcome = triangulate(&lifted, &mut triangles);
    assert_eq!(triangles.len(), points.len() - 2);
    let cross = |[a, b, c]: [[f64; 2]; 3]| {
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    };
    let areas: Vec<f64> = triangles
        .iter()
        .map(|t| cross(t.map(|i| points[i as usize])))
        .collect();
    let smallest = areas.iter().copied().fold(f64::INFINITY, f64::min);
    (outcome, areas.iter().sum(), smallest)
}

#[test]
fn concave_polygons_are_covered_exactly() {
    let comb: Vec<[f64; 2]> = (0..100)
        .map(|i| [f64::from(i), if i % 2 == 0 { 0.0 } else { 9.0 }])
        .chain([[99.0, 10.0], [0.0, 10.0]])
        .collect();
    let spiral: Vec<[f64; 2]> = (0..60)
        .map(|i| (f64::from(i) * 0.2, 1.0 + 0.1 * f64::from(i)))
        .chain(
            (0..60)
                .rev()
                .map(|i| (f64::from(i) * 0.2, 0.8 + 0.1 * f64::from(i))),
        )
        .map(|(angle, radius)| [radius * angle.cos(), radius * angle.sin()])
        .collect();
    let arrow = vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
    let collinear = vec![
        [0.0, 0.0],
        [1.0, 0.0],
        [2.0, 0.0],
        [2.0, 2.0],
        [0.0, 2.0],
        [0.0, 1.0],
    ];
    for polygon in [comb, spiral, arrow, collinear] {
        let shoelace: f64 = (0..polygon.len())
            .map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
            .map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0]))
            .sum();
        // From each corner, and in both directions of the polygon.
        for turn in 0..polygon.len() {
            let mut turned = polygon.clone();
            turned.rotate_left(turn);
            let (outcome, area, smallest) = split(&turned);
            assert_eq!(outcome, Outcome::Clean);
            assert!(
                (area - shoelace).abs() < 1e-9 * shoelace.abs(),
                "{area} {shoelace}"
            );
            assert!(smallest * shoelace.signum() > 0.0);
            turned.reverse();
            assert_eq!(split(&turned).0, Outcome::Clean);
        }
    }
}

#[test]
fn hopeless_polygons_end() {
    let bowtie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]];
    assert_eq!(split(&bowtie).0, Outcome::Doubtful);
    assert_eq!(split(&[[0.0, 0.0]; 5]).0, Outcome::Doubtful);
    let line: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), 0.0]).collect();
    assert_eq!(split(&line).0, Outcome::Doubtful);
    let star: Vec<[f64; 2]> = (0..2001)
        .map(|i| (f64::from(i) * 1000.0 / 2001.0 * std::f64::consts::TAU).sin_cos())
        .map(|(s, c)| [c, s])
        .collect();
    assert_ne!(split(&star).0, Outcome::TooLarge);
    let zigzag: Vec<[f64; 2]> = (0..5000)
        .map(|i| [f64::from(i), if i % 2 == 0 { 0.0 } else { 9.0 }])
        .chain([[4999.0, 10.0], [0.0, 10.0]])
        .collect();
    assert_eq!(split(&zigzag).0, Outcome::TooLarge);
}
