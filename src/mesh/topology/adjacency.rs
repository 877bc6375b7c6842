//! From triangles to opposite corners, by bucketing half-edges at their lower vertex.

use super::{MeshError, NONE, next, previous};

/// Checks that there are faces and that each has three different, existing vertices.
pub(crate) fn check_simplices(simplices: &[[u32; 3]], vertices: usize) -> Result<(), MeshError> {
    if simplices.is_empty() {
        return Err(MeshError::Empty);
    }
    for (face, &[a, b, c]) in simplices.iter().enumerate() {
        if let Some(index) = [a, b, c].into_iter().find(|&v| v as usize >= vertices) {
            return Err(MeshError::IndexOutOfRange {
                face,
                index: u64::from(index),
                vertices,
            });
        }
        if a == b || a == c {
            return Err(MeshError::RepeatedVertex { face, vertex: a });
        }
        if b == c {
            return Err(MeshError::RepeatedVertex { face, vertex: b });
        }
    }
    Ok(())
}

/// The opposite of each corner, whatever the orientations; edges of three faces or more and duplicate
/// faces are errors.
pub(crate) fn opposites(simplices: &[[u32; 3]], vertices: usize) -> Result<Vec<u32>, MeshError> {
    let corners = simplices.as_flattened();
    let edge = |corner: u32| {
        let (a, b) = (
            corners[next(corner) as usize],
            corners[previous(corner) as usize],
        );
        (a.min(b), a.max(b))
    };
    // A counting sort by the lower vertex; within its bucket (three edges on average) by the higher.
    let mut starts = vec![0u32; vertices + 1];
    for corner in 0..corners.len() as u32 {
        starts[edge(corner).0 as usize + 1] += 1;
    }
    for vertex in 0..vertices {
        starts[vertex + 1] += starts[vertex];
    }
    let mut half_edges = vec![(0u32, 0u32); corners.len()];
    let mut ends = starts.clone();
    for corner in 0..corners.len() as u32 {
        let (low, high) = edge(corner);
        let end = &mut ends[low as usize];
        half_edges[*end as usize] = (high, corner);
        *end += 1;
    }
    let mut opposite = vec![NONE; corners.len()];
    for low in 0..vertices {
        let bucket = &mut half_edges[starts[low] as usize..starts[low + 1] as usize];
        bucket.sort_unstable();
        for group in bucket.chunk_by(|a, b| a.0 == b.0) {
            match group {
                [_] => {}
                &[(_, a), (_, b)] if corners[a as usize] != corners[b as usize] => {
                    opposite[a as usize] = b;
                    opposite[b as usize] = a;
                }
                _ => return Err(crowded_edge(corners, low as u32, group)),
            }
        }
    }
    Ok(opposite)
}

/// What is wrong with an edge whose faces are more than two, or two of the same vertices.
#[cold]
fn crowded_edge(corners: &[u32], low: u32, group: &[(u32, u32)]) -> MeshError {
    // Faces at this edge with the same third vertex are the same face.
    let mut apexes: Vec<(u32, u32)> = group
        .iter()
        .map(|&(_, corner)| (corners[corner as usize], corner / 3))
        .collect();
    apexes.sort_unstable();
    match apexes.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => MeshError::DuplicateFace {
            first: pair[0].1 as usize,
            second: pair[1].1 as usize,
        },
        None => MeshError::NonManifoldEdge {
            vertices: [low, group[0].0],
            faces: group.len(),
        },
    }
}
