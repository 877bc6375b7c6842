//! Choosing the edges to cut.

use super::{SurfaceMesh, Topology};
use crate::disjoint_sets::DisjointSets;
use crate::mesh::topology::{next, previous};
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

const NONE: u32 = u32::MAX;

/// An edge of the surface.
pub(super) struct Edge {
    /// Lower first.
    pub vertices: [u32; 2],
    /// The faces on both sides; none for a boundary edge.
    faces: Option<[u32; 2]>,
    length: f64,
}

/// The edges of a surface as a graph of its vertices, and its dual.
pub(super) struct EdgeGraph {
    pub edges: Vec<Edge>,
    corner_edges: Vec<u32>,
    /// Per vertex, where its part of `neighbours` begins.
    starts: Vec<u32>,
    /// (neighbour, edge).
    neighbours: Vec<(u32, u32)>,
    faces: usize,
}

impl EdgeGraph {
    pub fn new(mesh: &SurfaceMesh, topology: &Topology) -> Self {
        let vertices = mesh.positions.len();
        let mut edges = Vec::with_capacity(topology.edges());
        let mut corner_edges = vec![NONE; 3 * mesh.simplices.len()];
        let mut starts = vec![0u32; vertices + 1];
        for corner in 0..corner_edges.len() as u32 {
            let across = topology.opposite(corner);
            if across.is_some_and(|across| across < corner) {
                continue;
            }
            let (a, b) = (
                topology.vertex(next(corner)),
                topology.vertex(previous(corner)),
            );
            corner_edges[corner as usize] = edges.len() as u32;
            if let Some(across) = across {
                corner_edges[across as usize] = edges.len() as u32;
            }
            edges.push(Edge {
                vertices: [a.min(b), a.max(b)],
                faces: across.map(|across| [corner / 3, across / 3]),
                length: mesh.positions[a as usize].distance(mesh.positions[b as usize]),
            });
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut ends = starts.clone();
        let mut neighbours = vec![(0, 0); 2 * edges.len()];
        for (index, edge) in edges.iter().enumerate() {
            let [a, b] = edge.vertices;
            for (from, to) in [(a, b), (b, a)] {
                let end = &mut ends[from as usize];
                neighbours[*end as usize] = (to, index as u32);
                *end += 1;
            }
        }
        Self {
            edges,
            corner_edges,
            starts,
            neighbours,
            faces: mesh.simplices.len(),
        }
    }

    /// The edge that a corner faces.
    pub fn edge_of_corner(&self, corner: u32) -> u32 {
        self.corner_edges[corner as usize]
    }

    fn vertices(&self) -> usize {
        self.starts.len() - 1
    }

    fn around(&self, vertex: usize) -> &[(u32, u32)] {
        &self.neighbours[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

/// Shortest paths from a set of vertices along edges.
struct Forest {
    /// Infinite where no face has the vertex.
    distances: Vec<f64>,
    /// The edge towards the source, `NONE` at sources.
    parents: Vec<u32>,
}

impl Forest {
    /// Dijkstra's algorithm; on equal distances the lower vertex goes first.
    fn new(graph: &EdgeGraph, sources: &[u32]) -> Self {
        let mut distances = vec![f64::INFINITY; graph.vertices()];
        let mut parents = vec![NONE; graph.vertices()];
        // Non-negative floats are ordered as their bits are.
        let mut heap = BinaryHeap::with_capacity(graph.vertices());
        for &source in sources {
            distances[source as usize] = 0.0;
            heap.push(Reverse((0u64, source)));
        }
        while let Some(Reverse((bits, vertex))) = heap.pop() {
            let distance = f64::from_bits(bits);
            if distance > distances[vertex as usize] {
                continue;
            }
            for &(neighbour, edge) in graph.around(vertex as usize) {
                let through = distance + graph.edges[edge as usize].length;
                if through < distances[neighbour as usize] {
                    distances[neighbour as usize] = through;
                    parents[neighbour as usize] = edge;
                    heap.push(Reverse((through.to_bits(), neighbour)));
                }
            }
        }
        Self { distances, parents }
    }

    /// The reached vertex farthest away; the lowest of several.
    fn farthest(&self) -> u32 {
        let mut best = 0;
        for (vertex, &distance) in self.distances.iter().enumerate() {
            let best_distance = self.distances[best as usize];
            if distance.is_finite() && (distance > best_distance || best_distance.is_infinite()) {
                best = vertex as u32;
            }
        }
        best
    }
}

/// A vertex at an end of the surface: the one farthest along edges from the one farthest from the
/// middle. It does not depend on the order of the vertices (unless the surface is symmetric).
pub(super) fn end_of(mesh: &SurfaceMesh, graph: &EdgeGraph) -> u32 {
    let corners = mesh.simplices.as_flattened();
    let sum: DVec3 = corners.iter().map(|&v| mesh.positions[v as usize]).sum();
    let middle = sum / corners.len() as f64;
    let mut outermost = corners[0];
    for &vertex in corners {
        let distance = |v: u32| mesh.positions[v as usize].distance_squared(middle);
        if distance(vertex) > distance(outermost) {
            outermost = vertex;
        }
    }
    Forest::new(graph, &[outermost]).farthest()
}

/// Seams, their length, and how far each vertex is from their sources.
pub(super) struct Seams {
    pub is_seam: Vec<bool>,
    length: f64,
    distances: Vec<f64>,
}

/// The seams given the sources of the forest: all boundary vertices, or one vertex of a closed surface.
pub(super) fn seams(graph: &EdgeGraph, sources: &[u32]) -> Seams {
    let forest = Forest::new(graph, sources);
    let mut is_seam: Vec<bool> = graph
        .edges
        .iter()
        .map(|edge| edge.faces.is_some())
        .collect();
    // Non-forest edges, the longest loop first, into the dual tree.
    let mut in_forest = vec![false; graph.edges.len()];
    for &edge in &forest.parents {
        if edge != NONE {
            in_forest[edge as usize] = true;
        }
    }
    let mut candidates: Vec<(Reverse<u64>, u32)> = (0..graph.edges.len() as u32)
        .filter(|&e| is_seam[e as usize] && !in_forest[e as usize])
        .map(|e| {
            let edge = &graph.edges[e as usize];
            let [a, b] = edge.vertices.map(|v| forest.distances[v as usize]);
            (Reverse((a + edge.length + b).to_bits()), e)
        })
        .collect();
    candidates.sort_unstable();
    let mut sets = DisjointSets::new(graph.faces);
    for (_, e) in candidates {
        if let Some([a, b]) = graph.edges[e as usize].faces
            && sets.join(a, b)
        {
            is_seam[e as usize] = false;
        }
    }
    prune(graph, &mut is_seam, sources);
    let length = graph
        .edges
        .iter()
        .zip(&is_seam)
        .filter(|&(_, &seam)| seam)
        .map(|(edge, _)| edge.length)
        .sum();
    Seams {
        is_seam,
        length,
        distances: forest.distances,
    }
}

/// Takes back seams that end inside the surface. `anchors` are the boundary vertices, where a seam may
/// end (a single anchor is the root of a closed surface, which is none).
fn prune(graph: &EdgeGraph, is_seam: &mut [bool], anchors: &[u32]) {
    let mut degrees = vec![0u32; graph.vertices()];
    for (edge, _) in graph.edges.iter().zip(is_seam.iter()).filter(|&(_, &s)| s) {
        for vertex in edge.vertices {
            degrees[vertex as usize] += 1;
        }
    }
    if anchors.len() > 1 {
        for &anchor in anchors {
            degrees[anchor as usize] = NONE;
        }
    }
    let mut tips: Vec<u32> = (0..degrees.len() as u32)
        .filter(|&v| degrees[v as usize] == 1)
        .collect();
    while let Some(tip) = tips.pop() {
        let found = graph
            .around(tip as usize)
            .iter()
            .find(|&&(_, edge)| is_seam[edge as usize]);
        if let Some(&(neighbour, edge)) = found {
            is_seam[edge as usize] = false;
            let degree = &mut degrees[neighbour as usize];
            if *degree != NONE {
                *degree -= 1;
                if *degree == 1 {
                    tips.push(neighbour);
                }
            }
        }
    }
}

/// The shortest seams of a closed surface with handles, over a few roots. Loops through a root are
/// short where the surface is thin, and seams tend to pass through such places: so the roots tried
/// next lie along the best seams so far.
pub(super) fn shortest_of_several_roots(graph: &EdgeGraph, start: u32) -> Vec<bool> {
    const ROUNDS: usize = 2;
    const ROOTS_A_ROUND: usize = 2;
    let mut best = seams(graph, &[start]);
    for _ in 0..ROUNDS {
        let along = vertices_by_distance(graph, &best);
        let before = best.length;
        for i in 1..=ROOTS_A_ROUND {
            let root = along[(along.len() - 1) * i / ROOTS_A_ROUND];
            let other = seams(graph, &[root]);
            if other.length < best.length {
                best = other;
            }
        }
        if best.length == before {
            break;
        }
    }
    best.is_seam
}

/// The vertices of seams, those near their root first.
fn vertices_by_distance(graph: &EdgeGraph, seams: &Seams) -> Vec<u32> {
    let mut along: Vec<(u64, u32)> = graph
        .edges
        .iter()
        .zip(&seams.is_seam)
        .filter(|&(_, &seam)| seam)
        .flat_map(|(edge, _)| edge.vertices)
        .map(|v| (seams.distances[v as usize].to_bits(), v))
        .collect();
    along.sort_unstable();
    along.dedup();
    along.into_iter().map(|(_, v)| v).collect()
}

/// A shortest path between two far vertices of a closed surface without handles, of at least two edges.
pub(super) fn slit(graph: &EdgeGraph, start: u32) -> Vec<bool> {
    let forest = Forest::new(graph, &[start]);
    let mut is_seam = vec![false; graph.edges.len()];
    let mut at = forest.farthest();
    let end = at;
    let mut length = 0;
    while forest.parents[at as usize] != NONE {
        let edge = forest.parents[at as usize];
        is_seam[edge as usize] = true;
        let [a, b] = graph.edges[edge as usize].vertices;
        at = if a == at { b } else { a };
        length += 1;
    }
    if length == 1 {
        // A single edge opens nothing: go on by the longest edge that does not lead back.
        let around = graph.around(end as usize).iter();
        let longest = around
            .filter(|&&(neighbour, _)| neighbour != start)
            .max_by(|a, b| {
                let length = |&(_, e): &(u32, u32)| graph.edges[e as usize].length;
                length(a).total_cmp(&length(b)).then(b.1.cmp(&a.1))
            });
        if let Some(&(_, edge)) = longest {
            is_seam[edge as usize] = true;
        }
    }
    is_seam
}
