//! `foldfree deform --method lim`: solids, and triangles in the plane.

use crate::arguments::Deform;
use crate::failure::Failure;
use crate::relaxation::{Body, check_start};
use crate::solids::{read_positions, read_solid, write_deformed};
use crate::{Outcome, files, solids};
use foldfree::deformation::Deformation;
use foldfree::mesh::{SurfaceMesh, io};
use glam::DVec3;
use std::path::Path;

/// Reads, deforms, writes, reports.
pub fn run(arguments: &Deform) -> Result<Outcome, Failure> {
    let rest = arguments.rest.as_ref().unwrap_or(&arguments.init);
    match solids::read_if_solid(rest)? {
        Some(_) => solid(arguments, rest),
        None => planar(arguments, rest),
    }
}

fn solid(arguments: &Deform, rest_path: &Path) -> Result<Outcome, Failure> {
    let options = arguments.lim_options().map_err(Failure::new)?;
    let relaxation = &arguments.relaxation;
    if let Some(path) = &relaxation.out {
        solids::check_format(path)?;
    }
    relaxation.prepare()?;
    let file = read_solid(rest_path)?;
    let rest = file.mesh;
    let start = read_positions(&arguments.init)?;
    check_start(&arguments.init, &start, rest.positions.len())?;
    let handles = relaxation.read(start.len(), read_positions)?;
    let (pins, targets) = (&handles.pins, &handles.targets);
    let deformation = Deformation::locally_injective(&rest, &start, pins, targets, &options)
        .map_err(Failure::new)?;
    let body = Body {
        rest: rest_path,
        init: &arguments.init,
        options,
        vertices: rest.positions.len(),
        triangles: None,
        tetrahedra: Some(rest.simplices.len()),
        notes: file.notes,
    };
    relaxation.run(deformation, handles, body, |path, positions| {
        write_deformed(path, &rest, positions)
    })
}

fn planar(arguments: &Deform, rest_path: &Path) -> Result<Outcome, Failure> {
    let options = arguments.lim_options().map_err(Failure::new)?;
    let relaxation = &arguments.relaxation;
    if let Some(path) = &relaxation.out {
        files::format(path)?;
    }
    relaxation.prepare()?;
    let positions =
        |path: &Path| -> Result<Vec<DVec3>, Failure> { Ok(files::read_mesh(path)?.mesh.positions) };
    let file = files::read_mesh(rest_path)?;
    let rest = file.mesh;
    let start = positions(&arguments.init)?;
    check_start(&arguments.init, &start, rest.positions.len())?;
    let handles = relaxation.read(start.len(), positions)?;
    let (pins, targets) = (&handles.pins, &handles.targets);
    let deformation =
        Deformation::locally_injective_in_plane(&rest, &start, pins, targets, &options)
            .map_err(Failure::new)?;
    let body = Body {
        rest: rest_path,
        init: &arguments.init,
        options,
        vertices: rest.positions.len(),
        triangles: Some(rest.simplices.len()),
        tetrahedra: None,
        notes: file.notes,
    };
    relaxation.run(deformation, handles, body, |path, positions| {
        let map = SurfaceMesh {
            positions,
            simplices: rest.simplices.clone(),
        };
        files::write(path, &io::write(&map, files::format(path)?))
    })
}
