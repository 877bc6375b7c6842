//! The broad phase: which vertices, edges and faces come near each other while they move.

use super::Boundary;
use super::ccd::{Impact, Pair, impact};
use super::separation::Four;
use crate::boxes::{Bounds, Tree};
use crate::parallel;
use std::ops::ControlFlow;

/// A pair of a boundary that may meet. Pairs that share a vertex are none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Candidate {
    /// A vertex with a facet: a face, in the plane an edge.
    VertexFacet {
        /// The vertex.
        vertex: u32,
        /// Place of the facet in the boundary.
        facet: u32,
    },
    /// Two edges in space.
    EdgeEdge {
        /// Their places in the boundary, the lower first.
        edges: [u32; 2],
    },
}

impl Candidate {
    /// What kind of pair it is.
    pub fn pair(&self) -> Pair {
        match self {
            Candidate::VertexFacet { .. } => Pair::VertexFace,
            Candidate::EdgeEdge { .. } => Pair::EdgeEdge,
        }
    }

    /// Its four vertices, in the order of [`impact`].
    pub fn vertices<const D: usize>(&self, boundary: &Boundary<D>) -> [u32; 4] {
        match *self {
            Candidate::VertexFacet { vertex, facet } => {
                let f = boundary.facets[facet as usize];
                [vertex, f[0], f[1], f[D - 1]]
            }
            Candidate::EdgeEdge { edges } => {
                let [[a, b], [c, d]] = edges.map(|e| boundary.edges[e as usize]);
                [a, b, c, d]
            }
        }
    }

    /// [`impact`] of this pair.
    pub fn impact<const D: usize>(
        &self,
        boundary: &Boundary<D>,
        from: &[[f64; D]],
        to: &[[f64; D]],
        gap: f64,
    ) -> Option<Impact<D>> {
        let vertices = self.vertices(boundary);
        let start: Four<D> = vertices.map(|v| from[v as usize]);
        let end: Four<D> = vertices.map(|v| to[v as usize]);
        impact(self.pair(), &start, &end, gap)
    }
}

/// Pairs that are one piece of work, and that are kept at a time.
const CHUNK: usize = 256;
const BLOCK: usize = 1 << 15;

/// A tree of boxes around the facets of a boundary, from where they are to where they go.
#[derive(Debug, Clone)]
pub struct BroadPhase<const D: usize> {
    tree: Option<Tree<D>>,
    facets: Vec<Bounds<D>>,
    edges: Vec<Bounds<D>>,
    vertices: Vec<Bounds<D>>,
}

impl<const D: usize> Default for BroadPhase<D> {
    fn default() -> Self {
        Self {
            tree: None,
            facets: Vec::new(),
            edges: Vec::new(),
            vertices: Vec::new(),
        }
    }
}

impl<const D: usize> BroadPhase<D> {
    /// Has the tree built anew before it is used again: after large motions a refitted one gets slow.
    pub fn forget(&mut self) {
        self.tree = None;
    }

    fn fit(&mut self, boundary: &Boundary<D>, from: &[[f64; D]], to: &[[f64; D]], gap: f64) {
        let around = |simplex: &[u32]| {
            let all = simplex.iter().fold(Bounds::EMPTY, |b, &v| {
                b.with(from[v as usize]).with(to[v as usize])
            });
            // half on either side
            all.inflated(0.5 * gap)
        };
        self.facets.clear();
        self.facets
            .extend(boundary.facets.iter().map(|f| around(f)));
        self.edges.clear();
        self.edges.extend(boundary.edges.iter().map(|e| around(e)));
        self.vertices.clear();
        self.vertices
            .extend(boundary.vertices.iter().map(|&v| around(&[v])));
        match &mut self.tree {
            Some(tree) => tree.refit(&self.facets),
            None => self.tree = Some(Tree::new(&self.facets)),
        }
    }

    /// Visits pairs of facets whose boxes meet where they stand, until a visit breaks off; those that share vertices
    /// are among them.
    pub(super) fn facet_pairs(
        &mut self,
        boundary: &Boundary<D>,
        positions: &[[f64; D]],
        visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>,
    ) {
        self.fit(boundary, positions, positions, 0.0);
        if let Some(tree) = &self.tree {
            tree.pairs(&self.facets, visit);
        }
    }

    /// Visits every candidate once, in an order that depends on the tree.
    fn visit(&self, boundary: &Boundary<D>, visit: &mut impl FnMut(Candidate)) {
        let Some(tree) = &self.tree else { return };
        // every vertex and edge belongs to one of its facets, whose box is around its own: so no pair is missed, and
        // none is met twice
        tree.pairs(&self.facets, &mut |i, j| {
            for (i, j) in [(i, j), (j, i)] {
                let (facet, corners) = (&self.facets[j as usize], &boundary.facets[j as usize]);
                for &place in boundary.own_vertices.of(i as usize) {
                    let vertex = boundary.vertices[place as usize];
                    if !corners.contains(&vertex) && self.vertices[place as usize].meets(facet) {
                        visit(Candidate::VertexFacet { vertex, facet: j });
                    }
                }
            }
            for &e in boundary.own_edges.of(i as usize) {
                let ends = boundary.edges[e as usize];
                for &f in boundary.own_edges.of(j as usize) {
                    let others = boundary.edges[f as usize];
                    if !others.iter().any(|v| ends.contains(v))
                        && self.edges[e as usize].meets(&self.edges[f as usize])
                    {
                        let edges = [e.min(f), e.max(f)];
                        visit(Candidate::EdgeEdge { edges });
                    }
                }
            }
            ControlFlow::Continue(())
        });
    }

