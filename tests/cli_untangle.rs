//! `foldfree untangle`.
#![cfg(feature = "cli")]

mod cli_support;
mod random;

use cli_support::Folder;
use foldfree::mesh::io::{Format, read, write};
use random::Random;

/// The unit grid, the same with its inside shuffled, and its edges as pins.
fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder
        .foldfree("generate grid --triangles 288 --out grid.obj")
        .ends(0);
    let mut mesh = read(&folder.read("grid.obj"), Format::Obj).unwrap().mesh;
    let mut random = Random(2);
    let mut pins = String::new();
    for (v, p) in mesh.positions.iter_mut().enumerate() {
        let (row, column) = (v / 13, v % 13);
        if row % 12 == 0 || column % 12 == 0 {
            pins += &format!("{v}\n");
        } else {
            (p.x, p.y) = (0.5 + 0.5 * random.next(), 0.5 + 0.5 * random.next());
        }
    }
    folder.write("pins.txt", pins);
    folder.write("start.obj", write(&mesh, Format::Obj));
    folder
}

const UNTANGLE: &str = "untangle --rest grid.obj --init start.obj --pins pins.txt";

#[test]
fn a_shuffled_grid_is_untangled() {
    let folder = folder("untangle-grid");
    folder
        .foldfree("check start.obj --rest grid.obj -q")
        .ends(2);
    folder
        .foldfree(&format!("{UNTANGLE} --out out.obj --report r.json"))
        .ends(0);
    folder
        .foldfree("check out.obj --rest grid.obj --global -q")
        .ends(0);
    let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(report["status"], "converged");
    assert_eq!(report["criterion"], "injective");
    assert_eq!(report["energy"], "arap");
    assert_eq!(report["elements"], 288);
    assert_eq!(report["pins"], 48);
    assert_eq!(report["options"]["max_polish_iterations"], 30);
    assert_eq!(
        report["outcome"]["not_positive"].as_array().unwrap().len(),
        0
    );
    assert!(report["outcome"]["smallest_measure"].as_f64().unwrap() > 0.0);
    assert_eq!(report["certificate"]["globally_injective"], true);
    let steps = report["iterations"].as_array().unwrap();
    assert!(steps[0]["inverted"].as_u64().unwrap() > 50);
    let last = steps.last().unwrap();
    assert_eq!(last["inverted"], 0);
    assert!(last["gini"]["first_offset"].as_f64().unwrap() > 0.0);
    assert!(last["gini"]["polish"].is_array());
    let out = read(&folder.read("out.obj"), Format::Obj).unwrap().mesh;
    let grid = read(&folder.read("grid.obj"), Format::Obj).unwrap().mesh;
    assert_eq!(out.positions[0], grid.positions[0], "pins stay");
    assert_eq!(out.positions[168], grid.positions[168]);

    // symmetric Dirichlet, and targets that pull
    folder.write("targets.txt", "84 0.4 0.4\n");
    folder
        .foldfree(&format!(
            "{UNTANGLE} --energy symmetric-dirichlet --targets targets.txt --out soft.obj -q"
        ))
        .ends(0);
    folder.foldfree("check soft.obj --rest grid.obj -q").ends(0);
    // held where the target says
    folder
        .foldfree(&format!(
            "{UNTANGLE} --targets targets.txt --hard --out hard.obj -q"
        ))
        .ends(0);
    let hard = read(&folder.read("hard.obj"), Format::Obj).unwrap().mesh;
    assert_eq!(hard.positions[84].to_array(), [0.4, 0.4, 0.0]);
    // without pins nothing is held, and it ends all the same
    folder
        .foldfree("untangle --rest grid.obj --init start.obj --out free.obj -q")
        .ends(0);
    folder.foldfree("check free.obj --rest grid.obj -q").ends(0);
}

#[test]
fn a_solid_is_untangled_with_every_energy() {
    let folder = Folder::new("untangle-solid");
    folder
        .foldfree("generate box --tetrahedra 600 --out box.mesh")
        .ends(0);
    let mut solid = foldfree::mesh::io::read_solid(&folder.read("box.mesh"), Format::Medit)
        .unwrap()
        .mesh;
    let mut random = Random(8);
    for p in &mut solid.positions {
        *p += 0.3 * glam::DVec3::from_array(random.many());
    }
    let start = foldfree::mesh::io::write_solid(&solid, Format::Medit).unwrap();
    folder.write("start.mesh", start);
    folder
        .foldfree("check start.mesh --rest box.mesh -q")
        .ends(2);
    for energy in [
        "arap",
        "neo-hookean",
        "stable-neo-hookean",
        "symmetric-dirichlet",
    ] {
        folder
            .foldfree(&format!(
                "untangle --rest box.mesh --init start.mesh --energy {energy} --out out.mesh -q"
            ))
            .ends(0);
        folder.foldfree("check out.mesh --rest box.mesh -q").ends(0);
    }
}

