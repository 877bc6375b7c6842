//! The commands at work on generated meshes.
#![cfg(feature = "cli")]

mod cli_support;

use cli_support::Folder;
use serde_json::Value;

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).expect("valid JSON")
}

#[test]
fn generate_writes_every_shape_in_every_format() {
    let folder = Folder::new("generate");
    let shapes = foldfree::mesh::Shape::ALL.map(foldfree::mesh::Shape::name);
    for shape in shapes {
        for name in ["a.obj", "a.off", "a.obj.gz", "a.off.gz"] {
            let ran = folder
                .run(&["generate", shape, "--triangles", "300", "--out", name])
                .ends(0);
            assert!(
                ran.stdout.contains("triangles") && ran.stderr.is_empty(),
                "{ran:#?}"
            );
        }
        assert!(folder.read("a.off.gz").starts_with(&[0x1f, 0x8b]));
        assert!(folder.read("a.off").starts_with(b"OFF"));
    }
}

#[test]
fn generate_writes_every_solid() {
    use foldfree::mesh::io::{read_ele, read_node};
    let folder = Folder::new("generate-solid");
    for shape in foldfree::mesh::SolidShape::ALL {
        for out in ["a.node", "b.ele.gz"] {
            let ran = folder
                .run(&[
                    "generate",
                    shape.name(),
                    "--tetrahedra",
                    "600",
                    "--out",
                    out,
                ])
                .ends(0);
            assert!(
                ran.stdout.contains("tetrahedra") && ran.stderr.is_empty(),
                "{ran:#?}"
            );
        }
        let nodes = read_node(&folder.read("a.node")).expect("vertices");
        let solid = read_ele(&folder.read("a.ele"), nodes).expect("tetrahedra");
        assert_eq!(solid, foldfree::mesh::generate_solid(shape, 600));
        for packed in ["b.node.gz", "b.ele.gz"] {
            assert!(folder.read(packed).starts_with(&[0x1f, 0x8b]));
        }
    }
    folder
        .foldfree("generate hand --out hand.glb")
        .fails(&["hand.glb", ".node", ".mesh"]);
    // a format of surfaces gets the boundary
    folder
        .foldfree("generate hand --tetrahedra 600 --out hand.obj")
        .ends(0);
    let boundary = foldfree::mesh::generate_solid(foldfree::mesh::SolidShape::Hand, 600).boundary();
    let written =
        foldfree::mesh::io::read(&folder.read("hand.obj"), foldfree::mesh::io::Format::Obj);
    assert_eq!(written.unwrap().mesh, boundary.unwrap().mesh);
    folder
        .foldfree("generate box --out no/such.node")
        .fails(&["no/such.node"]);
}

#[test]
fn parameterize_writes_a_map_that_check_accepts_and_a_report() {
    let folder = Folder::new("parameterize");
    folder
        .foldfree("generate bumpy-cap --triangles 600 --out cap.off.gz")
        .ends(0);
    let ran = folder
        .foldfree("parameterize cap.off.gz --out map.obj --report report.json --threads 2")
        .ends(0);
    assert!(ran.stdout.contains("Converged after"), "{ran:#?}");
    assert!(
        ran.stderr.is_empty(),
        "no progress bar where there is no terminal: {ran:#?}"
    );

    let report = json(&folder, "report.json");
    assert_eq!(report["status"], "converged");
    assert_eq!(report["threads"], 2);
    assert_eq!(report["options"]["method"], "wrapd");
    assert_eq!(report["options"]["max_iterations"], 5000);
    let setup = report["setup_seconds"].as_f64().expect("a number");
    assert!((0.0..60.0).contains(&setup));
    let iterations = report["iterations"].as_array().expect("a list");
    for (i, step) in iterations.iter().enumerate() {
        assert_eq!(step["iteration"], i);
        for key in ["seconds", "inverted", "smallest_sigma", "lbfgs_iterations"] {
            assert!(step[key].is_number(), "{key} in {step}");
        }
        for key in [
            "energy",
            "gradient_norm",
            "largest_sigma",
            "reweighted",
            "phases",
        ] {
            assert!(step.get(key).is_some(), "{key} in {step}");
        }
    }
    let last = iterations.last().expect("an iteration");
    assert_eq!(last["inverted"], 0);
    let certificate = &report["certificate"];
    assert_eq!(certificate["locally_injective"], true);
    assert_eq!(certificate["inverted"], Value::Array(vec![]));
    assert_eq!(certificate["elements"], report["triangles"]);
    let energy = certificate["symmetric_dirichlet"]
        .as_f64()
        .expect("a number");
    let reported = last["energy"].as_f64().expect("a number");
    assert!(
        (energy / reported - 1.0).abs() < 1e-9,
        "{energy} and {reported}"
    );

    // The written map says the same.
    let ran = folder.foldfree("check map.obj --report check.json").ends(0);
    assert!(ran.stdout.contains("0 inverted"), "{ran:#?}");
    let check = json(&folder, "check.json");
    for key in [
        "elements",
        "boundary_edges",
        "is_disk",
        "symmetric_dirichlet",
        "globally_injective",
    ] {
        assert_eq!(check["certificate"][key], certificate[key], "{key}");
    }
    // Also when the surface comes from its own file.
    folder.foldfree("check map.obj --rest cap.off.gz").ends(0);
    // Compared with itself there is no difference.
    folder
        .foldfree("parameterize cap.off.gz --reference map.obj --report again.json --quiet")
        .ends(0);
    let reference = &json(&folder, "again.json")["reference"];
    assert!(
        reference["relative_energy_error"]
            .as_f64()
            .expect("a number")
            .abs()
            < 1e-12
    );
    assert!(
        reference["relative_position_error"]
            .as_f64()
            .expect("a number")
            < 1e-9
    );
    assert!(reference["iterations_to_1_percent"].is_number());
}

