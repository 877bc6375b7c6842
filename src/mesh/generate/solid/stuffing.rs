//! Isosurface stuffing: tetrahedra with bounded dihedral angles inside an implicit surface.
//!
//! Labelle & Shewchuk, *Isosurface stuffing: fast tetrahedral meshes with good dihedral angles*,
//! ACM Trans. Graph. 26(3), 2007, with tetrahedra of one size: lattice vertices that the surface
//! passes closely are moved onto it, then every lattice tetrahedron is replaced by the part inside.
//!
//! One step is added. Where the solid is thinner than the lattice, moved vertices can make the
//! boundary touch itself in a vertex or an edge. Such a vertex is put back, and the cut points round
//! it keep the distance of a cut point that would not have moved it. The angles have the same bounds,
//! and the boundary becomes a manifold.

use super::lattice::Lattice;
use super::stencil::{Side, fill};
use crate::mesh::SolidMesh;
use glam::DVec3;

/// A cut point moves the end of a long (short) lattice edge that is nearer than this fraction of it.
/// With these two values every dihedral angle is between 10.78° and 164.74°, the bounds that the paper
/// states; `stencil_tests.rs` finds the extremes over all stencils.
pub(super) const ALPHA_LONG: f64 = 0.2851;
/// See [`ALPHA_LONG`].
pub(super) const ALPHA_SHORT: f64 = 0.3988;

/// Why a solid cannot be filled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StuffingError {
    /// The spacing is not a positive number.
    #[error("the spacing is {spacing}, not a positive number")]
    Spacing {
        /// The spacing asked for.
        spacing: f64,
    },
    /// The corners of the box are not finite, or not in order.
    #[error("the bounds are not finite or not in order")]
    Bounds,
    /// The lattice would have too many cells.
    #[error("the lattice would have {cells:e} cells")]
    TooFine {
        /// How many.
        cells: f64,
    },
}

/// No cut point, no node.
const NONE: u32 = u32::MAX;

/// The crossing of a lattice edge with the surface.
struct Cut {
    inside: u32,
    outside: u32,
    /// Position on the edge: 0 at the inside vertex, 1 at the outside one.
    fraction: f64,
}

/// Fills the solid f < 0 with tetrahedra of edge length about `spacing` (the side of a cell of the
/// body-centred cubic lattice; a cell has twelve).
///
/// `bounds` (lower and upper corner) are those of the solid, which they do not cut: what sticks out of
/// them is cut off within two spacings.
///
/// |f| must not be greater than the distance to the surface f = 0 (a function whose gradient is
/// nowhere longer than 1 qualifies); far from the surface it is evaluated sparsely. Every dihedral
/// angle of the result is between 10.7° and 164.8°, the boundary is a manifold, and neighbours
/// share whole faces. Parts that are thinner than the spacing can be missing or fall into pieces. A
/// solid with no lattice vertex inside gives an empty mesh.
///
/// # Errors
/// [`StuffingError`]: bounds or spacing that are no numbers, more than 3·10⁷ cells.
pub fn stuff(
    f: impl Fn(DVec3) -> f64,
    bounds: [DVec3; 2],
    spacing: f64,
) -> Result<SolidMesh, StuffingError> {
    let lattice = Lattice::new(bounds, spacing)?;
    let inside = lattice.sample(&f);
    let mut stuffing = Stuffing::new(lattice, inside, &f);
    stuffing.warp();
    loop {
        let tetrahedra = stuffing.fill();
        let pinched = stuffing.pinched(&tetrahedra);
        if pinched.is_empty() {
            return Ok(stuffing.mesh(tetrahedra));
        }
        // Every round has fewer moved vertices, and without any the boundary is a manifold.
        for vertex in pinched {
            stuffing.moved[vertex as usize] = NONE;
        }
    }
}

struct Stuffing {
    lattice: Lattice,
    inside: Vec<bool>,
    /// The cut points of the edges whose lower vertex is v: `cuts[starts[v]..starts[v + 1]]`.
    cuts: Vec<Cut>,
    starts: Vec<u32>,
    /// The cut point a vertex was moved to, or `NONE`.
    moved: Vec<u32>,
}

