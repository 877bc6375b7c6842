//! Approximate minimum degree (Amestoy et al. 1996) of a part of a graph: faer behind one small type.

use super::Graph;
use super::graph::starts;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// The neighbours of a part outside it, which are eliminated later.
#[derive(Default)]
pub struct Halo {
    /// How many there are.
    count: usize,
    /// Those of each vertex of the part, ascending: where they begin, and their numbers.
    begin: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Halo {
    /// Of a part of `whole` with these vertices (ascending).
    pub fn new(whole: &Graph, part: &Graph, names: &[u32]) -> Self {
        let mut found: Vec<(u32, u32)> = Vec::new();
        for (&name, k) in names.iter().zip(0..) {
            let mut own = part.of(k).iter().map(|&l| names[l as usize]).peekable();
            let all = whole.of(name).iter();
            found.extend(all.filter_map(|&w| own.next_if_eq(&w).is_none().then_some((w, k))));
        }
        found.sort_unstable();
        let mut begin = vec![0u32; names.len() + 1];
        found.iter().for_each(|&(_, k)| begin[k as usize] += 1);
        let mut neighbours = vec![0u32; starts(&mut begin)];
        let mut next = begin.clone();
        let mut count = 0;
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            for &(_, k) in same {
                let slot = &mut next[k as usize];
                neighbours[*slot as usize] = count as u32;
                *slot += 1;
            }
            count += 1;
        }
        Self {
            count,
            begin,
            neighbours,
        }
    }

    fn of(&self, v: usize) -> &[u32] {
        match self.count {
            0 => &[],
            _ => &self.neighbours[self.begin[v] as usize..self.begin[v + 1] as usize],
        }
    }
}

/// The vertices of a graph by approximate minimum degree in it and its halo: a clique of that has
/// too high a degree to come first (Pellegrini, Roman & Amestoy 2000, by other means).
pub fn minimum_degree(graph: &Graph, halo: &Halo) -> Vec<u32> {
    let own = graph.vertices();
    let n = own + halo.count;
    // the lower triangle
    let mut offsets = Vec::with_capacity(n + 1);
    let mut rows: Vec<usize> = Vec::new();
    offsets.push(0);
    for v in 0..own {
        rows.push(v);
        let neighbours = graph.of(v as u32);
        let lower = neighbours.partition_point(|&w| (w as usize) < v);
        rows.extend(neighbours[lower..].iter().map(|&w| w as usize));
        rows.extend(halo.of(v).iter().map(|&h| own + h as usize));
        offsets.push(rows.len());
    }
    for h in own..n {
        rows.extend(h..n);
        offsets.push(rows.len());
    }
    let symbolic = SymbolicSparseColMatRef::new_checked(n, n, &offsets, None, &rows);
    let mut forward = vec![0usize; n];
    let mut inverse = vec![0usize; n];
    let mut buffer = MemBuffer::new(amd::order_scratch::<usize>(n, rows.len()));
    let ordered = amd::order(
        &mut forward,
        &mut inverse,
        symbolic,
        amd::Control::default(),
        MemStack::new(&mut buffer),
    );
    // only an index overflow can fail here, and 32-bit meshes cannot cause one
    if ordered.is_err() {
        return (0..own as u32).collect();
    }
    let first = forward.into_iter().filter(|&k| k < own);
    first.map(|k| k as u32).collect()
}
