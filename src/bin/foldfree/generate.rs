//! `foldfree generate`.

use crate::arguments::{Generate, Sample};
use crate::failure::Failure;
use crate::{Outcome, files, say, solids};
use foldfree::mesh::io;
use foldfree::mesh::{Shape, SolidShape};
use std::path::Path;

/// Makes the mesh and writes it.
pub fn run(arguments: &Generate) -> Result<Outcome, Failure> {
    let (out, count) = (&arguments.out, arguments.triangles as usize);
    match arguments.shape {
        Sample::Surface(_) => files::format(out).map(drop)?,
        Sample::Solid(_) => solids::check_format(out)?,
    }
    solids::files_of(out, matches!(arguments.shape, Sample::Solid(_)))
        .iter()
        .try_for_each(|file| files::check_writable(file))?;
    match arguments.shape {
        Sample::Surface(shape) => surface(shape, count, out),
        Sample::Solid(shape) => solid(shape, count, out),
    }
}

fn surface(shape: Shape, triangles: usize, out: &Path) -> Result<Outcome, Failure> {
    let format = files::format(out)?;
    let mesh = foldfree::mesh::generate(shape, triangles);
    let bytes = io::write(&mesh, format);
    files::write(out, &bytes)?;
    say(&format!(
        "{}: {} vertices, {} triangles",
        out.display(),
        mesh.positions.len(),
        mesh.simplices.len()
    ));
    Ok(Outcome::Done)
}

fn solid(shape: SolidShape, tetrahedra: usize, out: &Path) -> Result<Outcome, Failure> {
    let mesh = foldfree::mesh::generate_solid(shape, tetrahedra);
    let written = solids::write_solid(out, &mesh)?;
    say(&format!(
        "{written}: {} vertices, {} tetrahedra",
        mesh.positions.len(),
        mesh.simplices.len()
    ));
    Ok(Outcome::Done)
}
