//! Oracles in whole numbers: slow, obvious, exact for coordinates below 2⁶⁰.

use foldfree::certificate::{Certificate, CrossingKind};
use foldfree::mesh::SurfaceMesh;
use glam::{DVec2, DVec3};

pub type Point = (i64, i64);

/// Positive: c is left of a → b.
pub fn turn(a: Point, b: Point, c: Point) -> i128 {
    let d = |p: i64, q: i64| i128::from(p) - i128::from(q);
    (d(b.0, a.0) * d(c.1, a.1) - d(b.1, a.1) * d(c.0, a.0)).signum()
}

/// Is p on the closed segment ab?
fn on(a: Point, b: Point, p: Point) -> bool {
    let between = |x: i64, y: i64, z: i64| (x.min(y)..=x.max(y)).contains(&z);
    turn(a, b, p) == 0 && between(a.0, b.0, p.0) && between(a.1, b.1, p.1)
}

/// Do closed segments meet? Either an end is on the other segment, or they cross.
pub fn meet(a: Point, b: Point, c: Point, d: Point) -> Option<CrossingKind> {
    let mut ends: Vec<Point> = Vec::new();
    ends.extend([c, d].iter().filter(|&&p| on(a, b, p)));
    ends.extend([a, b].iter().filter(|&&p| on(c, d, p)));
    ends.sort_unstable();
    ends.dedup();
    match ends.len() {
        0 => {
            let crosses = turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
            crosses.then_some(CrossingKind::Proper)
        }
        1 => Some(CrossingKind::Touch),
        _ => Some(CrossingKind::Overlap),
    }
}

/// What an exact brute force says of a map.
#[derive(Debug, PartialEq)]
pub struct Truth {
    pub inverted: Vec<u32>,
    pub degenerate: Vec<u32>,
    pub crossings: Vec<([[u32; 2]; 2], CrossingKind)>,
    /// Known when no triangle is inverted or degenerate.
    pub locally_injective: Option<bool>,
    pub globally_injective: Option<bool>,
}

pub fn truth(triangles: &[[u32; 3]], uv: &[Point]) -> Truth {
    let at = |v: u32| uv[v as usize];
    let side = |t: &[u32; 3]| turn(at(t[0]), at(t[1]), at(t[2]));
    let which = |wanted: i128| -> Vec<u32> {
        let all = triangles.iter().enumerate();
        all.filter(|(_, t)| side(t) == wanted)
            .map(|(i, _)| i as u32)
            .collect()
    };
    let (inverted, degenerate) = (which(-1), which(0));
    let good = inverted.is_empty() && degenerate.is_empty() && !triangles.is_empty();
    let pairs =
        || (0..triangles.len()).flat_map(|i| (0..i).map(move |j| (&triangles[i], &triangles[j])));
    Truth {
        crossings: boundary_crossings(triangles, uv),
        locally_injective: good.then(|| !pairs().any(|(s, t)| sectors_overlap(s, t, uv))),
        globally_injective: good.then(|| !pairs().any(|(s, t)| triangles_meet(s, t, uv))),
        inverted,
        degenerate,
    }
}

fn boundary_crossings(triangles: &[[u32; 3]], uv: &[Point]) -> Vec<([[u32; 2]; 2], CrossingKind)> {
    let at = |v: u32| uv[v as usize];
    let directed = || {
        triangles
            .iter()
            .flat_map(|t| (0..3).map(move |k| [t[k], t[(k + 1) % 3]]))
    };
    let mut boundary: Vec<[u32; 2]> = directed()
        .filter(|&[a, b]| directed().all(|e| e != [b, a]))
        .collect();
    boundary.sort_unstable();
    let mut found = Vec::new();
    for (i, &e) in boundary.iter().enumerate() {
        for &f in &boundary[i + 1..] {
            let kind = match e.iter().find(|v| f.contains(v)) {
                None => meet(at(e[0]), at(e[1]), at(f[0]), at(f[1])),
                Some(&p) => {
                    let other = |e: [u32; 2]| at(if e[0] == p { e[1] } else { e[0] });
                    let (q, r, p) = (other(e), other(f), at(p));
                    if p == q || p == r {
                        Some(CrossingKind::Touch)
                    } else if on(p, q, r) || on(p, r, q) {
                        Some(CrossingKind::Overlap)
                    } else {
                        None
                    }
                }
            };
            found.extend(kind.map(|kind| ([e, f], kind)));
        }
    }
    found
}

