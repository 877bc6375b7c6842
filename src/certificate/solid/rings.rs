//! How tetrahedra stand around edges and vertices: what joins them, and what bounds them.

use crate::disjoint_sets::DisjointSets;

/// The tetrahedra of an edge that form one ring or one fan.
pub(super) struct Ring {
    /// The edge, the lower vertex first.
    pub ends: [u32; 2],
    /// Where its vertices are in [`Rings::links`].
    start: usize,
    end: usize,
    /// Do they close up around the edge? Otherwise they reach from one boundary face to another.
    pub closed: bool,
}

/// All rings of a mesh, and all that keeps its tetrahedra from forming a manifold.
#[derive(Default)]
pub(super) struct Rings {
    pub rings: Vec<Ring>,
    links: Vec<u32>,
    /// Faces of three or more tetrahedra, or with two on one side, in ascending order.
    pub irregular_faces: Vec<[u32; 3]>,
    /// Edges whose tetrahedra form more than one ring or fan, in ascending order.
    pub irregular_edges: Vec<[u32; 2]>,
    /// Vertices whose tetrahedra do not all hang together by faces, in ascending order.
    pub irregular_vertices: Vec<u32>,
    /// Faces (x, y, z) of one tetrahedron (x, y, z, w), positive in this order.
    pub boundary: Vec<[u32; 3]>,
}

/// A tetrahedron at an edge (p, q), p < q: turning around it by the right-hand rule the tetrahedron
/// reaches from the face (p, q, from) to the face (p, q, to); (p, q, from, to) is positive.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Wedge {
    edge: u64,
    from: u32,
    to: u32,
    tetrahedron: u32,
}

/// Even orders of the corners, one for each edge, which comes first.
const EDGES: [[usize; 4]; 6] = [
    [0, 1, 2, 3],
    [0, 2, 3, 1],
    [0, 3, 1, 2],
    [1, 2, 0, 3],
    [2, 3, 0, 1],
    [3, 1, 0, 2],
];

/// All wedges, those of an edge next to each other and ordered by `from`.
fn wedges(tetrahedra: &[[u32; 4]]) -> Vec<Wedge> {
    let mut wedges = Vec::with_capacity(6 * tetrahedra.len());
    for (i, t) in tetrahedra.iter().enumerate() {
        for corners in EDGES {
            let [p, q, r, s] = corners.map(|k| t[k]);
            let (from, to) = if p < q { (r, s) } else { (s, r) };
            wedges.push(Wedge {
                edge: u64::from(p.min(q)) << 32 | u64::from(p.max(q)),
                from,
                to,
                tetrahedron: i as u32,
            });
        }
    }
    wedges.sort_unstable();
    wedges
}

impl Rings {
    /// Of tetrahedra with four different vertices each, all positive at rest.
    pub(super) fn new(tetrahedra: &[[u32; 4]], vertices: usize) -> Self {
        let wedges = wedges(tetrahedra);
        let mut out = Self::default();
        out.links.reserve(wedges.len() + wedges.len() / 4);
        let mut corners = DisjointSets::new(4 * tetrahedra.len());
        // How many more tetrahedra than clusters of them a vertex has.
        let mut surplus = vec![-1i64; vertices];
        for v in tetrahedra.iter().flatten() {
            surplus[*v as usize] += 1;
        }
        let mut by_end: Vec<Wedge> = Vec::new();
        for star in wedges.chunk_by(|a, b| a.edge == b.edge) {
            by_end.clear();
            by_end.extend(star);
            by_end.sort_unstable_by_key(|w| (w.to, w.tetrahedron));
            let edge = [(star[0].edge >> 32) as u32, star[0].edge as u32];
            let repeated = out.faces(edge, star, &by_end, |v, s, t| {
                let corner = |t: u32| {
                    let at = tetrahedra[t as usize].iter().position(|&w| w == v);
                    4 * t + at.unwrap_or(0) as u32
                };
                if corners.join(corner(s), corner(t)) {
                    surplus[v as usize] -= 1;
                }
            });
            if !repeated {
                out.ring(edge, star, &by_end);
            }
        }
        let apart = |&v: &u32| surplus[v as usize] > 0;
        out.irregular_vertices = (0..vertices as u32).filter(apart).collect();
        out.irregular_faces.sort_unstable();
        out
    }

    /// The vertices around an edge in order; in a closed ring the first is not repeated.
    pub(super) fn link(&self, ring: &Ring) -> &[u32] {
        &self.links[ring.start..ring.end]
    }

    /// The faces of an edge. Each is recorded, and the tetrahedra on its two sides are joined at each of
    /// its vertices, when the edge is that of its two lowest vertices. Is there a face of more than one
    /// tetrahedron a side?
    fn faces(
        &mut self,
        [p, q]: [u32; 2],
        by_start: &[Wedge],
        by_end: &[Wedge],
        mut join: impl FnMut(u32, u32, u32),
    ) -> bool {
        let (mut i, mut j) = (0, 0);
        let mut repeated = false;
        while i < by_start.len() || j < by_end.len() {
            let next = |r: Option<u32>| r.unwrap_or(u32::MAX);
            let r = next(by_start.get(i).map(|w| w.from)).min(next(by_end.get(j).map(|w| w.to)));
            let ahead = by_start[i..].iter().take_while(|w| w.from == r).count();
            let behind = by_end[j..].iter().take_while(|w| w.to == r).count();
            repeated |= ahead > 1 || behind > 1;
            if r > q {
                match (ahead, behind) {
                    (1, 1) => {
                        let (s, t) = (by_start[i].tetrahedron, by_end[j].tetrahedron);
                        [p, q, r].iter().for_each(|&v| join(v, s, t));
                    }
                    (1, 0) => self.boundary.push([p, q, r]),
                    (0, 1) => self.boundary.push([q, p, r]),
                    _ => self.irregular_faces.push([p, q, r]),
                }
            }
            i += ahead;
            j += behind;
        }
        repeated
    }

