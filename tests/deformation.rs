//! Quasi-static deformation: bars of tetrahedra, and the problems of the paper where they are.

mod bar;

use bar::{bar, twisted};
use foldfree::deformation::{Deformation, DeformationMethod, DeformationOptions, Material};
use foldfree::mesh::SolidMesh;
use foldfree::mesh::io::{read_ele, read_node, write_ele, write_node};
use foldfree::optim::Status;
use glam::{DMat3, DVec3};
use std::io::Read;
use std::path::Path;

fn solve(
    mesh: &SolidMesh,
    start: &[DVec3],
    pins: &[u32],
    options: &DeformationOptions,
) -> Deformation {
    let mut deformation = Deformation::new(mesh, start, pins, options).unwrap();
    while deformation.solver().status() == Status::Running {
        deformation.step().unwrap();
    }
    deformation
}

#[test]
fn what_is_only_held_at_one_end_goes_back_to_rest() {
    let mesh = bar(6, 2);
    let (start, _) = twisted(&mesh, 2.0);
    let pins: Vec<u32> = (0..mesh.positions.len() as u32)
        .filter(|&v| mesh.positions[v as usize].x == 0.0)
        .collect();
    for material in [
        Material::NeoHookean {
            young: 1e3,
            poisson: 0.4,
        },
        Material::Arap,
        Material::SymmetricDirichlet,
    ] {
        let options = DeformationOptions {
            material,
            ..Default::default()
        };
        let done = solve(&mesh, &start, &pins, &options);
        assert!(
            matches!(done.solver().status(), Status::Converged(_)),
            "{material:?}"
        );
        for (p, q) in done.positions().iter().zip(&mesh.positions) {
            assert!(p.distance(*q) < 1e-3, "{material:?}: {p} {q}");
        }
    }
}

#[test]
fn methods_agree_on_the_minimum() {
    let mesh = bar(6, 2);
    let (start, pins) = twisted(&mesh, 1.0);
    let options = DeformationOptions {
        tolerance: 1e-13,
        ..Default::default()
    };
    let energies = [
        DeformationMethod::Wrapd,
        DeformationMethod::RAdmm,
        DeformationMethod::WAdmm,
        DeformationMethod::AdmmPd,
    ]
    .map(|method| {
        let done = solve(
            &mesh,
            &start,
            &pins,
            &DeformationOptions { method, ..options },
        );
        assert_eq!(done.solver().report().inverted, 0);
        done.solver().report().energy
    });
    for energy in energies {
        assert!((energy / energies[0] - 1.0).abs() < 1e-8, "{energies:?}");
    }
}

#[test]
fn collapsed_and_random_starts_unfold() {
    let mesh = bar(4, 2);
    let (start, pins) = twisted(&mesh, 0.5);
    let held = |v: usize| pins.contains(&(v as u32));
    let optimum = solve(&mesh, &start, &pins, &Default::default());
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 40) as f64 / (1u64 << 24) as f64
    };
    let scattered: Vec<DVec3> = (0..start.len())
        .map(|v| match held(v) {
            true => start[v],
            false => DVec3::new(2.0 * random(), random(), random()),
        })
        .collect();
    let collapsed: Vec<DVec3> = (0..start.len())
        .map(|v| if held(v) { start[v] } else { DVec3::splat(0.5) })
        .collect();
    for from in [scattered, collapsed] {
        let done = solve(&mesh, &from, &pins, &Default::default());
        let (report, best) = (done.solver().report(), optimum.solver().report());
        assert_eq!(report.inverted, 0);
        assert!(
            report.energy <= best.energy * (1.0 + 1e-6),
            "{} {}",
            report.energy,
            best.energy
        );
    }
}

