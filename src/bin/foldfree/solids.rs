//! Solids in files: vertices in one, tetrahedra in another beside it.

use crate::failure::Failure;
use crate::files;
use foldfree::mesh::SolidMesh;
use foldfree::mesh::io::{read_ele, read_node};
use glam::DVec3;
use std::path::{Path, PathBuf};

/// Is this the name of a solid's file?
pub fn is_solid(path: &Path) -> bool {
    beside(path, "node").is_some()
}

/// The same path with another ending before an optional .gz; the one that exists, compressed or not.
fn beside(path: &Path, ending: &str) -> Option<PathBuf> {
    let text = path.to_string_lossy();
    let stem = text.strip_suffix(".gz").unwrap_or(&text);
    let stem = stem
        .strip_suffix(".node")
        .or_else(|| stem.strip_suffix(".ele"))?;
    let candidates = ["", ".gz"].map(|packed| PathBuf::from(format!("{stem}.{ending}{packed}")));
    let existing = candidates.iter().find(|p| p.exists());
    Some(existing.unwrap_or(&candidates[0]).clone())
}

fn pair(path: &Path) -> Result<[PathBuf; 2], Failure> {
    match (beside(path, "node"), beside(path, "ele")) {
        (Some(node), Some(ele)) => Ok([node, ele]),
        _ => {
            let what = "the format is not known by this name (known: .node, .ele, also with .gz)";
            Err(Failure::of_file(path, what))
        }
    }
}

/// The vertices of a solid.
pub fn read_positions(path: &Path) -> Result<Vec<DVec3>, Failure> {
    let [node, _] = pair(path)?;
    let bytes = files::read_bytes(&node)?;
    let nodes = read_node(&bytes).map_err(|error| Failure::of_file(&node, error))?;
    Ok(nodes.positions)
}

/// A solid.
pub fn read_solid(path: &Path) -> Result<SolidMesh, Failure> {
    let [node, ele] = pair(path)?;
    let bytes = files::read_bytes(&node)?;
    let nodes = read_node(&bytes).map_err(|error| Failure::of_file(&node, error))?;
    let bytes = files::read_bytes(&ele)?;
    read_ele(&bytes, nodes).map_err(|error| Failure::of_file(&ele, error))
}
