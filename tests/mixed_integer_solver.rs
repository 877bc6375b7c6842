//! The solver on systems like those it is for: residuals, levels, steps, cancelling, other right-hand
//! sides, and what must not change the result.

mod miqp;

use foldfree::mixed_integer::{
    Action, Engine, Level, MixedInteger, MixedIntegerOptions, Problem, Rounding,
};
use foldfree::optim::{CancelToken, Status};
use miqp::{ROUNDINGS, field, options, shared, solve, solve_with, torus};

/// Integers exact, rows kept to 1e-9, and the reals at their best: the gradient is a combination of rows.
#[track_caller]
fn is_sound(solver: &MixedInteger) {
    let (problem, report) = (solver.problem(), solver.report());
    assert!(report.feasible && report.violation < 1e-9, "{report:?}");
    let x = solver.solution();
    assert!(
        problem
            .integers()
            .iter()
            .all(|&i| x[i as usize].fract() == 0.0)
    );
    assert!(problem.violation(x) < 1e-9);
    assert!((problem.energy(x) - report.energy).abs() <= 1e-12 * report.energy.abs().max(1.0));
    assert!(report.energy >= report.relaxed_energy - 1e-9);
    // with the integers held as they are, nothing better is found
    let mut held = Problem::builder(problem.unknowns()).linear(problem.linear());
    for (i, j, &a) in problem.matrix().triplet_iter() {
        held.push_quadratic(i as u32, j as u32, a);
        if i != j {
            held.push_quadratic(j as u32, i as u32, a);
        }
    }
    for row in 0..problem.rows() {
        held.push_constraint(problem.row(row), problem.constants()[row]);
    }
    for &i in problem.integers() {
        held.push_constraint(&[(i, 1.0)], -x[i as usize]);
    }
    let held = solve(&held.build().expect("a problem"), Rounding::Direct).expect("feasible");
    let (best, scale) = (held.report().energy, report.energy.abs().max(1.0));
    assert!(
        (best - report.energy).abs() < 1e-9 * scale,
        "{best} {}",
        report.energy
    );
}

fn three_level() -> MixedIntegerOptions {
    MixedIntegerOptions {
        engine: Engine::ThreeLevel,
        ..MixedIntegerOptions::default()
    }
}

#[test]
fn every_rounding_gives_integers_constraints_and_the_best_reals() {
    let problem = torus(20, 4);
    let mut gaps = Vec::new();
    for rounding in ROUNDINGS {
        let solver = solve(&problem, rounding).expect("feasible");
        is_sound(&solver);
        let report = solver.report();
        gaps.push(report.energy - report.relaxed_energy);
    }
    assert!(
        gaps[2] <= gaps[1] + 1e-9 && gaps[3] <= gaps[2] + 1e-9,
        "{gaps:?}"
    );
    is_sound(&solve_with(&problem, three_level()).expect("feasible"));
    let direct = MixedIntegerOptions {
        rounding: Rounding::Direct,
        ..three_level()
    };
    let direct = solve_with(&problem, direct).expect("feasible");
    is_sound(&direct);
    let gap = direct.report().energy - direct.report().relaxed_energy;
    assert!(
        (gap - gaps[0]).abs() < 1e-9,
        "both engines round alike: {gap} {gaps:?}"
    );
}