    /// Pairs of vertices and facets, and in space of edges, that have no vertex in common and whose boxes come nearer
    /// to each other than `gap` while they move from `from` to `to`; sorted, each once.
    pub fn candidates(
        &mut self,
        boundary: &Boundary<D>,
        from: &[[f64; D]],
        to: &[[f64; D]],
        gap: f64,
    ) -> Vec<Candidate> {
        self.fit(boundary, from, to, gap);
        let mut found = Vec::new();
        self.visit(boundary, &mut |candidate| found.push(candidate));
        found.sort_unstable();
        found
    }

    /// The candidates for which `matters` holds that meet, and how, sorted by pair. Never more
    /// than a block of candidates is kept.
    pub fn collisions(
        &mut self,
        boundary: &Boundary<D>,
        from: &[[f64; D]],
        to: &[[f64; D]],
        gap: f64,
        matters: impl Fn(&Candidate) -> bool,
    ) -> Vec<(Candidate, Impact<D>)> {
        self.fit(boundary, from, to, gap);
        let mut found = Vec::new();
        let mut block: Vec<(Candidate, Option<Impact<D>>)> = Vec::new();
        let mut decide = |block: &mut Vec<(Candidate, Option<Impact<D>>)>| {
            parallel::for_each_chunk(block, CHUNK, |_, block| {
                for (candidate, impact) in block {
                    *impact = candidate.impact(boundary, from, to, gap);
                }
            });
            found.extend(block.drain(..).filter_map(|(c, impact)| Some((c, impact?))));
        };
        self.visit(boundary, &mut |candidate| {
            if matters(&candidate) {
                block.push((candidate, None));
                if block.len() == BLOCK {
                    decide(&mut block);
                }
            }
        });
        decide(&mut block);
        found.sort_unstable_by_key(|hit| hit.0);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
        fn points<const D: usize>(&mut self, n: usize) -> Vec<[f64; D]> {
            (0..n)
                .map(|_| std::array::from_fn(|_| self.next()))
                .collect()
        }
    }

    /// Small facets all over the place, some of which share vertices.
    fn soup<const D: usize>(random: &mut Random) -> (Boundary<D>, Vec<[f64; D]>, Vec<[f64; D]>) {
        let mut facets = Vec::new();
        for k in 0..60u32 {
            facets.push(std::array::from_fn(|i| 2 * k + i as u32));
        }
        let boundary = Boundary::of_facets(facets);
        let n = 2 * 60 + D;
        let near = |random: &mut Random, at: &[[f64; D]]| -> Vec<[f64; D]> {
            let shake = |p: &[f64; D]| p.map(|x| x + 0.15 * (random.next() - 0.5));
            at.iter().map(shake).collect()
        };
        let centres = random.points::<D>(n.div_ceil(4));
        let at: Vec<[f64; D]> = (0..n).map(|v| centres[v / 4]).collect();
        let (from, to) = (near(random, &at), near(random, &at));
        (boundary, from, to)
    }

    /// All pairs, with boxes made one by one.
    fn brute<const D: usize>(
        b: &Boundary<D>,
        from: &[[f64; D]],
        to: &[[f64; D]],
        gap: f64,
    ) -> Vec<Candidate> {
        let around = |vertices: &[u32]| {
            let all = vertices.iter();
            all.fold(Bounds::EMPTY, |b, &v| {
                b.with(from[v as usize]).with(to[v as usize])
            })
            .inflated(0.5 * gap)
        };
        let mut found = Vec::new();
        for &vertex in &b.vertices {
            for (facet, f) in b.facets.iter().enumerate() {
                if !f.contains(&vertex) && around(&[vertex]).meets(&around(f)) {
                    let facet = facet as u32;
                    found.push(Candidate::VertexFacet { vertex, facet });
                }
            }
        }
        for (e, ends) in b.edges.iter().enumerate() {
            for (f, others) in b.edges.iter().enumerate().skip(e + 1) {
                let share = ends.iter().any(|v| others.contains(v));
                if !share && around(ends).meets(&around(others)) {
                    let edges = [e as u32, f as u32];
                    found.push(Candidate::EdgeEdge { edges });
                }
            }
        }
        found.sort_unstable();
        found
    }

    fn candidates_are_all_pairs_of_meeting_boxes<const D: usize>() {
        let mut random = Random(7);
        let mut broad = BroadPhase::default();
        for round in 0..8 {
            // the tree of the first is refitted to the others
            let (boundary, from, to) = soup::<D>(&mut random);
            let gap = if round % 2 == 0 { 0.0 } else { 0.02 };
            let expected = brute(&boundary, &from, &to, gap);
            assert!(expected.len() > 20);
            assert_eq!(broad.candidates(&boundary, &from, &to, gap), expected);
            let hits = broad.collisions(&boundary, &from, &to, gap, |_| true);
            let one_by_one: Vec<(Candidate, Impact<D>)> = expected
                .iter()
                .filter_map(|c| Some((*c, c.impact(&boundary, &from, &to, gap)?)))
                .collect();
            assert_eq!(hits, one_by_one);
        }
    }

    #[test]
    fn no_candidate_is_missed() {
        candidates_are_all_pairs_of_meeting_boxes::<2>();
        candidates_are_all_pairs_of_meeting_boxes::<3>();
    }
}
