//! Bodies that keep from passing through themselves and each other: no accepted state has a boundary that meets
//! itself, and the last one is injective as a whole, by exact predicates.

mod overlap_problems;

use foldfree::Error;
use foldfree::certificate::{Certificate, SolidCertificate};
use foldfree::collision::{Boundary, BroadPhase, intersections};
use foldfree::deformation::{Material, Target, Untangling};
use foldfree::gini::GiniOptions;
use foldfree::mesh::{SimplicialMesh, SolidMesh};
use foldfree::optim::{BuildError, Criterion, Status};
use glam::{DVec2, DVec3};
use overlap_problems::*;

const INJECTIVE: Status = Status::Converged(Criterion::Injective);

fn options() -> GiniOptions {
    GiniOptions {
        settle: 0.0,
        ..GiniOptions::overlap()
    }
}

/// Pairs of boundary faces that meet; written here once more, from the mesh alone.
fn meeting(mesh: &SolidMesh, positions: &[DVec3]) -> usize {
    let boundary = Boundary::<3>::new(mesh.simplices.as_flattened()).expect("a manifold");
    let x: Vec<[f64; 3]> = positions.iter().map(|p| p.to_array()).collect();
    intersections(&boundary, &x, &mut BroadPhase::default(), 100).len()
}

/// Runs until the status is not running, looking at every accepted state. Returns the most contacts there were.
fn run(u: &mut Untangling) -> usize {
    let mut contacts = 0;
    while u.solver().status() == Status::Running {
        let report = u.step().expect("a step");
        contacts = contacts.max(report.gini.map_or(0, |g| g.contacts));
        assert_eq!(u.outcome().intersections, Some(0));
    }
    contacts
}

/// Makes all moves. Returns the most contacts there were.
fn follow<const K: usize>(problem: &Moves<K>, u: &mut Untangling) -> usize {
    let mut contacts = 0;
    for (k, pins) in problem.moves.iter().enumerate() {
        u.move_pins(pins).expect("pins");
        contacts = contacts.max(run(u));
        assert_eq!(
            u.solver().status(),
            INJECTIVE,
            "move {k}: {:?}",
            u.outcome()
        );
        assert_eq!(u.outcome().globally_injective, Some(true));
        let x = u.positions();
        for &(v, p) in pins {
            assert_eq!(x[v as usize], p, "pins arrive");
        }
    }
    contacts
}

/// With overlap nothing meets; without, the same pins lead to a state in which the boundary meets itself.
fn solid_keeps_apart(problem: &Moves<4>, material: Material) {
    let Moves {
        rest, start, pins, ..
    } = problem;
    let mut u = Untangling::of_solid(rest, start, pins, &[], material, &options()).expect("free");
    let contacts = follow(problem, &mut u);
    assert!(contacts > 0, "nothing was in the way");
    let x = u.positions();
    assert_eq!(meeting(rest, &x), 0);
    assert!(SolidCertificate::of_solid(rest, &x).locally_injective);
}

/// Where pins lead to when nothing keeps apart.
fn passes_through(problem: &Moves<4>) -> bool {
    let Moves {
        rest,
        start,
        pins,
        moves,
    } = problem;
    let last = moves.last().expect("moves").iter();
    let targets: Vec<Target> = last
        .map(|&(vertex, position)| Target { vertex, position })
        .collect();
    let options = GiniOptions::default();
    let material = Material::Arap;
    let mut u =
        Untangling::of_solid(rest, start, pins, &targets, material, &options).expect("a problem");
    // some steps on, so that it is not only free of inversions but near the minimum
    for _ in 0..30 {
        u.step().expect("a step");
    }
    meeting(rest, &u.positions()) > 0
}

#[test]
fn interlocked_arms_hold_each_other() {
    let problem = interlocked_arms(1);
    solid_keeps_apart(&problem, Material::Arap);
    assert!(passes_through(&problem));
}

