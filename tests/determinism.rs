//! The same bits whatever the number of threads.
#![cfg(feature = "parallel")]

mod flattening;

use flattening::{Run, from};
use foldfree::mesh::{Shape, SurfaceMesh, generate};
use foldfree::optim::{CancelToken, Solver, StepReport, run};
use foldfree::parameterization::{Method, Parameterization, ParameterizationOptions, Start};

/// What a run leaves: the bits of every position and of every number reported but times.
fn fingerprint(reports: &[StepReport], p: &Parameterization) -> Vec<u64> {
    let of_report = |r: &StepReport| {
        [
            r.iteration as u64,
            r.energy.to_bits(),
            r.inverted as u64,
            r.gradient_norm.to_bits(),
            r.smallest_sigma.to_bits(),
            r.largest_sigma.to_bits(),
            r.lbfgs_iterations as u64,
            u64::from(r.reweighted),
        ]
    };
    let positions = p.solver().positions().iter().map(|x| x.to_bits());
    let inspection = p.solver().inspect();
    let fields = inspection.distortion.iter().chain(&inspection.weights);
    reports
        .iter()
        .flat_map(of_report)
        .chain(positions)
        .chain(fields.map(|f| u64::from(f.to_bits())))
        .collect()
}

fn with_threads(
    threads: usize,
    mesh: &SurfaceMesh,
    options: &ParameterizationOptions,
    steps: usize,
) -> Vec<u64> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let run = Run::new(mesh, options).steps(steps);
        fingerprint(&run.reports, &run.parameterization)
    })
}

/// From less than one block of elements to several, none a multiple of a block.
const SIZES: [usize; 4] = [60, 500, 1_700, 5_500];

fn same_bits(method: Method, start: Start, steps: usize) {
    for size in SIZES {
        let mesh = generate(Shape::BumpyCap, size);
        assert_ne!(mesh.simplices.len() % 512, 0);
        let options = from(start, method);
        let one = with_threads(1, &mesh, &options, steps);
        for threads in [1, 2, 3] {
            let other = with_threads(threads, &mesh, &options, steps);
            let first = one.iter().zip(&other).position(|(a, b)| a != b);
            assert_eq!(
                first, None,
                "{method:?}, {size} triangles, {threads} threads"
            );
            assert_eq!(one.len(), other.len());
        }
    }
}

#[test]
fn wrapd() {
    same_bits(Method::Wrapd, Start::Automatic, 25);
}

#[test]
fn wrapd_from_a_start_with_flips() {
    same_bits(Method::Wrapd, Start::Random, 15);
}

#[test]
fn admm_pd() {
    same_bits(Method::AdmmPd, Start::Automatic, 25);
    same_bits(Method::WAdmm, Start::Automatic, 15);
}

#[test]
fn arap_by_local_global() {
    same_bits(Method::Arap, Start::Automatic, 10);
}

#[test]
fn second_order() {
    same_bits(Method::Cm, Start::Automatic, 12);
    same_bits(Method::Slim, Start::Automatic, 6);
    same_bits(Method::WrapdCm, Start::Automatic, 12);
}

#[test]
fn direct_maps() {
    for method in [Method::Lscm, Method::Harmonic, Method::Tutte] {
        same_bits(method, Start::Automatic, 1);
    }
}

#[test]
fn a_closed_surface_that_is_cut_first() {
    let mesh = generate(Shape::Torus, 3_000);
    let options = from(Start::Automatic, Method::Wrapd);
    let one = with_threads(1, &mesh, &options, 10);
    for threads in [2, 3] {
        assert!(one == with_threads(threads, &mesh, &options, 10));
    }
}

/// A run to the end, by `run`, on more threads than there are blocks.
#[test]
fn to_the_end() {
    let mesh = generate(Shape::Terrain, 1_300);
    let options = ParameterizationOptions {
        tolerance: 1e-9,
        max_iterations: 300,
        ..Default::default()
    };
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut p = Parameterization::new(&mesh, &options).unwrap();
            let status = run(
                p.solver_mut(),
                &mut |_: &dyn Solver| (),
                &CancelToken::default(),
            )
            .unwrap();
            let report = p.solver().report().clone();
            (status, fingerprint(&[report], &p))
        })
    };
    assert!(on(1) == on(5));
}
