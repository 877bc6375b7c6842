//! Handles dragged anywhere: nothing ever inverts, as an exact predicate says, and every run ends.

mod lim_grid;
mod random;

use foldfree::certificate::{orientation, orientation_of_tetrahedron};
use foldfree::geometry::RestShape;
use foldfree::lim::{Lim, LimEnergy, LimHessian, LimOptions, LimProblem};
use foldfree::mesh::{SolidShape, generate_solid};
use foldfree::optim::{Deformer, Solver, Status};
use foldfree::space::Solid;
use glam::{DVec2, DVec3};
use lim_grid::{grid, planar};
use random::Random;
use std::cmp::Ordering;

const SEEDS: u64 = 500;

fn options(seed: u64) -> LimOptions {
    LimOptions {
        energy: LimEnergy::ALL[seed as usize % 6],
        hessian: match seed / 6 % 2 {
            0 => LimHessian::Projected,
            _ => LimHessian::Frozen,
        },
        max_iterations: 60,
        ..Default::default()
    }
}

/// Steps to the end, with another target in between.
fn drag(
    lim: &mut Lim,
    seed: u64,
    targets: [&[(u32, [f64; 3])]; 2],
    injective: impl Fn(&[f64]) -> bool,
) {
    for targets in targets {
        lim.retarget(targets, &[]).unwrap();
        let first = lim.report().iteration;
        while lim.status() == Status::Running {
            let report = lim.step().unwrap();
            assert!(
                injective(lim.positions()),
                "seed {seed}, iteration {}",
                report.iteration
            );
            assert!(
                report.energy.is_finite() && report.iteration <= first + 60,
                "seed {seed}"
            );
        }
    }
}

/// Up to three times the size of the shape (1) away.
fn anywhere(random: &mut Random, vertices: &[u32], dimension: usize) -> Vec<(u32, [f64; 3])> {
    let mut point = || {
        let mut p = [0.0; 3];
        p[..dimension]
            .iter_mut()
            .for_each(|x| *x = 0.5 + 3.0 * random.next());
        p
    };
    vertices.iter().map(|&v| (v, point())).collect()
}

#[test]
fn nothing_inverts_in_the_plane() {
    let mesh = grid(6);
    for seed in 0..SEEDS {
        let mut random = Random(seed);
        let mut vertex = |least: u32| least + (17.9 * (random.next() + 1.0)) as u32 % 12;
        // two that stay, two that go anywhere, also across each other
        let handles = [vertex(0), vertex(12), vertex(24)];
        let moved = &handles[1..];
        let mut lim = planar(&mesh, &handles, options(seed));
        let targets = [0; 2].map(|_| anywhere(&mut random, moved, 2));
        drag(&mut lim, seed, [&targets[0], &targets[1]], |p| {
            let at = |v: u32| DVec2::new(p[2 * v as usize], p[2 * v as usize + 1]);
            let positive =
                |&[a, b, c]: &[u32; 3]| orientation(at(a), at(b), at(c)) == Ordering::Greater;
            mesh.simplices.iter().all(positive)
        });
    }
}

#[test]
fn nothing_inverts_in_space() {
    let mesh = generate_solid(SolidShape::Box, 40);
    let (rest, _) = RestShape::of_solid(&mesh).unwrap();
    // of size 1
    let positions: Vec<f64> = mesh.positions.iter().flat_map(|p| p.to_array()).collect();
    let n = mesh.positions.len() as u32;
    for seed in 0..SEEDS {
        let mut random = Random(seed);
        let mut vertex = |part: u32| {
            let third = n / 3;
            part * third + (third as f64 * 0.499 * (random.next() + 1.0)) as u32
        };
        let handles = [vertex(0), vertex(1), vertex(2)];
        let problem = LimProblem {
            rest: &rest,
            rest_positions: &positions,
            start: &positions,
            handles: &handles,
        };
        let mut lim = Lim::new::<Solid>(problem, options(seed)).unwrap();
        let targets = [0; 2].map(|_| {
            let mut targets = anywhere(&mut random, &handles[1..], 3);
            targets
                .iter_mut()
                .for_each(|(_, p)| p.iter_mut().for_each(|x| *x *= 2.0));
            targets
        });
        drag(&mut lim, seed, [&targets[0], &targets[1]], |p| {
            let at = |v: u32| DVec3::from_slice(&p[3 * v as usize..]);
            let positive = |t: &[u32; 4]| {
                let [a, b, c, d] = t.map(at);
                orientation_of_tetrahedron(a, b, c, d) == Ordering::Greater
            };
            mesh.simplices.iter().all(positive)
        });
    }
}
