//! Who touches whom: a compact corner table, boundary loops, components, Euler characteristic.
//!
//! Corner `3·t + i` is corner i of triangle t; its *opposite* is the corner across the edge that it
//! faces (Rossignac's corner table), or none on the boundary. Everything is built by counting sorts in
//! O(n) and does not depend on any hash order.

mod adjacency;
mod orient;

pub(crate) use adjacency::{check_simplices, opposites};
pub(super) use orient::orient;

use super::{MeshError, SurfaceMesh};

/// No corner: the edge is on the boundary.
pub(super) const NONE: u32 = u32::MAX;

/// The next corner of the same triangle, counter-clockwise.
#[inline]
pub fn next(corner: u32) -> u32 {
    if corner % 3 == 2 {
        corner - 2
    } else {
        corner + 1
    }
}

/// The previous corner of the same triangle.
#[inline]
pub fn previous(corner: u32) -> u32 {
    if corner.is_multiple_of(3) {
        corner + 2
    } else {
        corner - 1
    }
}

/// The topology of a manifold, consistently oriented triangle mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Topology {
    simplices: Vec<[u32; 3]>,
    opposite: Vec<u32>,
    /// A corner of each vertex, the most clockwise one on the boundary; `NONE` if unreferenced.
    vertex_corner: Vec<u32>,
    boundary_loops: Vec<Vec<u32>>,
    face_components: Vec<u32>,
    components: usize,
    vertices: usize,
    edges: usize,
}

impl Topology {
    /// Builds the table and checks that the mesh is an oriented manifold, with boundary or without, of
    /// any number of components. Positions are not looked at.
    ///
    /// # Errors
    /// [`MeshError`]: empty, index out of range, repeated vertex, duplicate face, non-manifold edge or
    /// vertex, faces oriented against each other ([`prepare`](super::prepare) mends that).
    pub fn new(mesh: &SurfaceMesh) -> Result<Self, MeshError> {
        check_simplices(&mesh.simplices, mesh.positions.len())?;
        let opposite = opposites(&mesh.simplices, mesh.positions.len())?;
        if let Some(faces) = orient::first_clash(&mesh.simplices, &opposite) {
            return Err(MeshError::InconsistentOrientation { faces });
        }
        Self::of_oriented(mesh, opposite)
    }

    /// The rest of the table, from checked, consistently oriented simplices and their opposites.
    pub(super) fn of_oriented(mesh: &SurfaceMesh, opposite: Vec<u32>) -> Result<Self, MeshError> {
        let mut topology = Self {
            simplices: mesh.simplices.clone(),
            vertex_corner: Vec::new(),
            boundary_loops: Vec::new(),
            face_components: Vec::new(),
            components: 0,
            vertices: 0,
            edges: 0,
            opposite,
        };
        topology.find_fans(mesh.positions.len())?;
        topology.find_boundary();
        topology.find_components();
        Ok(topology)
    }

    /// One corner a vertex, having checked that the corners of a vertex form one fan.
    fn find_fans(&mut self, vertices: usize) -> Result<(), MeshError> {
        let mut visited = vec![false; self.opposite.len()];
        self.vertex_corner = vec![NONE; vertices];
        for corner in 0..self.opposite.len() as u32 {
            if visited[corner as usize] {
                continue;
            }
            let vertex = self.vertex(corner);
            if self.vertex_corner[vertex as usize] != NONE {
                return Err(MeshError::NonManifoldVertex { vertex });
            }
            self.vertices += 1;
            // Clockwise to the boundary or once round, then counter-clockwise over the whole fan.
            let mut first = corner;
            while let Some(before) = self.clockwise(first) {
                first = before;
                if first == corner {
                    break;
                }
            }
            self.vertex_corner[vertex as usize] = first;
            let mut at = Some(first);
            while let Some(corner) = at {
                if visited[corner as usize] {
                    break;
                }
                visited[corner as usize] = true;
                at = self.counter_clockwise(corner);
            }
        }
        Ok(())
    }

