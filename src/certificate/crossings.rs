//! All pairs of boundary edges that meet and should not.
//!
//! Broad phase: a binary tree of boxes over the edges, split at the median of the longer side, walked
//! against itself. Boxes are made of coordinates only compared, never computed with, so nothing is
//! lost to rounding; the narrow phase (`segments`) decides exactly.

use super::segments::{CrossingKind, meet, meet_beyond};
use glam::DVec2;

/// Two boundary edges whose images meet where they should not.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct BoundaryCrossing {
    /// The two edges, each by its vertices in the direction of its triangle.
    pub edges: [[u32; 2]; 2],
    /// How they meet.
    pub kind: CrossingKind,
}

/// Edges in a leaf of the tree.
const LEAF: usize = 4;

#[derive(Clone, Copy)]
struct Box2 {
    low: DVec2,
    high: DVec2,
}

impl Box2 {
    const EMPTY: Self = Self {
        low: DVec2::INFINITY,
        high: DVec2::NEG_INFINITY,
    };
    fn union(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
    fn overlaps(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }
}

struct Search<'a> {
    edges: &'a [[u32; 2]],
    uv: &'a [DVec2],
    boxes: Vec<Box2>,
    /// Edges in the order of the tree; node `k` over `range` has children over its halves.
    order: Vec<u32>,
    nodes: Vec<Box2>,
    limit: usize,
    found: Vec<BoundaryCrossing>,
}

/// The crossings among `edges`, sorted by their vertices, at most `limit` of
/// them. Every end of an edge must be finite.
pub(super) fn find(edges: &[[u32; 2]], uv: &[DVec2], limit: usize) -> Vec<BoundaryCrossing> {
    if edges.is_empty() || limit == 0 {
        return Vec::new();
    }
    let boxes: Vec<Box2> = edges
        .iter()
        .map(|&[a, b]| {
            let (a, b) = (uv[a as usize], uv[b as usize]);
            Box2 {
                low: a.min(b),
                high: a.max(b),
            }
        })
        .collect();
    let mut order: Vec<u32> = (0..edges.len() as u32).collect();
    let mut nodes = vec![Box2::EMPTY; 2 * edges.len().div_ceil(LEAF).next_power_of_two()];
    build(&mut nodes, &mut order, &boxes, 1);
    let mut search = Search {
        edges,
        uv,
        boxes,
        order,
        nodes,
        limit,
        found: Vec::new(),
    };
    search.within(1, 0, edges.len());
    let mut found = search.found;
    found.sort_unstable_by_key(|c| c.edges);
    found
}

/// Children of node k are 2k and 2k+1, over the lower and upper half of its edges.
fn build(nodes: &mut [Box2], order: &mut [u32], boxes: &[Box2], node: usize) {
    let bounds = order
        .iter()
        .fold(Box2::EMPTY, |b, &e| b.union(boxes[e as usize]));
    nodes[node] = bounds;
    if is_leaf(nodes.len(), node) {
        return;
    }
    let extent = bounds.high * 0.5 - bounds.low * 0.5;
    let axis = usize::from(extent.y > extent.x);
    let middle = order.len() / 2;
    if !order.is_empty() {
        order.select_nth_unstable_by(middle, |&i, &j| {
            let centre = |e: u32| {
                let b = boxes[e as usize];
                b.low[axis] * 0.5 + b.high[axis] * 0.5
            };
            centre(i).total_cmp(&centre(j)).then(i.cmp(&j))
        });
    }
    let (lower, upper) = order.split_at_mut(middle);
    build(nodes, lower, boxes, 2 * node);
    build(nodes, upper, boxes, 2 * node + 1);
}

fn is_leaf(nodes: usize, node: usize) -> bool {
    2 * node >= nodes
}

impl Search<'_> {
    fn full(&self) -> bool {
        self.found.len() >= self.limit
    }

    /// Pairs inside one node.
    fn within(&mut self, node: usize, start: usize, end: usize) {
        if self.full() || end - start < 2 {
            return;
        }
        if is_leaf(self.nodes.len(), node) {
            for i in start..end {
                for j in i + 1..end {
                    self.test(i, j);
                }
            }
            return;
        }
        let middle = start + (end - start) / 2;
        self.within(2 * node, start, middle);
        self.within(2 * node + 1, middle, end);
        self.between((2 * node, start, middle), (2 * node + 1, middle, end));
    }

    /// Pairs with one edge in each of two nodes.
    fn between(&mut self, a: (usize, usize, usize), b: (usize, usize, usize)) {
        if self.full() || !self.nodes[a.0].overlaps(&self.nodes[b.0]) {
            return;
        }
        if is_leaf(self.nodes.len(), a.0) && is_leaf(self.nodes.len(), b.0) {
            for i in a.1..a.2 {
                for j in b.1..b.2 {
                    self.test(i, j);
                }
            }
            return;
        }
        let halves = |(node, start, end): (usize, usize, usize)| {
            let middle = start + (end - start) / 2;
            [(2 * node, start, middle), (2 * node + 1, middle, end)]
        };
        // The tree is complete: both are leaves at once, or neither; split the larger set.
        let (split, whole) = if is_leaf(self.nodes.len(), a.0) || b.2 - b.1 > a.2 - a.1 {
            (b, a)
        } else {
            (a, b)
        };
        for half in halves(split) {
            self.between(half, whole);
        }
    }

    fn test(&mut self, i: usize, j: usize) {
        let (i, j) = (self.order[i] as usize, self.order[j] as usize);
        let (i, j) = (i.min(j), i.max(j));
        if self.full() || !self.boxes[i].overlaps(&self.boxes[j]) {
            return;
        }
        let (e, f) = (self.edges[i], self.edges[j]);
        let at = |v: u32| self.uv[v as usize];
        let shared = |v: u32| f.contains(&v);
        let other = |edge: [u32; 2], v: u32| if edge[0] == v { edge[1] } else { edge[0] };
        let kind = match (shared(e[0]), shared(e[1])) {
            (false, false) => meet(at(e[0]), at(e[1]), at(f[0]), at(f[1])),
            (true, true) => Some(CrossingKind::Overlap),
            (first, _) => {
                let p = if first { e[0] } else { e[1] };
                meet_beyond(at(p), at(other(e, p)), at(other(f, p)))
            }
        };
        if let Some(kind) = kind {
            self.found.push(BoundaryCrossing {
                edges: [e, f],
                kind,
            });
        }
    }
}
