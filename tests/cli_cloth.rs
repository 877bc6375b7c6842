//! `foldfree cloth`.
#![cfg(feature = "cli")]

mod cli_support;
mod cloth_square;

use cli_support::Folder;
use cloth_square::{corners, square, wrinkled};
use foldfree::mesh::SurfaceMesh;
use foldfree::mesh::io::{Format, read, write};

fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    let mesh = square(8);
    let pins = corners(8);
    let start = SurfaceMesh {
        positions: wrinkled(&mesh, &pins),
        simplices: mesh.simplices.clone(),
    };
    folder.write("rest.obj", write(&mesh, Format::Obj));
    folder.write("start.off", write(&start, Format::Off));
    let pins: Vec<String> = pins.iter().map(|v| format!("{v}\n")).collect();
    folder.write("pins.txt", pins.concat());
    folder
}

#[test]
fn cloth_comes_to_rest() {
    let folder = folder("cloth-rest");
    let run = "cloth --rest rest.obj --init start.off --pins pins.txt --bending 1e-3";
    folder.foldfree(&format!("{run} --out first.ply")).ends(0);
    folder
        .foldfree(&format!(
            "{run} --method admm-pd --iterations 5 --reference first.ply --report r.json --quiet"
        ))
        .ends(2);
    let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(report["status"], "max-iterations");
    assert_eq!(report["triangles"], 128);
    assert_eq!(report["vertices"], 81);
    assert_eq!(report["pins"], 4);
    assert_eq!(report["options"]["target_stiffness"], 10.0);
    assert_eq!(report["options"]["gravity"][2], -9.81);
    let iterations = report["iterations"].as_array().unwrap();
    assert_eq!(iterations.len(), 6);
    assert_eq!(iterations[0]["position_error"], 1.0);
    let error = iterations[5]["position_error"].as_f64().unwrap();
    assert!(error > 0.01 && error < 1.0, "{error}");

    let cloth = read(&folder.read("first.ply"), Format::Ply).unwrap().mesh;
    assert_eq!(cloth.simplices, square(8).simplices);
    // it hangs below its corners
    let level = cloth.positions[0].z;
    let lowest = cloth.positions.iter().fold(level, |z, p| z.min(p.z));
    assert!(lowest < level - 0.05, "{lowest}");
    // without weight, upside down
    folder
        .foldfree(&format!(
            "{run} --gravity 0,0,9.81 --limits 0,inf --out up.obj -q"
        ))
        .ends(0);
    let cloth = read(&folder.read("up.obj"), Format::Obj).unwrap().mesh;
    let highest = cloth.positions.iter().fold(level, |z, p| z.max(p.z));
    assert!(highest > level + 0.05, "{highest}");
}

#[test]
fn what_does_not_fit_is_named() {
    let folder = folder("cloth-bad");
    let start = "cloth --init start.off";
    folder.foldfree(start).fails(&["no pin"]);
    for (arguments, words) in [
        ("--pins pins.txt --gravity 1,2", ["--gravity", "3 numbers"]),
        (
            "--pins pins.txt --gravity 1,2,x",
            ["--gravity", "3 numbers"],
        ),
        ("--pins pins.txt --limits 1.1,1.2", ["limits", "0 to 1"]),
        (
            "--pins pins.txt --limits nan,1.2",
            ["--limits", "2 numbers"],
        ),
        ("--pins pins.txt --stretch 0", ["--stretch", "positive"]),
        (
            "--pins pins.txt --bending=-1",
            ["--bending", "not negative"],
        ),
        ("--pins pins.txt --out cloth.node", ["cloth.node", "format"]),
        ("--pins none.txt", ["none.txt", ""]),
        ("--rest pins.txt", ["pins.txt", "format"]),
    ] {
        folder
            .foldfree(&format!("{start} {arguments}"))
            .fails(&words);
    }
    folder.write("pins.txt", "0\n81\n");
    folder
        .foldfree(&format!("{start} --pins pins.txt"))
        .fails(&["pins.txt", "line 2", "81 of 81"]);
    let other = write(&square(3), Format::Obj);
    folder.write("other.obj", other);
    folder
        .foldfree(&format!("{start} --rest other.obj"))
        .fails(&["start.off", "81 vertices", "16"]);
}
