//! From a mesh as it comes to one that can be worked with.

use super::topology::{check_simplices, opposites, orient};
use super::{MeshError, SurfaceMesh, Topology, counted};
use glam::DVec3;

/// A face of less than this part of the whole surface is degenerate.
const DEGENERATE_AREA: f64 = 1e-14;

/// A surface of less than this part of its squared extent has no area.
const ZERO_AREA: f64 = 1e-14;

/// A checked mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    /// The mesh: finite, no degenerate face, manifold, consistently oriented, every vertex used.
    /// Triangles are in the order of the input's.
    pub mesh: SurfaceMesh,
    /// Per vertex of `mesh`: its index in the input.
    pub input_vertices: Vec<u32>,
    /// Its topology; any number of components, any boundary.
    pub topology: Topology,
    /// What was mended, in words.
    pub notes: Vec<String>,
}

/// Checks a mesh, turns faces until neighbours agree (and says so), drops vertices of no face (and
/// says so), and finds the topology.
///
/// # Errors
/// Everything in [`MeshError`] but several components and not being a disk; the element is named by
/// its index in the input.
pub fn prepare(mesh: &SurfaceMesh) -> Result<Prepared, MeshError> {
    let positions = &mesh.positions;
    if let Some(vertex) = positions.iter().position(|p| !p.is_finite()) {
        return Err(MeshError::NonFinitePosition { vertex });
    }
    check_simplices(&mesh.simplices, positions.len())?;
    check_areas(mesh)?;

    let mut notes = Vec::new();
    let mut simplices = mesh.simplices.clone();
    let mut opposite = opposites(&simplices, positions.len())?;
    let turned = orient(&mut simplices, &mut opposite)?;
    if turned > 0 {
        notes.push(format!(
            "{} of {} turned round to agree with {} neighbours",
            counted(turned, "face"),
            simplices.len(),
            if turned == 1 { "its" } else { "their" },
        ));
    }

    let mut used = vec![false; positions.len()];
    for &vertex in simplices.as_flattened() {
        used[vertex as usize] = true;
    }
    let input_vertices: Vec<u32> = (0..positions.len() as u32)
        .filter(|&v| used[v as usize])
        .collect();
    let dropped = positions.len() - input_vertices.len();
    let mesh = if dropped == 0 {
        SurfaceMesh {
            positions: positions.clone(),
            simplices,
        }
    } else {
        notes.push(format!(
            "{} dropped",
            counted(dropped, "unreferenced vertex")
        ));
        let mut renumbered = vec![0; positions.len()];
        for (new, &old) in input_vertices.iter().enumerate() {
            renumbered[old as usize] = new as u32;
        }
        for vertex in simplices.as_flattened_mut() {
            *vertex = renumbered[*vertex as usize];
        }
        SurfaceMesh {
            positions: input_vertices
                .iter()
                .map(|&v| positions[v as usize])
                .collect(),
            simplices,
        }
    };
    let topology = Topology::of_oriented(&mesh, opposite).map_err(|error| match error {
        MeshError::NonManifoldVertex { vertex } => MeshError::NonManifoldVertex {
            vertex: input_vertices[vertex as usize],
        },
        other => other,
    })?;
    Ok(Prepared {
        mesh,
        input_vertices,
        topology,
        notes,
    })
}

/// Areas relative to the whole, so that units do not matter; computed on scaled coordinates, so that
/// neither very large nor very small ones overflow or vanish.
fn check_areas(mesh: &SurfaceMesh) -> Result<(), MeshError> {
    let corners = || mesh.simplices.as_flattened().iter();
    // Halved, so that a difference of two finite numbers is finite; taken from the lowest corner
    // before anything is rounded, so that a small surface far from the origin keeps its digits.
    let half = |v: u32| mesh.positions[v as usize] * 0.5;
    let (mut low, mut high) = (DVec3::MAX, DVec3::MIN);
    for &v in corners() {
        low = low.min(half(v));
        high = high.max(half(v));
    }
    let extent = (high - low).max_element();
    if extent == 0.0 {
        return Err(MeshError::ZeroArea);
    }
    let at = |v: u32| (half(v) - low) / extent;
    let area = |&[a, b, c]: &[u32; 3]| 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).length();
    let total: f64 = mesh.simplices.iter().map(area).sum();
    if total <= ZERO_AREA {
        return Err(MeshError::ZeroArea);
    }
    for (face, simplex) in mesh.simplices.iter().enumerate() {
        let area = area(simplex) / total;
        if area < DEGENERATE_AREA {
            return Err(MeshError::DegenerateFace { face, area });
        }
    }
    Ok(())
}
