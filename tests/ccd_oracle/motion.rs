//! When two primitives whose corners move linearly between integer points meet first.

use super::polynomial::{Polynomial, Root, roots};
use dashu_ratio::RBig;
use foldfree::collision::Pair;
use std::cmp::Ordering::{Equal, Greater, Less};

/// Four points at the time 0, and at 1; in the plane the third coordinates are 0 and the last two points are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    pub pair: Pair,
    pub from: [[i64; 3]; 4],
    pub to: [[i64; 3]; 4],
}

type Vector = [Polynomial; 3];

fn sub(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i].minus(&b[i]))
}

fn dot(a: &Vector, b: &Vector) -> Polynomial {
    let sum = a[0].times(&b[0]).plus(&a[1].times(&b[1]), 1);
    sum.plus(&a[2].times(&b[2]), 1)
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

/// p is on the closed segment where `line` is 0 and `between` is not positive.
struct OnSegment {
    line: Vector,
    between: Polynomial,
}

impl OnSegment {
    fn new(p: &Vector, a: &Vector, b: &Vector) -> Self {
        let (from_a, from_b) = (sub(p, a), sub(p, b));
        Self {
            line: cross(&sub(b, a), &from_a),
            between: dot(&from_a, &from_b),
        }
    }
    fn holds(&self, t: &mut Root) -> bool {
        self.line.iter().all(|l| t.sign_of(l) == Equal) && t.sign_of(&self.between) != Greater
    }
}

/// What must hold at a time at which all four points are in one plane: one of the ends is on a segment, or the normal
/// is not 0 and none of these is negative.
struct Conditions {
    ends: Vec<OnSegment>,
    normal: Vector,
    inside: Vec<Polynomial>,
}

impl Conditions {
    fn new(pair: Pair, [a, b, c, d]: &[Vector; 4]) -> Self {
        match pair {
            Pair::VertexFace => {
                let normal = cross(&sub(c, b), &sub(d, b));
                let sides = [(b, c), (c, d), (d, b)];
                let beside =
                    |(b, c): (&Vector, &Vector)| dot(&normal, &cross(&sub(c, b), &sub(a, b)));
                Self {
                    inside: sides.map(beside).into(),
                    ends: sides.map(|(b, c)| OnSegment::new(a, b, c)).into(),
                    normal,
                }
            }
            Pair::EdgeEdge => {
                let (e, f, w) = (sub(b, a), sub(d, c), sub(c, a));
                let normal = cross(&e, &f);
                let square = dot(&normal, &normal);
                // the common point of both lines is at these parameters, times the square of the normal
                let s = dot(&cross(&w, &f), &normal);
                let u = dot(&cross(&w, &e), &normal);
                let inside = vec![square.minus(&s), square.minus(&u), s, u];
                let ends = [(a, c, d), (b, c, d), (c, a, b), (d, a, b)];
                Self {
                    ends: ends.map(|(p, a, b)| OnSegment::new(p, a, b)).into(),
                    normal,
                    inside,
                }
            }
        }
    }

    fn hold(&self, t: &mut Root) -> bool {
        self.normal.iter().any(|n| t.sign_of(n) != Equal)
            && self.inside.iter().all(|p| t.sign_of(p) != Less)
            || self.ends.iter().any(|end| end.holds(t))
    }

    fn all(&self) -> impl Iterator<Item = &Polynomial> {
        let ends = self.ends.iter();
        let ends = ends.flat_map(|e| e.line.iter().chain([&e.between]));
        ends.chain(&self.normal).chain(&self.inside)
    }
}

impl Motion {
    /// Split into the points of the first primitive and of the second.
    pub fn split(&self) -> usize {
        match self.pair {
            Pair::VertexFace => 1,
            Pair::EdgeEdge => 2,
        }
    }

    /// Are the boxes around both paths apart?
    fn is_far(&self) -> bool {
        let split = self.split();
        (0..3).any(|i| {
            let range = |side: std::ops::Range<usize>| {
                let all = || side.clone().flat_map(|p| [self.from[p][i], self.to[p][i]]);
                (all().min().expect("points"), all().max().expect("points"))
            };
            let ((a, b), (c, d)) = (range(0..split), range(split..4));
            b < c || d < a
        })
    }

    /// An upper bound of the first time at which they meet, not more than 2^−60 above it, if they do.
    pub fn first_meeting(&self) -> Option<RBig> {
        if self.is_far() {
            return None;
        }
        let points: [Vector; 4] = std::array::from_fn(|p| {
            std::array::from_fn(|i| Polynomial::linear(self.from[p][i], self.to[p][i]))
        });
        let [a, b, c, d] = &points;
        let mut planar = Vec::new();
        let (e, f, g) = (sub(b, a), sub(c, a), sub(d, a));
        let is_flat = points.iter().all(|p| p[2].is_zero());
        let volume = match is_flat {
            // in the plane of a vertex and an edge it is the area
            true => e[0].times(&f[1]).minus(&e[1].times(&f[0])),
            false => dot(&cross(&e, &f), &g),
        };
        let is_edge = self.from[2] == self.from[3] && self.to[2] == self.to[3];
        let is_vertex_edge = is_flat && is_edge && self.pair == Pair::VertexFace;
        let volume = match is_flat && !is_vertex_edge {
            // always in one plane
            true => volume.minus(&volume),
            false => volume,
        };
        let conditions = Conditions::new(self.pair, &points);
        let mut times = roots(&volume);
        if volume.is_zero() {
            // they begin to meet at 0, or where a condition begins to hold
            times.push(Root::rational(0));
            planar.extend(conditions.all().flat_map(roots));
        }
        let mut first: Option<RBig> = None;
        for mut t in times.into_iter().chain(planar) {
            if conditions.hold(&mut t) {
                t.refine(60);
                if first.as_ref().is_none_or(|first| t.high < *first) {
                    first = Some(t.high);
                }
            }
        }
        first
    }
}
