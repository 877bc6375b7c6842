//! Nested dissection (George 1973): a set of vertices whose removal splits the graph in two halves is
//! eliminated after both, which then know nothing of each other.
//!
//! It takes the graph alone, no coordinates, so that neither rotation nor scale can change an order.
//! A half is one end of the graph as seen by a walker: breadth-first distances from two vertices far
//! apart, one minus the other, smoothed by a few averages over neighbours, cut near the
//! median. The separator is the smallest set of vertices that covers all cut edges (Kőnig 1931: from a largest
//! matching of the cut edges).

use super::Graph;
use std::collections::BTreeSet;

/// The two sides and what separates them.
#[derive(Debug, Clone, Default)]
pub struct Bisection {
    /// One side and the other.
    pub sides: [Vec<u32>; 2],
    /// No edge leads from one side to the other but through these.
    pub separator: Vec<u32>,
}

/// Room for bisections of one graph.
pub struct Bisector<'a> {
    graph: &'a Graph,
    /// Which call a vertex belongs to.
    member: Vec<u32>,
    calls: u32,
    /// Distance or place in this call.
    number: Vec<u32>,
    value: Vec<f64>,
    smooth: Vec<f64>,
}

const NONE: u32 = u32::MAX;

/// Walks that are tried, each from a vertex far from the ends of the one before.
const WALKS: usize = 3;

/// Places that are tried, as the fraction of the vertices on one side.
const PLACES: [f64; 5] = [0.5, 0.46, 0.54, 0.42, 0.58];

/// Averages over neighbours: enough that level sets are as straight as a mesh allows.
const SMOOTHING: usize = 12;

impl<'a> Bisector<'a> {
    /// For this graph.
    pub fn new(graph: &'a Graph) -> Self {
        let n = graph.vertices();
        Self {
            graph,
            member: vec![0; n],
            calls: 0,
            number: vec![NONE; n],
            value: vec![0.0; n],
            smooth: vec![0.0; n],
        }
    }

    /// Breadth-first distances from `start` to all that it reaches among the members, into `number`,
    /// which is `NONE` there; returns those, nearest first.
    fn reach(&mut self, start: u32) -> Vec<u32> {
        let mut queue = vec![start];
        self.number[start as usize] = 0;
        let mut head = 0;
        while head < queue.len() {
            let v = queue[head];
            head += 1;
            for &w in self.graph.of(v) {
                let w_at = w as usize;
                if self.member[w_at] == self.calls && self.number[w_at] == NONE {
                    self.number[w_at] = self.number[v as usize] + 1;
                    queue.push(w);
                }
            }
        }
        queue
    }

    /// Distances from `start` to all of a connected set; returns the last of the farthest.
    fn distances(&mut self, vertices: &[u32], start: u32) -> u32 {
        for &v in vertices {
            self.number[v as usize] = NONE;
        }
        let reached = self.reach(start);
        reached[reached.len() - 1]
    }

    /// Splits a set of vertices. What separates them are vertices of its largest component; the other
    /// components fill up the smaller side.
    pub fn bisect(&mut self, vertices: &[u32]) -> Bisection {
        self.calls += 1;
        for &v in vertices {
            self.member[v as usize] = self.calls;
            self.number[v as usize] = NONE;
        }
        let mut components = Vec::new();
        for &v in vertices {
            if self.number[v as usize] == NONE {
                components.push(self.reach(v));
            }
        }
        components.sort_by_key(|c| core::cmp::Reverse(c.len()));
        let mut components = components.into_iter();
        let Some(mut largest) = components.next() else {
            return Bisection::default();
        };
        largest.sort_unstable();
        let mut split = match largest.len() > vertices.len().div_ceil(2) {
            true => self.bisect_connected(&largest),
            false => Bisection {
                sides: [largest, Vec::new()],
                separator: Vec::new(),
            },
        };
        for component in components {
            let smaller = usize::from(split.sides[1].len() < split.sides[0].len());
            split.sides[smaller].extend(component);
        }
        split.sides.iter_mut().for_each(|side| side.sort_unstable());
        split
    }

    /// Splits a connected set: of a few ways to walk through the graph and a few places near the middle,
    /// the one with the smallest separator for its balance.
    fn bisect_connected(&mut self, vertices: &[u32]) -> Bisection {
        if let &[single] = vertices {
            return Bisection {
                separator: vec![single],
                ..Bisection::default()
            };
        }
        let mut best: Option<(f64, Vec<u32>, usize, BTreeSet<u32>)> = None;
        let mut one = self.distances(vertices, vertices[0]);
        for _ in 0..WALKS {
            let beside = self.walk(vertices, one);
            let mut order = vertices.to_vec();
            order.sort_by(|&a, &b| {
                let values = [a, b].map(|v| self.value[v as usize]);
                values[0].total_cmp(&values[1]).then(a.cmp(&b))
            });
            for place in PLACES {
                let left = (order.len() as f64 * place) as usize;
                let left = left.clamp(1, order.len() - 1);
                let cover = self.cover(&order, left);
                let smaller = left.min(order.len() - left);
                let cost = cover.len() as f64 / smaller as f64;
                if best.as_ref().is_none_or(|(least, ..)| cost < *least) {
                    best = Some((cost, order.clone(), left, cover));
                }
            }
            one = beside;
        }
        let (_, order, left, cover) = best.unwrap_or_default();
        let side = |part: &[u32]| -> Vec<u32> {
            let own = part.iter().copied().filter(|v| !cover.contains(v));
            own.collect()
        };
        Bisection {
            sides: [side(&order[..left]), side(&order[left..])],
            separator: cover.iter().copied().collect(),
        }
    }

