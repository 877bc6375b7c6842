//! Bad problems and bad files: typed errors that name the place.

mod miqp;

use foldfree::mixed_integer::{
    Engine, MixedInteger, MixedIntegerError as Error, MixedIntegerOptions, Problem, Rounding,
};
use miqp::{nearest, solve, solve_with};

fn refused(text: &str) -> (usize, String) {
    match Problem::from_sys(text.as_bytes()) {
        Err(Error::Parse { line, what }) => (line, what),
        other => panic!("{text:?}: {other:?}"),
    }
}

const GOOD: &str = "2 1 1 2 3\n0 0 1\n1 1 1\n0.3 0.4\n0 0 2\n0 1 3\n0 2 -1\n0\n";

#[test]
fn a_file_is_read_as_it_is_meant() {
    let problem = Problem::from_sys(GOOD.as_bytes()).expect("good");
    assert_eq!((problem.unknowns(), problem.rows()), (2, 1));
    assert_eq!(problem.row(0), [(0, 2.0), (1, 3.0)]);
    assert_eq!(
        (problem.constants(), problem.integers()),
        (&[-1.0][..], &[0][..])
    );
    assert_eq!(problem.linear(), [0.3, 0.4]);
    assert!((problem.energy(&[1.0, 2.0]) - 1.4).abs() < 1e-15);
    // line ends are blanks like others
    let windows = GOOD.replace('\n', "\r\n");
    assert!(Problem::from_sys(windows.as_bytes()).is_ok());
}

#[test]
fn damaged_files_name_the_line() {
    let cases: [(&str, &str, usize, &str); 12] = [
        ("", "", 1, "the file ends where the number of unknowns"),
        ("2 1 1 2 3", "2 1 1 2 3 ", 8, "nothing"),
        ("2 1 1 2 3", "2 1 1 2 -3", 1, "expected a whole number"),
        ("2 1 1 2 3", "2 1 1 2 4000000000", 1, "claim at least"),
        ("2 1 1 2 3", "4000000000 1 1 2 3", 1, "claim at least"),
        ("2 1 1 2 3", "2 4000000000 1 2 3", 1, "claim at least"),
        ("1 1 1", "1 2 1", 3, "the column of a matrix entry is 2"),
        ("0.3 0.4", "0.3 nan", 4, "not finite"),
        (
            "0.3 0.4",
            "0.3 four",
            4,
            "expected a number, found \"four\"",
        ),
        (
            "0 1 3",
            "1 1 3",
            6,
            "the row of a coefficient is 1, expected less than 1",
        ),
        ("-1\n0\n", "-1\n2\n", 8, "an integer unknown is 2"),
        ("-1\n0\n", "-1\n0 7\n", 8, "behind the end"),
    ];
    for (from, to, line, what) in cases {
        let text = if from.is_empty() {
            String::new()
        } else {
            GOOD.replacen(from, to, 1)
        };
        if what == "nothing" {
            assert!(Problem::from_sys(text.as_bytes()).is_ok());
            continue;
        }
        let (at, said) = refused(&text);
        assert!(
            at == line && said.contains(what),
            "{text:?}: line {at}: {said}"
        );
    }
    let twice = GOOD
        .replacen("2 1 1", "2 1 2", 1)
        .replace("-1\n0\n", "-1\n0\n0\n");
    let (line, said) = refused(&twice);
    assert!(line == 9 && said.contains("twice"), "{line}: {said}");
    // wherever a file ends, it is said or it is whole
    for end in 0..GOOD.len() - 2 {
        let (line, said) = refused(&GOOD[..end]);
        assert!((1..=8).contains(&line), "{end}: {line} {said}");
    }
    for byte in [0u8, 0xff, b'-', b'e', b'9'] {
        for at in 0..GOOD.len() {
            let mut bytes = GOOD.as_bytes().to_vec();
            bytes[at] = byte;
            // an answer or an error, never a panic
            if let Ok(problem) = Problem::from_sys(&bytes) {
                let _ = solve(&problem, Rounding::Lattice);
            }
        }
    }
}

#[test]
fn what_is_given_to_the_builder_is_checked() {
    let build = |b: foldfree::mixed_integer::ProblemBuilder| b.build().expect_err("bad");
    let out = |item, position, index| Error::IndexOutOfRange {
        item,
        position,
        index,
        unknowns: 2,
    };
    let two = || Problem::builder(2);
    assert_eq!(build(two().quadratic(0, 2, 1.0)), out("matrix entry", 0, 2));
    assert_eq!(build(two().integer(7)), out("integer", 0, 7));
    let row = two()
        .constraint(&[(0, 1.0)], 0.0)
        .constraint(&[(5, 1.0)], 0.0);
    assert_eq!(build(row), out("constraint row", 1, 5));
    let length = Error::WrongLength {
        argument: "linear",
        expected: 2,
        found: 3,
    };
    assert_eq!(build(two().linear(&[1.0; 3])), length);
    let position = 1;
    let item = "linear";
    assert_eq!(
        build(two().linear(&[1.0, f64::NAN])),
        Error::NonFinite { item, position }
    );
    let entry = build(two().quadratic(0, 0, 1.0).quadratic(1, 1, f64::INFINITY));
    assert_eq!(entry.to_string(), "matrix entry 1 is not finite");
    let coefficient = build(two().constraint(&[(0, f64::NAN)], 0.0));
    assert_eq!(
        coefficient.to_string(),
        "a coefficient of constraint row 0 is not finite"
    );
    let constant = build(two().constraint(&[(0, 1.0)], f64::NAN));
    assert_eq!(constant.code(), "non-finite");
    assert_eq!(
        build(two().integers(&[1, 0, 1])),
        Error::IntegerTwice { index: 1 }
    );
    let skew = two()
        .quadratic(0, 0, 1.0)
        .quadratic(1, 1, 1.0)
        .quadratic(1, 0, 0.5);
    let expected = Error::NotSymmetric {
        row: 1,
        column: 0,
        value: 0.5,
        mirrored: 0.0,
    };
    assert_eq!(build(skew), expected);
}

