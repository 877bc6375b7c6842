//! `foldfree generate`.

use crate::arguments::Generate;
use crate::failure::Failure;
use crate::{Outcome, files, say};
use foldfree::mesh::io;

/// Makes the mesh and writes it.
pub fn run(arguments: &Generate) -> Result<Outcome, Failure> {
    let format = files::format(&arguments.out)?;
    files::check_writable(&arguments.out)?;
    let mesh = foldfree::mesh::generate(arguments.shape, arguments.triangles as usize);
    let bytes = io::write(&mesh, format);
    files::write(&arguments.out, &bytes)?;
    say(&format!(
        "{}: {} vertices, {} triangles",
        arguments.out.display(),
        mesh.positions.len(),
        mesh.simplices.len()
    ));
    Ok(Outcome::Done)
}
