//! Tiny systems in which the pitfalls of integer constraints can be seen one by one.

mod miqp;

use foldfree::mixed_integer::{MixedIntegerError, Problem, Rounding};
use miqp::{ROUNDINGS, nearest, shared, solve};

/// The feasible point of least energy among all integers of a box.
fn best_in_box(problem: &Problem, reach: i32) -> Vec<f64> {
    let n = problem.unknowns();
    assert_eq!(problem.integers().len(), n, "integers only");
    let side = (2 * reach + 1) as usize;
    let mut best = (f64::INFINITY, Vec::new());
    for code in 0..side.pow(n as u32) {
        let digit = |k: usize| (code / side.pow(k as u32) % side) as i32 - reach;
        let x: Vec<f64> = (0..n).map(|k| f64::from(digit(k))).collect();
        if problem.violation(&x) == 0.0 && problem.energy(&x) < best.0 {
            best = (problem.energy(&x), x);
        }
    }
    best.1
}

#[track_caller]
fn all_find(problem: &Problem, expected: &[f64]) {
    assert_eq!(best_in_box(problem, 6), expected);
    for rounding in ROUNDINGS {
        let solver = solve(problem, rounding).expect("feasible");
        assert_eq!(solver.solution(), expected, "{rounding:?}");
        assert_eq!(solver.report().violation, 0.0);
    }
}

#[track_caller]
fn all_refuse(problem: &Problem, expected: &MixedIntegerError) {
    for rounding in ROUNDINGS {
        let error = solve(problem, rounding).err();
        assert_eq!(error.as_ref(), Some(expected), "{rounding:?}");
    }
}

fn infeasible(row: usize, constant: f64) -> MixedIntegerError {
    MixedIntegerError::Infeasible { row, constant }
}

#[test]
fn two_x_plus_three_y_is_one_without_a_coefficient_of_one() {
    let rows: [miqp::Row; 1] = [(&[(0, 2.0), (1, 3.0)], -1.0)];
    all_find(&nearest(&[0.3, 0.4], &rows, &[0, 1]), &[-1.0, 1.0]);
}

#[test]
fn six_ten_fifteen_have_no_common_divisor_though_each_two_have_one() {
    let rows: [miqp::Row; 1] = [(&[(0, 6.0), (1, 10.0), (2, 15.0)], -1.0)];
    all_find(
        &nearest(&[0.3, 0.4, 0.2], &rows, &[0, 1, 2]),
        &[1.0, 1.0, -1.0],
    );
}

#[test]
fn two_four_six_is_divided_by_two() {
    let rows: [miqp::Row; 1] = [(&[(0, 2.0), (1, 4.0), (2, 6.0)], -2.0)];
    all_find(
        &nearest(&[0.3, 0.4, 0.2], &rows, &[0, 1, 2]),
        &[1.0, 0.0, 0.0],
    );
}

#[test]
fn halves_as_coefficients_mean_whole_numbers() {
    let rows: [miqp::Row; 1] = [(&[(0, 0.5), (1, 0.5)], -1.0)];
    all_find(&nearest(&[0.3, 0.4], &rows, &[0, 1]), &[1.0, 1.0]);
}

#[test]
fn x_is_half_of_y_makes_y_even() {
    let rows: [miqp::Row; 1] = [(&[(0, 1.0), (1, -0.5)], 0.0)];
    all_find(&nearest(&[0.8, 1.1], &rows, &[0, 1]), &[1.0, 2.0]);
}

#[test]
fn a_third_and_a_seventh_have_a_common_measure() {
    // z/3 + w/7 = 1/21: 7 z + 3 w = 1
    let rows: [miqp::Row; 1] = [(&[(0, 1.0 / 3.0), (1, 1.0 / 7.0)], -1.0 / 21.0)];
    let problem = nearest(&[0.0, 0.0], &rows, &[0, 1]);
    let solver = solve(&problem, Rounding::Lattice).expect("feasible");
    assert_eq!(solver.solution(), [1.0, -2.0]);
}

#[test]
fn integer_rows_together_leave_a_sublattice() {
    // 2x + 3y + 5z = 4 and 3x + 5y + 7z = 6: one dimension, of steps (−4, 1, 1)
    let rows: [miqp::Row; 2] = [
        (&[(0, 2.0), (1, 3.0), (2, 5.0)], -4.0),
        (&[(0, 3.0), (1, 5.0), (2, 7.0)], -6.0),
    ];
    all_find(
        &nearest(&[0.3, 0.4, 0.2], &rows, &[0, 1, 2]),
        &[2.0, 0.0, 0.0],
    );
}

#[test]
fn an_integer_that_has_to_be_a_half_is_infeasible() {
    let rows: [miqp::Row; 1] = [(&[(0, 1.0)], -0.5)];
    all_refuse(&nearest(&[0.3], &rows, &[0]), &infeasible(0, -0.5));
}

#[test]
fn two_x_plus_four_y_is_three_has_real_solutions_only() {
    let rows: [miqp::Row; 1] = [(&[(0, 2.0), (1, 4.0)], -3.0)];
    all_refuse(&nearest(&[0.3, 0.4], &rows, &[0, 1]), &infeasible(0, -1.5));
    // with a real unknown in it there is nothing wrong
    let real = nearest(&[0.3, 0.4], &rows, &[0]);
    assert!(solve(&real, Rounding::Greedy).is_ok());
}

