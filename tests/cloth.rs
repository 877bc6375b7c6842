//! Cloth: what theory says of a hanging strip and of a shelf, the limits of stretch, and the experiment
//! of the paper's figure 8.

mod cloth_square;

use cloth_square::{corners, rectangle, square, wrinkled};
use foldfree::deformation::{ClothOptions, Deformation, DeformationMethod, Target};
use foldfree::mesh::SurfaceMesh;
use foldfree::optim::Status;
use glam::{DMat3, DVec3};

fn solve(mesh: &SurfaceMesh, start: &[DVec3], pins: &[u32], options: &ClothOptions) -> Deformation {
    let mut cloth = Deformation::of_cloth(mesh, start, pins, &[], options).unwrap();
    while cloth.solver().status() == Status::Running {
        cloth.step().unwrap();
    }
    cloth
}

fn distance(x: &[DVec3], y: &[DVec3]) -> f64 {
    let squares = x.iter().zip(y).map(|(a, b)| a.distance_squared(*b));
    squares.sum::<f64>().sqrt()
}

/// A strip 0.2 m wide and 1 m long that hangs from its upper end, and its stretch at the arc length s from
/// there.
fn hanging(options: &ClothOptions, most: f64) {
    let (columns, rows, size) = (4, 20, 0.05);
    let mesh = rectangle(columns, rows, size);
    let pins: Vec<u32> = (0..=columns as u32).collect();
    let hang = |p: &DVec3| DVec3::new(p.x, 0.0, -p.y);
    let start: Vec<DVec3> = mesh.positions.iter().map(hang).collect();
    let done = solve(&mesh, &start, &pins, options);
    assert!(matches!(done.solver().status(), Status::Converged(_)));
    let tension = |s: f64| 9.81 * options.density * (1.0 - s);
    let mut length = 0.0;
    for row in 0..rows {
        let middle = (row as f64 + 0.5) * size;
        length += size * (1.0 + tension(middle) / options.stretch).min(most);
        let lowest = done.positions()[(row + 1) * (columns + 1) + columns / 2];
        assert!((lowest.z + length).abs() < 1e-3, "{row}: {lowest} {length}");
    }
    let report = done.solver().report();
    assert!(report.largest_sigma < most + 1e-6, "{report:?}");
}

#[test]
fn a_hanging_strip_stretches_by_the_weight_below() {
    let soft = ClothOptions {
        stretch: 25.0,
        bending: 0.0,
        limits: None,
        ..Default::default()
    };
    hanging(&soft, f64::INFINITY);
    // its upper half is at the limit
    let limits = Some([0.9, 1.05]);
    hanging(&ClothOptions { limits, ..soft }, 1.05);
}

#[test]
fn a_shelf_sags_as_a_plate_does() {
    // equilateral triangles; a wide shelf, clamped at one side: two rows are held
    let (columns, rows, size) = (40, 12, 0.01);
    let mut mesh = rectangle(columns, rows, size);
    for (v, p) in mesh.positions.iter_mut().enumerate() {
        let row = v / (columns + 1);
        p.x += 0.5 * size * (row % 2) as f64;
        p.y *= 0.75f64.sqrt();
    }
    let at = |row: usize, column: usize| (row * (columns + 1) + column) as u32;
    for (quad, two) in mesh.simplices.as_chunks_mut::<2>().0.iter_mut().enumerate() {
        let (j, i) = (quad / columns, quad % columns);
        let [a, b, c, d] = [at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)];
        *two = match j % 2 {
            0 => [[a, b, d], [b, c, d]],
            _ => [[a, b, c], [a, c, d]],
        };
    }
    let pins: Vec<u32> = (0..at(2, 0)).collect();
    let options = ClothOptions {
        stretch: 1e4,
        bending: 0.1,
        limits: None,
        tolerance: 1e-9,
        ..Default::default()
    };
    let done = solve(&mesh, &mesh.positions, &pins, &options);
    assert!(matches!(done.solver().status(), Status::Converged(_)));
    // q L⁴/8D; the first hinges that bend are those at the second row, half of them in the clamp
    let length = (rows as f64 - 0.5) * size * 0.75f64.sqrt();
    let sag = 9.81 * options.density * length.powi(4) / (8.0 * options.bending);
    let tip = -done.positions()[at(rows, columns / 2) as usize].z;
    // hinges let the sides curl: a narrow one would have D·8/9
    assert!(tip > 0.95 * sag && tip < 1.15 * sag, "{tip} {sag}");
}