#[test]
fn each_level_can_be_switched_off_and_is_counted() {
    let problem = field(24);
    let base = three_level();
    let one = |gauss_seidel, conjugate_gradients, cholesky| {
        let options = MixedIntegerOptions {
            gauss_seidel,
            conjugate_gradients,
            cholesky,
            ..base.clone()
        };
        let solver = solve_with(&problem, options).expect("feasible");
        is_sound(&solver);
        (solver.report().levels, solver.report().energy)
    };
    let (all, e_all) = one(100_000, 50, true);
    assert!(
        all.gauss_seidel > 0 && all.none == 0 && all.dense == 0,
        "{all:?}"
    );
    let (gradients, e_gradients) = one(0, 50, true);
    assert!(
        gradients.gauss_seidel == 0 && gradients.pops == 0,
        "{gradients:?}"
    );
    assert!(
        gradients.conjugate_gradients > 0 && gradients.iterations > 0,
        "{gradients:?}"
    );
    let (cholesky, e_cholesky) = one(0, 0, true);
    assert!(
        cholesky.gauss_seidel + cholesky.conjugate_gradients <= 1,
        "{cholesky:?}"
    );
    assert!(
        cholesky.cholesky > 0 && cholesky.iterations == 0,
        "{cholesky:?}"
    );
    let (lazy, _) = one(3, 0, false);
    assert!(lazy.none > 0 && lazy.pops > 0, "{lazy:?}");
    // all are approximations of the same greedy rounding
    for e in [e_gradients, e_cholesky] {
        assert!(
            (e - e_all).abs() < 0.05 * e_all.abs(),
            "{e_all} {e_gradients} {e_cholesky}"
        );
    }
}

#[test]
fn many_local_integers_greedy_is_far_better_than_direct() {
    let problem = field(24);
    let gap = |rounding, engine| {
        let options = MixedIntegerOptions {
            rounding,
            engine,
            ..MixedIntegerOptions::default()
        };
        let solver = solve_with(&problem, options).expect("feasible");
        assert_eq!(solver.report().reduced_integers, 23 * 23);
        solver.report().energy - solver.report().relaxed_energy
    };
    let greedy = gap(Rounding::Greedy, Engine::Automatic);
    let exact = gap(Rounding::Greedy, Engine::Dense);
    let direct = gap(Rounding::Direct, Engine::Automatic);
    assert!(greedy < 0.9 * direct, "greedy {greedy}, direct {direct}");
    assert!(
        (greedy - exact).abs() < 0.1 * exact,
        "greedy {greedy}, exact {exact}"
    );
}

#[test]
fn steps_say_which_integer_became_what_and_how_far_it_was_felt() {
    let problem = torus(12, 3);
    for (options, dense) in [(options(Rounding::Greedy), true), (three_level(), false)] {
        let mut solver = MixedInteger::new(problem.clone(), options).expect("feasible");
        let start = solver.last_step().clone();
        assert_eq!((start.iteration, start.action), (0, Action::Relax));
        assert_eq!(start.remaining, solver.report().reduced_integers);
        let mut energy = start.energy;
        let mut seen = Vec::new();
        while solver.status() == Status::Running {
            let step = solver.step().expect("a step").clone();
            let Action::Round { rounded, level, .. } = &step.action else {
                panic!("{step:?}");
            };
            assert_eq!(dense, *level == Level::Dense);
            assert!(!rounded.is_empty());
            assert!(
                step.energy >= energy - 1e-2,
                "{} after {energy}",
                step.energy
            );
            energy = step.energy;
            seen.extend(rounded.iter().map(|r| (r.unknown, r.to)));
            let x = solver.iterate();
            assert!(
                seen.iter()
                    .all(|&(i, to)| (x[i as usize] - to).abs() < 1e-9)
            );
        }
        assert_eq!(seen.len(), start.remaining);
        assert_eq!(solver.last_step().remaining, 0);
        // nothing happens any more
        let last = solver.last_step().clone();
        assert_eq!(solver.step().expect("no step"), &last);
    }
}

