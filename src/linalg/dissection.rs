//! Nested dissection (George 1973): a set of vertices whose removal splits the graph in two halves is
//! eliminated after both, which then know nothing of each other.
//!
//! It takes the graph alone, no coordinates, so that neither rotation nor scale can change an order.
//! A half is one end of the graph as seen by a walker: breadth-first distances from two vertices far
//! apart, one minus the other, smoothed by a few averages over neighbours, cut near the
//! median. The separator is the smallest set of vertices that covers all cut edges.

use super::Graph;
use super::cut::Cut;
use crate::total_order::ranked;

/// The two sides and what separates them.
#[derive(Debug, Clone, Default)]
pub struct Bisection {
    /// One side and the other, ascending.
    pub sides: [Vec<u32>; 2],
    /// No edge leads from one side to the other but through these (ascending).
    pub separator: Vec<u32>,
}

const NONE: u32 = u32::MAX;

/// Walks that are tried, each from a vertex far from the ends of the one before.
const WALKS: usize = 3;

/// Places that are tried, as the fraction of the vertices on one side: ascending,
const PLACES: [f64; 5] = [0.42, 0.46, 0.5, 0.54, 0.58];

/// and in the order in which they are tried: of equals the first is taken.
const TRIED: [usize; 5] = [2, 1, 3, 0, 4];

/// Averages over neighbours: enough that level sets are as straight as a mesh allows.
const SMOOTHING: usize = 12;

/// Splits a graph. What separates the sides are vertices of its largest component; the other components
/// fill up the smaller side.
pub fn bisect(graph: &Graph) -> Bisection {
    let n = graph.vertices();
    let mut distance = vec![NONE; n];
    let mut components = Vec::new();
    for v in 0..n as u32 {
        if distance[v as usize] == NONE {
            components.push(reach(graph, v, &mut distance));
        }
    }
    components.sort_by_key(|c| core::cmp::Reverse(c.len()));
    let mut components = components.into_iter();
    let Some(mut largest) = components.next() else {
        return Bisection::default();
    };
    let farthest = largest[largest.len() - 1];
    if largest.len() == n && n > 1 {
        return bisect_connected(graph, farthest);
    }
    largest.sort_unstable();
    let mut split = if largest.len() > n.div_ceil(2) {
        bisect_part(graph, &largest, farthest)
    } else {
        Bisection {
            sides: [largest, Vec::new()],
            separator: Vec::new(),
        }
    };
    for component in components {
        let smaller = usize::from(split.sides[1].len() < split.sides[0].len());
        split.sides[smaller].extend(component);
    }
    split.sides.iter_mut().for_each(|side| side.sort_unstable());
    split
}

/// Breadth-first distances from `start` to all that it reaches, into `distance`, which is `NONE` there;
/// returns those, nearest first.
fn reach(graph: &Graph, start: u32, distance: &mut [u32]) -> Vec<u32> {
    let mut queue = vec![start];
    distance[start as usize] = 0;
    let mut head = 0;
    while head < queue.len() {
        let v = queue[head];
        head += 1;
        let next = distance[v as usize] + 1;
        for &w in graph.of(v) {
            let distance = &mut distance[w as usize];
            if *distance == NONE {
                *distance = next;
                queue.push(w);
            }
        }
    }
    queue
}

/// Distances from `start` to all of a connected graph; returns the last of the farthest.
fn distances(graph: &Graph, start: u32, distance: &mut [u32]) -> u32 {
    distance.fill(NONE);
    let reached = reach(graph, start, distance);
    reached[reached.len() - 1]
}

/// Splits a component of two vertices or more (ascending), by walks of which the first is from `start`.
fn bisect_part(graph: &Graph, component: &[u32], start: u32) -> Bisection {
    let part = graph.part(component, &graph.places(&[component]));
    let start = component.partition_point(|&v| v < start);
    let mut split = bisect_connected(&part, start as u32);
    let sets = split.sides.iter_mut().chain([&mut split.separator]);
    sets.flatten().for_each(|v| *v = component[*v as usize]);
    split
}

