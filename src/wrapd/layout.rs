//! Where elements and their corners lie in memory.

use super::block::{BLOCK, Block};
use super::elements::Shape;
use crate::geometry::RestShape;
use core::array::from_fn;

/// Elements in the order of their lowest slots, so that the positions a block reads and the forces a
/// vertex gathers are close together.
pub fn element_order(rest: &RestShape, slot: &[u32]) -> Vec<u32> {
    let lowest = |e: u32| {
        let slots = rest.simplex(e as usize).iter().map(|&v| slot[v as usize]);
        slots.fold(u32::MAX, u32::min)
    };
    let mut order: Vec<u32> = (0..rest.len() as u32).collect();
    order.sort_by_cached_key(|&e| lowest(e));
    order
}

/// The elements in blocks, Z and U not set.
pub fn build_blocks(rest: &RestShape, slot: &[u32], shape: &Shape) -> Vec<Block> {
    let k = rest.stretches;
    (0..rest.len())
        .step_by(BLOCK)
        .map(|begin| {
            let len = (rest.len() - begin).min(BLOCK);
            let source = |e: usize| begin + e.min(len - 1);
            let zeros = |count: usize| vec![[0.0; BLOCK]; count];
            let constant = |value: f64| vec![[value; BLOCK]];
            Block {
                vertices: (0..=k)
                    .map(|v| from_fn(|e| slot[rest.simplex(source(e))[v] as usize]))
                    .collect(),
                inverse: (0..k * k)
                    .map(|c| from_fn(|e| rest.inverse[source(e) * k * k + c]))
                    .collect(),
                measure: vec![from_fn(|e| {
                    if e < len {
                        rest.measure[begin + e]
                    } else {
                        0.0
                    }
                })],
                stiffness: constant(shape.constants.rest_stiffness),
                candidate: constant(shape.constants.rest_stiffness),
                gradient: zeros(shape.gradient),
                guess: shape.guess.0[..shape.guess.1]
                    .iter()
                    .map(|&g| [g; BLOCK])
                    .collect(),
                kept: zeros(shape.kept),
                z: zeros(shape.local),
                u: zeros(shape.local),
                sigma: vec![[1.0; BLOCK]; k],
                z_density: zeros(1),
                stretch: zeros(k),
                sums: Default::default(),
            }
        })
        .collect()
}

/// For each free slot its corners, by ascending element: vertex v of element e of a block is corner
/// (block·(k+1) + v)·BLOCK + e.
pub fn corner_lists(rest: &RestShape, slot: &[u32], free: usize) -> (Vec<u32>, Vec<u32>) {
    let corners = rest.stretches + 1;
    let mut begin = vec![0u32; free + 1];
    let slots = || {
        rest.vertices
            .iter()
            .map(|&v| slot[v as usize] as usize)
            .enumerate()
            .filter(|&(_, s)| s < free)
    };
    slots().for_each(|(_, s)| begin[s + 1] += 1);
    for s in 0..free {
        begin[s + 1] += begin[s];
    }
    let mut next = begin.clone();
    let mut list = vec![0u32; begin[free] as usize];
    for (i, s) in slots() {
        let (e, v) = (i / corners, i % corners);
        let corner = ((e / BLOCK) * corners + v) * BLOCK + e % BLOCK;
        list[next[s] as usize] = corner as u32;
        next[s] += 1;
    }
    (begin, list)
}
