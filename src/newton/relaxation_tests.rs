//! Vertices moved one by one: derivatives, and what a sweep does to a crumpled map.

use super::relaxation::{Local, Relaxation, derivatives};
use crate::energy::SymmetricDirichlet;
use crate::geometry::{Elimination, RestShape};
use crate::mesh::SurfaceMesh;
use crate::quasi_newton::evaluation::Evaluation;
use crate::space::Plane;
use crate::wrapd::Linear;
use crate::wrapd::elements::{Model, Shape};
use glam::DVec3;

/// Pseudo-random numbers in −1..1 (SplitMix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[test]
fn derivatives_are_those_of_the_energy() {
    let mut random = Random(1);
    for _ in 0..50 {
        let local: Vec<Local> = (0..5)
            .map(|_| Local {
                f: [
                    1.0 + 0.3 * random.next(),
                    0.3 * random.next(),
                    0.3 * random.next(),
                    0.7 + 0.2 * random.next(),
                ],
                hat: [random.next(), random.next()],
                measure: 1.5 + random.next(),
            })
            .collect();
        let at = |y: [f64; 2]| local.iter().map(|l| l.energy(y)).sum::<f64>();
        let (energy, [gx, gy], [xx, xy, yy]) = derivatives(&local);
        let h = 1e-4;
        let size = xx + yy;
        assert!((energy - at([0.0; 2])).abs() < 1e-13 * energy);
        let first = [
            (at([h, 0.0]) - at([-h, 0.0])) / (2.0 * h),
            (at([0.0, h]) - at([0.0, -h])) / (2.0 * h),
        ];
        let twice = |x: f64, y: f64| (at([x, y]) - 2.0 * energy + at([-x, -y])) / (h * h);
        let second = [
            twice(h, 0.0),
            0.5 * (twice(h, h) - twice(h, 0.0) - twice(0.0, h)),
            twice(0.0, h),
        ];
        for (found, expected) in [gx, gy, xx, xy, yy].iter().zip(first.iter().chain(&second)) {
            assert!((found - expected).abs() < 1e-5 * size, "{found} {expected}");
        }
    }
}

/// A square of n × n squares, its map crumpled without inversions, and its evaluation; the first vertex is pinned.
fn crumpled(n: usize, seed: u64, turned: bool) -> (Evaluation, Elimination, Vec<f64>) {
    let mut random = Random(seed);
    let mut mesh = SurfaceMesh::default();
    let mut places = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            mesh.positions.push(DVec3::new(i as f64, j as f64, 0.0));
            places.push([
                i as f64 + 0.24 * random.next(),
                j as f64 + 0.24 * random.next(),
            ]);
            if i < n && j < n {
                let a = ((n + 1) * i + j) as u32;
                let up = n as u32 + 1;
                mesh.simplices
                    .extend([[a, a + up, a + up + 1], [a, a + up + 1, a + 1]]);
            }
        }
    }
    let count = places.len() as u32;
    let name = |v: u32| if turned { count - 1 - v } else { v };
    if turned {
        mesh.positions.reverse();
        places.reverse();
        for corner in mesh.simplices.iter_mut().flatten() {
            *corner = name(*corner);
        }
    }
    let rest = RestShape::of_surface(&mesh, 1.0).unwrap();
    let elimination = Elimination::new(&rest, places.len(), &[name(0)]);
    let shape = Shape::of::<Plane, Linear, _>(&SymmetricDirichlet);
    let elements = Box::new(Model::<Plane, Linear>::new(SymmetricDirichlet));
    let evaluation = Evaluation::new(shape, elements, &rest, &elimination, None);
    let mut x = vec![0.0; 2 * places.len()];
    for (p, &s) in places.iter().zip(&elimination.slot) {
        x[2 * s as usize..][..2].copy_from_slice(p);
    }
    (evaluation, elimination, x)
}

#[test]
fn the_energy_falls_and_nothing_inverts() {
    for seed in 0..20 {
        let (mut evaluation, elimination, mut x) = crumpled(12, seed, false);
        let mut gradient = vec![0.0; 2 * elimination.free];
        let before = evaluation.at(&x, &mut gradient);
        assert_eq!(before.inverted, 0, "the start is injective");
        let pinned = x[2 * elimination.free..].to_vec();
        let relaxation =
            Relaxation::new(&evaluation.blocks, evaluation.elements(), elimination.free);
        let mut last = before.energy;
        for _ in 0..30 {
            relaxation.relax(&mut x);
            let after = evaluation.at(&x, &mut gradient);
            assert_eq!(after.inverted, 0);
            assert!(
                after.energy <= last * (1.0 + 1e-14),
                "{} after {last}",
                after.energy
            );
            last = after.energy;
        }
        // the isometry has the relative energy 1
        let offset = evaluation.shape.constants.offset;
        let excess = |e: f64| e + offset - 1.0;
        assert!(
            excess(last) < 0.05 * excess(before.energy),
            "{last} of {}",
            before.energy
        );
        assert_eq!(x[2 * elimination.free..], pinned);
    }
}

#[test]
fn the_order_of_the_vertices_does_not_matter() {
    let maps: Vec<Vec<f64>> = [false, true]
        .map(|turned| {
            let (evaluation, elimination, mut x) = crumpled(12, 7, turned);
            let relaxation =
                Relaxation::new(&evaluation.blocks, evaluation.elements(), elimination.free);
            relaxation.relax(&mut x);
            let mut places: Vec<[f64; 2]> = elimination
                .slot
                .iter()
                .map(|&s| [x[2 * s as usize], x[2 * s as usize + 1]])
                .collect();
            if turned {
                places.reverse();
            }
            places.into_flattened()
        })
        .into();
    for (a, b) in maps[0].iter().zip(&maps[1]) {
        assert!((a - b).abs() < 1e-10, "{a} {b}");
    }
}
