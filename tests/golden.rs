//! Golden runs: what the methods are known to do on the generated shapes.
//!
//! The numbers were measured with this crate (what they are held against is in `conformance.rs`: the
//! authors' own). Energies depend on nothing but the mesh, up to 1e-12 (`invariance.rs`): 1e-9 leaves
//! room for another platform's sine and cosine. Counts are decisions at a threshold that a last bit
//! can tip, so one iteration, or 5 %, is allowed.

mod flattening;

use flattening::{Run, endless, from};
use foldfree::embedding::tutte;
use foldfree::energy::SymmetricDirichlet;
use foldfree::geometry::{RestShape, surface_area};
use foldfree::mesh::{Shape, SurfaceMesh, generate, prepare};
use foldfree::optim::Solver;
use foldfree::parameterization::{Method, Parameterization, Start};
use foldfree::space::Plane;
use foldfree::wrapd::{Problem, Reweighting, RotationAware, Wrapd, WrapdOptions};

/// WRAPD on one shape.
struct Golden {
    shape: Shape,
    triangles: usize,
    /// Energy of the harmonic start and of the minimum.
    energies: [f64; 2],
    /// Iterations to 1.01 E* and (1 + 1e-6) E*.
    counts: [usize; 2],
}

/// Each asked for with 2 000 triangles.
#[rustfmt::skip]
const GOLDEN: [Golden; 7] = [
    Golden { shape: Shape::BumpyCap, triangles: 1944, energies: [1.5584449006377776, 1.166228112052], counts: [3, 18] },
    Golden { shape: Shape::Terrain, triangles: 2048, energies: [1.6384399886524184, 1.001711027730], counts: [1, 7] },
    Golden { shape: Shape::SpiralRamp, triangles: 1998, energies: [15.644385047237332, 1.000002653685], counts: [15, 35] },
    Golden { shape: Shape::HilbertStrip, triangles: 1908, energies: [2796.9326161223976, 1.0], counts: [14, 81] },
    Golden { shape: Shape::Torus, triangles: 1980, energies: [1.765284739345872, 1.055728593281], counts: [2, 16] },
    Golden { shape: Shape::Sphere, triangles: 2000, energies: [1.5914210358592202, 1.150707907688], counts: [3, 18] },
    Golden { shape: Shape::RoundedCube, triangles: 2028, energies: [1.584264721530709, 1.152570734832], counts: [3, 16] },
];

#[track_caller]
fn same_energy(name: Shape, found: f64, known: f64) {
    assert!(
        (found - known).abs() <= 1e-9 * known,
        "{name:?}: {found}, known {known}"
    );
}

#[test]
fn wrapd_on_the_generated_shapes() {
    for golden in GOLDEN {
        let shape = golden.shape;
        let mesh = generate(shape, 2_000);
        assert_eq!(
            mesh.simplices.len(),
            golden.triangles,
            "{shape:?}: another mesh"
        );
        // the strip needs longest; energies no longer move by 1e-10 then
        let steps = if shape == Shape::HilbertStrip {
            170
        } else {
            75
        };
        let run = Run::new(&mesh, &endless(Method::Wrapd)).steps(steps);
        let [start, optimum] = golden.energies;
        same_energy(shape, run.reports[0].energy, start);
        same_energy(shape, run.last().energy, optimum);
        let certificate = run.parameterization.certificate();
        same_energy(shape, certificate.symmetric_dirichlet, optimum);
        assert!(certificate.inverted.is_empty() && certificate.degenerate.is_empty());
        assert!(certificate.locally_injective, "{shape:?}");

        for (known, excess) in golden.counts.into_iter().zip([1e-2, 1e-6]) {
            let found = run.reaches((1.0 + excess) * optimum).unwrap();
            let room = (known / 20).max(1);
            assert!(
                found.abs_diff(known) <= room,
                "{shape:?}: {found} iterations to {excess}, known {known}"
            );
        }
    }
}

/// Iterations to (1 + `excess`) E* of WRAPD, R-ADMM, W-ADMM and ADMM-PD; `limit` where it takes longer.
fn four_curves(mesh: &SurfaceMesh, optimum: f64, excess: f64, limit: usize) -> [usize; 4] {
    let bound = (1.0 + excess) * optimum;
    [Method::Wrapd, Method::RAdmm, Method::WAdmm, Method::AdmmPd].map(|method| {
        let run = Run::new(mesh, &endless(method));
        let run =
            run.while_true(|r| r.iteration < limit && !(r.inverted == 0 && r.energy <= bound));
        run.reaches(bound).unwrap_or(limit)
    })
}

