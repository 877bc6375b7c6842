//! The smallest set of vertices that covers every edge of a cut: from a largest matching of these edges
//! (Kőnig 1931).
//!
//! Matchings of the same size there are many, but all lead to the same cover: that of the vertices on
//! the right that alternating paths from unmatched vertices of the left reach, and of those on the left
//! that they do not (Dulmage & Mendelsohn 1958).

use super::Graph;

const NONE: u32 = u32::MAX;

/// Room for the cuts of a graph. The vertices at the cut are numbered anew on either side.
pub struct Cut {
    /// Number of a vertex on the right, `NONE` between two calls.
    number: Vec<u32>,
    /// Vertices of the right side at the cut.
    right: Vec<u32>,
    /// Where the edges of a vertex of the left side begin, and where they lead to.
    begin: Vec<u32>,
    across: Vec<u32>,
    /// Whom each vertex of either side is matched with.
    of_left: Vec<u32>,
    of_right: Vec<u32>,
    /// Has the search met a vertex of the right side?
    seen: Vec<bool>,
    /// The path of the search: a vertex of the left side, its next edge and the last vertex it went to.
    path: Vec<(u32, u32, u32)>,
    visited: Vec<u32>,
}

impl Cut {
    /// For graphs of this many vertices.
    pub fn new(vertices: usize) -> Self {
        Self {
            number: vec![NONE; vertices],
            right: Vec::new(),
            begin: Vec::new(),
            across: Vec::new(),
            of_left: Vec::new(),
            of_right: Vec::new(),
            seen: Vec::new(),
            path: Vec::new(),
            visited: Vec::new(),
        }
    }

    /// The smallest cover (ascending) of the edges that lead from the left side to the right, if its size is
    /// `better`, which holds below some size; `left` are all vertices of the left side that have such an
    /// edge.
    pub fn cover(
        &mut self,
        graph: &Graph,
        left: &[u32],
        is_left: impl Fn(u32) -> bool,
        better: impl Fn(usize) -> bool,
    ) -> Option<Vec<u32>> {
        self.collect(graph, left, is_left);
        let mut size = self.match_free();
        // what the search meets without success leads nowhere for good: nothing is matched anew there
        for l in 0..left.len() as u32 {
            if !better(size) {
                return None;
            }
            if self.of_left[l as usize] == NONE && self.augment(l) {
                size += 1;
                self.visited
                    .iter()
                    .for_each(|&r| self.seen[r as usize] = false);
            }
        }
        if !better(size) {
            return None;
        }
        let met = |r: u32| self.seen[r as usize];
        let partners = left.iter().zip(&self.of_left);
        let own = partners
            .filter(|&(_, &r)| r != NONE && !met(r))
            .map(|(&v, _)| v);
        let right = self.right.iter().zip(&self.seen);
        let right = right.filter_map(|(&w, seen)| seen.then_some(w));
        let mut cover: Vec<u32> = own.chain(right).collect();
        cover.sort_unstable();
        Some(cover)
    }

    /// Numbers the vertices at the cut and collects its edges.
    fn collect(&mut self, graph: &Graph, left: &[u32], is_left: impl Fn(u32) -> bool) {
        self.right.clear();
        self.begin.clear();
        self.across.clear();
        self.begin.push(0);
        for &v in left {
            for &w in graph.of(v) {
                if !is_left(w) {
                    let number = &mut self.number[w as usize];
                    if *number == NONE {
                        *number = self.right.len() as u32;
                        self.right.push(w);
                    }
                    self.across.push(*number);
                }
            }
            self.begin.push(self.across.len() as u32);
        }
        for &w in &self.right {
            self.number[w as usize] = NONE;
        }
        let all = [&mut self.of_left, &mut self.of_right];
        for (partner, len) in all.into_iter().zip([left.len(), self.right.len()]) {
            partner.clear();
            partner.resize(len, NONE);
        }
        self.seen.clear();
        self.seen.resize(self.right.len(), false);
    }

    /// Matches each vertex of the left side with one that is free, where there is one; returns how many.
    fn match_free(&mut self) -> usize {
        let mut size = 0;
        for l in 0..self.of_left.len() as u32 {
            if let Some(r) = self.free(l) {
                self.of_left[l as usize] = r;
                self.of_right[r as usize] = l;
                size += 1;
            }
        }
        size
    }

    /// A vertex beside `l` that has no partner.
    fn free(&self, l: u32) -> Option<u32> {
        let edges = self.begin[l as usize] as usize..self.begin[l as usize + 1] as usize;
        let mut beside = self.across[edges].iter().copied();
        beside.find(|&r| self.of_right[r as usize] == NONE)
    }

    /// Looks for a path from `start` that alternates between unmatched and matched edges and ends at an
    /// unmatched vertex of the right side, and makes the matching larger by it. What it met is `visited`.
    fn augment(&mut self, start: u32) -> bool {
        self.visited.clear();
        self.path.clear();
        // depth first with a stack of its own: paths can be long
        self.path.push((start, self.begin[start as usize], NONE));
        while let Some((l, next, taken)) = self.path.last_mut() {
            let end = self.begin[*l as usize + 1];
            let unseen = (*next..end).find(|&e| !self.seen[self.across[e as usize] as usize]);
            let Some(edge) = unseen else {
                self.path.pop();
                continue;
            };
            *next = edge + 1;
            *taken = self.across[edge as usize];
            let r = *taken;
            self.seen[r as usize] = true;
            self.visited.push(r);
            let back = self.of_right[r as usize];
            if let Some(free) = self.free(back) {
                for &(l, _, r) in &self.path {
                    self.of_left[l as usize] = r;
                    self.of_right[r as usize] = l;
                }
                self.of_left[back as usize] = free;
                self.of_right[free as usize] = back;
                return true;
            }
            self.path.push((back, self.begin[back as usize], NONE));
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_are_the_smallest() {
        let mut state = 9u64;
        let mut random = |below: u64| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let n = 12;
        let mut cut = Cut::new(n);
        for round in 0..300 {
            // some edges inside of either side, too
            let count = 2 + round % 24;
            let edges: Vec<(u32, u32)> = (0..count)
                .map(|_| (random(n as u64) as u32, random(n as u64) as u32))
                .collect();
            let graph = Graph::new(n, edges.iter().copied());
            let is_left = |v: u32| v.is_multiple_of(2);
            let crossing = || edges.iter().filter(|e| is_left(e.0) != is_left(e.1));
            let is_cover = |set: u32| crossing().all(|&(a, b)| (set >> a | set >> b) & 1 == 1);
            let sets = (0..1u32 << n).filter(|&set| is_cover(set));
            let least = sets.map(u32::count_ones).min().expect("all vertices") as usize;
            let has_edge = |v: &u32| graph.of(*v).iter().any(|&w| !is_left(w));
            let left: Vec<u32> = (0..n as u32)
                .filter(|&v| is_left(v))
                .filter(has_edge)
                .collect();
            let cover = cut
                .cover(&graph, &left, is_left, |_| true)
                .expect("any size");
            assert_eq!(cover.len(), least, "{edges:?}");
            assert!(cover.is_sorted() && is_cover(cover.iter().fold(0, |set, v| set | 1 << v)));
            // one of that size only where that is good enough
            assert!(
                cut.cover(&graph, &left, is_left, |size| size < least)
                    .is_none()
            );
            assert_eq!(
                cut.cover(&graph, &left, is_left, |size| size <= least),
                Some(cover)
            );
        }
    }
}