    /// Strings the wedges of an edge together, where they form one ring or one fan.
    fn ring(&mut self, ends: [u32; 2], by_start: &[Wedge], by_end: &[Wedge]) {
        let follows = |r: u32| by_start.binary_search_by_key(&r, |w| w.from).ok();
        let preceded = |w: &&Wedge| by_end.binary_search_by_key(&w.from, |w| w.to).is_ok();
        let first = by_start.iter().find(|w| !preceded(w));
        let start = self.links.len();
        let mut at = first.unwrap_or(&by_start[0]);
        let mut strung = 1;
        self.links.push(at.from);
        let origin = at.from;
        while let Some(next) = follows(at.to).filter(|_| at.to != origin) {
            self.links.push(at.to);
            at = &by_start[next];
            strung += 1;
        }
        if first.is_some() {
            self.links.push(at.to);
        }
        if strung < by_start.len() {
            self.links.truncate(start);
            self.irregular_edges.push(ends);
            return;
        }
        self.rings.push(Ring {
            ends,
            start,
            end: self.links.len(),
            closed: first.is_none(),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rings(tetrahedra: &[[u32; 4]]) -> Rings {
        let n = tetrahedra.iter().flatten().max().map_or(0, |&v| v + 1);
        Rings::new(tetrahedra, n as usize)
    }

    #[test]
    fn the_orders_of_corners_are_even() {
        for order in EDGES {
            let inversions = |i: usize| order[i + 1..].iter().filter(|&&k| k < order[i]).count();
            assert_eq!((0..4).map(inversions).sum::<usize>() % 2, 0, "{order:?}");
        }
    }

    #[test]
    fn one_tetrahedron() {
        let one = rings(&[[0, 1, 2, 3]]);
        assert_eq!((one.rings.len(), one.boundary.len()), (6, 4));
        assert!(
            one.rings
                .iter()
                .all(|r| !r.closed && one.link(r).len() == 2)
        );
        // (x, y, z, w) is positive for all four faces.
        let even = [[0, 1, 2], [1, 0, 3], [0, 2, 3], [2, 1, 3]];
        let turned = |f: [u32; 3]| [f, [f[1], f[2], f[0]], [f[2], f[0], f[1]]];
        for face in &one.boundary {
            assert!(even.iter().any(|&f| turned(f).contains(face)), "{face:?}");
        }
        assert!(one.irregular_edges.is_empty() && one.irregular_vertices.is_empty());
    }

    #[test]
    fn a_closed_ring_and_an_open_one() {
        let wheel = |n: u32, closed: bool| -> Vec<[u32; 4]> {
            let last = if closed { n } else { n - 1 };
            (0..last).map(|i| [0, 1, 2 + i, 2 + (i + 1) % n]).collect()
        };
        let closed = rings(&wheel(5, true));
        let axis = |r: &Rings| {
            r.rings
                .iter()
                .position(|r| r.ends == [0, 1])
                .expect("the axis")
        };
        let ring = &closed.rings[axis(&closed)];
        assert!(ring.closed);
        assert_eq!(closed.link(ring), [2, 3, 4, 5, 6]);
        assert_eq!(closed.boundary.len(), 10);
        let open = rings(&wheel(5, false));
        let ring = &open.rings[axis(&open)];
        assert!(!ring.closed);
        assert_eq!(open.link(ring), [2, 3, 4, 5, 6]);
        assert_eq!(open.boundary.len(), 10);
    }

    #[test]
    fn what_is_no_manifold() {
        // A face of three; a face with both on one side; the same twice.
        let three = rings(&[[0, 1, 2, 3], [1, 0, 2, 4], [0, 1, 2, 5]]);
        assert_eq!(three.irregular_faces, [[0, 1, 2]]);
        let side = rings(&[[0, 1, 2, 3], [0, 1, 2, 4]]);
        assert_eq!(side.irregular_faces, [[0, 1, 2]]);
        let twice = rings(&[[0, 1, 2, 3], [0, 1, 2, 3]]);
        assert_eq!(twice.irregular_faces.len(), 4);
        assert!(twice.boundary.is_empty());
        // Two at an edge; two at a vertex; two apart.
        let edge = rings(&[[0, 1, 2, 3], [0, 1, 4, 5]]);
        assert_eq!(edge.irregular_edges, [[0, 1]]);
        assert_eq!(edge.irregular_vertices, [0, 1]);
        let vertex = rings(&[[0, 1, 2, 3], [4, 5, 6, 0]]);
        assert!(vertex.irregular_edges.is_empty());
        assert_eq!(vertex.irregular_vertices, [0]);
        let apart = rings(&[[0, 1, 2, 3], [4, 5, 6, 7]]);
        assert!(apart.irregular_vertices.is_empty());
    }
}
