//! Files of pins and targets: a vertex a line, the first vertex being 0. Empty lines and what follows a
//! # are passed over.

use crate::failure::Failure;
use crate::files;
use foldfree::deformation::Target;
use glam::DVec3;
use std::path::Path;

/// Vertex indices, one a line.
pub fn read_pins(path: &Path, vertices: usize) -> Result<Vec<u32>, Failure> {
    lines(path, |fields| match fields {
        [index] => vertex(index, vertices),
        _ => Err(format!(
            "expected a vertex index, found {:?}",
            fields.join(" ")
        )),
    })
}

/// Lines `index x y` or `index x y z`; without z it is 0.
pub fn read_targets(path: &Path, vertices: usize) -> Result<Vec<Target>, Failure> {
    lines(path, |fields| {
        let (index, coordinates) = match fields {
            [index, rest @ ..] if (2..=3).contains(&rest.len()) => (index, rest),
            _ => {
                let found = fields.join(" ");
                return Err(format!("expected \"index x y z\", found {found:?}"));
            }
        };
        let mut position = DVec3::ZERO;
        for (i, text) in coordinates.iter().enumerate() {
            position[i] = match text.parse::<f64>() {
                Ok(x) if x.is_finite() => x,
                _ => return Err(format!("expected a finite coordinate, found {text:?}")),
            };
        }
        let vertex = vertex(index, vertices)?;
        Ok(Target { vertex, position })
    })
}

fn vertex(text: &str, vertices: usize) -> Result<u32, String> {
    match text.parse::<u32>() {
        Ok(v) if (v as usize) < vertices => Ok(v),
        Ok(v) => Err(format!("vertex {v} of {vertices} (the first is 0)")),
        Err(_) => Err(format!("expected a vertex index, found {text:?}")),
    }
}

fn lines<T>(path: &Path, parse: impl Fn(&[&str]) -> Result<T, String>) -> Result<Vec<T>, Failure> {
    let bytes = files::read_bytes(path)?;
    let text = String::from_utf8_lossy(&bytes);
    let mut found = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let fields: Vec<&str> = line
            .split('#')
            .next()
            .unwrap_or("")
            .split_whitespace()
            .collect();
        if fields.is_empty() {
            continue;
        }
        let one = parse(&fields)
            .map_err(|what| Failure::of_file(path, format!("line {}: {what}", number + 1)))?;
        found.push(one);
    }
    Ok(found)
}
