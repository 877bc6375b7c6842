//! How often does a map without inverted triangles cover the plane? Counted exactly, at a vertex by
//! its own triangles, and anywhere by the winding of the boundary.

use super::predicates::{compare_points, orientation};
use glam::DVec2;
use std::cmp::Ordering;

/// The half-plane a direction from `v` is in: false for angles in [0, π), true for [π, 2π). The
/// direction of a point onto itself counts as angle 0.
fn lower(v: DVec2, p: DVec2) -> bool {
    p.y < v.y || (p.y == v.y && p.x < v.x)
}

/// Order of the directions from `v` by angle in [0, 2π).
fn compare_angles(v: DVec2, p: DVec2, q: DVec2) -> Ordering {
    lower(v, p)
        .cmp(&lower(v, q))
        .then_with(|| orientation(v, p, q).reverse())
}

/// A boundary edge as seen from one of its ends: turning counter-clockwise over it, one enters
/// (+1) or leaves (−1) the surface.
#[derive(Clone, Copy)]
struct Ray {
    at: u32,
    to: u32,
    change: i64,
}

/// The rays of all boundary vertices, those of a vertex together and ordered by angle; of equal
/// angles the entering come first.
fn rays(boundary: &[[u32; 2]], uv: &[DVec2]) -> Vec<Ray> {
    let mut rays = Vec::with_capacity(2 * boundary.len());
    for &[a, b] in boundary {
        rays.push(Ray {
            at: a,
            to: b,
            change: 1,
        });
        rays.push(Ray {
            at: b,
            to: a,
            change: -1,
        });
    }
    rays.sort_by(|r, s| {
        r.at.cmp(&s.at)
            .then_with(|| {
                let at = |v: u32| uv[v as usize];
                compare_angles(at(r.at), at(r.to), at(s.to))
            })
            .then(s.change.cmp(&r.change))
    });
    rays
}

/// Largest number of sheets met in one turn, beginning with `first` of them.
fn most_sheets(first: i64, rays: &[Ray]) -> i64 {
    let mut sheets = first;
    rays.iter().fold(first, |most, ray| {
        sheets += ray.change;
        most.max(sheets)
    })
}

/// Vertices around which the triangles wind more than once, so that the map is not injective near
/// them even though no triangle is inverted. For maps whose triangles are all positive.
pub(super) fn overwound_vertices(
    triangles: &[[u32; 3]],
    boundary: &[[u32; 2]],
    uv: &[DVec2],
) -> Vec<u32> {
    // A triangle turns by less than π at its corner: it covers the direction just before angle 0
    // when it goes from the lower half-plane to the upper.
    let mut turns = vec![0i64; uv.len()];
    for t in triangles {
        for k in 0..3 {
            let [v, next, previous] = [0, 1, 2].map(|i| uv[t[(k + i) % 3] as usize]);
            if lower(v, next) && !lower(v, previous) {
                turns[t[k] as usize] += 1;
            }
        }
    }
    let rays = rays(boundary, uv);
    for fan in rays.chunk_by(|r, s| r.at == s.at) {
        let v = fan[0].at as usize;
        turns[v] = most_sheets(turns[v], fan);
    }
    (0..uv.len() as u32)
        .filter(|&v| turns[v as usize] > 1)
        .collect()
}

/// Largest number of triangles over one point of the plane (edges and vertices apart). For maps whose
/// triangles are all positive and whose boundary does not meet itself: the number of triangles over
/// a point is then the sum of the boundary's winding numbers, which changes only across the
/// boundary, so looking around one vertex of every boundary loop sees every value it takes.
pub(super) fn sheets(boundary: &[[u32; 2]], uv: &[DVec2]) -> i64 {
    let rays = rays(boundary, uv);
    let queries: Vec<&[Ray]> = queries(boundary, &rays, uv);
    // Sweep upwards over the queries; `active` holds the edges that end at or above the query and
    // begin below it.
    let at = |v: u32| uv[v as usize];
    let span = |e: &[u32; 2]| {
        let (a, b) = (at(e[0]).y, at(e[1]).y);
        (a.min(b), a.max(b))
    };
    let mut edges: Vec<[u32; 2]> = boundary.to_vec();
    edges.sort_unstable_by(|e, f| span(e).0.total_cmp(&span(f).0));
    let mut coming = edges.iter().peekable();
    let mut active: Vec<[u32; 2]> = Vec::new();
    let mut most = 0;
    for fan in queries {
        let v = fan[0].at;
        let p = at(v);
        while let Some(e) = coming.next_if(|e| span(e).0 < p.y) {
            active.push(*e);
        }
        active.retain(|e| span(e).1 >= p.y);
        // Winding number of the point infinitely close to p, just below the ray to the right.
        let winding: i64 = active
            .iter()
            .filter(|e| !e.contains(&v))
            .map(|&[a, b]| match orientation(at(a), at(b), p) {
                Ordering::Greater if at(a).y < p.y => 1,
                Ordering::Less if at(b).y < p.y => -1,
                _ => 0,
            })
            .sum();
        most = most.max(most_sheets(winding, fan));
    }
    most
}

/// The vertices to look around, from low to high: of every boundary loop the lexicographically
/// smallest, or all where loops share vertices.
fn queries<'a>(boundary: &[[u32; 2]], rays: &'a [Ray], uv: &[DVec2]) -> Vec<&'a [Ray]> {
    let mut fan_of = vec![None; uv.len()];
    let mut next = vec![None; uv.len()];
    for fan in rays.chunk_by(|r, s| r.at == s.at) {
        fan_of[fan[0].at as usize] = Some(fan);
    }
    for &[a, b] in boundary {
        next[a as usize] = Some(b);
    }
    let mut queries: Vec<&[Ray]> = Vec::new();
    let mut seen = vec![false; uv.len()];
    for &[start, _] in boundary {
        let mut cycle = Vec::new();
        let mut v = start;
        while !std::mem::replace(&mut seen[v as usize], true) {
            cycle.push(v);
            match next[v as usize] {
                Some(n) => v = n,
                None => break,
            }
        }
        let fans = || cycle.iter().filter_map(|&v| fan_of[v as usize]);
        if v == start && fans().all(|fan| fan.len() == 2) {
            queries.extend(
                fans().min_by(|f, g| compare_points(uv[f[0].at as usize], uv[g[0].at as usize])),
            );
        } else {
            queries.extend(fans());
        }
    }
    queries.sort_by(|f, g| uv[f[0].at as usize].y.total_cmp(&uv[g[0].at as usize].y));
    queries
}
