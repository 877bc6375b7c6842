//! Do two boundary edges of a map have a point in common that they should not have? Exactly.

use super::predicates::{compare_points, orientation};
use glam::DVec2;
use std::cmp::Ordering;

/// How two edges meet that should not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum CrossingKind {
    /// The interiors cross in one point.
    Proper,
    /// An end of one is on the other, in one point.
    Touch,
    /// Both are on one line and share more than a point.
    Overlap,
}

/// How the closed segments `a`–`b` and `c`–`d` meet, `None` when they are disjoint. Segments of
/// length zero are points.
pub fn meet(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<CrossingKind> {
    use Ordering::Equal;
    let (abc, abd) = (orientation(a, b, c), orientation(a, b, d));
    if abc == abd && abc != Equal {
        return None;
    }
    let (cda, cdb) = (orientation(c, d, a), orientation(c, d, b));
    if cda == cdb && cda != Equal {
        return None;
    }
    if [abc, abd, cda, cdb] == [Equal; 4] {
        // All on one line (or points): the intersection of two intervals in lexicographic order.
        let low = max(min(a, b), min(c, d));
        let high = min(max(a, b), max(c, d));
        return match compare_points(low, high) {
            Ordering::Less => Some(CrossingKind::Overlap),
            Equal => Some(CrossingKind::Touch),
            Ordering::Greater => None,
        };
    }
    if abc != Equal && abd != Equal && cda != Equal && cdb != Equal {
        return Some(CrossingKind::Proper);
    }
    // Not all on one line, each segment has its ends on both sides of (or on) the other's line: the
    // lines meet in one point, which is in both segments.
    Some(CrossingKind::Touch)
}

/// How two edges that share the end `p` meet beyond it: `Overlap` when `q` and `r` leave `p` in the
/// same direction, `Touch` when one edge has no length (two ends of the boundary in one place).
pub fn meet_beyond(p: DVec2, q: DVec2, r: DVec2) -> Option<CrossingKind> {
    if orientation(p, q, r) != Ordering::Equal {
        return None;
    }
    match (compare_points(q, p), compare_points(r, p)) {
        (Ordering::Equal, _) | (_, Ordering::Equal) => Some(CrossingKind::Touch),
        (x, y) if x == y => Some(CrossingKind::Overlap),
        _ => None,
    }
}

fn min(a: DVec2, b: DVec2) -> DVec2 {
    if compare_points(b, a) == Ordering::Less {
        b
    } else {
        a
    }
}

fn max(a: DVec2, b: DVec2) -> DVec2 {
    if compare_points(b, a) == Ordering::Greater {
        b
    } else {
        a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: i64 = 4;

    fn p(i: i64) -> (i64, i64) {
        (i % N, i / N)
    }

    /// Oracle in rationals with denominators kept apart: solves for the parameters of the common
    /// point instead of looking at sides.
    fn oracle(a: (i64, i64), b: (i64, i64), c: (i64, i64), d: (i64, i64)) -> Option<CrossingKind> {
        let sub = |p: (i64, i64), q: (i64, i64)| (p.0 - q.0, p.1 - q.1);
        let cross = |p: (i64, i64), q: (i64, i64)| p.0 * q.1 - p.1 * q.0;
        let dot = |p: (i64, i64), q: (i64, i64)| p.0 * q.0 + p.1 * q.1;
        let (r, s, w) = (sub(b, a), sub(d, c), sub(c, a));
        let det = cross(r, s);
        if det != 0 {
            // t = cross(w, s)/det on ab, u = cross(w, r)/det on cd
            let (t, u, n) = (
                cross(w, s) * det.signum(),
                cross(w, r) * det.signum(),
                det.abs(),
            );
            if t < 0 || t > n || u < 0 || u > n {
                return None;
            }
            let inside = t > 0 && t < n && u > 0 && u < n;
            return Some(if inside {
                CrossingKind::Proper
            } else {
                CrossingKind::Touch
            });
        }
        // Parallel or a point among them: a direction that is not zero, if there is one.
        let along = if r != (0, 0) { r } else { s };
        if along == (0, 0) {
            return (a == c).then_some(CrossingKind::Touch);
        }
        if cross(along, w) != 0 {
            return None;
        }
        let interval = |p, q| {
            let (x, y) = (dot(along, p), dot(along, q));
            (x.min(y), x.max(y))
        };
        let ((l, h), (m, k)) = (interval(a, b), interval(c, d));
        match l.max(m).cmp(&h.min(k)) {
            Ordering::Less => Some(CrossingKind::Overlap),
            Ordering::Equal => Some(CrossingKind::Touch),
            Ordering::Greater => None,
        }
    }

    #[test]
    fn every_pair_of_segments_on_a_grid() {
        // All 16⁴ configurations, also away from the origin, at an irrational-looking scale that is
        // exact (a power of two times a small integer) and far out.
        let place = |(x, y): (i64, i64), s: f64| DVec2::new(x as f64 * s, y as f64 * s);
        let n = N * N;
        for i in 0..n * n * n * n {
            let q = [p(i % n), p(i / n % n), p(i / n / n % n), p(i / n / n / n)];
            let expected = oracle(q[0], q[1], q[2], q[3]);
            for s in [1.0, 3.0 * 2f64.powi(-30), 2f64.powi(600)] {
                if s > 1e100 && i % 7 != 0 {
                    continue;
                }
                let [a, b, c, d] = q.map(|q| place(q, s));
                assert_eq!(meet(a, b, c, d), expected, "{q:?}");
            }
        }
    }

    #[test]
    fn every_pair_of_neighbours_on_a_grid() {
        let n = N * N;
        let v = |q: (i64, i64)| DVec2::new(q.0 as f64, q.1 as f64);
        for i in 0..n * n * n {
            let [a, b, c] = [p(i % n), p(i / n % n), p(i / n / n)];
            // p itself is common; more than that is an overlap, or an end that lies on p.
            let expected = match oracle(a, b, a, c) {
                Some(CrossingKind::Overlap) => Some(CrossingKind::Overlap),
                _ if a == b || a == c => Some(CrossingKind::Touch),
                _ => None,
            };
            assert_eq!(meet_beyond(v(a), v(b), v(c)), expected, "{a:?} {b:?} {c:?}");
        }
    }

    #[test]
    fn one_ulp_decides() {
        let (a, b) = (DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0));
        let top = DVec2::new(0.3, 1.0);
        let tiny = f64::from_bits(1);
        let at = |y| DVec2::new(0.3, y);
        assert_eq!(meet(a, b, at(0.0), top), Some(CrossingKind::Touch));
        assert_eq!(meet(a, b, at(tiny), top), None);
        assert_eq!(meet(a, b, at(-tiny), top), Some(CrossingKind::Proper));
        let (p, q) = (DVec2::ZERO, DVec2::new(0.1, 0.1));
        let r = |y| DVec2::new(0.7, y);
        assert_eq!(meet_beyond(p, q, r(0.7)), Some(CrossingKind::Overlap));
        assert_eq!(meet_beyond(p, q, r(0.7f64.next_up())), None);
        assert_eq!(meet_beyond(p, q, -r(0.7)), None);
    }
}