impl Stuffing {
    /// Finds the cut points.
    fn new(lattice: Lattice, inside: Vec<bool>, f: &impl Fn(DVec3) -> f64) -> Self {
        let steps = lattice.neighbours();
        let mut edges = Vec::new();
        for v in (0..inside.len() as u32).filter(|&v| inside[v as usize]) {
            for step in steps[v as usize % 2] {
                let w = (i64::from(v) + step) as u32;
                if !inside[w as usize] {
                    edges.push((v.min(w), v, w));
                }
            }
        }
        edges.sort_unstable();
        let mut starts = vec![0u32; inside.len() + 1];
        for &(low, _, _) in &edges {
            starts[low as usize + 1] += 1;
        }
        for v in 0..inside.len() {
            starts[v + 1] += starts[v];
        }
        let find = |&(_, v, w): &(u32, u32, u32)| Cut {
            inside: v,
            outside: w,
            fraction: crossing(f, lattice.position(v), lattice.position(w)),
        };
        Self {
            cuts: edges.iter().map(find).collect(),
            starts,
            moved: vec![NONE; inside.len()],
            lattice,
            inside,
        }
    }

    /// The index of the cut point between two vertices.
    fn cut(&self, a: u32, b: u32) -> u32 {
        let [start, end] = [0, 1].map(|k| self.starts[a.min(b) as usize + k]);
        let sum = u64::from(a) + u64::from(b);
        (start..end)
            .find(|&c| {
                let cut = &self.cuts[c as usize];
                u64::from(cut.inside) + u64::from(cut.outside) == sum
            })
            .unwrap_or(NONE)
    }

    /// Moves each vertex that is too close to a cut point to the closest one. That takes the cut
    /// points off its other edges.
    fn warp(&mut self) {
        let steps = self.lattice.neighbours();
        let mut near: Vec<u32> = self
            .cuts
            .iter()
            .flat_map(|cut| [cut.inside, cut.outside])
            .collect();
        near.sort_unstable();
        near.dedup();
        for v in near {
            let mut closest = f64::INFINITY;
            for step in steps[v as usize % 2] {
                let w = (i64::from(v) + step) as u32;
                if self.inside[w as usize] == self.inside[v as usize]
                    || self.moved[w as usize] != NONE
                {
                    continue;
                }
                let index = self.cut(v, w);
                let cut = &self.cuts[index as usize];
                let fraction = match cut.inside == v {
                    true => cut.fraction,
                    false => 1.0 - cut.fraction,
                };
                let (long, length) = self.lattice.edge(v, w);
                let alpha = if long { ALPHA_LONG } else { ALPHA_SHORT };
                if fraction < alpha && fraction * length < closest {
                    closest = fraction * length;
                    self.moved[v as usize] = index;
                }
            }
        }
    }

    fn side(&self, vertex: u32) -> Side {
        match (self.moved[vertex as usize], self.inside[vertex as usize]) {
            (NONE, true) => Side::Inside,
            (NONE, false) => Side::Outside,
            _ => Side::On,
        }
    }

    /// All tetrahedra. A node is a lattice vertex, or behind all of these a cut point.
    fn fill(&self) -> Vec<[u32; 4]> {
        let vertices = self.inside.len() as u32;
        let templates = self.lattice.templates();
        let mut tetrahedra = Vec::new();
        for corner in self.lattice.corners() {
            for template in &templates {
                let at = template.steps.map(|step| (i64::from(corner) + step) as u32);
                if at.iter().any(|&v| self.inside[v as usize]) {
                    let node = |i: usize| at[i];
                    let cut = |i: usize, j: usize| vertices + self.cut(at[i], at[j]);
                    let sides = at.map(|v| self.side(v));
                    fill(sides, &template.at, node, cut, &mut tetrahedra);
                }
            }
        }
        tetrahedra
    }

