//! What is flattened: the pieces of a surface, each cut to what has a map.

use super::CutPolicy;
use crate::Error;
use crate::mesh::cut::cut_to_disk;
use crate::mesh::{MeshError, Prepared, SurfaceMesh, Topology, prepare};
use core::ops::Range;

/// The pieces, made ready.
pub(super) struct Atlas {
    /// All pieces in one; triangles in the order of the input's.
    pub mesh: SurfaceMesh,
    /// Per vertex of `mesh` the vertex of the input.
    pub input_vertices: Vec<u32>,
    pub charts: Vec<Chart>,
    pub seam_edges: usize,
    pub notes: Vec<String>,
}

/// A piece of an atlas.
pub(super) struct Chart {
    /// Its vertices in the atlas, which are numbered chart by chart.
    pub vertices: Range<u32>,
    /// Its triangles there, ascending.
    pub triangles: Vec<u32>,
    /// Its boundary, in the atlas's vertices: the longest loop, which goes round the others.
    pub outline: Vec<u32>,
    /// The other loops.
    pub holes: Vec<Vec<u32>>,
}

/// One piece, cut.
struct Piece {
    mesh: SurfaceMesh,
    topology: Topology,
    /// Per vertex of `mesh` the vertex of the piece as it was.
    source: Vec<u32>,
    seam_edges: usize,
}

fn cut(mesh: SurfaceMesh, topology: Topology, policy: CutPolicy) -> Result<Piece, MeshError> {
    let planar = topology.genus() == 0 && !topology.is_closed();
    if topology.is_disk() || (policy == CutPolicy::KeepHoles && planar) {
        return Ok(Piece {
            source: (0..mesh.positions.len() as u32).collect(),
            mesh,
            topology,
            seam_edges: 0,
        });
    }
    if policy == CutPolicy::Refuse {
        return Err(MeshError::NotADisk {
            euler_characteristic: topology.euler_characteristic(),
            boundary_loops: topology.boundary_loops().len(),
        });
    }
    let cut = cut_to_disk(&mesh, &topology)?;
    Ok(Piece {
        topology: Topology::new(&cut.mesh)?,
        source: cut.source_vertices,
        seam_edges: cut.seam_edges.len(),
        mesh: cut.mesh,
    })
}

/// These triangles of a mesh, and for each vertex they have its index there.
pub(super) fn part(mesh: &SurfaceMesh, triangles: &[u32]) -> (SurfaceMesh, Vec<u32>) {
    let mut used: Vec<u32> = triangles
        .iter()
        .flat_map(|&t| mesh.simplices[t as usize])
        .collect();
    used.sort_unstable();
    used.dedup();
    // found by bisection: no table as long as the whole for every piece
    let place = |v: u32| used.partition_point(|&u| u < v) as u32;
    let part = SurfaceMesh {
        positions: used.iter().map(|&v| mesh.positions[v as usize]).collect(),
        simplices: triangles
            .iter()
            .map(|&t| mesh.simplices[t as usize].map(place))
            .collect(),
    };
    (part, used)
}

/// The triangles of each component.
fn components(topology: &Topology) -> Vec<Vec<u32>> {
    let mut lists = vec![Vec::new(); topology.components()];
    for (t, &component) in topology.face_components().iter().enumerate() {
        lists[component as usize].push(t as u32);
    }
    lists
}

impl Atlas {
    /// Checks the mesh, takes it apart, and cuts what is no disk as the policy has it.
    ///
    /// # Errors
    /// [`MeshError`], for a piece as for a whole.
    pub fn new(mesh: &SurfaceMesh, policy: CutPolicy) -> Result<Self, Error> {
        let Prepared {
            mesh,
            input_vertices,
            topology,
            mut notes,
        } = prepare(mesh)?;
        let mut this = Self {
            mesh: SurfaceMesh {
                positions: Vec::with_capacity(mesh.positions.len()),
                simplices: vec![[0; 3]; mesh.simplices.len()],
            },
            input_vertices: Vec::with_capacity(mesh.positions.len()),
            charts: Vec::new(),
            seam_edges: 0,
            notes: Vec::new(),
        };
        let triangles = components(&topology);
        let mut pieces = Vec::with_capacity(triangles.len());
        if triangles.len() == 1 {
            let vertices = (0..mesh.positions.len() as u32).collect();
            pieces.push((mesh, topology, vertices));
        } else {
            for triangles in &triangles {
                let (piece, vertices) = part(&mesh, triangles);
                let topology = Topology::new(&piece)?;
                pieces.push((piece, topology, vertices));
            }
        }
        let mut cuts = 0;
        for ((piece, topology, vertices), triangles) in pieces.into_iter().zip(triangles) {
            let euler = topology.euler_characteristic();
            let loops = topology.boundary_loops().len();
            let piece = cut(piece, topology, policy)?;
            if piece.seam_edges > 0 {
                cuts += 1;
                notes.push(format!(
                    "cut to a disk along {} edges (Euler characteristic {euler}, {loops} boundary loops)",
                    piece.seam_edges
                ));
            }
            let source = piece.source.iter();
            let inputs = source.map(|&v| input_vertices[vertices[v as usize] as usize]);
            this.input_vertices.extend(inputs);
            this.add(&piece, triangles);
        }
        let (charts, kept) = (this.charts.len(), this.holes());
        if charts > 1 {
            // one note, not one a piece
            notes.truncate(notes.len() - cuts);
            let cut = match cuts {
                0 => String::new(),
                _ => format!(
                    ", cut along {} edges where they were no disks",
                    this.seam_edges
                ),
            };
            notes.push(format!("{charts} pieces, a chart for each{cut}"));
        }
        if kept > 0 {
            let holes = if kept == 1 { "hole" } else { "holes" };
            notes.push(format!("{kept} {holes} kept"));
        }
        this.notes = notes;
        Ok(this)
    }

    fn holes(&self) -> usize {
        self.charts.iter().map(|chart| chart.holes.len()).sum()
    }

    fn add(&mut self, piece: &Piece, triangles: Vec<u32>) {
        let first = self.mesh.positions.len() as u32;
        for (&t, corners) in triangles.iter().zip(&piece.mesh.simplices) {
            self.mesh.simplices[t as usize] = corners.map(|v| first + v);
        }
        self.mesh.positions.extend(&piece.mesh.positions);
        let position = |v: u32| piece.mesh.positions[v as usize];
        let length = |list: &[u32]| -> f64 {
            let next = list.iter().cycle().skip(1);
            let edges = list.iter().zip(next);
            edges
                .map(|(&a, &b)| position(a).distance(position(b)))
                .sum()
        };
        let loops = piece.topology.boundary_loops();
        let mut longest = 0;
        for (i, list) in loops.iter().enumerate() {
            if length(list) > length(&loops[longest]) {
                longest = i;
            }
        }
        let mut holes: Vec<Vec<u32>> = loops
            .iter()
            .map(|list| list.iter().map(|&v| first + v).collect())
            .collect();
        self.charts.push(Chart {
            vertices: first..self.mesh.positions.len() as u32,
            triangles,
            outline: holes.remove(longest),
            holes,
        });
        self.seam_edges += piece.seam_edges;
    }
}