    /// The boundary as loops of vertices, surface to the left; counts the edges.
    fn find_boundary(&mut self) {
        let mut after = vec![NONE; self.vertex_corner.len()];
        let mut boundary_edges = 0;
        for corner in 0..self.opposite.len() as u32 {
            if self.opposite[corner as usize] == NONE {
                after[self.vertex(next(corner)) as usize] = self.vertex(previous(corner));
                boundary_edges += 1;
            }
        }
        self.edges = (self.opposite.len() + boundary_edges) / 2;
        // In the order of their lowest vertices, each beginning with it.
        for start in 0..after.len() {
            let mut vertices = Vec::new();
            let mut at = start as u32;
            while after[at as usize] != NONE {
                vertices.push(at);
                at = std::mem::replace(&mut after[at as usize], NONE);
            }
            if !vertices.is_empty() {
                self.boundary_loops.push(vertices);
            }
        }
    }

    fn find_components(&mut self) {
        self.face_components = vec![NONE; self.simplices.len()];
        let mut stack = Vec::new();
        for face in 0..self.simplices.len() {
            if self.face_components[face] != NONE {
                continue;
            }
            let label = self.components as u32;
            self.components += 1;
            self.face_components[face] = label;
            stack.push(face);
            while let Some(face) = stack.pop() {
                for &across in &self.opposite[3 * face..3 * face + 3] {
                    if across != NONE && self.face_components[across as usize / 3] == NONE {
                        self.face_components[across as usize / 3] = label;
                        stack.push(across as usize / 3);
                    }
                }
            }
        }
    }

    /// Number of vertices that belong to a face.
    pub fn vertices(&self) -> usize {
        self.vertices
    }

    /// Number of edges.
    pub fn edges(&self) -> usize {
        self.edges
    }

    /// Number of faces.
    pub fn faces(&self) -> usize {
        self.simplices.len()
    }

    /// The vertex at a corner.
    #[inline]
    pub fn vertex(&self, corner: u32) -> u32 {
        self.simplices[corner as usize / 3][corner as usize % 3]
    }

    /// The corner across the edge that `corner` faces; none on the boundary.
    #[inline]
    pub fn opposite(&self, corner: u32) -> Option<u32> {
        let across = self.opposite[corner as usize];
        (across != NONE).then_some(across)
    }

    /// The next corner of the same vertex, counter-clockwise; none at the boundary.
    #[inline]
    pub fn counter_clockwise(&self, corner: u32) -> Option<u32> {
        self.opposite(next(corner)).map(next)
    }

    /// The next corner of the same vertex, clockwise; none at the boundary.
    #[inline]
    pub fn clockwise(&self, corner: u32) -> Option<u32> {
        self.opposite(previous(corner)).map(previous)
    }

    /// A corner of a vertex, the most clockwise one if it is on the boundary; none if no face has it.
    pub fn corner_of(&self, vertex: u32) -> Option<u32> {
        let corner = self.vertex_corner[vertex as usize];
        (corner != NONE).then_some(corner)
    }

    /// Is the vertex on the boundary?
    pub fn is_boundary_vertex(&self, vertex: u32) -> bool {
        self.corner_of(vertex)
            .is_some_and(|corner| self.clockwise(corner).is_none())
    }

    /// The boundary, as loops of vertices with the surface to their left, in the order of their lowest
    /// vertices, each beginning with its lowest.
    pub fn boundary_loops(&self) -> &[Vec<u32>] {
        &self.boundary_loops
    }

    /// Number of connected components.
    pub fn components(&self) -> usize {
        self.components
    }

    /// The component of each face, numbered by first face.
    pub fn face_components(&self) -> &[u32] {
        &self.face_components
    }

    /// Vertices − edges + faces.
    pub fn euler_characteristic(&self) -> i64 {
        self.vertices as i64 - self.edges as i64 + self.simplices.len() as i64
    }

    /// Number of handles, of all components together.
    pub fn genus(&self) -> usize {
        let twice = 2 * self.components as i64
            - self.euler_characteristic()
            - self.boundary_loops.len() as i64;
        (twice / 2) as usize
    }

    /// No boundary?
    pub fn is_closed(&self) -> bool {
        self.boundary_loops.is_empty()
    }

    /// One component with one boundary loop and no handle?
    pub fn is_disk(&self) -> bool {
        self.components == 1 && self.boundary_loops.len() == 1 && self.euler_characteristic() == 1
    }
}
