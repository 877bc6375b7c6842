//! How far a step may go before the first element degenerates.
//!
//! Along a direction the measure of an element, det(E + t D) with E its edges and D how they move, is a
//! polynomial in t of the degree of the dimension. It is handled by its Bernstein coefficients on the part
//! of the way that matters, and these are means of determinants of columns of E and of E + t D: no power
//! basis, no discriminant. The polynomial lies above the lower hull of its coefficients, so where that hull
//! meets zero is a safe step; the rest of the way is looked at again, until there is no root or no progress.
//! Near a simple root this converges quadratically, from below.

use crate::parallel;
use crate::wrapd::block::{BLOCK, Block};

/// Rounds at most; a double root needs one for each bit.
const MOST_ROUNDS: usize = 200;

/// The smallest root in (0, 1] of the polynomial of degree N − 1 with these Bernstein coefficients on [0, 1],
/// or infinity. Never above the root by more than rounding. The first coefficient, the value at 0, has to be
/// positive; if it is not, the answer is 0.
pub fn first_root<const N: usize>(coefficients: [f64; N]) -> f64 {
    let mut b = coefficients;
    let mut reached = 0.0;
    for _ in 0..MOST_ROUNDS {
        if !(b[0] > 0.0) {
            return reached;
        }
        // where the lines from the first coefficient down to the others meet zero
        let mut safe = f64::INFINITY;
        for i in 1..N {
            if !(b[i] > 0.0) {
                let place = i as f64 / (N - 1) as f64;
                safe = f64::min(safe, place * (b[0] / (b[0] - b[i])));
            }
        }
        if safe == f64::INFINITY {
            return f64::INFINITY;
        }
        let advance = safe * (1.0 - reached);
        if !(advance > 1e-15 * reached) {
            return reached;
        }
        reached += advance;
        // de Casteljau: the coefficients on what is left
        for round in 1..N {
            for i in 0..N - round {
                b[i] += safe * (b[i + 1] - b[i]);
            }
        }
    }
    reached
}

/// The Bernstein coefficients of det(E + u (G − E)) on u ∈ [0, 1], for 2×2 matrices by columns.
pub fn area_coefficients(e: [[f64; 2]; 2], g: [[f64; 2]; 2]) -> [f64; 3] {
    let det = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    [
        det(e[0], e[1]),
        0.5 * (det(e[0], g[1]) + det(g[0], e[1])),
        det(g[0], g[1]),
    ]
}

/// The same for 3×3 matrices.
pub fn volume_coefficients(e: [[f64; 3]; 3], g: [[f64; 3]; 3]) -> [f64; 4] {
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [
            a[1] * b[2] - a[2] * b[1],
            a[2] * b[0] - a[0] * b[2],
            a[0] * b[1] - a[1] * b[0],
        ]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let (ee, gg) = (cross(e[1], e[2]), cross(g[1], g[2]));
    let (eg, ge) = (cross(e[1], g[2]), cross(g[1], e[2]));
    [
        dot(e[0], ee),
        (dot(g[0], ee) + dot(e[0], eg) + dot(e[0], ge)) / 3.0,
        (dot(e[0], gg) + dot(g[0], eg) + dot(g[0], ge)) / 3.0,
        dot(g[0], gg),
    ]
}

/// `fraction` of the way along `direction` to the first degenerate element, at most `most`. Positions and
/// direction by slot, interleaved. `bounds` has room for one number a block.
///
/// An element that is degenerate already to rounding says nothing: the evaluation of the step will.
pub fn step_bound(
    blocks: &[Block],
    elements: usize,
    positions: &[f64],
    direction: &[f64],
    fraction: f64,
    most: f64,
    bounds: &mut [f64],
) -> f64 {
    parallel::for_each_chunk(bounds, 1, |i, bound| {
        let count = BLOCK.min(elements - i * BLOCK);
        bound[0] = match blocks[i].vertices.len() {
            3 => planar(&blocks[i], count, positions, direction, most / fraction),
            _ => solid(&blocks[i], count, positions, direction, most / fraction),
        };
    });
    most * bounds.iter().copied().fold(1.0, f64::min)
}

/// The edges from the first corner, and those after `way` steps.
#[inline(always)]
fn edges<const D: usize>(
    block: &Block,
    e: usize,
    positions: &[[f64; D]],
    direction: &[[f64; D]],
    way: f64,
) -> ([[f64; D]; D], [[f64; D]; D]) {
    let slot = |v: usize| block.vertices[v][e] as usize;
    let (x0, d0) = (positions[slot(0)], direction[slot(0)]);
    let mut before = [[0.0; D]; D];
    let mut after = before;
    for v in 0..D {
        let (x, d) = (positions[slot(v + 1)], direction[slot(v + 1)]);
        for i in 0..D {
            before[v][i] = x[i] - x0[i];
            after[v][i] = before[v][i] + way * (d[i] - d0[i]);
        }
    }
    (before, after)
}

fn least_root<const N: usize>(least: f64, mut coefficients: [f64; N], rest_sign: f64) -> f64 {
    coefficients.iter_mut().for_each(|c| *c *= rest_sign);
    if !(coefficients[0] > 0.0) || coefficients.iter().all(|&c| c > 0.0) {
        return least;
    }
    f64::min(least, first_root(coefficients))
}

fn planar(block: &Block, count: usize, x: &[f64], direction: &[f64], way: f64) -> f64 {
    let (x, direction) = (x.as_chunks::<2>().0, direction.as_chunks::<2>().0);
    let mut least = f64::INFINITY;
    for e in 0..count {
        let (before, after) = edges(block, e, x, direction, way);
        let row = |c: usize| block.inverse[c][e];
        let sign = (row(0) * row(3) - row(1) * row(2)).signum();
        least = least_root(least, area_coefficients(before, after), sign);
    }
    least
}

fn solid(block: &Block, count: usize, x: &[f64], direction: &[f64], way: f64) -> f64 {
    let (x, direction) = (x.as_chunks::<3>().0, direction.as_chunks::<3>().0);
    let mut least = f64::INFINITY;
    for e in 0..count {
        let (before, after) = edges(block, e, x, direction, way);
        let column = |c: usize| core::array::from_fn(|r| block.inverse[3 * c + r][e]);
        let rest = [column(0), column(1), column(2)];
        let sign = volume_coefficients(rest, rest)[0].signum();
        least = least_root(least, volume_coefficients(before, after), sign);
    }
    least
}