#[test]
fn interlocked_arms_in_the_plane_do_too() {
    let problem = interlocked_arms_in_the_plane(2);
    let Moves {
        rest, start, pins, ..
    } = &problem;
    let material = Material::Arap;
    let mut u = Untangling::of_plane(rest, start, pins, &[], material, &options()).expect("free");
    assert!(follow(&problem, &mut u) > 0);
    let uv: Vec<DVec2> = u.positions().iter().map(|p| p.truncate()).collect();
    assert!(Certificate::of_map(rest, &uv).globally_injective);
}

#[test]
fn a_folded_sheet_lies_on_itself() {
    let problem = folded_sheet(1);
    solid_keeps_apart(&problem, Material::Arap);
}

#[test]
fn a_twisted_beam_does_not_wind_through_itself() {
    let problem = twisted_beam(2, 4);
    solid_keeps_apart(&problem, Material::Arap);
}

#[test]
fn boxes_slide_along_each_other() {
    let problem = sliding_boxes(2);
    let neo = Material::StableNeoHookean {
        young: Material::YOUNG,
        poisson: Material::POISSON,
    };
    solid_keeps_apart(&problem, neo);
    assert!(passes_through(&problem));
}

#[test]
fn parallel_edges_meet_and_stay_apart() {
    let problem = parallel_edges(1);
    solid_keeps_apart(&problem, Material::Arap);
    assert!(passes_through(&problem));
}

#[test]
fn problems_that_nothing_was_chosen_on() {
    let problems = [
        linked_rings(1),
        combs(1),
        peg(2),
        buckling_beam(2),
        stack(1),
    ];
    for problem in problems {
        solid_keeps_apart(&problem, Material::Arap);
    }
}

#[test]
fn gears_in_the_plane_turn_each_other() {
    let problem = gears_in_the_plane(1);
    let Moves {
        rest, start, pins, ..
    } = &problem;
    let material = Material::Arap;
    let mut u = Untangling::of_plane(rest, start, pins, &[], material, &options()).expect("free");
    follow(&problem, &mut u);
    let uv: Vec<DVec2> = u.positions().iter().map(|p| p.truncate()).collect();
    assert!(Certificate::of_map(rest, &uv).globally_injective);
}

#[test]
fn a_shrinking_box_presses_a_body_to_a_quarter() {
    let press = Press::new(4);
    let Moves {
        rest, start, pins, ..
    } = &press.problem;
    let mut u =
        Untangling::of_solid(rest, start, pins, &[], Material::Arap, &options()).expect("free");
    let mut scale = 1.0;
    while press.volume(&u.positions()) > 0.25 {
        scale *= 0.97;
        u.move_pins(&press.walls(scale)).expect("walls");
        run(&mut u);
        assert_eq!(
            u.solver().status(),
            INJECTIVE,
            "at {scale}: {:?}",
            u.outcome()
        );
    }
    assert_eq!(u.outcome().globally_injective, Some(true));
    assert_eq!(meeting(rest, &u.positions()), 0);
}

#[test]
fn targets_pull_only_as_far_as_there_is_room() {
    // the upper box is pulled right through the lower one
    let problem = sliding_boxes(1);
    let rest = &problem.rest;
    let all = 0..rest.positions.len() as u32;
    let pins: Vec<u32> = all
        .clone()
        .filter(|&v| rest.positions[v as usize].z == 0.0)
        .collect();
    let upper = all.filter(|&v| rest.positions[v as usize].z > 1.04);
    let targets: Vec<Target> = upper
        .map(|vertex| Target {
            vertex,
            position: rest.positions[vertex as usize] - DVec3::Z,
        })
        .collect();
    let options = GiniOptions {
        target_stiffness: 0.1,
        ..GiniOptions::overlap()
    };
    let start = &rest.positions;
    let mut u =
        Untangling::of_solid(rest, start, &pins, &targets, Material::Arap, &options).expect("free");
    let contacts = run(&mut u);
    assert!(contacts > 0);
    assert_eq!(
        u.outcome().globally_injective,
        Some(true),
        "{:?}",
        u.outcome()
    );
}

