//! `foldfree deform --method lim`.
#![cfg(feature = "cli")]

mod cli_support;

use cli_support::Folder;
use foldfree::mesh::io::{Format, read};

/// The grid, its left and bottom edges as pins, and a target for its corner.
fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder
        .foldfree("generate grid --triangles 288 --out grid.obj")
        .ends(0);
    let n = 13;
    let pins = (0..n).chain((1..n).map(|row| row * n));
    let pins: Vec<String> = pins.map(|v| format!("{v}\n")).collect();
    folder.write("pins.txt", pins.concat());
    folder.write("targets.txt", format!("{} 0.2 0.2\n", n * n - 1));
    folder
}

const LIM: &str = "deform --method lim --init grid.obj --pins pins.txt --targets targets.txt";

#[test]
fn a_grid_is_dragged_by_its_corner() {
    let folder = folder("lim-grid");
    folder
        .foldfree(&format!(
            "{LIM} --hard --energy dirichlet --out out.obj --report r.json"
        ))
        .ends(0);
    let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(report["status"], "converged");
    assert_eq!(report["triangles"], 288);
    assert_eq!(report["options"]["energy"], "dirichlet");
    assert_eq!(report["options"]["barrier"], true);
    assert_eq!(report["certificate"]["inverted"], serde_json::json!([]));
    assert_eq!(report["certificate"]["locally_injective"], true);
    let last = report["iterations"].as_array().unwrap().last().unwrap();
    assert_eq!(last["inverted"], 0);
    assert_eq!(last["lim"]["positional_error"], 0.0);
    assert_eq!(last["lim"]["arrived"], 26);
    assert!(last["lim"]["alpha"].as_f64().unwrap() >= 1e8);
    let out = read(&folder.read("out.obj"), Format::Obj).unwrap().mesh;
    assert_eq!(out.positions[168].to_array(), [0.2, 0.2, 0.0]);
    folder.foldfree("check out.obj --rest grid.obj").ends(0);

    // without barrier it folds
    folder
        .foldfree(&format!(
            "{LIM} --hard --energy dirichlet --no-barrier --out folded.obj -q"
        ))
        .ends(0);
    folder.foldfree("check folded.obj --rest grid.obj").ends(2);
    // and cannot be a start
    folder
        .foldfree("deform --method lim --rest grid.obj --init folded.obj --pins pins.txt")
        .fails(&["inverted", "first", "untangle"]);
    // a soft target is approached, not reached
    folder
        .foldfree(&format!("{LIM} --hessian frozen --out soft.obj -q"))
        .ends(0);
    let soft = read(&folder.read("soft.obj"), Format::Obj).unwrap().mesh;
    let corner = soft.positions[168];
    assert!(corner.x > 0.2 && corner.x < 1.0, "{corner}");
}

#[test]
fn a_solid_keeps_its_tetrahedra() {
    let folder = Folder::new("lim-solid");
    folder
        .foldfree("generate box --tetrahedra 200 --out box.mesh")
        .ends(0);
    folder.write("pins.txt", "0\n1\n2\n3\n");
    folder.write("targets.txt", "40 0.3 0.2 -0.4\n");
    folder
        .foldfree("deform --method lim --init box.mesh --pins pins.txt --targets targets.txt --hard --energy green-strain --out out.mesh -q")
        .ends(0);
    folder.foldfree("check out.mesh --rest box.mesh").ends(0);
}

#[test]
fn options_of_other_methods_are_refused() {
    let folder = folder("lim-options");
    folder
        .foldfree(&format!("{LIM} --energy neo-hookean"))
        .fails(&["neo-hookean", "arap"]);
    let other = LIM.replace("lim", "newton");
    folder
        .foldfree(&format!("{other} --energy green-strain"))
        .fails(&["green-strain", "lim"]);
    folder
        .foldfree(&format!("{other} --no-barrier"))
        .fails(&["--no-barrier"]);
    folder.write("twice.txt", "5 0 0\n5 1 1\n");
    folder
        .foldfree("deform --method lim --init grid.obj --pins pins.txt --targets twice.txt")
        .fails(&["vertex 5 has two targets"]);
}
