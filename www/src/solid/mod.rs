//! A solid of tetrahedra as the page draws it: its skin, its creases, how each tetrahedron is
//! stretched, how a plane cuts it, and what lies under the pointer.

pub mod contact;
pub mod field;
pub mod pick;
pub mod slice;
pub mod stretch;

use glam::{DVec3, Vec3};

use crate::outline;

/// Edges of the skin bent by more than this angle (in degrees) at rest are drawn as lines.
const CREASE: f64 = 40.0;

/// Cosine of the angle up to which one sharp edge continues another.
const STRAIGHT: f64 = 0.97;

/// Skins of fewer triangles have all their sharp edges drawn.
const FEW: usize = 100;

/// What does not change while a solid is deformed.
#[derive(Debug, Clone, Default)]
pub struct Solid {
    /// Vertices of every tetrahedron.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Triangles of the skin, counter-clockwise seen from outside.
    pub skin: Vec<[u32; 3]>,
    /// For every triangle of the skin the tetrahedron it belongs to.
    pub owners: Vec<u32>,
    /// Sharp edges of the skin.
    pub creases: Vec<[u32; 2]>,
    /// Vertices on the skin, in order.
    pub outside: Vec<u32>,
    /// Number of vertices.
    pub vertices: usize,
    /// Inverse edge matrices at rest.
    pub rest: stretch::RestShapes,
    /// Lowest corner of the bounding box at rest.
    pub low: Vec3,
    /// Highest corner of the bounding box at rest.
    pub high: Vec3,
    /// Whether this is triangles of a plane z = constant: as `tetrahedra` with a fourth vertex
    /// [`ABOVE`](stretch::ABOVE), and all of them the skin.
    pub planar: bool,
}

impl Solid {
    /// From rest positions (n×3), tetrahedra (m×4) and skin triangles (k×3), all indices in range.
    pub fn new(positions: &[f64], tetrahedra: &[u32], skin: &[u32]) -> Self {
        let tetrahedra = tetrahedra.as_chunks::<4>().0.to_vec();
        let skin = skin.as_chunks::<3>().0.to_vec();
        let point = |v: u32| DVec3::from_slice(&positions[3 * v as usize..]);
        let (low, high) = (0..(positions.len() / 3) as u32)
            .map(point)
            .fold((DVec3::MAX, DVec3::MIN), |(l, h), p| (l.min(p), h.max(p)));
        let mut outside: Vec<u32> = skin.as_flattened().to_vec();
        outside.sort_unstable();
        outside.dedup();
        Self {
            rest: stretch::RestShapes::new(positions, &tetrahedra),
            owners: owners(&tetrahedra, &skin),
            creases: creases(&skin, point),
            outside,
            vertices: positions.len() / 3,
            low: low.as_vec3(),
            high: high.as_vec3(),
            tetrahedra,
            skin,
            planar: false,
        }
    }

    /// Of triangles (m×3) of a plane z = constant, with indices in range.
    pub fn planar(positions: &[f64], triangles: &[u32]) -> Self {
        let skin = triangles.as_chunks::<3>().0;
        let tetrahedra: Vec<[u32; 4]> = skin
            .iter()
            .map(|&[a, b, c]| [a, b, c, stretch::ABOVE])
            .collect();
        let plain = Self::new(positions, &[], triangles);
        Self {
            rest: stretch::RestShapes::new(positions, &tetrahedra),
            owners: (0..tetrahedra.len() as u32).collect(),
            creases: outline::boundary_edges(triangles),
            tetrahedra,
            planar: true,
            ..plain
        }
    }
}

fn sorted<const N: usize>(mut vertices: [u32; N]) -> [u32; N] {
    vertices.sort_unstable();
    vertices
}

/// The tetrahedron each skin triangle is a face of (the first, for a triangle of none).
fn owners(tetrahedra: &[[u32; 4]], skin: &[[u32; 3]]) -> Vec<u32> {
    let mut faces: Vec<([u32; 3], u32)> = tetrahedra
        .iter()
        .enumerate()
        .flat_map(|(t, &[a, b, c, d])| {
            [[b, c, d], [a, c, d], [a, b, d], [a, b, c]].map(|face| (sorted(face), t as u32))
        })
        .collect();
    faces.sort_unstable();
    let find = |triangle: [u32; 3]| {
        let key = sorted(triangle);
        let at = faces.partition_point(|(face, _)| *face < key);
        faces
            .get(at)
            .filter(|(face, _)| *face == key)
            .map_or(0, |(_, t)| *t)
    };
    skin.iter().map(|&triangle| find(triangle)).collect()
}

