//! The graph of a symmetric pattern.

/// Neighbours of each vertex, ascending, without the vertex itself.
#[derive(Debug, Clone)]
pub struct Graph {
    begin: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// Of `n` vertices and these edges, each in either direction and as often as it likes. Edges to
    /// vertices ≥ n are left out.
    pub fn new(n: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let edges = edges.filter(|&(i, j)| i != j && (i.max(j) as usize) < n);
        let mut begin = vec![0u32; n + 1];
        for (i, j) in edges.clone() {
            begin[i as usize + 1] += 1;
            begin[j as usize + 1] += 1;
        }
        for v in 0..n {
            begin[v + 1] += begin[v];
        }
        let mut next = begin.clone();
        let mut all = vec![0u32; begin[n] as usize];
        for (i, j) in edges {
            for (from, to) in [(i, j), (j, i)] {
                let slot = &mut next[from as usize];
                all[*slot as usize] = to;
                *slot += 1;
            }
        }
        let mut this = Self {
            begin: Vec::with_capacity(n + 1),
            neighbours: Vec::with_capacity(all.len() / 2),
        };
        this.begin.push(0);
        for v in 0..n {
            let list = &mut all[begin[v] as usize..begin[v + 1] as usize];
            list.sort_unstable();
            let first = this.neighbours.len();
            for &w in &*list {
                if this.neighbours.len() == first || this.neighbours.last() != Some(&w) {
                    this.neighbours.push(w);
                }
            }
            this.begin.push(this.neighbours.len() as u32);
        }
        this
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.begin.len() - 1
    }

    /// Neighbours of a vertex.
    pub fn of(&self, v: u32) -> &[u32] {
        let v = v as usize;
        &self.neighbours[self.begin[v] as usize..self.begin[v + 1] as usize]
    }

    /// Every edge once, from the higher vertex to the lower.
    pub fn edges(&self) -> impl Iterator<Item = (u32, u32)> + Clone + '_ {
        (0..self.vertices() as u32).flat_map(|v| {
            let lower = self.of(v).iter().take_while(move |&&w| w < v);
            lower.map(move |&w| (v, w))
        })
    }

    /// Mean number of neighbours.
    pub fn mean_degree(&self) -> f64 {
        self.neighbours.len() as f64 / self.vertices().max(1) as f64
    }
}
