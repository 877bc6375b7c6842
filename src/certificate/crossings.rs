//! All pairs of boundary edges that meet and should not.
//!
//! The tree of boxes gives pairs that may meet. Boxes are made of coordinates only compared, never computed
//! with, so nothing is lost to rounding; the narrow phase (`segments`) decides exactly.

use super::segments::{CrossingKind, meet, meet_beyond};
use crate::boxes::{Bounds, Tree};
use glam::DVec2;
use std::ops::ControlFlow;

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

/// The crossings among `edges`, sorted by their vertices, at most `limit` of
/// them. Every end of an edge must be finite.
pub(super) fn find(edges: &[[u32; 2]], uv: &[DVec2], limit: usize) -> Vec<BoundaryCrossing> {
    let mut found = Vec::new();
    if limit == 0 {
        return found;
    }
    let at = |v: u32| uv[v as usize].to_array();
    let around = |&[a, b]: &[u32; 2]| Bounds::EMPTY.with(at(a)).with(at(b));
    let boxes: Vec<Bounds<2>> = edges.iter().map(around).collect();
    Tree::new(&boxes).pairs(&boxes, &mut |i, j| {
        let [e, f] = [i, j].map(|edge| edges[edge as usize]);
        if let Some(kind) = crossing(e, f, uv) {
            found.push(BoundaryCrossing {
                edges: [e, f],
                kind,
            });
        }
        match found.len() < limit {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    });
    found.sort_unstable_by_key(|c| c.edges);
    found
}

/// How the images of two edges meet where they should not: anywhere, but in a vertex that they share.
fn crossing(e: [u32; 2], f: [u32; 2], uv: &[DVec2]) -> Option<CrossingKind> {
    let at = |v: u32| uv[v as usize];
    let shared = |v: u32| f.contains(&v);
    let other = |edge: [u32; 2], v: u32| if edge[0] == v { edge[1] } else { edge[0] };
    match (shared(e[0]), shared(e[1])) {
        (false, false) => meet(at(e[0]), at(e[1]), at(f[0]), at(f[1])),
        (true, true) => Some(CrossingKind::Overlap),
        (first, _) => {
            let p = if first { e[0] } else { e[1] };
            meet_beyond(at(p), at(other(e, p)), at(other(f, p)))
        }
    }
}