    /// The boundary triangles at each moved vertex must form one fan: vertices where they do not.
    fn pinched(&self, tetrahedra: &[[u32; 4]]) -> Vec<u32> {
        let vertices = self.inside.len();
        let on = |node: u32| node as usize >= vertices || self.moved[node as usize] != NONE;
        let mut faces = Vec::new();
        for &[a, b, c, d] in tetrahedra {
            for mut face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
                if face.into_iter().all(on) {
                    face.sort_unstable();
                    faces.push(face);
                }
            }
        }
        faces.sort_unstable();
        // (vertex, next on the rim of its fan, next but one): each triangle in both directions.
        let mut fans = Vec::new();
        for face in faces.chunk_by(|a, b| a == b).filter(|same| same.len() == 1) {
            let [a, b, c] = face[0];
            for (v, x, y) in [(a, b, c), (b, c, a), (c, a, b)] {
                if (v as usize) < vertices {
                    fans.extend([(v, x, y), (v, y, x)]);
                }
            }
        }
        fans.sort_unstable();
        fans.chunk_by(|a, b| a.0 == b.0)
            .filter(|fan| !is_one_cycle(fan))
            .map(|fan| fan[0].0)
            .collect()
    }

    /// Numbers the nodes in the order of the tetrahedra and places them.
    fn mesh(&self, mut tetrahedra: Vec<[u32; 4]>) -> SolidMesh {
        let vertices = self.inside.len();
        let mut numbers = vec![NONE; vertices + self.cuts.len()];
        let mut positions = Vec::new();
        for node in tetrahedra.as_flattened_mut() {
            let number = &mut numbers[*node as usize];
            if *number == NONE {
                *number = positions.len() as u32;
                let cut = match (*node as usize).checked_sub(vertices) {
                    Some(cut) => Some((cut as u32, true)),
                    None => Some((self.moved[*node as usize], false)).filter(|&(c, _)| c != NONE),
                };
                positions.push(match cut {
                    None => self.lattice.position(*node),
                    Some((cut, clamped)) => self.cut_position(cut, clamped),
                });
            }
            *node = *number;
        }
        SolidMesh {
            positions,
            simplices: tetrahedra,
        }
    }

    /// Where a cut point is; clamped to where it moves neither end of its edge.
    fn cut_position(&self, index: u32, clamped: bool) -> DVec3 {
        let cut = &self.cuts[index as usize];
        let mut fraction = cut.fraction;
        if clamped {
            let (long, _) = self.lattice.edge(cut.inside, cut.outside);
            let alpha = if long { ALPHA_LONG } else { ALPHA_SHORT };
            fraction = fraction.clamp(alpha, 1.0 - alpha);
        }
        let [a, b] = [cut.inside, cut.outside].map(|v| self.lattice.position(v));
        a.lerp(b, fraction)
    }
}

/// Do the sorted directed edges (_, from, to) of a rim, both directions given, form one cycle?
fn is_one_cycle(rim: &[(u32, u32, u32)]) -> bool {
    if rim.chunk_by(|a, b| a.1 == b.1).any(|at| at.len() != 2) {
        return false;
    }
    let (start, mut before, mut node) = (rim[0].1, rim[0].1, rim[0].2);
    let mut length = 1;
    while node != start {
        let first = rim.partition_point(|edge| edge.1 < node);
        let next = match rim[first].2 == before {
            true => rim[first + 1].2,
            false => rim[first].2,
        };
        (before, node) = (node, next);
        length += 1;
    }
    2 * length == rim.len()
}

/// Where f changes sign between `a` (inside) and `b` (outside), as a fraction of the way: regula falsi
/// with the Illinois weights.
fn crossing(f: &impl Fn(DVec3) -> f64, a: DVec3, b: DVec3) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let (mut below, mut above) = (f(a), f(b));
    // Where the bounds cut the solid off, its wall is at the outside vertex.
    if !(above > 0.0) {
        return high;
    }
    let enough = 1e-9 * a.distance(b);
    let mut last = 0;
    for _ in 0..60 {
        let fraction: f64 = low + (high - low) * (below / (below - above)).clamp(0.0, 1.0);
        let value = f(a.lerp(b, fraction));
        if value.abs() <= enough || !value.is_finite() {
            return fraction;
        }
        let side = if value < 0.0 { -1 } else { 1 };
        if side < 0 {
            (low, below) = (fraction, value);
        } else {
            (high, above) = (fraction, value);
        }
        // The end that has stayed twice counts half.
        if side == last && side < 0 {
            above *= 0.5;
        } else if side == last {
            below *= 0.5;
        }
        last = side;
    }
    0.5 * (low + high)
}