#[test]
fn running_out_of_iterations_is_exit_code_2_and_still_a_result() {
    let folder = Folder::new("iterations");
    folder
        .foldfree("generate bumpy-cap --triangles 600 --out cap.obj")
        .ends(0);
    let ran = folder
        .foldfree(
            "parameterize cap.obj --iterations 2 --tolerance 0 --out map.obj.gz --report r.json",
        )
        .ends(2);
    assert!(ran.stderr.is_empty() && ran.stdout.contains("Not converged after 2 iterations"));
    let report = json(&folder, "r.json");
    assert_eq!(report["status"], "max-iterations");
    assert_eq!(report["iterations"].as_array().map(Vec::len), Some(3));
    folder
        .foldfree("parameterize cap.obj --iterations 0 --start tutte --report r.json")
        .ends(2);
    let report = json(&folder, "r.json");
    assert_eq!(report["iterations"].as_array().map(Vec::len), Some(1));
    assert_eq!(
        (&report["status"], &report["start"]),
        (&"max-iterations".into(), &"tutte".into())
    );
    assert!(folder.read("map.obj.gz").starts_with(&[0x1f, 0x8b]));
    let checked = folder.foldfree("check map.obj.gz");
    assert!(checked.stdout.contains("triangles: "), "{checked:#?}");
}

#[test]
fn every_method_runs_and_the_switches_are_methods() {
    let folder = Folder::new("methods");
    folder
        .foldfree("generate bumpy-cap --triangles 300 --out cap.obj")
        .ends(0);
    let method = |line: &str| {
        let line = format!("parameterize cap.obj --iterations 200 --report r.json {line}");
        let ran = folder.foldfree(&line);
        assert!(matches!(ran.code, Some(0 | 2)), "{line}: {ran:#?}");
        json(&folder, "r.json")["options"]["method"].clone()
    };
    for name in [
        "wrapd", "r-admm", "w-admm", "admm-pd", "arap", "lscm", "harmonic", "tutte",
    ] {
        assert_eq!(method(&format!("--method {name}")), name);
    }
    assert_eq!(method("--no-rotation-aware"), "w-admm");
    assert_eq!(method("--no-reweighting"), "r-admm");
    assert_eq!(method("--no-reweighting --no-rotation-aware"), "admm-pd");
    method("--energy arap");
    for start in [
        "automatic",
        "harmonic",
        "tutte",
        "lscm",
        "random",
        "collapsed",
    ] {
        method(&format!("--start {start} --seed 7"));
    }
}

