//! Deformations that never invert an element: of triangles in the plane and of solids.

use super::body::check;
use super::{Deformation, Supports, Target};
use crate::Error;
use crate::geometry::RestShape;
use crate::lim::{Lim, LimOptions, LimProblem};
use crate::mesh::{SimplicialMesh, SolidMesh, SurfaceMesh};
use crate::optim::{BuildError, Deformer, Stopwatch};
use crate::space::{Plane, Solid, Space};
use glam::DVec3;

impl Deformation {
    /// A solid that is deformed by locally injective mappings. Pins are held where they start, or led to their
    /// targets; targets of other vertices pull.
    ///
    /// # Errors
    /// As [`Self::with_targets`]; `InvertedStart` for a start with inverted elements, unless there is no barrier.
    pub fn locally_injective(
        rest: &SolidMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        options: &LimOptions,
    ) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        check(rest, start)?;
        let (shape, turned) = RestShape::of_solid(rest)?;
        let mut notes = Vec::new();
        if turned {
            notes.push("the mesh was inside out: all tetrahedra were turned".into());
        }
        let handles = (pins, targets);
        let mut made = build::<Solid, 4>((rest, start), &shape, handles, notes, options, clock)?;
        made.rest = Some(rest.clone());
        Ok(made)
    }

    /// The same of triangles in a plane z = constant.
    ///
    /// # Errors
    /// The same, and `InvalidOption` for vertices outside the plane of the first.
    pub fn locally_injective_in_plane(
        rest: &SurfaceMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        options: &LimOptions,
    ) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        check(rest, start)?;
        flat("rest", &rest.positions)?;
        flat("start", start)?;
        let (shape, turned) = RestShape::of_plane(rest)?;
        let mut notes = Vec::new();
        if turned {
            notes.push("the mesh was clockwise: all triangles were turned".into());
        }
        let handles = (pins, targets);
        let mut made = build::<Plane, 3>((rest, start), &shape, handles, notes, options, clock)?;
        made.level = start[0].z;
        let triangles = shape.vertices.as_chunks::<3>().0;
        made.flat = Some(SurfaceMesh {
            positions: rest.positions.clone(),
            simplices: triangles.to_vec(),
        });
        Ok(made)
    }
}

/// Fails if not all have the same z.
pub(super) fn flat(option: &'static str, positions: &[DVec3]) -> Result<(), BuildError> {
    let level = positions[0].z;
    match positions.iter().position(|p| p.z != level) {
        Some(vertex) => Err(BuildError::InvalidOption {
            option,
            what: format!(
                "vertex {vertex} is not in the plane z = {level} of the first; triangles are deformed in a plane"
            ),
        }),
        None => Ok(()),
    }
}

fn build<S: Space, const K: usize>(
    (rest, start): (&SimplicialMesh<K>, &[DVec3]),
    shape: &RestShape,
    (pins, targets): (&[u32], &[Target]),
    mut notes: Vec<String>,
    options: &LimOptions,
    clock: Stopwatch,
) -> Result<Deformation, Error> {
    let supports = Supports::new(rest, pins, &mut notes)?;
    let coordinates = |positions: &[DVec3]| -> Vec<f64> {
        let points = positions.iter();
        points
            .flat_map(|p| p.to_array().into_iter().take(S::DIM))
            .collect()
    };
    let problem = LimProblem {
        rest: shape,
        rest_positions: &coordinates(&rest.positions),
        start: &coordinates(start),
        handles: &supports.held(),
    };
    let mut solver = Lim::new::<S>(problem, *options)?;
    let stiffness = |v: usize| options.target_stiffness * solver.stiffness_at(v);
    let spring_stiffness: Vec<f64> = (0..start.len()).map(stiffness).collect();
    let (moved, springs) = supports.split(targets, &spring_stiffness)?;
    solver.retarget(&moved, &springs)?;
    Ok(Deformation {
        rest: None,
        flat: None,
        level: 0.0,
        notes,
        setup_seconds: clock.seconds(),
        supports,
        spring_stiffness,
        solver: Box::new(solver),
    })
}
