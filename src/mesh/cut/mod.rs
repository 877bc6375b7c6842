//! Cutting a surface of any genus and any boundary to a disk, along short seams.
//!
//! Tree–cotree (Eppstein 2003) with the greedy choice of Erickson & Whittlesey 2005: shortest paths
//! from the boundary (or, on a closed surface, from one vertex) are a forest; the edges outside of it,
//! weighted by the length of the loop or arc they close, hold a maximum spanning tree of the dual; the
//! edges in neither are the shortest loops and arcs that have to be cut. Their paths back along the
//! forest are the seams; spurs that lead nowhere are pruned. A sphere is slit between two far vertices.

mod seams;
mod split;

use super::{MeshError, SurfaceMesh, Topology};

/// A disk cut from a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Cut {
    /// The disk: triangles in the order of the input's, vertices of the input first (each for one side
    /// of the seams through it), their copies behind.
    pub mesh: SurfaceMesh,
    /// Per vertex of `mesh`: the vertex it came from.
    pub source_vertices: Vec<u32>,
    /// The edges that were cut, lower vertex first, sorted; none if the surface was a disk.
    pub seam_edges: Vec<[u32; 2]>,
}

/// Cuts a connected surface to a disk. A disk comes back as it is.
///
/// # Errors
/// [`MeshError::SeveralComponents`] if there is not exactly one.
pub fn cut_to_disk(mesh: &SurfaceMesh, topology: &Topology) -> Result<Cut, MeshError> {
    if topology.components() != 1 {
        return Err(MeshError::SeveralComponents {
            components: topology.components(),
        });
    }
    if topology.is_disk() {
        return Ok(Cut {
            mesh: mesh.clone(),
            source_vertices: (0..mesh.positions.len() as u32).collect(),
            seam_edges: Vec::new(),
        });
    }
    let graph = seams::EdgeGraph::new(mesh, topology);
    let is_seam = if topology.is_closed() && topology.genus() == 0 {
        seams::slit(&graph, seams::end_of(mesh, &graph))
    } else if topology.is_closed() {
        seams::shortest_of_several_roots(&graph, seams::end_of(mesh, &graph))
    } else {
        let boundary: Vec<u32> = topology.boundary_loops().concat();
        seams::seams(&graph, &boundary).is_seam
    };
    Ok(split::split(mesh, topology, &graph, &is_seam))
}
