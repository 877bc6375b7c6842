//! The boundary of a body: facets with one element, oriented outward, and their edges and vertices.

use crate::mesh::FACES;

/// Boundary edges of triangles (D = 2) or boundary faces of tetrahedra (D = 3).
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary<const D: usize> {
    /// Corners of the facets. Faces are counter-clockwise seen from outside, edges have the body on their left, where
    /// the element has a positive measure.
    pub facets: Vec<[u32; D]>,
    /// The edges of the faces, each once, the lower end first; empty in the plane.
    pub edges: Vec<[u32; 2]>,
    /// The vertices, in ascending order.
    pub vertices: Vec<u32>,
    /// Of each facet the vertices, as places in `vertices`, that no facet before has.
    pub(super) own_vertices: Lists,
    /// Of each facet the edges that no facet before has.
    pub(super) own_edges: Lists,
}

/// Lists one after the other.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Lists {
    begin: Vec<u32>,
    items: Vec<u32>,
}

impl Lists {
    fn close(&mut self) {
        self.begin.push(self.items.len() as u32);
    }

    /// One of them.
    pub fn of(&self, list: usize) -> &[u32] {
        &self.items[self.begin[list] as usize..self.begin[list + 1] as usize]
    }
}

/// A facet that more than two elements share has no side that is outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{elements} elements share the facet of vertices {vertices:?}")]
pub struct BoundaryError {
    /// Its vertices; in the plane the last is given twice.
    pub vertices: [u32; 3],
    /// How many have it.
    pub elements: usize,
}

impl<const D: usize> Boundary<D> {
    /// Of elements of D + 1 vertices each, positive at rest.
    ///
    /// # Errors
    /// [`BoundaryError`] for a facet of more than two elements.
    pub fn new(elements: &[u32]) -> Result<Self, BoundaryError> {
        // a facet by its sorted vertices, and as it is seen from outside
        let mut sides: Vec<([u32; D], [u32; D])> = Vec::new();
        for element in elements.chunks_exact(D + 1) {
            for k in 0..=D {
                let facet: [u32; D] = match D {
                    2 => std::array::from_fn(|i| element[(k + 1 + i) % 3]),
                    _ => std::array::from_fn(|i| element[FACES[k][i]]),
                };
                let mut key = facet;
                key.sort_unstable();
                sides.push((key, facet));
            }
        }
        sides.sort_unstable();
        let mut facets = Vec::new();
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            match same {
                [(_, facet)] => facets.push(*facet),
                [_, _] => {}
                _ => {
                    return Err(BoundaryError {
                        vertices: std::array::from_fn(|i| same[0].0[i.min(D - 1)]),
                        elements: same.len(),
                    });
                }
            }
        }
        Ok(Self::of_facets(facets))
    }

    /// Of facets that are known to be oriented outward.
    pub fn of_facets(facets: Vec<[u32; D]>) -> Self {
        let mut vertices: Vec<u32> = facets.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let sides = |f: &[u32; D]| -> [[u32; 2]; 3] {
            [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
                let (a, b) = (f[i % D], f[j % D]);
                [a.min(b), a.max(b)]
            })
        };
        let mut edges: Vec<[u32; 2]> = match D {
            2 => Vec::new(),
            _ => facets.iter().flat_map(sides).collect(),
        };
        edges.sort_unstable();
        edges.dedup();
        let (mut own_vertices, mut own_edges) = (Lists::default(), Lists::default());
        let mut has_vertex = vec![false; vertices.len()];
        let mut has_edge = vec![false; edges.len()];
        own_vertices.close();
        own_edges.close();
        for facet in &facets {
            for v in facet {
                let Ok(place) = vertices.binary_search(v) else {
                    continue;
                };
                if !std::mem::replace(&mut has_vertex[place], true) {
                    own_vertices.items.push(place as u32);
                }
            }
            own_vertices.close();
            for side in sides(facet) {
                // in the plane there are none
                let Ok(place) = edges.binary_search(&side) else {
                    continue;
                };
                if !std::mem::replace(&mut has_edge[place], true) {
                    own_edges.items.push(place as u32);
                }
            }
            own_edges.close();
        }
        Self {
            facets,
            edges,
            vertices,
            own_vertices,
            own_edges,
        }
    }

    /// One vertex of each connected part.
    pub(super) fn representatives(&self) -> Vec<u32> {
        let mut sets = crate::disjoint_sets::DisjointSets::new(self.vertices.len());
        let place = |v: &u32| self.vertices.partition_point(|w| w < v) as u32;
        for facet in &self.facets {
            for v in &facet[1..] {
                sets.join(place(&facet[0]), place(v));
            }
        }
        let all = 0..self.vertices.len() as u32;
        all.filter(|&v| sets.find(v) == v)
            .map(|v| self.vertices[v as usize])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_tetrahedra_have_six_faces() {
        let b = Boundary::<3>::new(&[0, 1, 2, 3, 0, 2, 1, 4]).expect("a manifold");
        assert_eq!((b.facets.len(), b.edges.len(), b.vertices.len()), (6, 9, 5));
        // every edge is used once in each direction
        let mut directed: Vec<[u32; 2]> = Vec::new();
        for f in &b.facets {
            directed.extend([[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]]);
        }
        assert!(directed.iter().all(|&[a, b]| directed.contains(&[b, a])));
        // seen from outside: the fourth corner of a positive tetrahedron is on the other side
        assert!(
            b.facets
                .iter()
                .any(|f| { (0..3).any(|r| [f[r], f[(r + 1) % 3], f[(r + 2) % 3]] == [1, 2, 3]) })
        );
        let owned = |lists: &Lists| (0..6).map(|f| lists.of(f).len()).sum::<usize>();
        assert_eq!((owned(&b.own_vertices), owned(&b.own_edges)), (5, 9));
        assert_eq!(b.representatives(), [0]);
    }

    #[test]
    fn a_square_has_four_edges_with_the_body_on_their_left() {
        let b = Boundary::<2>::new(&[0, 1, 2, 0, 2, 3, 7, 8, 9]).expect("a manifold");
        let mut edges = b.facets.clone();
        edges.sort_unstable();
        assert_eq!(
            edges,
            [[0, 1], [1, 2], [2, 3], [3, 0], [7, 8], [8, 9], [9, 7]]
        );
        assert!(b.edges.is_empty());
        assert_eq!(b.representatives(), [0, 7]);
    }

    #[test]
    fn facets_of_three_elements_are_refused() {
        let three = [0, 1, 2, 3, 0, 1, 2, 4, 0, 1, 2, 5];
        let error = Boundary::<3>::new(&three).expect_err("three on a face");
        assert_eq!((error.vertices, error.elements), ([0, 1, 2], 3));
    }
}
