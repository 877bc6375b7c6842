//! Opening a surface along its seams: every sector between seams gets its own copy of the vertex.

use super::seams::EdgeGraph;
use super::{Cut, SurfaceMesh, Topology};
use crate::mesh::topology::{next, previous};

pub(super) fn split(
    mesh: &SurfaceMesh,
    topology: &Topology,
    graph: &EdgeGraph,
    is_seam: &[bool],
) -> Cut {
    let open = |corner: u32| !is_seam[graph.edge_of_corner(corner) as usize];
    let clockwise = |corner: u32| {
        topology
            .clockwise(corner)
            .filter(|_| open(previous(corner)))
    };
    let counter_clockwise = |corner: u32| {
        topology
            .counter_clockwise(corner)
            .filter(|_| open(next(corner)))
    };
    const UNSEEN: u32 = u32::MAX;
    let mut copies: Vec<u32> = vec![UNSEEN; 3 * mesh.simplices.len()];
    let mut positions = mesh.positions.clone();
    let mut source_vertices: Vec<u32> = (0..positions.len() as u32).collect();
    let mut taken = vec![false; positions.len()];
    for corner in 0..copies.len() as u32 {
        if copies[corner as usize] != UNSEEN {
            continue;
        }
        let vertex = topology.vertex(corner);
        let copy = if std::mem::replace(&mut taken[vertex as usize], true) {
            positions.push(mesh.positions[vertex as usize]);
            source_vertices.push(vertex);
            (positions.len() - 1) as u32
        } else {
            vertex
        };
        // The whole sector, both ways from here.
        let mut at = Some(corner);
        while let Some(corner) = at.filter(|&c| copies[c as usize] == UNSEEN) {
            copies[corner as usize] = copy;
            at = counter_clockwise(corner);
        }
        let mut at = clockwise(corner);
        while let Some(corner) = at.filter(|&c| copies[c as usize] == UNSEEN) {
            copies[corner as usize] = copy;
            at = clockwise(corner);
        }
    }
    let mut seam_edges: Vec<[u32; 2]> = graph
        .edges
        .iter()
        .zip(is_seam)
        .filter(|&(_, &seam)| seam)
        .map(|(edge, _)| edge.vertices)
        .collect();
    seam_edges.sort_unstable();
    Cut {
        mesh: SurfaceMesh {
            positions,
            simplices: copies.as_chunks().0.to_vec(),
        },
        source_vertices,
        seam_edges,
    }
}