/// Figures 4 and 5 of the paper, by iterations instead of seconds. Where pieces have to turn far,
/// rotation awareness is what counts.
#[test]
fn rotation_awareness_turns_what_has_to_turn() {
    let ramp = generate(Shape::SpiralRamp, 2_000);
    let [wrapd, r_admm, w_admm, admm_pd] = four_curves(&ramp, 1.000002653685, 1e-4, 300);
    println!("ramp: {wrapd}, {r_admm}, {w_admm}, {admm_pd}");
    assert!(wrapd < r_admm, "reweighting helps on top");
    assert!(
        r_admm * 9 <= w_admm.min(admm_pd),
        "{r_admm}, {w_admm}, {admm_pd}"
    );

    let strip = generate(Shape::HilbertStrip, 2_000);
    let [wrapd, r_admm, w_admm, admm_pd] = four_curves(&strip, 1.0, 1e-3, 150);
    println!("strip: {wrapd}, {r_admm}, {w_admm}, {admm_pd}");
    assert!(wrapd.max(r_admm) * 4 <= w_admm.min(admm_pd));
}

/// Where nothing has to turn the four do the same.
#[test]
fn where_nothing_turns_the_four_are_alike() {
    let cap = generate(Shape::BumpyCap, 2_000);
    let counts = four_curves(&cap, 1.166228112052, 1e-3, 50);
    assert!(
        counts.iter().all(|c| c.abs_diff(counts[0]) <= 1),
        "{counts:?}"
    );
}

#[test]
fn a_developable_strip_unrolls_without_any_stretch() {
    let strip = generate(Shape::HilbertStrip, 1_000);
    let run = Run::new(&strip, &endless(Method::Wrapd)).steps(150);
    assert!(run.reports[0].energy > 100.0);
    let last = run.last();
    assert!((last.energy - 1.0).abs() < 1e-8, "{}", last.energy);
    // Σ A (σ − 1)² is about half of that: no triangle of a thousand is off by more than a thousandth
    assert!(last.smallest_sigma > 0.999 && last.largest_sigma < 1.001);
    assert!(run.parameterization.certificate().globally_injective);
    // and so does it under ARAP
    let run = Run::new(&strip, &endless(Method::Arap)).steps(20);
    assert!(run.last().energy < run.reports[0].energy / 3.0);
}

/// Both half-steps minimise the same energy, so it never rises, whatever the start.
#[test]
fn arap_by_local_global_never_rises() {
    for (shape, start) in [
        (Shape::BumpyCap, Start::Automatic),
        (Shape::SpiralRamp, Start::Tutte),
        (Shape::HilbertStrip, Start::Random),
        (Shape::Torus, Start::Lscm),
        (Shape::Sphere, Start::Collapsed),
    ] {
        let mesh = generate(shape, 700);
        let energies = Run::new(&mesh, &from(start, Method::Arap))
            .steps(80)
            .energies();
        for pair in energies.windows(2) {
            assert!(
                pair[1] <= pair[0] * (1.0 + 1e-14),
                "{shape:?}: {} to {}",
                pair[0],
                pair[1]
            );
        }
        assert!(energies[80] < 0.7 * energies[0] && energies[80] >= 0.0);
    }
}

#[test]
fn starts_that_fold_are_unfolded() {
    for shape in Shape::ALL {
        let mesh = generate(shape, 700);
        for (start, seed) in [
            (Start::Collapsed, 1),
            (Start::Random, 1),
            (Start::Random, 2),
        ] {
            let mut options = from(start, Method::Wrapd);
            options.seed = seed;
            let run = Run::new(&mesh, &options);
            let first = run.last();
            assert!(first.inverted * 3 > mesh.simplices.len());
            assert_eq!(first.energy, f64::INFINITY);
            let run = run.while_true(|r| r.iteration < 120 && (r.inverted > 0 || r.iteration < 1));
            let last = run.last();
            assert_eq!(last.inverted, 0, "{shape:?} {start:?}");
            let certificate = run.parameterization.certificate();
            assert!(certificate.inverted.is_empty() && certificate.degenerate.is_empty());
        }
    }
}

