//! `foldfree generate`.

use crate::arguments::{Generate, Sample};
use crate::failure::Failure;
use crate::{Outcome, files, say};
use foldfree::mesh::io::{self, Format};
use foldfree::mesh::{Shape, SolidShape};
use std::path::{Path, PathBuf};

/// Makes the mesh and writes it.
pub fn run(arguments: &Generate) -> Result<Outcome, Failure> {
    let (out, count) = (&arguments.out, arguments.triangles as usize);
    match arguments.shape {
        Sample::Surface(shape) => surface(shape, count, out),
        Sample::Solid(shape) => solid(shape, count, out),
    }
}

fn surface(shape: Shape, triangles: usize, out: &Path) -> Result<Outcome, Failure> {
    let format = files::format(out)?;
    files::check_writable(out)?;
    let mesh = foldfree::mesh::generate(shape, triangles);
    let bytes = match format {
        Format::Obj => io::write_obj(&mesh, None),
        Format::Off => io::write_off(&mesh),
    };
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
    let Some([node, ele]) = pair(out) else {
        let what =
            "a solid is written as .node and .ele (either name stands for both, also with .gz)";
        return Err(Failure::of_file(out, what));
    };
    files::check_writable(&node)?;
    files::check_writable(&ele)?;
    let mesh = foldfree::mesh::generate_solid(shape, tetrahedra);
    files::write(&node, &io::write_node(&mesh.positions))?;
    files::write(&ele, &io::write_ele(&mesh))?;
    say(&format!(
        "{}, {}: {} vertices, {} tetrahedra",
        node.display(),
        ele.display(),
        mesh.positions.len(),
        mesh.simplices.len()
    ));
    Ok(Outcome::Done)
}

/// The .node and the .ele file that a name of either stands for.
fn pair(path: &Path) -> Option<[PathBuf; 2]> {
    let text = path.to_string_lossy();
    let (stem, packed) = match text.strip_suffix(".gz") {
        Some(stem) => (stem, ".gz"),
        None => (&*text, ""),
    };
    let stem = stem
        .strip_suffix(".node")
        .or_else(|| stem.strip_suffix(".ele"))?;
    Some(["node", "ele"].map(|ending| PathBuf::from(format!("{stem}.{ending}{packed}"))))
}