fn intersecting<const K: usize>(rest: &SimplicialMesh<K>, result: Result<Untangling, Error>) {
    match result {
        Err(Error::Build(BuildError::IntersectingStart { pairs })) => {
            assert!(!pairs.is_empty());
            let n = rest.positions.len() as u32;
            assert!(pairs.iter().flatten().flatten().all(|&v| v < n));
        }
        Err(error) => panic!("another error: {error}"),
        Ok(_) => panic!("the start meets itself"),
    }
}

#[test]
fn starts_that_meet_themselves_are_refused() {
    let problem = sliding_boxes(1);
    let mut start = problem.start.clone();
    for (x, p) in start.iter_mut().zip(&problem.rest.positions) {
        if p.z > 1.04 {
            x.z -= 0.5;
        }
    }
    let (rest, material) = (&problem.rest, Material::Arap);
    intersecting(
        rest,
        Untangling::of_solid(rest, &start, &problem.pins, &[], material, &options()),
    );
    let problem = interlocked_arms_in_the_plane(1);
    let mut start = problem.start.clone();
    start
        .iter_mut()
        .for_each(|p| p.y *= if p.x > 5.0 { 0.0 } else { 1.0 });
    let rest = &problem.rest;
    intersecting(
        rest,
        Untangling::of_plane(rest, &start, &problem.pins, &[], material, &options()),
    );
}

#[test]
fn pins_that_would_cross_end_in_bounded_time() {
    // the upper box's top is to go below the lower one's bottom, both held
    let problem = sliding_boxes(1);
    let Moves {
        rest, start, pins, ..
    } = &problem;
    let mut u =
        Untangling::of_solid(rest, start, pins, &[], Material::Arap, &options()).expect("free");
    let to: Vec<(u32, DVec3)> = pins
        .iter()
        .map(|&v| (v, start[v as usize]))
        .map(|(v, p)| (v, if p.z > 1.0 { p - 3.0 * DVec3::Z } else { p }))
        .collect();
    u.move_pins(&to).expect("pins");
    run(&mut u);
    let status = u.solver().status();
    assert!(matches!(status, Status::Stalled | Status::MaxIterations));
    assert_eq!(
        u.outcome().intersections,
        Some(0),
        "the best state is handed out"
    );
}

#[test]
fn pins_are_checked() {
    let problem = sliding_boxes(1);
    let Moves {
        rest, start, pins, ..
    } = &problem;
    let new = |options: &GiniOptions| {
        Untangling::of_solid(rest, start, pins, &[], Material::Arap, options).expect("free")
    };
    let free = (0..start.len() as u32)
        .find(|v| !pins.contains(v))
        .expect("free");
    let mut u = new(&options());
    for bad in [
        (free, DVec3::ZERO),
        (u32::MAX, DVec3::ZERO),
        (pins[0], DVec3::NAN),
    ] {
        let error = u.move_pins(&[bad]).expect_err("bad pins");
        assert!(matches!(
            error,
            BuildError::InvalidOption { option: "pins", .. }
        ));
    }
    let error = new(&GiniOptions::default()).move_pins(&[]);
    assert!(error.is_err(), "only with overlap");
}

/// A box of 4 × 4 × 4 cells; one tetrahedron inside of it, all of whose vertices are held, is turned inside out.
fn turned_inside() -> (SolidMesh, Vec<DVec3>, Vec<u32>) {
    let rest = cubes(&block([0; 3], [4; 3], 1, 0), |at, _| point(at, 1));
    let is_inside = |v: &u32| {
        let p = rest.positions[*v as usize];
        p.min_element() > 0.0 && p.max_element() < 4.0
    };
    let tetrahedron = rest.simplices.iter().find(|t| t.iter().all(is_inside));
    let pins = tetrahedron.expect("one inside").to_vec();
    let mut start = rest.positions.clone();
    start.swap(pins[0] as usize, pins[1] as usize);
    (rest, start, pins)
}