/// A start turned over: σ₂ = −σ₁ or near it everywhere, where the rotation is all but undefined.
#[test]
fn a_mirrored_start_is_turned_back() {
    for shape in [Shape::BumpyCap, Shape::Terrain] {
        let mesh = generate(shape, 700);
        let flat = Run::new(&mesh, &endless(Method::Wrapd)).steps(40);
        let known = flat.last().energy;
        let rest = RestShape::of_surface(&mesh, surface_area(&mesh).sqrt().recip()).unwrap();
        let mirrored: Vec<f64> = flat
            .parameterization
            .solver()
            .positions()
            .chunks_exact(2)
            .flat_map(|p| [-p[0], p[1]])
            .collect();
        let problem = Problem {
            rest: &rest,
            start: &mirrored,
            pins: &[0],
            external: None,
        };
        // as `Parameterization` does for starts that fold
        let reweighting = Reweighting {
            delay: 50,
            ..Reweighting::PARAMETERIZATION
        };
        let options = WrapdOptions {
            tolerance: 0.0,
            reweighting: Some(reweighting),
            ..Default::default()
        };
        let mut solver =
            Wrapd::new::<Plane, RotationAware, _>(problem, SymmetricDirichlet, options).unwrap();
        assert_eq!(solver.report().inverted, mesh.simplices.len());
        for _ in 0..100 {
            solver.step().unwrap();
        }
        let report = solver.report();
        assert_eq!(report.inverted, 0, "{shape:?}");
        let difference = (report.energy - known).abs();
        assert!(
            difference <= 1e-8 * known,
            "{shape:?}: {}, from the other side {known}",
            report.energy
        );
    }
}

#[test]
fn tutte_never_flips() {
    for shape in Shape::ALL {
        for triangles in [0, 100, 1_000, 4_000] {
            let mesh = generate(shape, triangles);
            let run = Run::new(&mesh, &endless(Method::Tutte)).steps(1);
            let certificate = run.parameterization.certificate();
            assert!(
                certificate.globally_injective,
                "{shape:?} {triangles}: {certificate:?}"
            );
        }
    }
}

/// Tutte's map puts the boundary on a circle of unit area, counter-clockwise, and every inner vertex
/// in the middle of its neighbours.
#[test]
fn tutte_is_what_it_says() {
    let prepared = prepare(&generate(Shape::BumpyCap, 500)).unwrap();
    let mesh = &prepared.mesh;
    let rest = RestShape::of_surface(mesh, 1.0).unwrap();
    let boundary = &prepared.topology.boundary_loops()[0];
    let map = tutte(mesh, &rest, boundary).unwrap();
    let mut sums = vec![(glam::DVec2::ZERO, 0.0); map.len()];
    for t in &mesh.simplices {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            // the other direction of an inner edge belongs to the neighbour
            sums[a as usize].0 += map[b as usize];
            sums[a as usize].1 += 1.0;
        }
    }
    for (v, p) in map.iter().enumerate() {
        if boundary.contains(&(v as u32)) {
            let area = std::f64::consts::PI * p.length_squared();
            assert!((area - 1.0).abs() < 1e-14);
        } else {
            let (sum, count) = sums[v];
            assert!(p.distance(sum / count) < 1e-14);
        }
    }
}

/// Reports say what the positions are.
#[test]
fn reports_are_those_of_the_positions() {
    let mesh = generate(Shape::BumpyCap, 700);
    for method in [
        Method::Wrapd,
        Method::AdmmPd,
        Method::Arap,
        Method::Lscm,
        Method::Harmonic,
    ] {
        let mut p = Parameterization::new(&mesh, &endless(method)).unwrap();
        for _ in 0..3 {
            let report = p.step().unwrap();
            let certificate = p.certificate();
            assert_eq!(
                report.inverted,
                certificate.inverted.len() + certificate.degenerate.len()
            );
            assert!((report.smallest_sigma - certificate.smallest_sigma).abs() < 1e-12);
            assert!((report.largest_sigma - certificate.largest_sigma).abs() < 1e-12);
            if method != Method::Arap {
                let energy = certificate.symmetric_dirichlet;
                assert!(
                    (report.energy - energy).abs() < 1e-12,
                    "{} {energy}",
                    report.energy
                );
            }
            assert_eq!(p.solver().inspect().distortion.len(), mesh.simplices.len());
        }
    }
}