/// Splits a connected graph of two vertices or more: of a few ways to walk through it, the first from
/// `start`, and a few places near the middle, the one with the smallest separator for its balance.
fn bisect_connected(graph: &Graph, start: u32) -> Bisection {
    let n = graph.vertices();
    let ends = PLACES.map(|place| ((n as f64 * place) as usize).clamp(1, n - 1));
    let values = walks(graph, start);
    let mut cut = Cut::new(n);
    let mut best: Option<(f64, Vec<bool>, Vec<u32>)> = None;
    for walk in 0..WALKS {
        let zone = zones(values.iter().map(|v| v[walk]), &ends);
        let boundaries = boundaries(graph, &zone);
        for place in TRIED {
            let smaller = ends[place].min(n - ends[place]) as f64;
            let least = best.as_ref().map_or(f64::INFINITY, |(least, ..)| *least);
            let is_left = |v: u32| usize::from(zone[v as usize]) <= place;
            let better = |size: usize| size as f64 / smaller < least;
            if let Some(cover) = cut.cover(graph, &boundaries[place], is_left, better) {
                let left = (0..n as u32).map(is_left).collect();
                best = Some((cover.len() as f64 / smaller, left, cover));
            }
        }
    }
    let (_, mut left, separator) = best.unwrap_or_default();
    let mut right: Vec<bool> = left.iter().map(|left| !left).collect();
    for &v in &separator {
        left[v as usize] = false;
        right[v as usize] = false;
    }
    let members = |is: Vec<bool>| (0..).zip(is).filter_map(|(v, is)| is.then_some(v));
    Bisection {
        sides: [left, right].map(|side| members(side).collect()),
        separator,
    }
}

/// How far along each vertex is on each walk, of which the first is from `one` to the vertex farthest from
/// it; the next begins far from both ends.
fn walks(graph: &Graph, mut one: u32) -> Vec<[f64; WALKS]> {
    let n = graph.vertices();
    let mut value = vec![[0.0; WALKS]; n];
    let [mut from, mut to] = [vec![0u32; n], vec![0u32; n]];
    for walk in 0..WALKS {
        let other = distances(graph, one, &mut from);
        distances(graph, other, &mut to);
        let mut beside = (0, one);
        for (v, (&from, &to)) in from.iter().zip(&to).enumerate() {
            let nearer = from.min(to);
            if nearer > beside.0 {
                beside = (nearer, v as u32);
            }
            value[v][walk] = f64::from(from) - f64::from(to);
        }
        one = beside.1;
    }
    let mut smooth = value.clone();
    for _ in 0..SMOOTHING {
        for (v, (smooth, own)) in smooth.iter_mut().zip(&value).enumerate() {
            let neighbours = graph.of(v as u32);
            let mut sums = [0.0; WALKS];
            for &w in neighbours {
                let of_neighbour = &value[w as usize];
                for walk in 0..WALKS {
                    sums[walk] += of_neighbour[walk];
                }
            }
            let count = 1.0 + neighbours.len() as f64;
            *smooth = core::array::from_fn(|walk| (own[walk] + sums[walk]) / count);
        }
        core::mem::swap(&mut value, &mut smooth);
    }
    value
}

/// How many of these ends (ascending) a vertex is behind, were the vertices sorted by value, then by number:
/// those before end k are in zones up to k.
fn zones(values: impl Iterator<Item = f64>, ends: &[usize; PLACES.len()]) -> Vec<u8> {
    let mut order: Vec<(i64, u32)> = values.map(ranked).zip(0..).collect();
    // the middle first, outwards from there
    let [a, b, c, d, e] = *ends;
    for (first, end, limit) in [
        (0, c, order.len()),
        (0, b, c),
        (0, a, b),
        (c, d, order.len()),
        (d, e, order.len()),
    ] {
        if end < limit {
            order[first..limit].select_nth_unstable(end - first);
        }
    }
    let mut zone = vec![0; order.len()];
    for (&end, number) in ends.iter().zip(1..) {
        for &(_, v) in &order[end..] {
            zone[v as usize] = number;
        }
    }
    zone
}

/// For each place the vertices before it that have a neighbour behind it.
fn boundaries(graph: &Graph, zone: &[u8]) -> [Vec<u32>; PLACES.len()] {
    let mut boundaries = [const { Vec::new() }; PLACES.len()];
    for (&own, v) in zone.iter().zip(0..) {
        let of_neighbours = graph.of(v).iter().map(|&w| zone[w as usize]);
        let last = of_neighbours.fold(own, u8::max);
        for boundary in &mut boundaries[usize::from(own)..usize::from(last)] {
            boundary.push(v);
        }
    }
    boundaries
}
