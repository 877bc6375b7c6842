//! The surface of a solid.

use super::{MeshError, SolidMesh, SurfaceMesh};

/// The corners of the faces of a tetrahedron (0, 1, 2, 3) of positive volume, counter-clockwise seen
/// from outside; face k is opposite to corner k.
pub const FACES: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];

/// The surface of a solid, as a mesh of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// The faces that belong to one tetrahedron, in the order of the tetrahedra and of [`FACES`];
    /// counter-clockwise seen from outside where the tetrahedron has positive volume.
    pub mesh: SurfaceMesh,
    /// Per vertex of `mesh`: its index in the solid; increasing.
    pub vertices: Vec<u32>,
    /// Per triangle of `mesh`: the tetrahedron it belongs to; increasing.
    pub tetrahedra: Vec<u32>,
}

impl SolidMesh {
    /// The surface: faces that belong to one tetrahedron. It may have several components (cavities), and
    /// touch itself in edges and vertices.
    ///
    /// Which side is out is taken from the order of the tetrahedra's vertices alone, so that the surface
    /// of a deformed solid is that of its rest shape, even where it is inverted.
    ///
    /// # Errors
    /// [`MeshError`]: empty; index out of range and repeated vertex (of an element); non-manifold face
    /// (three tetrahedra or more share it).
    pub fn boundary(&self) -> Result<Boundary, MeshError> {
        self.check_elements()?;
        // A face by its sorted vertices, the tetrahedron, and the corner it is opposite to.
        let mut faces: Vec<([u32; 3], u32, u8)> = Vec::with_capacity(4 * self.simplices.len());
        for (number, tetrahedron) in self.simplices.iter().enumerate() {
            for (opposite, corners) in FACES.iter().enumerate() {
                let mut key = corners.map(|k| tetrahedron[k]);
                key.sort_unstable();
                faces.push((key, number as u32, opposite as u8));
            }
        }
        faces.sort_unstable();
        let mut outer: Vec<(u32, u8)> = Vec::new();
        for group in faces.chunk_by(|a, b| a.0 == b.0) {
            match *group {
                [(_, tetrahedron, opposite)] => outer.push((tetrahedron, opposite)),
                [_, _] => {}
                _ => {
                    return Err(MeshError::NonManifoldFace {
                        vertices: group[0].0,
                        tetrahedra: group.len(),
                    });
                }
            }
        }
        outer.sort_unstable();

        let mut used = vec![false; self.positions.len()];
        let mut simplices: Vec<[u32; 3]> = Vec::with_capacity(outer.len());
        for &(tetrahedron, opposite) in &outer {
            let corners = self.simplices[tetrahedron as usize];
            let triangle = FACES[usize::from(opposite)].map(|k| corners[k]);
            triangle.iter().for_each(|&v| used[v as usize] = true);
            simplices.push(triangle);
        }
        let vertices: Vec<u32> = (0..used.len() as u32)
            .filter(|&v| used[v as usize])
            .collect();
        let mut renumbered = vec![0; used.len()];
        for (new, &old) in vertices.iter().enumerate() {
            renumbered[old as usize] = new as u32;
        }
        for vertex in simplices.as_flattened_mut() {
            *vertex = renumbered[*vertex as usize];
        }
        Ok(Boundary {
            mesh: SurfaceMesh {
                positions: vertices
                    .iter()
                    .map(|&v| self.positions[v as usize])
                    .collect(),
                simplices,
            },
            vertices,
            tetrahedra: outer.iter().map(|&(tetrahedron, _)| tetrahedron).collect(),
        })
    }

    /// Every element has four different vertices that exist.
    fn check_elements(&self) -> Result<(), MeshError> {
        if self.simplices.is_empty() {
            return Err(MeshError::Empty);
        }
        let vertices = self.positions.len();
        for (face, corners) in self.simplices.iter().enumerate() {
            for (k, &vertex) in corners.iter().enumerate() {
                if vertex as usize >= vertices {
                    let index = u64::from(vertex);
                    return Err(MeshError::IndexOutOfRange {
                        face,
                        index,
                        vertices,
                    });
                }
                if corners[..k].contains(&vertex) {
                    return Err(MeshError::RepeatedVertex { face, vertex });
                }
            }
        }
        Ok(())
    }
}
