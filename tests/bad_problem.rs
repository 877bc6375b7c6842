//! Problems that do not fit together and solver options out of range are errors, and never a panic.

use foldfree::energy::{Arap, SymmetricDirichlet};
use foldfree::geometry::RestShape;
use foldfree::local_global::ArapLocalGlobal;
use foldfree::mesh::SurfaceMesh;
use foldfree::optim::{BuildError, Solver};
use foldfree::space::Plane;
use foldfree::wrapd::{Linear, Problem, Reweighting, RotationAware, Wrapd, WrapdOptions};
use glam::DVec3;

/// A unit square in four triangles round vertex 4, stretched, as a problem for a solver.
fn problem() -> (RestShape, Vec<f64>) {
    let mesh = SurfaceMesh {
        positions: [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.5]]
            .map(|[x, y]| DVec3::new(x, y, 0.0))
            .to_vec(),
        simplices: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    };
    let rest = RestShape::of_surface(&mesh, 1.0).unwrap();
    let start = mesh
        .positions
        .iter()
        .flat_map(|p| [p.x, 1.1 * p.y])
        .collect();
    (rest, start)
}

/// The errors of all three solvers for a problem: the same.
fn solvers_refuse(problem: Problem) -> BuildError {
    let options = WrapdOptions::default();
    let errors = [
        Wrapd::new::<Plane, RotationAware, _>(problem, SymmetricDirichlet, options).err(),
        Wrapd::new::<Plane, Linear, _>(problem, Arap, options).err(),
        ArapLocalGlobal::<Plane>::new(problem, 1e-6, 10).err(),
    ];
    let [Some(error), second, third] = errors else {
        panic!("no error");
    };
    // by their words: NaN does not equal itself
    for other in [second, third] {
        assert_eq!(other.map(|e| e.to_string()), Some(error.to_string()));
    }
    error
}

#[test]
fn problems_whose_parts_do_not_fit() {
    let (rest, start) = problem();
    let good = Problem {
        rest: &rest,
        start: &start,
        pins: &[4],
        external: None,
    };
    assert!(Wrapd::new::<Plane, RotationAware, _>(good, Arap, WrapdOptions::default()).is_ok());

    let short = &start[..start.len() - 1];
    let error = solvers_refuse(Problem {
        start: short,
        ..good
    });
    assert_eq!(error.code(), "wrong-length");
    let error = solvers_refuse(Problem {
        start: &start[..6],
        ..good
    });
    assert_eq!(error.code(), "wrong-length");
    for pins in [&[][..], &[5], &[0, u32::MAX]] {
        let error = solvers_refuse(Problem { pins, ..good });
        assert!(matches!(
            error,
            BuildError::InvalidOption { option: "pins", .. }
        ));
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let mut start = start.clone();
        start[3] = bad;
        let error = solvers_refuse(Problem {
            start: &start,
            ..good
        });
        assert!(matches!(
            error,
            BuildError::InvalidOption {
                option: "start",
                ..
            }
        ));
    }
    // no elements: nothing holds the vertices together
    let empty = RestShape {
        stretches: 2,
        ..Default::default()
    };
    solvers_refuse(Problem {
        rest: &empty,
        ..good
    });
    // vertices of no element
    let mut lonely = start.clone();
    lonely.extend([7.0, 7.0]);
    solvers_refuse(Problem {
        start: &lonely,
        ..good
    });
    // rest shapes that are not
    let mut broken = rest.clone();
    broken.inverse.pop();
    solvers_refuse(Problem {
        rest: &broken,
        ..good
    });
    let mut broken = rest.clone();
    broken.measure[1] = f64::NAN;
    solvers_refuse(Problem {
        rest: &broken,
        ..good
    });
}

#[test]
fn everything_pinned() {
    let (rest, start) = problem();
    let pins = [0, 1, 2, 3, 4, 4];
    let problem = Problem {
        rest: &rest,
        start: &start,
        pins: &pins,
        external: None,
    };
    let options = WrapdOptions::default();
    let mut solver =
        Wrapd::new::<Plane, RotationAware, _>(problem, SymmetricDirichlet, options).unwrap();
    let energy = solver.report().energy;
    let report = solver.step().unwrap();
    assert_eq!(report.energy, energy);
    assert_eq!(solver.positions(), start);
    let mut solver = ArapLocalGlobal::<Plane>::new(problem, 1e-6, 10).unwrap();
    solver.step().unwrap();
    assert_eq!(solver.positions(), start);
}

#[test]
fn solver_options_out_of_range() {
    let base = WrapdOptions::default();
    let weights = Reweighting::PARAMETERIZATION;
    let with = |reweighting| WrapdOptions {
        reweighting: Some(reweighting),
        ..base
    };
    assert!(base.validate().is_ok() && with(weights).validate().is_ok());
    let mut bad = vec![
        WrapdOptions { history: 0, ..base },
        WrapdOptions {
            max_global_iterations: 0,
            ..base
        },
        with(Reweighting {
            least: 11.0,
            ..weights
        }),
        with(Reweighting {
            cap: 1.0,
            ..weights
        }),
    ];
    for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        bad.push(WrapdOptions {
            tolerance: number,
            ..base
        });
        bad.push(with(Reweighting {
            threshold: number.min(1.0),
            ..weights
        }));
        bad.push(with(Reweighting {
            least: number,
            ..weights
        }));
        bad.push(with(Reweighting {
            most: number,
            ..weights
        }));
        if number != f64::INFINITY {
            bad.push(with(Reweighting {
                growth: number,
                ..weights
            }));
            bad.push(with(Reweighting {
                cap: number,
                ..weights
            }));
        }
    }
    let (rest, start) = problem();
    let problem = Problem {
        rest: &rest,
        start: &start,
        pins: &[0],
        external: None,
    };
    for options in bad {
        assert!(options.validate().is_err(), "{options:?}");
        assert!(Wrapd::new::<Plane, Linear, _>(problem, Arap, options).is_err());
    }
}