/// Edges between skin triangles whose normals differ by more than [`CREASE`].
fn creases(skin: &[[u32; 3]], point: impl Fn(u32) -> DVec3) -> Vec<[u32; 2]> {
    let normal = |&[a, b, c]: &[u32; 3]| {
        (point(b) - point(a))
            .cross(point(c) - point(a))
            .normalize_or_zero()
    };
    let mut edges: Vec<([u32; 2], u32)> = skin
        .iter()
        .enumerate()
        .flat_map(|(t, &[a, b, c])| [[a, b], [b, c], [c, a]].map(|e| (sorted(e), t as u32)))
        .collect();
    edges.sort_unstable();
    let limit = CREASE.to_radians().cos();
    let sharp: Vec<[u32; 2]> = edges
        .chunk_by(|a, b| a.0 == b.0)
        .filter(|same| match same {
            [(_, t), (_, u)] => normal(&skin[*t as usize]).dot(normal(&skin[*u as usize])) < limit,
            _ => true,
        })
        .map(|same| same[0].0)
        .collect();
    if skin.len() < FEW {
        return sharp;
    }
    // On a coarse round solid every other edge is sharp: only those that go on straight make a line.
    let mut at: Vec<(u32, DVec3)> = sharp
        .iter()
        .flat_map(|&[a, b]| {
            let along = (point(b) - point(a)).normalize_or_zero();
            [(a, along), (b, -along)]
        })
        .collect();
    at.sort_unstable_by_key(|(v, _)| *v);
    let goes_on = |v: u32, away: DVec3| {
        let first = at.partition_point(|(u, _)| *u < v);
        at[first..]
            .iter()
            .take_while(|(u, _)| *u == v)
            .any(|(_, along)| along.dot(away) < -STRAIGHT)
    };
    sharp
        .into_iter()
        .filter(|&[a, b]| {
            let along = (point(b) - point(a)).normalize_or_zero();
            goes_on(a, along) || goes_on(b, -along)
        })
        .collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A unit cube of five tetrahedra and its twelve outward triangles.
    pub(crate) fn cube() -> (Vec<f64>, Vec<u32>, Vec<u32>) {
        let positions = (0..8)
            .flat_map(|i| [i & 1, (i >> 1) & 1, (i >> 2) & 1].map(f64::from))
            .collect();
        let tetrahedra = vec![
            0, 1, 2, 4, 3, 2, 1, 7, 5, 4, 7, 1, 6, 7, 4, 2, 1, 2, 4, 7u32,
        ];
        let skin = vec![
            0, 2, 1, 1, 2, 3, 4, 5, 7, 4, 7, 6, 0, 1, 4, 1, 5, 4, 2, 7, 3, 2, 6, 7, 0, 4, 2, 2, 4,
            6, 1, 3, 7, 1, 7, 5u32,
        ];
        (positions, tetrahedra, skin)
    }

    #[test]
    fn a_cube_has_twelve_creases_and_every_face_an_owner() {
        let (positions, tetrahedra, skin) = cube();
        let solid = Solid::new(&positions, &tetrahedra, &skin);
        assert_eq!(solid.creases.len(), 12);
        assert_eq!(solid.outside, [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!((solid.low, solid.high), (Vec3::ZERO, Vec3::ONE));
        for (triangle, owner) in solid.skin.iter().zip(&solid.owners) {
            let tetrahedron = solid.tetrahedra[*owner as usize];
            assert!(triangle.iter().all(|v| tetrahedron.contains(v)));
        }
    }

    #[test]
    fn only_sharp_edges_that_go_straight_on_are_drawn() {
        // Two strips of sixty squares that meet at a right angle, along a straight or a jagged line.
        let count = |jag: f64| {
            let point = |v: u32| {
                let (i, row) = (f64::from(v / 3), v % 3);
                let jag = if (v / 3).is_multiple_of(2) { jag } else { -jag };
                match row {
                    0 => DVec3::new(i, -2.0, 0.0),
                    1 => DVec3::new(i, jag, jag),
                    _ => DVec3::new(i, 0.0, -2.0),
                }
            };
            let skin: Vec<[u32; 3]> = (0..60)
                .flat_map(|i| {
                    let v = 3 * i;
                    [
                        [v, v + 1, v + 3],
                        [v + 3, v + 1, v + 4],
                        [v + 1, v + 2, v + 4],
                        [v + 4, v + 2, v + 5],
                    ]
                })
                .collect();
            let lines = creases(&skin, point);
            lines
                .iter()
                .filter(|e| e.iter().all(|v| v % 3 == 1))
                .count()
        };
        assert_eq!(count(0.0), 60);
        assert_eq!(count(0.4), 0);
    }
}
