//! Everything that can be wrong with what the command line is given: exit code 1 and one line on
//! stderr that names the file.
#![cfg(feature = "cli")]

mod cli_support;

use cli_support::Folder;
use std::io::Write;

/// The same complaint of `parameterize` and, where the file could hold a map, no crash of `check`.
#[track_caller]
fn refused(folder: &Folder, name: &str, contents: impl AsRef<[u8]>, words: &[&str]) {
    folder.write(name, contents);
    let words: Vec<&str> = [name].iter().chain(words).copied().collect();
    folder
        .run(&["parameterize", name, "--out", "out.obj"])
        .fails(&words);
    assert!(!folder.path().join("out.obj").exists());
    folder.run(&["check", name]).fails(&[name]);
}

#[test]
fn files_that_cannot_be_read() {
    let folder = Folder::new("unreadable");
    refused(&folder, "empty.obj", "", &["empty"]);
    refused(&folder, "empty.off", "", &["empty"]);
    refused(
        &folder,
        "no-faces.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\n",
        &["no faces"],
    );
    refused(
        &folder,
        "truncated.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1",
        &["line 3"],
    );
    refused(
        &folder,
        "truncated.off",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n",
        &["line"],
    );
    refused(
        &folder,
        "nan.obj",
        "v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n",
        &["line 2"],
    );
    refused(
        &folder,
        "infinite.off",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 inf 0\n3 0 1 2\n",
        &["line 5"],
    );
    refused(
        &folder,
        "too-large.obj",
        "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n",
        &["line 2"],
    );
    refused(
        &folder,
        "index.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 90\n",
        &["line 4", "90"],
    );
    refused(
        &folder,
        "index.off",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
        &["line 6", "3"],
    );
    refused(&folder, "binary.obj", [0u8, 159, 146, 150, 0, 7, 255], &[]);
    refused(&folder, "words.off", "this is not a mesh\n", &["line 1"]);
}

#[test]
fn headers_that_claim_three_gigabytes() {
    let folder = Folder::new("claims");
    refused(&folder, "claim.off", "OFF\n125000000 3 0\n0 0 0\n", &[]);
    refused(
        &folder,
        "faces.off",
        "OFF\n3 250000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        &[],
    );
    refused(&folder, "more.off", "OFF\n99999999999999999999 3 0\n", &[]);
    refused(
        &folder,
        "corners.off",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3000000000 0 1 2\n",
        &[],
    );
}

#[test]
fn files_that_are_not_there_or_are_something_else() {
    let folder = Folder::new("absent");
    folder
        .foldfree("parameterize absent.obj")
        .fails(&["absent.obj", "no such file"]);
    folder
        .foldfree("check absent.obj")
        .fails(&["absent.obj", "no such file"]);
    std::fs::create_dir(folder.path().join("folder.obj")).expect("folder");
    folder
        .foldfree("parameterize folder.obj")
        .fails(&["folder.obj", "folder"]);
    folder.write("mesh.step", "ISO-10303-21;");
    folder
        .foldfree("parameterize mesh.step")
        .fails(&["mesh.step", ".obj", ".off"]);
    folder
        .foldfree("parameterize nothing")
        .fails(&["nothing", ".obj"]);
    folder
        .foldfree("generate terrain --triangles 100 --out a.obj")
        .ends(0);
    folder
        .foldfree("parameterize a.obj --out no/such/folder/b.obj")
        .fails(&["no/such/folder/b.obj"]);
    folder
        .foldfree("parameterize a.obj --out b.off")
        .fails(&["b.off", "texture"]);
    folder
        .foldfree("parameterize a.obj --out folder.obj")
        .fails(&["folder.obj", "folder"]);
    folder
        .foldfree("parameterize a.obj --reference none.obj")
        .fails(&["none.obj"]);
    folder
        .foldfree("generate torus --out no/such.obj")
        .fails(&["no/such.obj"]);
}

#[test]
fn gzip_that_is_cut_short_or_damaged() {
    let folder = Folder::new("gzip");
    folder
        .foldfree("generate terrain --triangles 1000 --out good.obj.gz")
        .ends(0);
    let good = folder.read("good.obj.gz");
    assert!(good.starts_with(&[0x1f, 0x8b]));
    for keep in [2, 5, 20, good.len() / 2, good.len() - 3] {
        folder.write("cut.obj.gz", &good[..keep]);
        folder
            .foldfree("parameterize cut.obj.gz")
            .fails(&["cut.obj.gz", "gzip"]);
    }
    let mut bad = good.clone();
    bad[good.len() / 2] ^= 0x55;
    folder.write("bad.obj.gz", &bad);
    folder
        .foldfree("parameterize bad.obj.gz")
        .fails(&["bad.obj.gz"]);
    // What counts is what the file holds, not only its name.
    folder.write("plain.obj.gz", "v 0 0 0\nv 1 0 0\nv 0 1 x\nf 1 2 3\n");
    folder
        .foldfree("parameterize plain.obj.gz")
        .fails(&["plain.obj.gz", "line 3"]);
    let mut packed = flate2_bytes(b"OFF\n125000000 250000000 0\n0 0 0\n");
    folder.write("claim.off.gz", &packed);
    folder
        .foldfree("parameterize claim.off.gz")
        .fails(&["claim.off.gz"]);
    packed.extend(b"rubbish behind the end");
    folder.write("behind.off.gz", &packed);
    folder
        .foldfree("parameterize behind.off.gz")
        .fails(&["behind.off.gz"]);
}