#[test]
fn rows_that_are_feasible_each_but_not_together() {
    // x + y = 1, x − y = 0: x = y = ½
    let rows: [miqp::Row; 2] = [(&[(0, 1.0), (1, 1.0)], -1.0), (&[(0, 1.0), (1, -1.0)], 0.0)];
    let error = solve(&nearest(&[0.3, 0.4], &rows, &[0, 1]), Rounding::Lattice).err();
    let is_half = |c: f64| c.abs() == 0.5;
    assert!(
        matches!(error, Some(MixedIntegerError::Infeasible { row: 1, constant }) if is_half(constant)),
        "{error:?}"
    );
}

#[test]
fn parity_through_a_real_unknown_is_seen() {
    // x − z/2 = 0 and x + w/2 = 1/4 with x real: z + w = 1/2 for integers
    let rows: [miqp::Row; 2] = [
        (&[(0, 1.0), (1, -0.5)], 0.0),
        (&[(0, 1.0), (2, 0.5)], -0.25),
    ];
    let error = solve(&nearest(&[0.0; 3], &rows, &[1, 2]), Rounding::Greedy).err();
    let code = error.map(|e| e.code());
    assert_eq!(code, Some("infeasible-row"));
}

#[test]
fn a_multiple_of_a_row_is_redundant() {
    let rows: [miqp::Row; 2] = [(&[(0, 1.0), (1, 1.0)], -1.0), (&[(0, 2.0), (1, 2.0)], -2.0)];
    let solver = solve(&nearest(&[0.3, 0.4], &rows, &[0]), Rounding::Greedy).expect("feasible");
    assert_eq!(solver.report().redundant_rows, [1]);
    assert_eq!(solver.solution(), [0.0, 1.0]);
}

#[test]
fn an_empty_row_is_redundant_or_contradictory() {
    let empty: miqp::Row = (&[], 0.0);
    let solver = solve(&nearest(&[0.3], &[empty], &[0]), Rounding::Greedy).expect("feasible");
    assert_eq!(solver.report().redundant_rows, [0]);
    let one: miqp::Row = (&[(0, 0.0)], 1.0);
    let expected = MixedIntegerError::Contradictory {
        row: 0,
        residual: 1.0,
    };
    all_refuse(&nearest(&[0.3], &[one], &[0]), &expected);
}

#[test]
fn the_same_sum_cannot_be_one_and_two() {
    let rows: [miqp::Row; 2] = [(&[(0, 1.0), (1, 1.0)], -1.0), (&[(0, 1.0), (1, 1.0)], -2.0)];
    for integers in [&[][..], &[0], &[0, 1]] {
        let expected = MixedIntegerError::Contradictory {
            row: 1,
            residual: -1.0,
        };
        all_refuse(&nearest(&[0.3, 0.4], &rows, integers), &expected);
    }
}

#[test]
fn root_two_and_one_have_no_common_measure() {
    let rows: [miqp::Row; 1] = [(&[(0, 1.0), (1, 2f64.sqrt())], 0.0)];
    let problem = nearest(&[0.3, 0.4], &rows, &[0, 1]);
    all_refuse(&problem, &MixedIntegerError::NotRational { row: 0 });
}

#[test]
fn a_tie_goes_the_same_way_whatever_the_last_bit() {
    for noise in [0.0, 1e-13, -1e-13] {
        let problem = nearest(&[0.5 + noise, -0.5 - noise], &[], &[0, 1]);
        for rounding in [Rounding::Direct, Rounding::Greedy, Rounding::TwoOpt] {
            let solver = solve(&problem, rounding).expect("feasible");
            assert_eq!(solver.solution(), [1.0, 0.0], "{rounding:?} {noise}");
        }
    }
}

#[test]
fn nothing_at_all_is_solved() {
    let empty = nearest(&[], &[], &[]);
    for rounding in ROUNDINGS {
        let solver = solve(&empty, rounding).expect("nothing to do");
        assert_eq!(solver.report().energy, 0.0);
        let no_integer = solve(&nearest(&[0.3], &[], &[]), rounding).expect("real");
        assert_eq!(no_integer.solution(), [0.3]);
        assert_eq!(no_integer.report().proven, rounding == Rounding::Lattice);
    }
}

#[test]
fn the_shared_tiny_systems_give_the_right_answer_or_name_the_row() {
    let answers: [(&str, Result<&[f64], &str>); 10] = [
        ("gcd23", Ok(&[-1.0, 1.0])),
        ("gcd246", Ok(&[1.0, 0.0, 0.0])),
        ("gcd6_10_15", Ok(&[1.0, 1.0, -1.0])),
        ("realcoef", Ok(&[1.0, 1.0])),
        ("mixhalf", Ok(&[0.0, 0.0])),
        ("tie", Ok(&[1.0, 0.0])),
        ("dup", Ok(&[0.0, 1.0])),
        ("half", Err("constraint row 0 has no integer solution")),
        ("infeas24", Err("constraint row 0 has no integer solution")),
        ("contradict", Err("constraint row 1 contradicts")),
    ];
    for (name, expected) in answers {
        let Some(problem) = shared(name) else { return };
        match (solve(&problem, Rounding::TwoOpt), expected) {
            (Ok(solver), Ok(x)) => assert_eq!(solver.solution(), x, "{name}"),
            (Err(error), Err(start)) => assert!(error.to_string().starts_with(start), "{error}"),
            (solved, _) => panic!("{name}: {:?}", solved.map(|s| s.solution().to_vec())),
        }
    }
}
