//! The numbering of the unknowns: free vertices in elimination order, pinned ones last.

use super::RestShape;
use crate::linalg::Order;
use core::array::from_fn;

/// Slots of the vertices.
#[derive(Debug, Clone)]
pub struct Elimination {
    /// Slot of each vertex: below `free` its place in the elimination order, from there on pinned.
    pub slot: Vec<u32>,
    /// Number of free vertices.
    pub free: usize,
    /// The levels of the order, see [`Order::levels`].
    pub levels: Vec<Vec<usize>>,
}

impl Elimination {
    /// Orders the free ones of `vertices` vertices to keep the Cholesky factor of a Laplacian sparse.
    pub fn new(rest: &RestShape, vertices: usize, pins: &[u32]) -> Self {
        Self::with_couplings(rest, vertices, pins, &[])
    }

    /// The same for a matrix that couples further pairs of vertices, too.
    pub fn with_couplings(
        rest: &RestShape,
        vertices: usize,
        pins: &[u32],
        couplings: &[(u32, u32, f64)],
    ) -> Self {
        let mut pinned = vec![false; vertices];
        pins.iter().for_each(|&p| pinned[p as usize] = true);
        let free_vertices: Vec<u32> = (0..vertices as u32)
            .filter(|&v| !pinned[v as usize])
            .collect();
        let free = free_vertices.len();
        let mut slot = vec![0u32; vertices];
        for (k, &v) in free_vertices.iter().enumerate() {
            slot[v as usize] = k as u32;
        }
        for (k, v) in (0..vertices).filter(|&v| pinned[v]).enumerate() {
            slot[v] = (free + k) as u32;
        }
        let pairs = rest.pairs().map(|(a, b, _)| (a, b));
        let pairs = pairs.chain(couplings.iter().map(|&(a, b, _)| (a, b)));
        let order = Order::new(
            free,
            pairs.map(|(a, b)| (slot[a as usize], slot[b as usize])),
        );
        for (k, &first) in order.unknowns.iter().enumerate() {
            slot[free_vertices[first as usize] as usize] = k as u32;
        }
        Self {
            slot,
            free,
            levels: order.levels,
        }
    }

    /// The contributions (row, column, element, A g_a·g_b) of (5a) of free vertices, to each other and to pinned ones, by
    /// slot.
    pub fn laplacian(&self, rest: &RestShape) -> Vec<(u32, u32, u32, f64)> {
        match rest.stretches {
            2 => self.laplacian_of::<3>(rest),
            _ => self.laplacian_of::<4>(rest),
        }
    }

    /// The same of elements with this many corners.
    fn laplacian_of<const CORNERS: usize>(&self, rest: &RestShape) -> Vec<(u32, u32, u32, f64)> {
        let mut list = Vec::with_capacity(rest.len() * CORNERS * (CORNERS + 1) / 2);
        let is_free = |slot: u32| (slot as usize) < self.free;
        for (simplex, e) in rest.vertices.as_chunks::<CORNERS>().0.iter().zip(0..) {
            let slots = simplex.map(|v| self.slot[v as usize]);
            if !slots.iter().any(|&slot| is_free(slot)) {
                continue;
            }
            let measure = rest.measure[e as usize];
            let gradients: [_; CORNERS] = from_fn(|a| rest.hat_gradient(e as usize, a));
            for a in 0..CORNERS {
                for b in 0..=a {
                    if is_free(slots[a]) || is_free(slots[b]) {
                        let [g, h] = [gradients[a], gradients[b]];
                        let product = g[0] * h[0] + g[1] * h[1] + g[2] * h[2];
                        list.push((slots[a], slots[b], e, measure * product));
                    }
                }
            }
        }
        list
    }
}
