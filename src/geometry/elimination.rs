//! The numbering of the unknowns: free vertices in elimination order, pinned ones last.

use super::RestShape;
use crate::linalg::Order;

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

    /// The contributions (row, column, element, A g_a·g_b) of (5a), by slot.
    pub fn laplacian(&self, rest: &RestShape) -> Vec<(u32, u32, u32, f64)> {
        let corners = rest.stretches + 1;
        let mut list = Vec::with_capacity(rest.len() * corners * (corners + 1) / 2);
        for e in 0..rest.len() {
            let s = rest.simplex(e);
            for a in 0..corners {
                for b in 0..=a {
                    list.push((
                        self.slot[s[a] as usize],
                        self.slot[s[b] as usize],
                        e as u32,
                        rest.measure[e] * rest.hat_product(e, a, b),
                    ));
                }
            }
        }
        list
    }
}
