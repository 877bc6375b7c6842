//! `foldfree cloth`.

use crate::arguments::Cloth;
use crate::failure::Failure;
use crate::relaxation::{Body, check_start};
use crate::{Outcome, files};
use foldfree::deformation::Deformation;
use foldfree::mesh::{SurfaceMesh, io};
use glam::DVec3;
use std::path::Path;

/// Reads, drapes, writes, reports.
pub fn run(arguments: &Cloth) -> Result<Outcome, Failure> {
    let options = arguments.options();
    let relaxation = &arguments.relaxation;
    if let Some(path) = &relaxation.out {
        files::format(path)?;
    }
    relaxation.prepare()?;
    let rest_path = arguments.rest.as_ref().unwrap_or(&arguments.init);
    let file = files::read_mesh(rest_path)?;
    let rest = file.mesh;
    let start = read_positions(&arguments.init)?;
    check_start(&arguments.init, &start, rest.positions.len())?;
    let handles = relaxation.read(start.len(), read_positions)?;
    let deformation =
        Deformation::of_cloth(&rest, &start, &handles.pins, &handles.targets, &options)
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
        let cloth = SurfaceMesh {
            positions,
            simplices: rest.simplices.clone(),
        };
        files::write(path, &io::write(&cloth, files::format(path)?))
    })
}

fn read_positions(path: &Path) -> Result<Vec<DVec3>, Failure> {
    Ok(files::read_mesh(path)?.mesh.positions)
}