#[test]
fn without_weight_it_is_flat_again() {
    let mesh = square(10);
    // rolled up, but for a corner: three vertices are held where the rest shape has them
    let roll = |p: &DVec3| {
        let (sin, cos) = (4.0 * p.x).sin_cos();
        DVec3::new(0.25 * sin, p.y, 0.25 * (1.0 - cos))
    };
    let mut start: Vec<DVec3> = mesh.positions.iter().map(roll).collect();
    let pins = [0, 1, 11];
    for v in pins {
        start[v as usize] = mesh.positions[v as usize];
    }
    let options = ClothOptions {
        gravity: [0.0; 3],
        bending: 1e-2,
        tolerance: 1e-14,
        ..Default::default()
    };
    let done = solve(&mesh, &start, &pins, &options);
    let report = done.solver().report();
    assert!(matches!(report.status, Status::Converged(_)), "{report:?}");
    let error = distance(&done.positions(), &mesh.positions);
    let first = distance(&start, &mesh.positions);
    assert!(error < 1e-4 * first, "{error} of {first}");
    assert!(report.energy < 1e-7, "{:e}", report.energy);
}

/// The experiment of figure 8, on a coarser cloth: normalized position errors over the iterations.
#[test]
fn rotation_awareness_pays() {
    let n = 20;
    let mesh = square(n);
    let pins = corners(n);
    let start = wrinkled(&mesh, &pins);
    let options = ClothOptions {
        stretch: 300.0,
        bending: 1e-3,
        tolerance: 1e-13,
        ..Default::default()
    };
    let reference = solve(&mesh, &start, &pins, &options);
    assert!(matches!(reference.solver().status(), Status::Converged(_)));
    let report = reference.solver().report();
    assert!(report.largest_sigma < 1.05 + 1e-6 && report.largest_sigma > 1.05 - 1e-6);
    assert!(report.smallest_sigma > 0.95 - 1e-6);
    let solution = reference.positions();
    let first = distance(&start, &solution);
    let error_after = |method, iterations| {
        let options = ClothOptions {
            method,
            max_iterations: iterations,
            ..options
        };
        let done = solve(&mesh, &start, &pins, &options);
        let seconds = done.solver().report().seconds;
        (distance(&done.positions(), &solution) / first, seconds)
    };
    let (error, seconds) = error_after(DeformationMethod::Wrapd, 50);
    assert!(error < 2e-3, "{error:e}");
    // the other takes many more iterations, and ends at the same cloth
    let (slow, slow_seconds) = error_after(DeformationMethod::AdmmPd, 300);
    assert!(
        slow > 20.0 * error,
        "{slow:e} {slow_seconds} s, {error:e} {seconds} s"
    );
    let (late, _) = error_after(DeformationMethod::AdmmPd, 8000);
    assert!(late < 2e-2, "{late:e}");
}

#[test]
fn place_direction_and_numbering_do_not_matter() {
    let n = 8;
    let mesh = square(n);
    let pins = corners(n);
    let start = wrinkled(&mesh, &pins);
    let options = ClothOptions {
        bending: 1e-3,
        tolerance: 1e-14,
        ..Default::default()
    };
    let solve = |mesh: &SurfaceMesh, start: &[DVec3], pins: &[u32], options: &ClothOptions| {
        let done = solve(mesh, start, pins, options);
        let status = done.solver().status();
        assert!(matches!(status, Status::Converged(_)), "{status:?}");
        done
    };
    let plain = solve(&mesh, &start, &pins, &options);
    let energy = plain.solver().report().energy;

    let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 0.5).normalize(), 2.0);
    let moved = |p: &DVec3| turn * *p + DVec3::new(30.0, -40.0, 50.0);
    let start_moved: Vec<DVec3> = start.iter().map(moved).collect();
    let gravity = (turn * DVec3::from_array(options.gravity)).to_array();
    let turned = solve(
        &mesh,
        &start_moved,
        &pins,
        &ClothOptions { gravity, ..options },
    );
    let expected: Vec<DVec3> = plain.positions().iter().map(moved).collect();
    let error = distance(&turned.positions(), &expected);
    assert!(error < 1e-5, "turned: {error:e}");
    assert!((turned.solver().report().energy - energy).abs() < 1e-9);

    // vertices in reverse, triangles turned round and in reverse
    let last = mesh.positions.len() as u32 - 1;
    let reversed = |x: &[DVec3]| x.iter().rev().copied().collect::<Vec<_>>();
    let other = SurfaceMesh {
        positions: reversed(&mesh.positions),
        simplices: mesh
            .simplices
            .iter()
            .rev()
            .map(|t| t.map(|v| last - v))
            .collect(),
    };
    let mut other = other;
    other
        .simplices
        .iter_mut()
        .step_by(3)
        .for_each(|t| t.swap(0, 2));
    let pins_reversed: Vec<u32> = pins.iter().map(|v| last - v).collect();
    let again = solve(&other, &reversed(&start), &pins_reversed, &options);
    let error = distance(&reversed(&again.positions()), &plain.positions());
    assert!(error < 1e-5, "numbered anew: {error:e}");

    // millimetres, grams: lengths × 1000, forces g mm/s² × 1e6, masses × 1000
    let millimetres = |x: &[DVec3]| x.iter().map(|p| *p * 1e3).collect::<Vec<_>>();
    let small = SurfaceMesh {
        positions: millimetres(&mesh.positions),
        ..mesh.clone()
    };
    let units = ClothOptions {
        stretch: 1e3 * options.stretch,
        bending: 1e9 * options.bending,
        density: 1e-3 * options.density,
        gravity: options.gravity.map(|g| 1e3 * g),
        ..options
    };
    let scaled = solve(&small, &millimetres(&start), &pins, &units);
    let error = distance(&scaled.positions(), &millimetres(&plain.positions()));
    assert!(error < 1e-2, "in millimetres: {error:e}");
}