/// Scale, rotation, vertex order, stiffness and threads change nothing beyond rounding.
#[test]
fn invariance() {
    let mesh = bar(5, 2);
    let (start, pins) = twisted(&mesh, 1.5);
    let options = DeformationOptions {
        max_iterations: 12,
        ..Default::default()
    };
    let energies = |mesh: &SolidMesh, start: &[DVec3], pins: &[u32]| -> Vec<f64> {
        let mut deformation = Deformation::new(mesh, start, pins, &options).unwrap();
        (0..12)
            .map(|_| deformation.step().unwrap().energy)
            .collect()
    };
    let plain = energies(&mesh, &start, &pins);
    let close = |other: &[f64], factor: f64, what: &str| {
        for (a, b) in plain.iter().zip(other) {
            assert!(
                (a * factor / b - 1.0).abs() < 1e-8,
                "{what}: {plain:?} {other:?}"
            );
        }
    };
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0);
    let moved: Vec<DVec3> = start.iter().map(|&p| turn * p + DVec3::ONE).collect();
    close(&energies(&mesh, &moved, &pins), 1.0, "rotation");
    for scale in [1e-3, 1e3] {
        let mut scaled = mesh.clone();
        scaled.positions.iter_mut().for_each(|p| *p *= scale);
        let start: Vec<DVec3> = start.iter().map(|&p| scale * p).collect();
        close(&energies(&scaled, &start, &pins), scale.powi(3), "scale");
    }
    let n = start.len() as u32;
    let other = |v: u32| (v * 7 + 3) % n;
    assert!(!n.is_multiple_of(7));
    let mut shuffled = mesh.clone();
    let mut from = start.clone();
    for v in 0..n {
        shuffled.positions[other(v) as usize] = mesh.positions[v as usize];
        from[other(v) as usize] = start[v as usize];
    }
    shuffled
        .simplices
        .iter_mut()
        .for_each(|t| *t = t.map(other));
    shuffled.simplices.reverse();
    let held: Vec<u32> = pins.iter().map(|&v| other(v)).collect();
    close(&energies(&shuffled, &from, &held), 1.0, "order");
    for threads in [1, 2, 3] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let same = pool.install(|| energies(&mesh, &start, &pins));
        assert_eq!(same, plain, "{threads} threads");
    }
}

#[test]
fn bad_input() {
    let mesh = bar(2, 1);
    let start = mesh.positions.clone();
    let options = DeformationOptions::default();
    let refused = |mesh: &SolidMesh, start: &[DVec3], pins: &[u32], words: &str| {
        let Err(error) = Deformation::new(mesh, start, pins, &options) else {
            panic!("not refused: {words}");
        };
        assert!(error.to_string().contains(words), "{error}");
    };
    refused(&mesh, &start, &[], "vertex 0 has no pin");
    refused(&mesh, &start, &[99], "vertex 99");
    let all: Vec<u32> = (0..start.len() as u32).collect();
    refused(&mesh, &start, &all, "all vertices");
    refused(&mesh, &start[1..], &[0], "start");
    let mut bad = start.clone();
    bad[3].y = f64::NAN;
    refused(&mesh, &bad, &[0], "vertex 3");
    let mut inside_out = mesh.clone();
    inside_out.simplices[4].swap(0, 1);
    refused(&inside_out, &start, &[0], "element 4 is inverted at rest");
    let mut flat = mesh.clone();
    flat.simplices[2] = [0, 1, 2, 1];
    refused(&flat, &start, &[0], "element 2 is degenerate");
    let mut beyond = mesh.clone();
    beyond.simplices[1][3] = 77;
    refused(&beyond, &start, &[0], "77");
    refused(&SolidMesh::default(), &[], &[0], "no faces");
    // a component of its own
    let mut two = mesh.clone();
    let shifted = mesh.positions.iter().map(|&p| p + 10.0 * DVec3::X);
    two.positions.extend(shifted);
    let n = start.len() as u32;
    two.simplices
        .extend(mesh.simplices.iter().map(|t| t.map(|v| v + n)));
    refused(
        &two,
        &two.positions,
        &[0],
        &format!("vertex {n} has no pin"),
    );
    for poisson in [0.5, 0.6] {
        let material = Material::NeoHookean {
            young: 1.0,
            poisson,
        };
        let options = DeformationOptions {
            material,
            ..options
        };
        let error = Deformation::new(&mesh, &start, &[0], &options)
            .err()
            .unwrap();
        assert!(error.to_string().contains("poisson"), "{error}");
    }
}

#[test]
fn what_can_be_mended_is_mended_and_said() {
    let mesh = bar(2, 1);
    let mut turned = mesh.clone();
    turned.simplices.iter_mut().for_each(|t| t.swap(0, 1));
    turned.positions.push(DVec3::splat(9.0));
    let mut start = turned.positions.clone();
    start[0] += 0.1;
    let pins: Vec<u32> = (3..turned.positions.len() as u32 - 1).collect();
    let done = solve(&turned, &start, &pins, &Default::default());
    let notes = done.notes().join("; ");
    assert!(
        notes.contains("inside out") && notes.contains("1 vertex in no"),
        "{notes}"
    );
    assert_eq!(
        done.positions()[turned.positions.len() - 1],
        DVec3::splat(9.0)
    );
    assert!(done.positions()[0].distance(mesh.positions[0]) < 1e-4);
}