fn flate2_bytes(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("in memory");
    encoder.finish().expect("in memory")
}

#[test]
fn surfaces_that_cannot_be_flattened() {
    let folder = Folder::new("surfaces");
    let quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 1 1\nv 3 1 1\nv 2 2 1\n";
    let with = |faces: &str| format!("{quad}{faces}");
    let cases = [
        ("repeated.obj", with("f 1 2 3\nf 1 3 3\n"), "twice"),
        ("duplicate.obj", with("f 1 2 3\nf 1 3 4\nf 3 1 2\n"), "same vertices"),
        ("edge.obj", with("f 1 2 3\nf 2 1 4\nf 1 2 5\n"), "belongs to 3 faces"),
        ("vertex.obj", with("f 1 2 4\nf 3 5 1\n"), "fan"),
        (
            "degenerate.obj",
            with("v 2 0 0\nf 1 2 3\nf 1 3 4\nf 2 1 8\n"),
            "no area",
        ),
        (
            "zero.obj",
            "v 0 0 0\nv 1 1 1\nv 2 2 2\nv 3 3 3\nf 1 2 3\nf 3 2 4\n".into(),
            "area",
        ),
        (
            "moebius.obj",
            "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 1\nv 0 1 2\nf 1 2 3\nf 2 3 4\nf 3 4 5\nf 4 5 1\nf 5 1 2\n".into(),
            "one-sided",
        ),
    ];
    for (name, contents, words) in cases {
        folder.write(name, contents);
        folder
            .run(&["parameterize", name, "--out", "out.obj"])
            .fails(&[name, words]);
        assert!(!folder.path().join("out.obj").exists());
    }
    for shape in ["torus", "sphere", "rounded-cube"] {
        folder
            .run(&[
                "generate",
                shape,
                "--triangles",
                "200",
                "--out",
                "closed.off",
            ])
            .ends(0);
        folder.foldfree("parameterize closed.off --no-cut").fails(&[
            "closed.off",
            "not a disk",
            "refused",
        ]);
    }
}

#[test]
fn maps_that_cannot_be_checked() {
    let folder = Folder::new("maps");
    folder.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 5\nf 1 2 3\n");
    folder
        .foldfree("check bare.obj")
        .fails(&["bare.obj", "--rest"]);
    folder
        .foldfree("check bare.obj --rest bare.obj")
        .fails(&["bare.obj", "z = 0"]);
    folder.write(
        "flat.off",
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
    );
    folder
        .foldfree("check flat.off --rest bare.obj")
        .fails(&["bare.obj", "1 triangle", "2"]);
    folder
        .foldfree("check flat.off --rest none.off")
        .fails(&["none.off"]);
}

#[test]
fn arguments_that_make_no_sense() {
    let folder = Folder::new("arguments");
    folder.foldfree("parameterize").fails(&["IN"]);
    folder
        .foldfree("parameterize a.obj --method mips")
        .fails(&["mips", "wrapd", "admm-pd"]);
    folder
        .foldfree("parameterize a.obj --energy rubber")
        .fails(&["rubber", "symmetric-dirichlet"]);
    folder
        .foldfree("parameterize a.obj --start here")
        .fails(&["here", "collapsed"]);
    folder
        .foldfree("parameterize a.obj --tolerance NaN")
        .fails(&["--tolerance"]);
    folder
        .foldfree("parameterize a.obj --tolerance=-1")
        .fails(&["--tolerance"]);
    folder
        .foldfree("parameterize a.obj --iterations many")
        .fails(&["--iterations"]);
    folder
        .foldfree("parameterize a.obj --threads 100000")
        .fails(&["--threads"]);
    folder
        .foldfree("parameterize a.obj --method arap --no-reweighting")
        .fails(&["--no-reweighting", "wrapd"]);
    folder.foldfree("flatten a.obj").fails(&["flatten"]);
    folder
        .foldfree("generate teapot --out a.obj")
        .fails(&["teapot", "bumpy-cap"]);
    folder
        .foldfree("generate torus --triangles 3000000000 --out a.obj")
        .fails(&["--triangles"]);
    folder
        .foldfree("generate torus --out a.glb")
        .fails(&["a.glb"]);
    folder.foldfree("").fails(&["--help"]);
    folder.foldfree("check a.obj --rest").fails(&["--rest"]);
}

#[test]
fn help_and_version_are_no_errors() {
    let folder = Folder::new("help");
    for line in [
        "--help",
        "--version",
        "parameterize --help",
        "check -h",
        "help generate",
    ] {
        let ran = folder.foldfree(line).ends(0);
        assert!(!ran.stdout.is_empty() && ran.stderr.is_empty(), "{ran:#?}");
    }
}