/// Do positive triangles meet outside the vertex or edge they share?
fn triangles_meet(s: &[u32; 3], t: &[u32; 3], uv: &[Point]) -> bool {
    let at = |v: u32| uv[v as usize];
    let edges = |t: &[u32; 3]| [0, 1, 2].map(|k| [t[k], t[(k + 1) % 3]]);
    let inside = |v: u32, t: &[u32; 3]| {
        !t.contains(&v)
            && edges(t)
                .iter()
                .all(|e| turn(at(e[0]), at(e[1]), at(v)) >= 0)
    };
    s.iter().any(|&v| inside(v, t))
        || t.iter().any(|&v| inside(v, s))
        || edges(s).iter().any(|e| {
            edges(t).iter().any(|f| {
                !e.iter().any(|v| f.contains(v))
                    && meet(at(e[0]), at(e[1]), at(f[0]), at(f[1])).is_some()
            })
        })
        || s.iter().all(|v| t.contains(v))
}

/// Do positive triangles that share a vertex overlap right beside it, or coincide in a boundary
/// direction there that is not a shared edge?
fn sectors_overlap(s: &[u32; 3], t: &[u32; 3], uv: &[Point]) -> bool {
    let at = |v: u32| uv[v as usize];
    let corner = |t: &[u32; 3], v: u32| {
        let k = t.iter().position(|&w| w == v).expect("shared");
        [t[(k + 1) % 3], t[(k + 2) % 3]]
    };
    s.iter().filter(|v| t.contains(v)).any(|&v| {
        let ([a, b], [c, d]) = (corner(s, v), corner(t, v));
        let left = |p: u32, q: u32| turn(at(v), at(p), at(q));
        let along = |p: u32, q: u32| {
            let (o, p, q) = (at(v), at(p), at(q));
            turn(o, p, q) == 0 && (on(o, p, q) || on(o, q, p))
        };
        let within = |p: u32, from: u32, to: u32| left(from, p) > 0 && left(p, to) > 0;
        let touching = [(a, c), (a, d), (b, c), (b, d)]
            .iter()
            .any(|&(p, q)| p != q && along(p, q));
        within(a, c, d)
            || within(b, c, d)
            || within(c, a, b)
            || within(d, a, b)
            || along(a, c)
            || touching
    })
}

/// Checks a certificate of an integer map against the brute force, `uv · scale` being the map.
pub fn agree(triangles: &[[u32; 3]], uv: &[Point], scale: f64) -> Certificate {
    let rest = SurfaceMesh {
        positions: (0..uv.len())
            .map(|i| DVec3::new(i as f64, (i * i % 17) as f64, (i % 3) as f64))
            .collect(),
        simplices: triangles.to_vec(),
    };
    let map: Vec<DVec2> = uv
        .iter()
        .map(|p| DVec2::new(p.0 as f64, p.1 as f64) * scale)
        .collect();
    let c = Certificate::of_map(&rest, &map);
    let t = truth(triangles, uv);
    let crossings: Vec<_> = c
        .boundary_crossings
        .iter()
        .map(|c| (c.edges, c.kind))
        .collect();
    assert_eq!(c.inverted, t.inverted);
    assert_eq!(c.degenerate, t.degenerate);
    if !c.mirrored {
        assert_eq!(crossings, t.crossings);
        assert_eq!(
            c.locally_injective,
            t.locally_injective == Some(true),
            "{c:#?}\n{t:#?}"
        );
        assert_eq!(
            c.globally_injective,
            t.globally_injective == Some(true),
            "{c:#?}\n{t:#?}"
        );
    }
    c
}