#[test]
fn files_read_back_and_bad_ones_are_refused() {
    let mesh = bar(3, 2);
    let nodes = read_node(&write_node(&mesh.positions)).unwrap();
    assert_eq!(read_ele(&write_ele(&mesh), nodes).unwrap(), mesh);
    // from 1, with attributes, markers and comments
    let nodes = b"# four\n4 3 1 1\n1 0 0 0 7 1\n2 1 0 0 7 1\n\n3 0 1 0 7 1 # third\n4 0 0 1 7 1\n";
    let nodes = read_node(nodes).unwrap();
    let mesh = read_ele(b"1 4 0\n1 1 2 3 4\n", nodes.clone()).unwrap();
    assert_eq!(mesh.simplices, [[0, 1, 2, 3]]);
    for (text, words) in [
        ("", "no vertices"),
        ("4 2 0 0\n", "dimension"),
        ("4 3 0 0\n0 0 0 0\n", "cannot hold"),
        ("999999999999 3 0 0\n0 0 0 0\n", "cannot hold"),
        ("1 3 0 0\n5 0 0 0\n", "not 0 or 1"),
        ("2 3 0 0\n0 0 0 0\n2 1 1 1\n", "line 3"),
        ("2 3 0 0\n0 0 0 0\n1 1 nan 1\n", "line 3, column 5"),
        ("1 3 0 0\n0 0 0     \n", "three coordinates"),
    ] {
        let error = read_node(text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(words), "{text:?}: {error}");
    }
    for (text, words) in [
        ("1 4 0\n1 1 2 3 5\n", "index 5 of 4"),
        ("1 4 0\n1 0 2 3 4\n", "index 0 of 4"),
        ("1 10 0\n1 1 2 3 4\n", "only 4 is read"),
        ("1 4 0\n1 1 2 3     \n", "four vertices"),
    ] {
        let error = read_ele(text.as_bytes(), nodes.clone())
            .unwrap_err()
            .to_string();
        assert!(error.contains(words), "{text:?}: {error}");
    }
}

fn data(problem: &str, file: &str) -> Option<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/quasistatic");
    let Ok(bytes) = std::fs::read(folder.join(problem).join(file)) else {
        println!("skipped: {problem} is not in {}", folder.display());
        return None;
    };
    if !file.ends_with(".gz") {
        return Some(bytes);
    }
    let mut text = Vec::new();
    flate2::read::GzDecoder::new(&bytes[..])
        .read_to_end(&mut text)
        .unwrap();
    Some(text)
}

/// After 60 iterations: at most this energy and this ‖x − x*‖/‖x₀ − x*‖ (what the authors' code
/// reaches).
fn reaches(problem: &str, energy: f64, error: f64) {
    let Some(node) = data(problem, "rest.node.gz") else {
        return;
    };
    let ele = data(problem, "rest.ele.gz").unwrap();
    let rest = read_ele(&ele, read_node(&node).unwrap()).unwrap();
    let positions = |file| read_node(&data(problem, file).unwrap()).unwrap().positions;
    let (start, solution) = (positions("init.node.gz"), positions("nh_soln.node.gz"));
    let pins = String::from_utf8(data(problem, "handles.txt").unwrap()).unwrap();
    let pins: Vec<u32> = pins
        .lines()
        .map(|line| line.trim().parse().unwrap())
        .collect();
    let options = DeformationOptions {
        max_iterations: 60,
        ..Default::default()
    };
    let done = solve(&rest, &start, &pins, &options);
    let distance = |x: &[DVec3]| {
        let squares = x.iter().zip(&solution).map(|(a, b)| a.distance_squared(*b));
        squares.sum::<f64>().sqrt()
    };
    let found = (
        done.solver().report().energy,
        distance(&done.positions()) / distance(&start),
    );
    println!(
        "{problem}: energy {}, position error {:e}",
        found.0, found.1
    );
    assert_eq!(done.solver().report().inverted, 0);
    assert!(
        found.0 <= energy && found.1 <= error,
        "{problem}: {found:?}"
    );
}

#[test]
fn shear() {
    reaches("shear", 1.3760e6, 7e-3);
}

#[test]
fn untwist() {
    reaches("untwist", 80.0, 1.5e-2);
}

#[test]
fn homer() {
    reaches("homer", 1858.73, 7e-4);
}
