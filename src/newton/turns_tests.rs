//! Curves along which triangles turn: their tangent, rigid motions, and what the energy does along them.

use super::curvature::{Curvature, Share, stride};
use super::majorization::CompositeMajorization;
use super::turns::Turns;
use crate::energy::SymmetricDirichlet;
use crate::geometry::{Elimination, RestShape};
use crate::mesh::SurfaceMesh;
use crate::quasi_newton::evaluation::Evaluation;
use crate::space::Plane;
use crate::wrapd::block::BLOCK;
use crate::wrapd::elements::{Model, Shape};
use crate::wrapd::{Linear, Problem};
use glam::DVec3;

const WHOLE: Share = Share {
    resistance: 1.0,
    negative: 1.0,
};

/// A strip of n × 2 squares, cut into triangles, bent and stretched somewhat.
struct Strip {
    evaluation: Evaluation,
    elimination: Elimination,
    turns: Turns,
    /// By slot.
    x: Vec<f64>,
}

fn strip(n: usize) -> Strip {
    let mut mesh = SurfaceMesh::default();
    for i in 0..=n {
        for j in 0..=2 {
            let (x, y) = (i as f64, j as f64);
            mesh.positions.push(DVec3::new(x + 0.1 * y, y, 0.0));
            if i < n && j < 2 {
                let a = (3 * i + j) as u32;
                mesh.simplices
                    .extend([[a, a + 3, a + 4], [a, a + 4, a + 1]]);
            }
        }
    }
    let rest = RestShape::of_surface(&mesh, 1.0).unwrap();
    let elimination = Elimination::new(&rest, mesh.positions.len(), &[4]);
    let shape = Shape::of::<Plane, Linear, _>(&SymmetricDirichlet);
    let elements = Box::new(Model::<Plane, Linear>::new(SymmetricDirichlet));
    let evaluation = Evaluation::new(shape, elements, &rest, &elimination, None);
    let mut x = vec![0.0; 2 * mesh.positions.len()];
    for (p, &s) in mesh.positions.iter().zip(&elimination.slot) {
        let (radius, angle) = (12.0 - 1.3 * p.y, 0.11 * p.x);
        x[2 * s as usize] = radius * angle.sin();
        x[2 * s as usize + 1] = -radius * angle.cos();
    }
    let problem = Problem {
        rest: &rest,
        start: &[],
        pins: &[4],
        external: None,
    };
    Strip {
        turns: Turns::new(&problem, &elimination, &evaluation).unwrap(),
        evaluation,
        elimination,
        x,
    }
}

impl Strip {
    fn unknowns(&self) -> usize {
        2 * self.elimination.free
    }

    /// Turning about the pin: 0 there.
    fn rotation(&self) -> Vec<f64> {
        let pin = self.unknowns();
        let [px, py] = [self.x[pin], self.x[pin + 1]];
        self.x
            .as_chunks::<2>()
            .0
            .iter()
            .flat_map(|[x, y]| [py - y, x - px])
            .collect()
    }

    /// Something smooth that is 0 at the pin.
    fn wave(&self) -> Vec<f64> {
        let pin = self.unknowns();
        let at = |x: f64, y: f64| [0.3 * (0.4 * x + 0.2 * y).sin(), 0.2 * (0.3 * x).cos()];
        let [px, py] = at(self.x[pin], self.x[pin + 1]);
        let waves = self.x.as_chunks::<2>().0.iter();
        waves
            .flat_map(|&[x, y]| {
                let [a, b] = at(x, y);
                [a - px, b - py]
            })
            .collect()
    }

    fn go(&mut self, direction: &[f64], t: f64) -> (Vec<f64>, f64) {
        let mut trial = self.x.clone();
        let unknowns = self.unknowns();
        let free = &mut trial[..unknowns];
        let most = self.turns.go(&self.evaluation, &self.x, direction, t, free);
        (trial, most)
    }

