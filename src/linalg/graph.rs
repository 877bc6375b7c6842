//! The graph of a symmetric pattern.

/// Neighbours of each vertex, ascending, without the vertex itself.
#[derive(Debug, Clone)]
pub struct Graph {
    begin: Vec<u32>,
    neighbours: Vec<u32>,
}

/// No place in a part.
const NONE: u32 = u32::MAX;

impl Graph {
    /// Of `n` vertices and these edges, each in either direction and as often as it likes. Edges to
    /// vertices ≥ n are left out.
    pub fn new(n: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let edges = edges.filter(|&(i, j)| i != j && (i.max(j) as usize) < n);
        // each edge at its higher end, as often as it is given
        let mut given = vec![0u32; n + 1];
        edges
            .clone()
            .for_each(|(i, j)| given[i.max(j) as usize] += 1);
        let total = starts(&mut given);
        let mut lower = vec![0u32; total];
        let mut next = given.clone();
        edges.for_each(|(i, j)| {
            let slot = &mut next[i.max(j) as usize];
            lower[*slot as usize] = i.min(j);
            *slot += 1;
        });
        // each once, the first ones of a list
        let mut seen = vec![NONE; n];
        let mut begin = vec![0u32; n + 1];
        let mut below = vec![0u32; n];
        for v in 0..n {
            let first = given[v] as usize;
            let mut kept = first;
            for at in first..given[v + 1] as usize {
                let w = lower[at];
                if seen[w as usize] != v as u32 {
                    seen[w as usize] = v as u32;
                    lower[kept] = w;
                    kept += 1;
                    begin[w as usize] += 1;
                }
            }
            below[v] = (kept - first) as u32;
            begin[v] += below[v];
        }
        let mut neighbours = vec![0u32; starts(&mut begin)];
        // what is read by ascending vertex arrives in ascending order: the higher neighbours, and from
        // them the lower ones
        let mut next: Vec<u32> = (0..n).map(|v| begin[v] + below[v]).collect();
        for v in 0..n {
            for &w in &lower[given[v] as usize..][..below[v] as usize] {
                let slot = &mut next[w as usize];
                neighbours[*slot as usize] = v as u32;
                *slot += 1;
            }
        }
        next.copy_from_slice(&begin[..n]);
        for w in 0..n {
            for at in begin[w] + below[w]..begin[w + 1] {
                let slot = &mut next[neighbours[at as usize] as usize];
                neighbours[*slot as usize] = w as u32;
                *slot += 1;
            }
        }
        Self { begin, neighbours }
    }

    /// Number of vertices.
    pub fn vertices(&self) -> usize {
        self.begin.len() - 1
    }

    /// Neighbours of a vertex.
    #[inline]
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

    /// Places of the vertices of parts that no edge connects, each in its own; the parts are ascending.
    pub(super) fn places(&self, parts: &[&[u32]]) -> Places {
        let mut places = vec![NONE; self.vertices()];
        for part in parts {
            for (k, &v) in part.iter().enumerate() {
                places[v as usize] = k as u32;
            }
        }
        Places(places)
    }

    /// The graph of one of these parts: its vertices are numbered in their order, edges that lead out
    /// of it are left out.
    pub(super) fn part(&self, part: &[u32], places: &Places) -> Self {
        let mut begin = Vec::with_capacity(part.len() + 1);
        begin.push(0);
        let mut neighbours = Vec::new();
        for &v in part {
            let placed = self.of(v).iter().map(|&w| places.0[w as usize]);
            neighbours.extend(placed.filter(|&place| place != NONE));
            begin.push(neighbours.len() as u32);
        }
        Self { begin, neighbours }
    }
}

/// See [`Graph::places`].
pub(super) struct Places(Vec<u32>);

/// Turns counts (and a last 0) into where each list begins, and the last ends; returns that.
pub(super) fn starts(counts: &mut [u32]) -> usize {
    let mut total = 0;
    for count in counts {
        total += core::mem::replace(count, total);
    }
    total as usize
}