#[test]
fn targets_pull_and_pins_move() {
    let n = 6;
    let mesh = square(n);
    let options = ClothOptions::default();
    let centre = (n / 2 * (n + 2)) as u32;
    let lifted = Target {
        vertex: centre,
        position: DVec3::new(0.5, 0.5, 0.4),
    };
    // hung up at its centre alone
    let mut cloth =
        Deformation::of_cloth(&mesh, &mesh.positions, &[], &[lifted], &options).unwrap();
    for _ in 0..200 {
        cloth.step().unwrap();
    }
    let peak = cloth.positions()[centre as usize];
    assert!(peak.distance(lifted.position) < 0.05, "{peak}");
    assert!(cloth.positions().iter().all(|p| p.z < peak.z + 1e-6));
    let moved = Target {
        position: DVec3::new(2.0, 0.5, 1.0),
        ..lifted
    };
    cloth.set_targets(&[moved]).unwrap();
    for _ in 0..200 {
        cloth.step().unwrap();
    }
    let peak = cloth.positions()[centre as usize];
    assert!(peak.distance(moved.position) < 0.05, "{peak}");

    // held at two sides, of which one is moved away, so that it is taut and has one minimum: it ends as if
    // that had been there from the start
    let on_side = |v: &u32, x: f64| mesh.positions[*v as usize].x == x;
    let vertices = 0..mesh.positions.len() as u32;
    let pins: Vec<u32> = vertices
        .filter(|v| on_side(v, 0.0) || on_side(v, 1.0))
        .collect();
    let goals: Vec<Target> = pins
        .iter()
        .filter(|v| on_side(v, 1.0))
        .map(|&vertex| Target {
            vertex,
            position: mesh.positions[vertex as usize] + DVec3::new(0.1, 0.0, 0.2),
        })
        .collect();
    assert_eq!((pins.len(), goals.len()), (2 * n + 2, n + 1));
    let options = ClothOptions {
        tolerance: 1e-13,
        bending: 1e-2,
        limits: None,
        ..options
    };
    let run = |cloth: &mut Deformation| {
        while cloth.solver().status() == Status::Running {
            cloth.step().unwrap();
        }
        let status = cloth.solver().status();
        assert!(matches!(status, Status::Converged(_)), "{status:?}");
    };
    let begin = |targets: &[Target]| {
        Deformation::of_cloth(&mesh, &mesh.positions, &pins, targets, &options).unwrap()
    };
    let mut dragged = begin(&[]);
    run(&mut dragged);
    let before = dragged.positions();
    dragged.set_targets(&goals).unwrap();
    let at_goals = |cloth: &Deformation| {
        let x = cloth.positions();
        goals.iter().all(|g| x[g.vertex as usize] == g.position)
    };
    assert!(at_goals(&dragged), "at once");
    run(&mut dragged);
    assert!(at_goals(&dragged));
    let after = dragged.positions();
    for pin in pins.iter().filter(|v| on_side(v, 0.0)) {
        assert_eq!(after[*pin as usize], mesh.positions[*pin as usize]);
    }
    let moved = distance(&before, &after);
    let mut fresh = begin(&goals);
    run(&mut fresh);
    let apart = distance(&after, &fresh.positions());
    assert!(apart < 1e-5 * moved, "{apart:e} of {moved}");
}