    /// dᵀHd of the sum of the elements' Hessians along straight lines, and along curves.
    fn products(&mut self, d: &[f64]) -> [f64; 2] {
        let mut gradient = vec![0.0; self.unknowns()];
        self.evaluation.at(&self.x, &mut gradient);
        let rows = self.turns.unbalanced(&self.evaluation, &gradient).to_vec();
        let mut sums = [0.0; 2];
        let elements = self.evaluation.elements();
        for (i, block) in self.evaluation.blocks.iter().enumerate() {
            let count = BLOCK.min(elements - i * BLOCK);
            let mut straight = vec![0.0; BLOCK * stride(2)];
            let mut curved = straight.clone();
            CompositeMajorization.fill(block, count, 1.0, &mut straight);
            CompositeMajorization.fill_turning(block, &rows[i], count, WHOLE, &mut curved);
            for (sum, out) in sums.iter_mut().zip([straight, curved]) {
                for (e, out) in out.chunks_exact(stride(2)).take(count).enumerate() {
                    let mut blocks = out.chunks_exact(4);
                    let y = |v: usize, i: usize| d[2 * block.vertices[v][e] as usize + i];
                    for u in 0..3 {
                        for v in 0..=u {
                            let block = blocks.next().unwrap();
                            let twice = if u == v { 1.0 } else { 2.0 };
                            for i in 0..2 {
                                for j in 0..2 {
                                    *sum += twice * y(u, i) * block[2 * i + j] * y(v, j);
                                }
                            }
                        }
                    }
                }
            }
        }
        sums
    }
}

#[test]
fn a_curve_leaves_along_its_direction() {
    let mut strip = strip(40);
    let d = strip.wave();
    let mut last = f64::INFINITY;
    for t in [1e-1, 1e-2, 1e-3] {
        let (x, most) = strip.go(&d, t);
        assert!(most > 0.01 * t, "something turns: {most}");
        let away = x.iter().zip(&strip.x).zip(&d);
        let error = away
            .map(|((x, o), d)| (x - o - t * d).abs())
            .fold(0.0, f64::max);
        assert!(error > 0.0, "it is a curve");
        assert!(error < 0.02 * last, "second order: {error} after {last}");
        last = error;
    }
}

#[test]
fn rigid_turns_are_exact() {
    let mut strip = strip(40);
    let d = strip.rotation();
    for (t, error) in [(0.1, 1e-9), (1.0, 1e-9), (7.0, 1e-9), (40.0, 1e-5)] {
        let (x, most) = strip.go(&d, t);
        assert!((most - t).abs() < 1e-9 * t, "{most}");
        let pin = strip.unknowns();
        let [px, py] = [strip.x[pin], strip.x[pin + 1]];
        for (got, from) in x.as_chunks::<2>().0.iter().zip(strip.x.as_chunks::<2>().0) {
            let (a, b) = (from[0] - px, from[1] - py);
            let want = [
                px + f64::cos(t) * a - f64::sin(t) * b,
                py + f64::sin(t) * a + f64::cos(t) * b,
            ];
            assert!((got[0] - want[0]).abs() < error && (got[1] - want[1]).abs() < error);
        }
    }
}

/// Straight lines of a rigid turn meet the stress; curves know that it resists none.
#[test]
fn a_rigid_turn_meets_no_resistance() {
    let mut strip = strip(40);
    let d = strip.rotation();
    let [straight, curved] = strip.products(&d);
    assert!(
        straight.abs() > 1.0,
        "the strip is under stress: {straight}"
    );
    assert!(
        curved.abs() < 1e-9 * straight.abs(),
        "{curved} of {straight}"
    );
}

/// At a state in equilibrium there is nothing to correct.
#[test]
fn nothing_is_out_of_equilibrium_without_a_gradient() {
    let mut strip = strip(10);
    let zero = vec![0.0; strip.unknowns()];
    let rows = strip.turns.unbalanced(&strip.evaluation, &zero);
    assert!(rows.iter().flatten().all(|&u| u == 0.0));
}
