//! Union–find with path halving.

/// The sets that joins make of 0, 1, …, n − 1.
pub(crate) struct DisjointSets {
    parent: Vec<u32>,
    /// How many joins joined two sets.
    pub joins: usize,
}

impl DisjointSets {
    /// Each of `n` elements on its own.
    pub fn new(n: usize) -> Self {
        Self {
            parent: (0..n as u32).collect(),
            joins: 0,
        }
    }

    /// The lowest element of the set.
    pub fn find(&mut self, mut element: u32) -> u32 {
        while self.parent[element as usize] != element {
            let grandparent = self.parent[self.parent[element as usize] as usize];
            self.parent[element as usize] = grandparent;
            element = grandparent;
        }
        element
    }

    /// Joins the sets of a and b; were they two? No ranks: the halving is enough.
    pub fn join(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        if a != b {
            self.parent[a.max(b) as usize] = a.min(b);
            self.joins += 1;
        }
        a != b
    }
}
