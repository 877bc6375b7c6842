//! Files in and out, gzipped or not.

use crate::failure::Failure;
use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use foldfree::certificate::CornerMap;
use foldfree::mesh::io::{self, Format, SurfaceFile};
use glam::DVec2;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;

/// The most a file may hold once decompressed; indices of vertices are 32 bits.
const LIMIT: u64 = 4 << 30;

/// Reads a mesh, by the ending of the file's name.
pub fn read_mesh(path: &Path) -> Result<SurfaceFile, Failure> {
    let format = format(path)?;
    let bytes = read_bytes(path)?;
    io::read(&bytes, format).map_err(|error| Failure::of_file(path, error))
}

/// The format a name stands for.
pub fn format(path: &Path) -> Result<Format, Failure> {
    let name = path.file_name().map(|n| n.to_string_lossy());
    Format::from_name(&name.unwrap_or_default()).ok_or_else(|| {
        let known = Format::ALL.map(|f| format!(".{}", f.name())).join(", ");
        let what = format!("the format is not known by this name (known: {known}, also with .gz)");
        Failure::of_file(path, what)
    })
}

/// All bytes of a file, decompressed if they begin as gzip does.
pub fn read_bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    let of_system = |error: std::io::Error| Failure::of_system(path, &error);
    let file = File::open(path).map_err(of_system)?;
    let length = file.metadata().map_err(of_system)?.len();
    let mut bytes = Vec::new();
    if length <= LIMIT {
        file.take(LIMIT + 1)
            .read_to_end(&mut bytes)
            .map_err(of_system)?;
    }
    if length > LIMIT || bytes.len() as u64 > LIMIT {
        return Err(too_large(path));
    }
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    let decoder = MultiGzDecoder::new(bytes.as_slice());
    match decoder.take(LIMIT + 1).read_to_end(&mut text) {
        Ok(n) if n as u64 > LIMIT => Err(too_large(path)),
        Ok(_) => Ok(text),
        Err(error) => Err(Failure::of_file(
            path,
            match error.kind() {
                std::io::ErrorKind::UnexpectedEof => "the gzip data end too early".to_owned(),
                _ => format!("the gzip data are damaged ({error})"),
            },
        )),
    }
}

fn too_large(path: &Path) -> Failure {
    Failure::of_file(path, format!("holds more than {} GiB", LIMIT >> 30))
}

/// Fails when a file cannot be written there: said before the work rather than after.
pub fn check_writable(path: &Path) -> Result<(), Failure> {
    if path.is_dir() {
        return Err(Failure::of_file(path, "is a folder"));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            Err(Failure::of_file(path, "its folder does not exist"))
        }
        _ => Ok(()),
    }
}

/// Writes a file, compressed if its name ends in .gz.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let compressed = path
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    let result = if compressed {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder
            .write_all(bytes)
            .and_then(|()| encoder.finish())
            .and_then(|packed| fs::write(path, packed))
    } else {
        fs::write(path, bytes)
    };
    result.map_err(|error| Failure::of_system(path, &error))
}

/// Image of every corner: the texture coordinates of a file, or the positions of a flat mesh.
pub fn corner_images(path: &Path, file: &SurfaceFile) -> Result<Vec<[DVec2; 3]>, Failure> {
    if let Some(texture) = &file.texture {
        let image = |&c: &u32| texture.coordinates[c as usize];
        let corners = texture.corners.iter();
        return Ok(corners
            .map(|t| [image(&t[0]), image(&t[1]), image(&t[2])])
            .collect());
    }
    let positions = &file.mesh.positions;
    if let Some(vertex) = positions.iter().position(|p| p.z != 0.0) {
        let what = format!(
            "there are no texture coordinates, and vertex {vertex} is not in the plane z = 0"
        );
        return Err(Failure::of_file(path, what));
    }
    let triangles = file.mesh.simplices.iter();
    Ok(triangles
        .map(|t| t.map(|v| positions[v as usize].truncate()))
        .collect())
}

/// The map in a file, of the surface in the same file or in another.
pub fn read_map(map: &Path, rest: Option<&Path>) -> Result<CornerMap, Failure> {
    let file = read_mesh(map)?;
    let other = match rest {
        Some(path) => Some((path, read_mesh(path)?)),
        None if file.texture.is_none() => {
            let what = "there are no texture coordinates; give the surface with --rest";
            return Err(Failure::of_file(map, what));
        }
        None => None,
    };
    let corners = corner_images(map, &file)?;
    let surface = match &other {
        Some((path, rest)) if rest.mesh.simplices.len() != corners.len() => {
            let (found, expected) = (rest.mesh.simplices.len(), corners.len());
            let what = format!(
                "has {found} triangles, but {} has {expected}",
                map.display()
            );
            return Err(Failure::of_file(path, what));
        }
        Some((_, rest)) => &rest.mesh,
        None => &file.mesh,
    };
    Ok(CornerMap::new(surface, &corners))
}
