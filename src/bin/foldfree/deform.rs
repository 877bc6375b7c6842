//! `foldfree deform`.

use crate::arguments::Deform;
use crate::failure::Failure;
use crate::relaxation::{Body, check_start};
use crate::solids::{read_positions, read_solid, write_deformed};
use crate::{Outcome, injective, solids};
use foldfree::deformation::{Deformation, DeformationMethod};

/// Reads, deforms, writes, reports.
pub fn run(arguments: &Deform) -> Result<Outcome, Failure> {
    if arguments.relaxation.method == DeformationMethod::Lim {
        return injective::run(arguments);
    }
    let options = arguments.options().map_err(Failure::new)?;
    let relaxation = &arguments.relaxation;
    if let Some(path) = &relaxation.out {
        solids::check_format(path)?;
    }
    relaxation.prepare()?;
    let rest_path = arguments.rest.as_ref().unwrap_or(&arguments.init);
    let file = read_solid(rest_path)?;
    let rest = file.mesh;
    let start = read_positions(&arguments.init)?;
    check_start(&arguments.init, &start, rest.positions.len())?;
    let handles = relaxation.read(start.len(), read_positions)?;
    let deformation =
        Deformation::with_targets(&rest, &start, &handles.pins, &handles.targets, &options)
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