#[test]
fn lattice_steps_reduce_then_enumerate_and_a_limit_leaves_a_gap() {
    let problem = torus(12, 8);
    let proven = solve(&problem, Rounding::Lattice).expect("feasible");
    let full = proven.report().clone();
    assert!(
        full.proven && full.exchanges > 0 && full.nodes > 16,
        "{full:?}"
    );
    let bound = full.lower_bound.expect("lattice");
    assert!(
        bound <= full.energy && full.energy - bound < 1e-4,
        "{full:?}"
    );
    let limited = MixedIntegerOptions {
        nodes: 1,
        ..options(Rounding::Lattice)
    };
    let limited = solve_with(&problem, limited).expect("feasible");
    assert_eq!(limited.status(), Status::MaxIterations);
    is_sound(&limited);
    let report = limited.report();
    assert!(!report.proven && report.energy >= full.energy - 1e-9);
    assert!(
        report.lower_bound.expect("lattice") <= full.energy,
        "{report:?}"
    );
}

#[test]
fn cancelling_stops_between_steps_and_can_go_on() {
    let problem = torus(12, 4);
    let expected = solve(&problem, Rounding::Greedy).expect("feasible");
    let mut solver = MixedInteger::new(problem, options(Rounding::Greedy)).expect("feasible");
    let cancel = CancelToken::default();
    let status = solver
        .run(
            |step| {
                if step.iteration == 2 {
                    cancel.cancel();
                }
            },
            &cancel,
        )
        .expect("no error");
    assert_eq!(status, Status::Cancelled);
    assert_eq!(
        (solver.last_step().iteration, solver.status()),
        (2, Status::Running)
    );
    assert!(!solver.report().feasible);
    solver
        .run(|_| {}, &CancelToken::default())
        .expect("no error");
    assert_eq!(solver.solution(), expected.solution());
}

#[test]
fn resolving_is_the_same_as_solving_anew() {
    let problem = torus(12, 4);
    let linear: Vec<f64> = problem.linear().iter().map(|b| 1.3 * b).collect();
    let mut constants = problem.constants().to_vec();
    constants[0] = -0.375;
    let mut other = problem.clone();
    other
        .replace(Some(&linear), Some(&constants))
        .expect("lengths fit");
    let engines = [Engine::Dense, Engine::ThreeLevel];
    for (rounding, engine) in ROUNDINGS
        .map(|r| (r, engines[0]))
        .into_iter()
        .chain([(Rounding::Greedy, engines[1])])
    {
        let options = MixedIntegerOptions {
            engine,
            ..options(rounding)
        };
        let mut solver = solve_with(&problem, options.clone()).expect("feasible");
        let first = solver.solution().to_vec();
        solver
            .resolve(Some(&linear), Some(&constants))
            .expect("feasible");
        assert_eq!(
            (solver.status(), solver.report().nodes),
            (Status::Running, 0)
        );
        solver
            .run(|_| {}, &CancelToken::default())
            .expect("no error");
        is_sound(&solver);
        let anew = solve_with(&other, options).expect("feasible");
        let difference = |a: &[f64], b: &[f64]| {
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)
        };
        assert!(
            difference(solver.solution(), anew.solution()) < 1e-9,
            "{rounding:?}"
        );
        assert!(difference(solver.solution(), &first) > 0.1);
        // and back again
        solver
            .resolve(Some(problem.linear()), Some(problem.constants()))
            .expect("feasible");
        solver
            .run(|_| {}, &CancelToken::default())
            .expect("no error");
        assert!(difference(solver.solution(), &first) < 1e-9, "{rounding:?}");
    }
}

