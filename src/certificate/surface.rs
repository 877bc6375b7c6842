//! What a certificate needs to know of the rest mesh: its boundary, and whether it is a disk.
//! Derived from the triangles alone, and right for any of them: nothing here fails.

use crate::disjoint_sets::DisjointSets;

/// Edges, pieces and boundary of a triangle mesh.
pub(super) struct Surface {
    /// Edges used by one triangle, in its direction (the surface on their left), sorted.
    pub boundary: Vec<[u32; 2]>,
    /// Edges that are neither on the boundary nor used once in each direction.
    pub irregular_edges: usize,
    /// Boundary loops; 0 when a vertex has several boundary edges leaving it.
    pub boundary_loops: usize,
    /// Is it connected, of one boundary loop, Euler characteristic 1, with one fan at every vertex?
    pub is_disk: bool,
}

impl Surface {
    pub(super) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let groups = edge_groups(triangles);
        let mut boundary = Vec::new();
        let mut irregular_edges = 0;
        let mut edges = 0;
        let mut corners = DisjointSets::new(3 * triangles.len());
        for group in groups.chunk_by(|a, b| a.0 == b.0) {
            edges += 1;
            match group {
                [half] => boundary.push(half.ends(triangles)),
                [a, b] if a.ends(triangles)[0] == b.ends(triangles)[1] => {
                    // Corners at the same end of the edge are in one fan.
                    let next = |corner: u32| corner - corner % 3 + (corner + 1) % 3;
                    corners.join(a.1, next(b.1));
                    corners.join(next(a.1), b.1);
                }
                _ => irregular_edges += 1,
            }
        }
        boundary.sort_unstable();

        let mut used = vec![false; vertices];
        let mut pieces = DisjointSets::new(vertices);
        for t @ &[a, b, c] in triangles {
            t.iter().for_each(|&v| used[v as usize] = true);
            pieces.join(a, b);
            pieces.join(b, c);
        }
        let used_count = used.iter().filter(|&&u| u).count();
        let components = used_count - pieces.joins;
        let fans = 3 * triangles.len() - corners.joins;
        let euler = used_count as i64 - edges as i64 + triangles.len() as i64;

        let mut loops = DisjointSets::new(vertices);
        for &[a, b] in &boundary {
            loops.join(a, b);
        }
        let simple = is_simple(&boundary);
        // A union of cycles with n vertices and n edges is joined n − (number of cycles) times.
        let boundary_loops = if simple {
            boundary.len() - loops.joins
        } else {
            0
        };
        let is_disk = components == 1
            && boundary_loops == 1
            && euler == 1
            && irregular_edges == 0
            && fans == used_count;
        Self {
            boundary,
            irregular_edges,
            boundary_loops,
            is_disk,
        }
    }
}

/// Does every vertex have at most one boundary edge leaving and one arriving?
fn is_simple(boundary: &[[u32; 2]]) -> bool {
    let distinct = |end: usize| {
        let mut ends: Vec<u32> = boundary.iter().map(|e| e[end]).collect();
        ends.sort_unstable();
        ends.windows(2).all(|w| w[0] != w[1])
    };
    distinct(0) && distinct(1)
}

/// A half-edge: its undirected key, and the corner of its triangle that it leaves.
struct HalfEdge(u64, u32);

impl HalfEdge {
    fn ends(&self, triangles: &[[u32; 3]]) -> [u32; 2] {
        let (t, k) = (self.1 as usize / 3, self.1 as usize % 3);
        [triangles[t][k], triangles[t][(k + 1) % 3]]
    }
}

/// All half-edges, those of one edge next to each other.
fn edge_groups(triangles: &[[u32; 3]]) -> Vec<HalfEdge> {
    let mut halves = Vec::with_capacity(3 * triangles.len());
    for (t, triangle) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
            let key = u64::from(a.min(b)) << 32 | u64::from(a.max(b));
            halves.push(HalfEdge(key, (3 * t + k) as u32));
        }
    }
    halves.sort_unstable_by_key(|h| (h.0, h.1));
    halves
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surface(triangles: &[[u32; 3]]) -> Surface {
        let n = triangles.iter().flatten().max().map_or(0, |&v| v + 1);
        Surface::new(triangles, n as usize)
    }

    #[test]
    fn disks_annuli_spheres_and_broken_things() {
        let two = surface(&[[0, 1, 2], [0, 2, 3]]);
        assert!(two.is_disk && two.boundary_loops == 1 && two.irregular_edges == 0);
        assert_eq!(two.boundary, [[0, 1], [1, 2], [2, 3], [3, 0]]);

        let tetrahedron = surface(&[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
        assert!(!tetrahedron.is_disk && tetrahedron.boundary.is_empty());

        // A ring of three quads: an annulus.
        let ring: Vec<[u32; 3]> = (0..3)
            .flat_map(|i| {
                let j = (i + 1) % 3;
                [[i, j, j + 3], [i, j + 3, i + 3]]
            })
            .collect();
        let ring = surface(&ring);
        assert!(!ring.is_disk && ring.boundary_loops == 2);

        // Two triangles at one vertex: no disk. Two pieces: no disk.
        let bow_tie = surface(&[[0, 1, 2], [0, 3, 4]]);
        assert!(!bow_tie.is_disk && bow_tie.boundary_loops == 0);
        assert!(!surface(&[[0, 1, 2], [3, 4, 5]]).is_disk);

        // Neighbours of opposite orientation; three triangles at one edge; one triangle twice.
        assert_eq!(surface(&[[0, 1, 2], [1, 0, 3]]).irregular_edges, 0);
        assert_eq!(surface(&[[0, 1, 2], [0, 1, 3]]).irregular_edges, 1);
        assert_eq!(
            surface(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).irregular_edges,
            1
        );
        assert_eq!(surface(&[[0, 1, 2], [0, 1, 2]]).irregular_edges, 3);
        assert!(!surface(&[]).is_disk);
    }
}
