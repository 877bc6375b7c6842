//! Queries of all kinds, many of them degenerate.

use super::motion::Motion;
use foldfree::collision::Pair;

/// Whole numbers that are the same in every run (SplitMix64).
pub struct Whole(pub u64);

impl Whole {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// From −most to most.
    fn up_to(&mut self, most: i64) -> i64 {
        (self.next() % (2 * most as u64 + 1)) as i64 - most
    }
    fn point(&mut self, most: i64) -> [i64; 3] {
        std::array::from_fn(|_| self.up_to(most))
    }
    fn points(&mut self, most: i64) -> [[i64; 3]; 4] {
        std::array::from_fn(|_| self.point(most))
    }
}

/// The kinds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Random,
    Grid,
    ParallelEdges,
    InOnePlane,
    NoExtent,
    TouchingHalfway,
    NearlyTouchingHalfway,
    TouchingAtTheStart,
    TouchingAtTheEnd,
    Standing,
    VertexAndEdgeInThePlane,
}

impl Kind {
    pub const ALL: [Kind; 11] = [
        Kind::Random,
        Kind::Grid,
        Kind::ParallelEdges,
        Kind::InOnePlane,
        Kind::NoExtent,
        Kind::TouchingHalfway,
        Kind::NearlyTouchingHalfway,
        Kind::TouchingAtTheStart,
        Kind::TouchingAtTheEnd,
        Kind::Standing,
        Kind::VertexAndEdgeInThePlane,
    ];
}

/// Moves the first point (the first two, of edges) so that the motion has a common point of both at this stage: a
/// point whose barycentric coordinates are multiples of 1/4. Coordinates become multiples of 16.
fn touch(r: &mut Whole, pair: Pair, p: &mut [[i64; 3]; 4]) {
    p.iter_mut().flatten().for_each(|x| *x *= 16);
    let weight = |r: &mut Whole, most: i64| (r.next() % (most as u64 + 1)) as i64;
    match pair {
        Pair::VertexFace => {
            let s = weight(r, 4);
            let t = weight(r, 4 - s);
            let at = |i: usize| (p[1][i] * (4 - s - t) + p[2][i] * s + p[3][i] * t) / 4;
            p[0] = std::array::from_fn(at);
        }
        Pair::EdgeEdge => {
            let s = weight(r, 4);
            // at s on the other edge, and halfway or at an end of this one
            let at: [i64; 3] = std::array::from_fn(|i| (p[2][i] * (4 - s) + p[3][i] * s) / 4);
            match r.next() % 3 {
                0 => p[0] = at,
                1 => p[1] = at,
                _ => p[1] = std::array::from_fn(|i| 2 * at[i] - p[0][i]),
            }
        }
    }
}

/// One query of this kind.
pub fn query(kind: Kind, r: &mut Whole) -> Motion {
    let pair = match r.next() % 2 {
        0 => Pair::VertexFace,
        _ => Pair::EdgeEdge,
    };
    let size = [3, 40, 1000][(r.next() % 3) as usize];
    let mut m = Motion {
        pair,
        from: r.points(size),
        to: r.points(size),
    };
    match kind {
        Kind::Random => {}
        Kind::Grid => (m.from, m.to) = (r.points(1), r.points(1)),
        Kind::ParallelEdges => {
            m.pair = Pair::EdgeEdge;
            for p in [&mut m.from, &mut m.to] {
                let factor = r.up_to(2);
                p[3] = std::array::from_fn(|i| p[2][i] + factor * (p[1][i] - p[0][i]));
            }
        }
        Kind::InOnePlane => {
            let slope = r.up_to(2);
            let all = m.from.iter_mut().chain(&mut m.to);
            all.for_each(|p| p[2] = slope * p[0] + p[1]);
        }
        Kind::NoExtent => {
            let (i, j) = [(2, 3), (1, 2), (0, 1)][(r.next() % 3) as usize];
            m.from[i] = m.from[j];
            if r.next().is_multiple_of(2) {
                m.to[i] = m.to[j];
            }
        }
        Kind::TouchingHalfway | Kind::NearlyTouchingHalfway => {
            // the points halfway, of which the ends are mirror images
            let mut middle = r.points(size);
            touch(r, pair, &mut middle);
            if kind == Kind::NearlyTouchingHalfway {
                middle.iter_mut().flatten().for_each(|x| *x *= 1 << 14);
                middle[0][(r.next() % 3) as usize] += 1;
            }
            let by = if kind == Kind::NearlyTouchingHalfway {
                16 << 14
            } else {
                16
            };
            let drift = r.points(size).map(|p| p.map(|x| by * x));
            let at = |sign: i64| -> [[i64; 3]; 4] {
                std::array::from_fn(|p| std::array::from_fn(|i| middle[p][i] + sign * drift[p][i]))
            };
            (m.from, m.to) = (at(-1), at(1));
        }
        Kind::TouchingAtTheStart => touch(r, pair, &mut m.from),
        Kind::TouchingAtTheEnd => touch(r, pair, &mut m.to),
        Kind::Standing => m.to = m.from,
        Kind::VertexAndEdgeInThePlane => {
            m.pair = Pair::VertexFace;
            for p in [&mut m.from, &mut m.to] {
                p.iter_mut().for_each(|p| p[2] = 0);
                p[3] = p[2];
            }
        }
    }
    m
}