#[test]
fn closed_surfaces_are_cut_and_the_seam_is_only_in_the_texture() {
    let folder = Folder::new("cut");
    folder
        .foldfree("generate torus --triangles 400 --out torus.obj")
        .ends(0);
    folder
        .foldfree("parameterize torus.obj --iterations 300 --out map.obj --report r.json")
        .code
        .expect("an exit code");
    let report = json(&folder, "r.json");
    assert!(report["seam_edges"].as_u64().expect("a number") > 0);
    let count = |name: &str, what: &str| {
        let text = String::from_utf8(folder.read(name)).expect("text");
        text.lines().filter(|line| line.starts_with(what)).count()
    };
    assert_eq!(count("map.obj", "v "), count("torus.obj", "v "));
    assert_eq!(count("map.obj", "f "), count("torus.obj", "f "));
    assert_eq!(report["vertices"], count("map.obj", "vt "));
    folder.foldfree("check map.obj --report c.json");
    let certificate = &json(&folder, "c.json")["certificate"];
    assert_eq!(certificate["is_disk"], true);
    assert_eq!(
        certificate["boundary_edges"],
        report["certificate"]["boundary_edges"]
    );
}

#[test]
fn check_tells_folds_overlaps_and_mirrors_apart() {
    let folder = Folder::new("check");
    let surface = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let faces = "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
    let map = |texture: &[(f64, f64)]| {
        let lines: String = texture
            .iter()
            .map(|(u, v)| format!("vt {u} {v}\n"))
            .collect();
        folder.write("map.obj", format!("{surface}{lines}{faces}"));
        folder.run(&["check", "map.obj", "--report", "c.json"])
    };
    let ran = map(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]).ends(0);
    assert!(
        ran.stdout.contains("injective") && ran.stdout.contains("energy 1.000000"),
        "{ran:#?}"
    );
    let ran = map(&[(0.0, 0.0), (0.0, 1.0), (1.0, 1.0), (1.0, 0.0)]).ends(0);
    assert!(ran.stdout.contains("mirrored"), "{ran:#?}");
    let ran = map(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.9, 0.1)]).ends(2);
    assert!(ran.stdout.contains("1 inverted"), "{ran:#?}");
    assert_eq!(
        json(&folder, "c.json")["certificate"]["inverted"],
        serde_json::json!([1])
    );
    // Infinite energy is null in JSON.
    assert!(json(&folder, "c.json")["certificate"]["symmetric_dirichlet"].is_null());
    let ran = map(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 0.5)]).ends(2);
    assert!(ran.stdout.contains("1 degenerate"), "{ran:#?}");

    // Faces that disagree about which side is up are turned round first.
    let turned = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 4/4 3/3\n";
    folder.write("turned.obj", format!("{surface}{turned}"));
    let ran = folder.foldfree("check turned.obj").ends(0);
    assert!(
        ran.stdout.contains("0 inverted") && ran.stdout.contains("turned round"),
        "{ran:#?}"
    );

    // A strip whose ends overlap: no folds, but not injective as a whole.
    let around = [(0, 0), (4, 0), (4, 4), (0, 4), (0, -1), (3, -1)];
    let mut overlap = String::new();
    let inner = |(x, y): (i32, i32)| (f64::from(x - 2) * 0.3 + 2.0, f64::from(y - 2) * 0.3 + 2.0);
    for &p in &around {
        overlap += &format!("v {} {} 0\nv {} {} 0\n", p.0, p.1, inner(p).0, inner(p).1);
    }
    for i in 0..around.len() - 1 {
        let [a, b, c, d] = [2 * i + 1, 2 * i + 3, 2 * i + 4, 2 * i + 2];
        overlap += &format!("f {a} {b} {c}\nf {a} {c} {d}\n");
    }
    folder.write("flat.obj", overlap);
    let ran = folder.foldfree("check flat.obj --rest flat.obj").ends(0);
    assert!(ran.stdout.contains("not as a whole"), "{ran:#?}");
    folder
        .foldfree("check flat.obj --rest flat.obj --global")
        .ends(2);
}

#[test]
fn threads_do_not_change_the_result() {
    let folder = Folder::new("threads");
    folder
        .foldfree("generate terrain --triangles 3000 --out t.obj")
        .ends(0);
    let with = |threads: &str| {
        folder.run(&[
            "parameterize",
            "t.obj",
            "--out",
            "m.obj",
            "--iterations",
            "20",
            "--threads",
            threads,
            "--quiet",
        ]);
        folder.read("m.obj")
    };
    let one = with("1");
    assert!(one == with("2") && one == with("3"));
}