#[test]
fn what_cannot_be_untangled_is_said() {
    let folder = folder("untangle-hopeless");
    // two corners of the square exchanged: the triangle of three pins at a corner is inverted
    let pins: Vec<String> = (0..169)
        .filter(|v| v / 13 % 12 == 0 || v % 13 % 12 == 0)
        .map(|v| format!("{v}\n"))
        .collect();
    folder.write("pins.txt", pins.concat());
    folder.write("targets.txt", "12 -0.5 0.5\n");
    let ran = folder
        .foldfree(&format!(
            "{UNTANGLE} --targets targets.txt --hard --report r.json --out out.obj"
        ))
        .ends(2);
    assert!(ran.stdout.contains("pinned"), "{ran:?}");
    let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(report["status"], "stalled");
    assert!(!report["outcome"]["hopeless"].as_array().unwrap().is_empty());
    folder.read("out.obj");
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let folder = folder("untangle-bad");
    folder
        .foldfree("untangle --rest grid.obj")
        .fails(&["--init"]);
    folder
        .foldfree("untangle --rest grid.obj --init nowhere.obj")
        .fails(&["nowhere.obj"]);
    folder
        .foldfree(&format!("{UNTANGLE} --energy st-venant-kirchhoff"))
        .fails(&["st-venant-kirchhoff"]);
    folder
        .foldfree(&format!("{UNTANGLE} --energy neo-hookean"))
        .fails(&["energy", "plane"]);
    folder
        .foldfree(&format!("{UNTANGLE} --target-stiffness 0"))
        .fails(&["target-stiffness"]);
    folder.write("bad.txt", "3\nfour\n");
    folder
        .foldfree("untangle --rest grid.obj --init start.obj --pins bad.txt")
        .fails(&["bad.txt", "line 2"]);
    folder.write("far.txt", "169\n");
    folder
        .foldfree("untangle --rest grid.obj --init start.obj --pins far.txt")
        .fails(&["far.txt", "169"]);
    let all: String = (0..169).map(|v| format!("{v}\n")).collect();
    folder.write("all.txt", all);
    folder
        .foldfree("untangle --rest grid.obj --init start.obj --pins all.txt")
        .fails(&["nothing to solve"]);
    folder
        .foldfree("generate sphere --triangles 100 --out sphere.obj")
        .ends(0);
    folder
        .foldfree("untangle --rest sphere.obj --init sphere.obj")
        .fails(&["plane"]);
    folder
        .foldfree("untangle --rest start.obj --init start.obj")
        .fails(&["inverted"]);
    folder
        .foldfree("untangle --rest grid.obj --init sphere.obj")
        .fails(&["sphere.obj", "vertices"]);
}

#[test]
fn the_ends_of_a_strip_do_not_pass_through_each_other() {
    let folder = Folder::new("untangle-overlap");
    let (nx, ny) = (25, 3);
    let (mut strip, mut crossed, mut targets) = (String::new(), String::new(), String::new());
    for v in 0..nx * ny {
        let (x, y) = ((v % nx) as f64 / 2.0, (v / nx) as f64 / 2.0);
        strip += &format!("v {x} {y} 0\n");
        // nearly one and a half turns of a ring: the ends lie upon each other
        let (angle, radius) = (8.8 * x / 12.0, 1.4 + y);
        crossed += &format!("v {} {} 0\n", radius * angle.sin(), -radius * angle.cos());
        for (column, end) in [(0, 9.0), (nx - 1, 3.0)] {
            if v % nx == column {
                targets += &format!("{v} {end} {} 0\n", 4.0 + y);
            }
        }
    }
    for cell in 0..(nx - 1) * (ny - 1) {
        let a = cell / (nx - 1) * nx + cell % (nx - 1) + 1;
        let faces = format!(
            "f {a} {} {}\nf {a} {} {}\n",
            a + 1,
            a + nx + 1,
            a + nx + 1,
            a + nx
        );
        strip += &faces;
        crossed += &faces;
    }
    folder.write("strip.obj", strip);
    folder.write("crossed.obj", crossed);
    folder.write("targets.txt", targets);
    let arguments = "--targets targets.txt --target-stiffness 0.01 --overlap --iterations 40";
    folder
        .foldfree(&format!(
            "untangle --init strip.obj {arguments} --out out.obj --report r.json -q"
        ))
        .ends(2);
    folder
        .foldfree("check out.obj --rest strip.obj --global -q")
        .ends(0);
    let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(report["options"]["overlap"], true);
    assert_eq!(report["outcome"]["globally_injective"], true);
    assert_eq!(report["outcome"]["intersections"], 0);
    let contacts = |step: &serde_json::Value| step["gini"]["contacts"].as_u64().unwrap_or(0);
    let steps = report["iterations"].as_array().unwrap();
    assert!(steps.iter().any(|step| contacts(step) > 0), "they meet");

    folder
        .foldfree("check crossed.obj --rest strip.obj --global -q")
        .ends(2);
    folder
        .foldfree(&format!(
            "untangle --rest strip.obj --init crossed.obj {arguments}"
        ))
        .fails(&["the boundary of the start meets itself", "--flow"]);

    // it is parted first, and pulled back as near as it can come
    let flow = "--overlap --flow --target-stiffness 0.01 --iterations 40";
    let ran = folder.foldfree(&format!(
        "untangle --rest strip.obj --init crossed.obj {flow} --out apart.obj --report f.json"
    ));
    assert!(matches!(ran.code, Some(0 | 2)), "{ran:?}");
    assert!(ran.stdout.contains("of flow parted it"), "{ran:?}");
    folder
        .foldfree("check apart.obj --rest strip.obj --global -q")
        .ends(0);
    let report: serde_json::Value = serde_json::from_slice(&folder.read("f.json")).unwrap();
    assert_eq!(report["outcome"]["globally_injective"], true);
    let pairs = report["flow"]["pairs"].as_array().unwrap();
    assert_eq!(report["flow"]["steps"], pairs.len() - 1);
    assert!(pairs[0].as_u64().unwrap() > 0 && pairs[pairs.len() - 1] == 0);
    // where nothing meets nothing flows
    let ran = folder.foldfree(&format!(
        "untangle --init strip.obj {flow} --report n.json --out same.obj"
    ));
    assert!(ran.stdout.contains("does not meet itself"), "{ran:?}");
    let report: serde_json::Value = serde_json::from_slice(&folder.read("n.json")).unwrap();
    assert_eq!(report["flow"]["steps"], 0);
    let [same, strip] =
        ["same.obj", "strip.obj"].map(|name| read(&folder.read(name), Format::Obj).unwrap().mesh);
    assert_eq!(same.positions, strip.positions);
    folder
        .foldfree("untangle --init strip.obj --flow")
        .fails(&["--overlap"]);
}