#[test]
fn resolving_with_constants_that_cannot_be_names_the_row_and_changes_nothing() {
    let rows: [miqp::Row; 2] = [
        (&[(0, 2.0), (1, 4.0)], -2.0),
        (&[(0, 1.0), (1, 2.0), (2, 1.0)], 0.5),
    ];
    let problem = miqp::nearest(&[0.3, 0.4, 0.1], &rows, &[0, 1]);
    let mut solver = solve(&problem, Rounding::Greedy).expect("feasible");
    let before = solver.solution().to_vec();
    let error = solver
        .resolve(None, Some(&[-3.0, 0.5]))
        .err()
        .map(|e| e.code());
    assert_eq!(error, Some("infeasible-row"));
    assert_eq!(
        solver.resolve(None, Some(&[1.0])).err().map(|e| e.code()),
        Some("wrong-length")
    );
    let nan = solver
        .resolve(Some(&[0.0, f64::NAN, 0.0]), None)
        .err()
        .map(|e| e.code());
    assert_eq!(nan, Some("non-finite"));
    assert_eq!(solver.solution(), before);
    solver.resolve(None, Some(&[-4.0, 0.5])).expect("feasible");
    solver
        .run(|_| {}, &CancelToken::default())
        .expect("no error");
    is_sound(&solver);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let problem = torus(40, 6);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let all = ROUNDINGS.map(options).into_iter().chain([three_level()]);
            let bits = |o| -> Vec<u64> {
                let solver = solve_with(&problem, o).expect("feasible");
                solver.solution().iter().map(|x| x.to_bits()).collect()
            };
            all.map(bits).collect::<Vec<_>>()
        })
    };
    let one = run(1);
    for threads in [2, 3] {
        assert!(run(threads) == one, "{threads} threads");
    }
}

/// The problem with the energy multiplied, rows multiplied each by its own factor, and unknowns numbered
/// backwards.
fn changed(problem: &Problem, energy: f64, rows: f64, backwards: bool) -> Problem {
    let n = problem.unknowns() as u32;
    let number = |i: u32| if backwards { n - 1 - i } else { i };
    let mut linear = vec![0.0; n as usize];
    for (i, b) in (0..).zip(problem.linear()) {
        linear[number(i) as usize] = energy * b;
    }
    let mut builder = Problem::builder(n as usize).linear(&linear);
    for (i, j, &a) in problem.matrix().triplet_iter() {
        let (p, q) = (number(i as u32), number(j as u32));
        builder.push_quadratic(p, q, energy * a);
        if p != q {
            builder.push_quadratic(q, p, energy * a);
        }
    }
    for row in 0..problem.rows() {
        let factor = rows * (1.0 + (row % 3) as f64);
        let terms = problem.row(row).iter();
        let terms: Vec<(u32, f64)> = terms.map(|&(i, a)| (number(i), factor * a)).collect();
        builder.push_constraint(&terms, factor * problem.constants()[row]);
    }
    let integers: Vec<u32> = problem.integers().iter().map(|&i| number(i)).collect();
    builder.integers(&integers).build().expect("a problem")
}

#[test]
fn units_of_the_energy_and_of_the_rows_change_nothing() {
    let problem = torus(16, 5);
    for rounding in ROUNDINGS {
        let expected = solve(&problem, rounding).expect("feasible");
        for (energy, rows) in [(1e12, 1.0), (1e-12, 1.0), (1.0, 1e6), (3.7, 1e-6)] {
            let solver =
                solve(&changed(&problem, energy, rows, false), rounding).expect("feasible");
            for (a, b) in solver.solution().iter().zip(expected.solution()) {
                assert!(
                    (a - b).abs() < 1e-8,
                    "{rounding:?} {energy} {rows}: {a} {b}"
                );
            }
        }
    }
}

#[test]
fn the_optimum_does_not_depend_on_the_numbers_of_unknowns() {
    let problem = torus(16, 5);
    let optimum = solve(&problem, Rounding::Lattice).expect("feasible");
    let reversed = solve(&changed(&problem, 1.0, 1.0, true), Rounding::Lattice).expect("feasible");
    let (a, b) = (optimum.report().energy, reversed.report().energy);
    assert!((a - b).abs() < 1e-9 * a.abs().max(1.0), "{a} {b}");
    assert!(reversed.report().proven);
}

#[test]
fn the_order_of_rows_changes_the_pattern_and_not_the_solution() {
    let problem = torus(16, 5);
    let unordered = MixedIntegerOptions {
        reorder: false,
        ..options(Rounding::Lattice)
    };
    let ordered = solve(&problem, Rounding::Lattice).expect("feasible");
    let unordered = solve_with(&problem, unordered).expect("feasible");
    let (a, b) = (ordered.report(), unordered.report());
    assert!((a.energy - b.energy).abs() < 1e-9, "{a:?} {b:?}");
    assert!(a.reduced_entries <= b.reduced_entries, "{a:?} {b:?}");
}

