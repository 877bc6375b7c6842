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

/// Rounds at most: a double root needs a few for each bit.
const MOST_ROUNDS: usize = 400;

/// Intervals to the right that can wait.
const MOST_WAITING: usize = 64;

/// Below this part of an interval a safe step is short, and the interval is halved, too.
const SHORT: f64 = 0.25;

/// A polynomial on an interval of [0, 1].
#[derive(Clone, Copy)]
struct Piece<const N: usize> {
    /// Its Bernstein coefficients there.
    b: [f64; N],
    start: f64,
    width: f64,
}

impl<const N: usize> Piece<N> {
    /// Left and right of the part `u` of the interval, by de Casteljau.
    fn split(&self, u: f64) -> [Self; 2] {
        let mut right = self.b;
        let mut left = self.b;
        for round in 1..N {
            for i in 0..N - round {
                right[i] += u * (right[i + 1] - right[i]);
            }
            left[round] = right[0];
        }
        let middle = u * self.width;
        [
            Self {
                b: left,
                start: self.start,
                width: middle,
            },
            Self {
                b: right,
                start: self.start + middle,
                width: self.width - middle,
            },
        ]
    }

    /// The part of the interval before which there is no root: the lower hull of the coefficients meets
    /// zero where the first of the lines from above to below does.
    fn safe(&self) -> f64 {
        let b = &self.b;
        let mut safe = f64::INFINITY;
        for j in (1..N).filter(|&j| !(b[j] > 0.0)) {
            for i in (0..j).filter(|&i| b[i] > 0.0) {
                let place = i as f64 + (j - i) as f64 * (b[i] / (b[i] - b[j]));
                safe = f64::min(safe, place / (N - 1) as f64);
            }
        }
        safe
    }
}

/// The smallest root in (0, 1] of the polynomial of degree N − 1 with these Bernstein coefficients on [0, 1],
/// or infinity. Never above the root by more than rounding. The first coefficient, the value at 0, has to be
/// positive; if it is not, the answer is 0.
pub fn first_root<const N: usize>(coefficients: [f64; N]) -> f64 {
    let mut piece = Piece {
        b: coefficients,
        start: 0.0,
        width: 1.0,
    };
    let mut waiting = [piece; MOST_WAITING];
    let mut count = 0;
    for _ in 0..MOST_ROUNDS {
        if !(piece.b[0] > 0.0) {
            return piece.start;
        }
        let safe = piece.safe();
        if safe == f64::INFINITY {
            // on to what lies right of it
            match count {
                0 => return f64::INFINITY,
                _ => count -= 1,
            }
            piece = waiting[count];
            continue;
        }
        if !(safe * piece.width > 1e-15 * piece.start) || count == MOST_WAITING {
            return piece.start;
        }
        piece = piece.split(safe)[1];
        if safe < SHORT {
            [piece, waiting[count]] = piece.split(0.5);
            count += 1;
        }
    }
    piece.start
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
pub(crate) fn step_bound(
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
