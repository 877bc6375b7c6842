//! Pieces of the plane that hang on one vertex.

use crate::disjoint_sets::DisjointSets;
use crate::geometry::{Elimination, RestShape};

/// The piece of each slot, and, of the pieces with one pinned vertex, which come first, that vertex: its slot, the
/// pinned counted from 0.
pub(super) fn only_pins(rest: &RestShape, elimination: &Elimination) -> (Vec<u32>, Vec<u32>) {
    let slots = elimination.slot.len();
    let mut sets = DisjointSets::new(slots);
    for e in 0..rest.len() {
        let simplex = rest.simplex(e);
        for pair in simplex.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|v| elimination.slot[v as usize]);
            sets.join(a, b);
        }
    }
    let roots: Vec<u32> = (0..slots as u32).map(|slot| sets.find(slot)).collect();
    let mut pins = vec![0u32; slots];
    for &root in &roots[elimination.free..] {
        pins[root as usize] += 1;
    }
    let mut number = vec![u32::MAX; slots];
    let mut only = Vec::new();
    for (pin, &root) in roots[elimination.free..].iter().enumerate() {
        if pins[root as usize] == 1 {
            number[root as usize] = only.len() as u32;
            only.push(pin as u32);
        }
    }
    let piece = roots.iter().map(|&root| number[root as usize]).collect();
    (piece, only)
}