/// The figures of the two systems of the reference, where the folder is there.
#[test]
fn dumped_parametrizations_reach_the_known_optima() {
    let known = [
        ("torus_4k", 12, 0.77, 0.7323),
        ("double_torus", 44, 3.8, 2.905),
    ];
    for (name, integers, two_opt, optimum) in known {
        let Some(problem) = shared(name) else { return };
        let gap = |solver: &MixedInteger| solver.report().energy - solver.report().relaxed_energy;
        let polished = solve(&problem, Rounding::TwoOpt).expect("feasible");
        is_sound(&polished);
        assert!(gap(&polished) <= two_opt, "{name}: {}", gap(&polished));
        let lattice = solve(&problem, Rounding::Lattice).expect("feasible");
        is_sound(&lattice);
        let report = lattice.report();
        assert_eq!(report.reduced_integers, integers);
        assert!(
            report.proven && (gap(&lattice) - optimum).abs() < 5e-4,
            "{name}: {}",
            gap(&lattice)
        );
        let bound = report.lower_bound.expect("proven");
        assert!(report.energy - bound < 1e-4, "{name}: {bound}");
    }
}

/// Rows of two unknowns are solved first, longer ones rewritten once: with integers and reals, factors, both
/// signs, closed chains, a constant at the end of one, and other constants afterwards.
#[test]
fn chains_of_pairs_in_longer_rows_are_what_elimination_row_by_row_makes_of_them() {
    let goal: Vec<f64> = (0..14).map(|i| (f64::from(i) * 1.7).sin() * 3.0).collect();
    let rows: [miqp::Row; 10] = [
        (&[(0, 1.0), (3, 1.0), (5, -1.0), (8, 2.0), (12, 1.0)], -1.0),
        (&[(0, 1.0), (1, 1.0)], 1.0),
        (&[(1, 2.0), (2, -2.0)], 4.0),
        (&[(2, -1.0), (3, 1.0)], 0.0),
        (&[(0, 1.0), (3, 1.0)], -1.0),
        (&[(4, 3.0), (5, 1.5)], -6.0),
        (&[(5, 1.0), (6, 4.0)], 2.0),
        (&[(7, 1.0), (8, -1.0)], 5.0),
        (&[(9, 2.0)], 3.0),
        (
            &[(4, 1.0), (9, 1.0), (10, 0.5), (11, -1.0), (13, 1.0)],
            0.25,
        ),
    ];
    let problem = miqp::nearest(&goal, &rows, &[0, 1, 2, 3, 6, 7, 8]);
    let by_row = MixedIntegerOptions {
        reorder: false,
        ..options(Rounding::Lattice)
    };
    let mut pairs = solve(&problem, Rounding::Lattice).expect("feasible");
    let mut by_row = solve_with(&problem, by_row).expect("feasible");
    let mut constants = problem.constants().to_vec();
    for round in 0..3 {
        is_sound(&pairs);
        let (a, b) = (pairs.solution(), by_row.solution());
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-9, "{round}: {a} {b}");
        }
        assert_eq!(pairs.report().redundant_rows.len(), 1);
        constants[2] += 2.0;
        constants[4] -= 1.0;
        constants[5] += 0.7;
        constants[8] -= 1.0;
        for solver in [&mut pairs, &mut by_row] {
            solver.resolve(None, Some(&constants)).expect("feasible");
            solver
                .run(|_| {}, &CancelToken::default())
                .expect("positive definite");
        }
    }
    // a closed chain that does not close
    constants[4] += 1.0;
    assert!(pairs.resolve(None, Some(&constants)).is_err());
}