#[test]
fn pins_that_mend_what_they_hold_inside_out_are_enough() {
    let (rest, start, pins) = turned_inside();
    let held = Untangling::of_solid(&rest, &start, &pins, &[], Material::Arap, &options());
    let mut held = held.expect("the boundary is free");
    assert_eq!(held.solver().status(), Status::Stalled);
    assert_eq!(held.outcome().hopeless.len(), 1);
    let back: Vec<(u32, DVec3)> = pins
        .iter()
        .map(|&v| (v, rest.positions[v as usize]))
        .collect();
    held.move_pins(&back).expect("pins");
    assert!(held.outcome().hopeless.is_empty());
    run(&mut held);
    assert_eq!(held.solver().status(), INJECTIVE, "{:?}", held.outcome());
    // and the other way round it is known before the first step
    let away: Vec<(u32, DVec3)> = pins.iter().map(|&v| (v, start[v as usize])).collect();
    held.move_pins(&away).expect("pins");
    assert_eq!(held.outcome().hopeless.len(), 1);
    assert!(held.outcome().not_positive.is_empty());
    run(&mut held);
    assert_ne!(held.solver().status(), INJECTIVE);
}

#[test]
fn a_body_inside_another_is_not_apart() {
    let mut cells = block([0; 3], [3; 3], 1, 0);
    cells.extend(block([1; 3], [2; 3], 1, 1));
    // within one tetrahedron of the outer box, whose boundary it does not meet
    let rest = cubes(&cells, |at, part| match part {
        0 => point(at, 1),
        _ => DVec3::new(1.7, 1.5, 1.2) + 0.02 * point(at, 1),
    });
    for settle in [0.0, 1e-3] {
        let options = GiniOptions {
            settle,
            max_iterations: 3,
            ..GiniOptions::overlap()
        };
        let mut u =
            Untangling::of_solid(&rest, &rest.positions, &[], &[], Material::Arap, &options)
                .expect("no facets meet");
        assert_eq!(u.outcome().intersections, Some(0));
        assert_eq!(u.outcome().globally_injective, Some(false));
        assert_eq!(u.solver().status(), Status::Running);
        run(&mut u);
        assert_ne!(u.solver().status(), INJECTIVE);
    }
}

#[test]
fn neither_units_nor_threads_change_the_way() {
    let problem = interlocked_arms_in_the_plane(2);
    let states = |unit: f64, threads: usize| {
        let scaled = |points: &[DVec3]| points.iter().map(|p| unit * *p).collect::<Vec<_>>();
        let mut rest = problem.rest.clone();
        rest.positions = scaled(&rest.positions);
        let start = scaled(&problem.start);
        let go = || {
            let pins = &problem.pins;
            let made = Untangling::of_plane(&rest, &start, pins, &[], Material::Arap, &options());
            let mut u = made.expect("apart");
            let mut states = Vec::new();
            for pins in &problem.moves {
                let pins: Vec<(u32, DVec3)> = pins.iter().map(|&(v, p)| (v, unit * p)).collect();
                u.move_pins(&pins).expect("pins");
                while u.solver().status() == Status::Running {
                    u.step().expect("a step");
                    states.push(scaled(&u.positions()));
                }
            }
            states
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(go)
    };
    let one = states(1.0, 1);
    assert!(one.len() > 1);
    assert_eq!(one, states(1.0, 3));
    // powers of two leave nothing to rounding; states have been scaled once more
    let far = states(1024.0, 2);
    assert_eq!(one.len(), far.len());
    for (a, b) in one.iter().flatten().zip(far.iter().flatten()) {
        assert!(a.distance(*b / (1024.0 * 1024.0)) < 1e-9, "{a} and {b}");
    }
}