#[test]
fn a_matrix_that_is_not_positive_definite_names_an_unknown() {
    // unknown 1 costs nothing
    let problem = Problem::builder(3)
        .quadratic(0, 0, 1.0)
        .quadratic(2, 2, 1.0)
        .integer(2)
        .build()
        .expect("a problem");
    for engine in [Engine::Dense, Engine::ThreeLevel] {
        let options = MixedIntegerOptions {
            engine,
            ..MixedIntegerOptions::default()
        };
        let error = MixedInteger::new(problem.clone(), options).err();
        assert_eq!(error, Some(Error::NotPositiveDefinite { pivot: 1 }));
    }
    // a pivot that only rounding keeps from 0
    let third = 1.0 / 3.0;
    let flat = Problem::builder(2)
        .quadratics(
            &[0, 0, 1, 1],
            &[0, 1, 0, 1],
            &[1.0, third, third, third * third],
        )
        .build()
        .expect("a problem");
    let error = solve(&flat, Rounding::Greedy).err();
    assert_eq!(error.map(|e| e.code()), Some("not-positive-definite"));
    // definite where the constraints hold is enough
    let saddle = Problem::builder(2)
        .quadratic(0, 0, 1.0)
        .quadratic(1, 1, -0.5)
        .linear(&[0.4, 0.0])
        .constraint(&[(1, 1.0)], -3.0)
        .integers(&[0, 1])
        .build()
        .expect("a problem");
    let solver = solve(&saddle, Rounding::Lattice).expect("a minimum");
    assert_eq!(solver.solution(), [0.0, 3.0]);
}

#[test]
fn options_are_checked() {
    let problem = nearest(&[0.3], &[], &[0]);
    let default = MixedIntegerOptions::default;
    let cases = [
        (
            MixedIntegerOptions {
                tolerance: f64::NAN,
                ..default()
            },
            "tolerance",
        ),
        (
            MixedIntegerOptions {
                residual: 0.0,
                ..default()
            },
            "residual",
        ),
        (
            MixedIntegerOptions {
                budget: Some(0.7),
                ..default()
            },
            "budget",
        ),
        (
            MixedIntegerOptions {
                gauss_seidel: 0,
                conjugate_gradients: 0,
                cholesky: false,
                ..default()
            },
            "cholesky",
        ),
        (
            MixedIntegerOptions {
                engine: Engine::ThreeLevel,
                rounding: Rounding::Lattice,
                ..default()
            },
            "engine",
        ),
    ];
    for (options, name) in cases {
        match solve_with(&problem, options).err() {
            Some(Error::InvalidOption { option, .. }) => assert_eq!(option, name),
            other => panic!("{name}: {other:?}"),
        }
    }
}

#[test]
fn too_many_integers_for_the_dense_engine_are_refused() {
    let n = 2001;
    let problem = nearest(&vec![0.3; n], &[], &(0..n as u32).collect::<Vec<_>>());
    let error = solve(&problem, Rounding::Lattice).err();
    assert_eq!(
        error,
        Some(Error::TooManyIntegers {
            count: n,
            limit: 2000
        })
    );
    let greedy = solve(&problem, Rounding::Greedy).expect("any number");
    assert!(greedy.solution().iter().all(|&x| x == 0.0));
}

#[test]
fn integer_coefficients_that_outgrow_double_precision_are_refused() {
    // each row makes coefficients of the next grow by 1e5 or so
    let n = 12u32;
    let rows: Vec<(Vec<(u32, f64)>, f64)> = (0..n - 1)
        .map(|i| (vec![(i, 99991.0), (i + 1, 65537.0), (n, 2.0)], 0.0))
        .collect();
    let rows: Vec<miqp::Row> = rows
        .iter()
        .map(|(terms, c)| (terms.as_slice(), *c))
        .collect();
    let integers: Vec<u32> = (0..=n).collect();
    let problem = nearest(&vec![0.3; n as usize + 1], &rows, &integers);
    let error = solve(&problem, Rounding::Greedy).err().map(|e| e.code());
    assert!(
        matches!(error, Some("coefficients-too-large" | "not-rational-row")),
        "{error:?}"
    );
}