#[test]
fn bad_cloth_is_named() {
    let mesh = square(3);
    let start = mesh.positions.clone();
    let error = |mesh: &SurfaceMesh, start: &[DVec3], pins: &[u32], options: &ClothOptions| {
        match Deformation::of_cloth(mesh, start, pins, &[], options) {
            Ok(_) => panic!("accepted"),
            Err(error) => error.to_string(),
        }
    };
    let plain = ClothOptions::default();
    let nan = f64::NAN;
    for (options, named) in [
        (
            ClothOptions {
                stretch: 0.0,
                ..plain
            },
            "stretch",
        ),
        (
            ClothOptions {
                stretch: nan,
                ..plain
            },
            "stretch",
        ),
        (
            ClothOptions {
                bending: -1.0,
                ..plain
            },
            "bending",
        ),
        (
            ClothOptions {
                bending: f64::INFINITY,
                ..plain
            },
            "bending",
        ),
        (
            ClothOptions {
                density: nan,
                ..plain
            },
            "density",
        ),
        (
            ClothOptions {
                gravity: [0.0, nan, 0.0],
                ..plain
            },
            "gravity",
        ),
        (
            ClothOptions {
                limits: Some([1.1, 1.2]),
                ..plain
            },
            "limits",
        ),
        (
            ClothOptions {
                limits: Some([1.0, 1.0]),
                ..plain
            },
            "limits",
        ),
        (
            ClothOptions {
                tolerance: nan,
                ..plain
            },
            "tolerance",
        ),
        (
            ClothOptions {
                target_stiffness: 0.0,
                ..plain
            },
            "targetStiffness",
        ),
        (
            ClothOptions {
                method: DeformationMethod::Lbfgs,
                ..plain
            },
            "l-bfgs",
        ),
    ] {
        let error = error(&mesh, &start, &[0], &options);
        assert!(error.contains(named), "{named}: {error}");
    }
    assert!(error(&mesh, &start, &[], &plain).contains("no pin"));
    assert!(error(&mesh, &start, &[16], &plain).contains("vertex 16 of 16"));
    assert!(error(&mesh, &start[1..], &[0], &plain).contains("start"));
    let mut bad = start.clone();
    bad[7].y = nan;
    assert!(error(&mesh, &bad, &[0], &plain).contains("vertex 7"));
    let mut flat = mesh.clone();
    flat.positions[4] = flat.positions[5];
    assert!(error(&flat, &start, &[0], &plain).contains("degenerate"));
    let mut bad = mesh.clone();
    bad.simplices[2][1] = 99;
    assert!(error(&bad, &start, &[0], &plain).contains("99"));
    let mut bad = mesh.clone();
    let [a, b, _] = bad.simplices[0];
    bad.simplices.push([a, b, 15]);
    bad.simplices.push([a, b, 14]);
    assert!(error(&bad, &start, &[0], &plain).contains("edge"));
    let all: Vec<u32> = (0..16).collect();
    assert!(error(&mesh, &start, &all, &plain).contains("all vertices"));
    assert!(error(&SurfaceMesh::default(), &[], &[], &plain).contains("no faces"));
}

/// Collapsed to a point or almost, the pins too: it unfolds and hangs, no lower than its limits let it.
#[test]
fn collapsed_starts_unfold() {
    let mesh = square(6);
    let pins = [0, 6];
    let depth = |p: &DVec3| {
        let from = pins.map(|pin| p.distance(mesh.positions[pin as usize]));
        1.05 * from[0].min(from[1])
    };
    let depths: f64 = mesh.positions.iter().map(depth).sum();
    let options = ClothOptions::default();
    let weight = 9.81 * options.density;
    let lowest = -weight * depths / mesh.positions.len() as f64;
    for scale in [0.0, 1e-200] {
        let start: Vec<DVec3> = mesh.positions.iter().map(|p| *p * scale).collect();
        let done = solve(&mesh, &start, &pins, &options);
        let report = done.solver().report();
        assert!(matches!(report.status, Status::Converged(_)), "{report:?}");
        assert!(report.energy < 0.0 && report.energy > lowest, "{report:?}");
        assert!(report.largest_sigma < 1.05 + 1e-6, "{report:?}");
    }
}

/// Pins much further apart than the limits allow: nothing converges, and nothing gets out of hand.
#[test]
fn torn_apart_it_stays_finite() {
    let mesh = square(6);
    let start: Vec<DVec3> = mesh.positions.iter().map(|p| *p * 1e6).collect();
    let options = ClothOptions {
        max_iterations: 60,
        ..Default::default()
    };
    for method in [DeformationMethod::Wrapd, DeformationMethod::AdmmPd] {
        let options = ClothOptions { method, ..options };
        let first = Deformation::of_cloth(&mesh, &start, &[0, 6], &[], &options).unwrap();
        let first = first.solver().report().energy;
        let done = solve(&mesh, &start, &[0, 6], &options);
        let report = done.solver().report();
        assert_eq!(report.status, Status::MaxIterations);
        assert!(report.energy < 0.5 * first, "{first:e}, {report:?}");
        assert!(done.positions().iter().all(|p| p.is_finite()));
    }
}