    /// Sets `value` to how far along a vertex is on the walk from `one` to the vertex farthest from it;
    /// returns a vertex far from both ends.
    fn walk(&mut self, vertices: &[u32], one: u32) -> u32 {
        let other = self.distances(vertices, one);
        for &v in vertices {
            self.value[v as usize] = f64::from(self.number[v as usize]);
        }
        self.distances(vertices, other);
        let mut beside = (0.0, one);
        for &v in vertices {
            let distance = f64::from(self.number[v as usize]);
            let value = &mut self.value[v as usize];
            let nearer = distance.min(*value);
            if nearer > beside.0 {
                beside = (nearer, v);
            }
            *value -= distance;
        }
        for _ in 0..SMOOTHING {
            for &v in vertices {
                let own = |w: &&u32| self.member[**w as usize] == self.calls;
                let neighbours = self.graph.of(v).iter().filter(own);
                let (sum, count) = neighbours.fold((0.0, 0.0), |(sum, count), &w| {
                    (sum + self.value[w as usize], count + 1.0)
                });
                self.smooth[v as usize] = (self.value[v as usize] + sum) / (1.0 + count);
            }
            core::mem::swap(&mut self.value, &mut self.smooth);
        }
        beside.1
    }

    /// The smallest set of vertices that covers every edge between the first `half` of `order` and the
    /// rest.
    fn cover(&mut self, order: &[u32], half: usize) -> BTreeSet<u32> {
        for (k, &v) in order.iter().enumerate() {
            self.number[v as usize] = k as u32;
        }
        let (graph, member, calls, number) = (self.graph, &self.member, self.calls, &self.number);
        // partners across the cut of a vertex of the left side
        let across = |v: u32| {
            graph.of(v).iter().copied().filter(move |&w| {
                member[w as usize] == calls && number[w as usize] as usize >= half
            })
        };
        let left: Vec<u32> = order[..half]
            .iter()
            .copied()
            .filter(|&v| across(v).next().is_some())
            .collect();
        // by place in `order`: the partner of a matched vertex
        let mut partner = vec![NONE; order.len()];
        let mut seen = vec![NONE; order.len()];
        for (round, &start) in left.iter().enumerate() {
            augment(
                start,
                round as u32,
                &across,
                number,
                &mut partner,
                &mut seen,
            );
        }
        // what alternating paths from unmatched vertices of the left side reach
        let mut reached = vec![false; order.len()];
        let unmatched = |v: &u32| partner[number[*v as usize] as usize] == NONE;
        let mut stack: Vec<u32> = left.iter().copied().filter(unmatched).collect();
        stack
            .iter()
            .for_each(|&v| reached[number[v as usize] as usize] = true);
        while let Some(v) = stack.pop() {
            for w in across(v) {
                let place = number[w as usize] as usize;
                if !reached[place] {
                    reached[place] = true;
                    let back = partner[place];
                    if back != NONE && !reached[number[back as usize] as usize] {
                        reached[number[back as usize] as usize] = true;
                        stack.push(back);
                    }
                }
            }
        }
        let of_left = left
            .iter()
            .filter(|&&v| !reached[number[v as usize] as usize]);
        let of_right = order[half..]
            .iter()
            .filter(|&&w| reached[number[w as usize] as usize]);
        of_left.chain(of_right).copied().collect()
    }
}

/// Looks for a path from `start` that alternates between unmatched and matched edges and ends at an
/// unmatched vertex of the right side, and makes the matching larger by it.
fn augment<'a, I: Iterator<Item = u32> + 'a>(
    start: u32,
    round: u32,
    across: &impl Fn(u32) -> I,
    number: &[u32],
    partner: &mut [u32],
    seen: &mut [u32],
) {
    // depth first with a stack of its own: paths can be long
    let mut path: Vec<(u32, I, u32)> = vec![(start, across(start), NONE)];
    while let Some((_, candidates, taken)) = path.last_mut() {
        let Some(w) = candidates.find(|&w| seen[number[w as usize] as usize] != round) else {
            path.pop();
            continue;
        };
        *taken = w;
        let place = number[w as usize] as usize;
        seen[place] = round;
        let back = partner[place];
        if back != NONE {
            path.push((back, across(back), NONE));
            continue;
        }
        for (v, _, taken) in path {
            partner[number[v as usize] as usize] = taken;
            partner[number[taken as usize] as usize] = v;
        }
        return;
    }
}