#[test]
fn second_order_methods() {
    let folder = Folder::new("second-order");
    folder
        .run(&[
            "generate",
            "bumpy-cap",
            "--triangles",
            "400",
            "--out",
            "a.obj",
        ])
        .ends(0);
    for method in ["cm", "wrapd+cm", "slim"] {
        let flatten = [
            "parameterize",
            "a.obj",
            "--method",
            method,
            "--report",
            "r.json",
        ];
        folder.run(&flatten).ends(0);
        let report = json(&folder, "r.json");
        assert_eq!(report["options"]["method"], method);
        let iterations = report["iterations"].as_array().expect("a list");
        let last = iterations.last().expect("iterations");
        assert_eq!(last["inverted"], 0);
        // the hybrid says when it changed over, from then on
        let switched: Vec<_> = iterations
            .iter()
            .filter_map(|i| i["switched_at"].as_u64())
            .collect();
        assert_eq!(switched.is_empty(), method != "wrapd+cm");
        assert!(switched.iter().all(|&k| k >= 1 && k == switched[0]));
        if let Some(&k) = switched.first() {
            assert_eq!(iterations.len() as u64 - k, switched.len() as u64);
        }
    }
    let refused = [
        "parameterize",
        "a.obj",
        "--method",
        "cm",
        "--start",
        "random",
    ];
    let ran = folder.run(&refused).ends(1);
    assert!(
        ran.stderr
            .contains("inverted elements, and this method needs none"),
        "{ran:#?}"
    );
    let refused = [
        "parameterize",
        "a.obj",
        "--method",
        "wrapd+cm",
        "--energy",
        "arap",
    ];
    let ran = folder.run(&refused).ends(1);
    assert!(ran.stderr.contains("option energy"), "{ran:#?}");

    folder
        .run(&["generate", "bar", "--tetrahedra", "300", "--out", "s.node"])
        .ends(0);
    folder.write("pins.txt", b"0\n1\n2\n3\n");
    folder.write("targets.txt", b"40 1.5 0.2 0.1\n");
    for method in ["newton", "wrapd+newton"] {
        let deform = [
            "deform",
            "--init",
            "s.node",
            "--pins",
            "pins.txt",
            "--targets",
            "targets.txt",
            "--method",
            method,
            "--report",
            "r.json",
        ];
        folder.run(&deform).ends(0);
        let report = json(&folder, "r.json");
        assert_eq!(report["options"]["method"], method);
        assert_eq!(report["status"], "converged");
    }
    let cloth = [
        "cloth", "--init", "a.obj", "--pins", "pins.txt", "--method", "newton",
    ];
    let ran = folder.run(&cloth).ends(1);
    assert!(ran.stderr.contains("option method"), "{ran:#?}");
}

#[test]
fn landmarks_and_pieces() {
    let folder = Folder::new("landmarks");
    folder
        .run(&[
            "generate",
            "bumpy-cap",
            "--triangles",
            "400",
            "--out",
            "cap.obj",
        ])
        .ends(0);
    folder.write("corners.txt", "# vertex, u, v\n0 10 0\n7 10.5 0.2\n");
    let line = "parameterize cap.obj --method wrapd+cm --landmarks corners.txt --out map.obj";
    folder.foldfree(line).ends(0);
    folder.foldfree(&format!("{line} --hard")).ends(0);
    let map = String::from_utf8(folder.read("map.obj")).unwrap();
    let place = |u: f64, v: f64| {
        map.lines()
            .filter_map(|line| line.strip_prefix("vt "))
            .any(|line| {
                let numbers: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
                (numbers[0] - u).abs() + (numbers[1] - v).abs() < 1e-9
            })
    };
    assert!(place(10.0, 0.0) && place(10.5, 0.2));
    for (contents, words) in [
        ("0 1 2\n9999 0 0\n", "line 2"),
        ("0 1 2\n0 3 4\n", "vertex 0 has two places"),
        ("0 1 2 3\n", "two coordinates"),
    ] {
        folder.write("corners.txt", contents);
        folder.foldfree(line).fails(&[words]);
    }
    folder
        .foldfree("parameterize cap.obj --hard")
        .fails(&["--landmarks"]);

    let two = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 1\nv 6 0 0\nv 5 1 0\nf 1 2 3\nf 4 5 6\n";
    folder.write("two.obj", two);
    let ran = folder.foldfree("parameterize two.obj --keep-holes --report two.json");
    assert!(ran.ends(0).stdout.contains("2 pieces, a chart for each"));
    assert_eq!(
        json(&folder, "two.json")["certificate"]["globally_injective"],
        true
    );
}
