//! Solids in and out: .node with its .ele beside it, or one file that holds both.

use crate::failure::Failure;
use crate::files;
use foldfree::mesh::SolidMesh;
use foldfree::mesh::io::{self, Format, SolidFile, read_ele, read_node, write_ele, write_node};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// The .node or the .ele file that a name of either stands for: itself, or the one beside it, compressed
/// as it is if there is such a one. `None`: this is neither.
fn beside(path: &Path, ending: &str) -> Option<PathBuf> {
    let [node, ele] = pair(path)?;
    let wanted = if ending == "node" { node } else { ele };
    if wanted.exists() {
        return Some(wanted);
    }
    let text = wanted.to_string_lossy();
    let other = match text.strip_suffix(".gz") {
        Some(plain) => PathBuf::from(plain),
        None => PathBuf::from(format!("{text}.gz")),
    };
    Some(if other.exists() { other } else { wanted })
}

/// The format a name stands for, of those with one file.
fn format(path: &Path) -> Result<Format, Failure> {
    let name = path.file_name().map(|n| n.to_string_lossy());
    Format::from_name(&name.unwrap_or_default()).ok_or_else(|| {
        let solids = Format::ALL.into_iter().filter(|f| f.holds_solids());
        let known: Vec<String> = solids.map(|f| format!(".{}", f.name())).collect();
        let what = format!(
            "the format is not known by this name (known: .node, .ele, {}, also with .gz)",
            known.join(", ")
        );
        Failure::of_file(path, what)
    })
}

/// Reads a solid, by the ending of the file's name.
pub fn read_solid(path: &Path) -> Result<SolidFile, Failure> {
    let (Some(node), Some(ele)) = (beside(path, "node"), beside(path, "ele")) else {
        let format = format(path)?;
        let bytes = files::read_bytes(path)?;
        return io::read_solid(&bytes, format).map_err(|error| Failure::of_file(path, error));
    };
    let bytes = files::read_bytes(&node)?;
    let nodes = read_node(&bytes).map_err(|error| Failure::of_file(&node, error))?;
    let bytes = files::read_bytes(&ele)?;
    Ok(SolidFile {
        mesh: read_ele(&bytes, nodes).map_err(|error| Failure::of_file(&ele, error))?,
        notes: Vec::new(),
    })
}

/// Reads the vertices of a solid; no .ele file is needed.
pub fn read_positions(path: &Path) -> Result<Vec<DVec3>, Failure> {
    let Some(node) = beside(path, "node") else {
        return Ok(read_solid(path)?.mesh.positions);
    };
    let bytes = files::read_bytes(&node)?;
    let nodes = read_node(&bytes).map_err(|error| Failure::of_file(&node, error))?;
    Ok(nodes.positions)
}

/// The vertices of a solid, if that is what this file holds: those of a .node, or of a file with tetrahedra.
///
/// # Errors
/// As [`read_positions`] of a .node or .ele. What is wrong with another file is for the reader of surfaces to
/// say.
pub fn read_if_solid(path: &Path) -> Result<Option<Vec<DVec3>>, Failure> {
    if beside(path, "node").is_some() {
        return read_positions(path).map(Some);
    }
    if !format(path).is_ok_and(Format::holds_solids) {
        return Ok(None);
    }
    let solid = read_solid(path).ok().map(|file| file.mesh);
    let solid = solid.filter(|mesh| !mesh.simplices.is_empty());
    Ok(solid.map(|mesh| mesh.positions))
}

/// Fails when [`write_deformed`] would not know the name: said before the work rather than after.
pub fn check_format(path: &Path) -> Result<(), Failure> {
    match beside(path, "node") {
        Some(_) => Ok(()),
        None => format(path).map(|_| ()),
    }
}

/// Writes a deformed solid: its vertices (.node), vertices and elements, or, in a format of surfaces,
/// the boundary.
pub fn write_deformed(path: &Path, rest: &SolidMesh, to: Vec<DVec3>) -> Result<(), Failure> {
    if let Some([node, _]) = pair(path) {
        return files::write(&node, &write_node(&to));
    }
    let solid = SolidMesh {
        positions: to,
        simplices: rest.simplices.clone(),
    };
    write_one_file(path, &solid)
}

/// Writes a solid: .node with .ele beside it, one file of both, or, in a format of surfaces, the boundary.
/// Returns the names of the files.
pub fn write_solid(path: &Path, solid: &SolidMesh) -> Result<String, Failure> {
    let Some([node, ele]) = pair(path) else {
        write_one_file(path, solid)?;
        return Ok(path.display().to_string());
    };
    files::write(&node, &write_node(&solid.positions))?;
    files::write(&ele, &write_ele(solid))?;
    Ok(format!("{}, {}", node.display(), ele.display()))
}

/// The files that are written under a name: of a solid may be two.
pub fn files_of(path: &Path, solid: bool) -> Vec<PathBuf> {
    match pair(path) {
        Some(both) if solid => both.into(),
        _ => vec![path.to_path_buf()],
    }
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

fn write_one_file(path: &Path, solid: &SolidMesh) -> Result<(), Failure> {
    let format = format(path)?;
    let bytes = match io::write_solid(solid, format) {
        Some(bytes) => bytes,
        None => {
            let boundary = solid.boundary();
            let boundary = boundary.map_err(|error| Failure::of_file(path, error))?;
            io::write(&boundary.mesh, format)
        }
    };
    files::write(path, &bytes)
}