#[test]
fn a_solid_that_passes_through_itself_comes_apart() {
    let folder = Folder::new("untangle-flow");
    folder
        .foldfree("generate bar --tetrahedra 600 --out bar.mesh")
        .ends(0);
    let bar = foldfree::mesh::io::read_solid(&folder.read("bar.mesh"), Format::Medit)
        .unwrap()
        .mesh;
    // along its length to more than a ring, with one end somewhat higher
    let (low, high) = bar.positions.iter().fold(
        (glam::DVec3::INFINITY, glam::DVec3::NEG_INFINITY),
        |(low, high), &p| (low.min(p), high.max(p)),
    );
    let (middle, size) = (0.5 * (low + high), high - low);
    let radius = size.x / (1.15 * std::f64::consts::TAU);
    let mut ring = bar.clone();
    for p in &mut ring.positions {
        let q = *p - middle;
        let (sin, cos) = (q.x / radius).sin_cos();
        let up = q.z + 0.5 * size.z * q.x / size.x;
        *p = glam::DVec3::new((radius - q.y) * sin, -(radius - q.y) * cos, up);
    }
    let ring = foldfree::mesh::io::write_solid(&ring, Format::Medit).unwrap();
    folder.write("ring.mesh", ring);
    let line = "untangle --rest bar.mesh --init ring.mesh --overlap --target-stiffness 0.01 --iterations 15 --report r.json";
    folder
        .foldfree(line)
        .fails(&["the boundary of the start meets itself", "--flow"]);
    let ran = folder.foldfree(&format!("{line} --flow --out out.mesh"));
    assert!(matches!(ran.code, Some(0 | 2)), "{ran:?}");
    folder.foldfree("check out.mesh --rest bar.mesh -q").ends(0);
    let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(report["outcome"]["globally_injective"], true);
    assert_eq!(report["outcome"]["intersections"], 0);
    assert!(report["flow"]["steps"].as_u64().unwrap() > 0);
}

#[test]
fn newtons_method_goes_on_from_there() {
    let folder = folder("untangle-minimize");
    let energy = |name: &str| {
        let report: serde_json::Value = serde_json::from_slice(&folder.read(name)).unwrap();
        assert_eq!(report["status"], "converged");
        let steps = report["iterations"].as_array().unwrap();
        let last = steps[steps.len() - 1]["energy"].as_f64().unwrap();
        (last, report["minimized_to"].as_f64())
    };
    let line = format!("{UNTANGLE} --energy symmetric-dirichlet -q");
    folder
        .foldfree(&format!("{line} --report first.json"))
        .ends(0);
    folder
        .foldfree(&format!(
            "{line} --minimize --tolerance 1e-9 --report both.json --out out.obj"
        ))
        .ends(0);
    folder
        .foldfree("check out.obj --rest grid.obj --global -q")
        .ends(0);
    let ((first, none), (both, tolerance)) = (energy("first.json"), energy("both.json"));
    assert_eq!((none, tolerance), (None, Some(1e-9)));
    // the grid itself is the minimum
    assert!(
        first > both + 1e-5 && (both - 1.0).abs() < 1e-6,
        "{first}, {both}"
    );
    for (line, words) in [
        ("--minimize", "minimize"),
        (
            "--energy symmetric-dirichlet --tolerance 1e-3",
            "--minimize",
        ),
    ] {
        folder
            .foldfree(&format!("{UNTANGLE} {line}"))
            .fails(&[words]);
    }
}
