//! Meshes in and out.

use super::error::{Fallible, invalid_argument, thrown};
use crate::mesh::generate::{self, Shape};
use crate::mesh::io::{self, CornerTexture, Format};
use crate::mesh::{MeshError, SurfaceMesh};
use glam::{DVec2, DVec3};
use js_sys::{Float32Array, Float64Array, Uint32Array};
use serde::Serialize;
use tsify::Tsify;
use wasm_bindgen::prelude::*;

/// A triangle mesh in wasm memory.
#[wasm_bindgen]
#[derive(Debug)]
pub struct WasmMesh {
    mesh: SurfaceMesh,
    texture: Option<CornerTexture>,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl WasmMesh {
    /// Reads a file's bytes; `format` is one of the names of [`Format`].
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(bytes: &[u8], format: &str) -> Fallible<WasmMesh> {
        let format = Format::from_name(format).ok_or_else(|| {
            let known = Format::ALL.map(Format::name).join(", ");
            invalid_argument("format", &format!("\"{format}\" is not known; {known} are"))
        })?;
        let file = io::read(bytes, format).map_err(thrown)?;
        Ok(Self {
            mesh: file.mesh,
            texture: file.texture,
            notes: file.notes,
        })
    }

    /// Takes positions (n × 3, interleaved) and triangles (m × 3, 0-based, counter-clockwise).
    #[wasm_bindgen(js_name = fromArrays)]
    pub fn from_arrays(positions: &[f64], indices: &[u32]) -> Fallible<WasmMesh> {
        let positions = positions3(positions)?;
        let (triangles, rest) = indices.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(invalid_argument(
                "indices",
                "the length is not a multiple of 3",
            ));
        }
        let vertices = positions.len();
        for (face, triangle) in triangles.iter().enumerate() {
            if let Some(&index) = triangle.iter().find(|&&index| index as usize >= vertices) {
                return Err(thrown(MeshError::IndexOutOfRange {
                    face,
                    index: index.into(),
                    vertices,
                }));
            }
        }
        Ok(Self {
            mesh: SurfaceMesh {
                positions,
                simplices: triangles.to_vec(),
            },
            texture: None,
            notes: Vec::new(),
        })
    }

    /// Generates a sample shape of about so many triangles; the names are those of `shapes()`.
    pub fn generate(name: &str, triangles: usize) -> Fallible<WasmMesh> {
        let shape = Shape::from_name(name)
            .ok_or_else(|| invalid_argument("name", &format!("there is no shape \"{name}\"")))?;
        Ok(Self {
            mesh: generate::generate(shape, triangles),
            texture: None,
            notes: Vec::new(),
        })
    }

    /// These triangles with their vertices elsewhere, n × 3, as a file of this format.
    pub fn write(&self, positions: &[f64], format: &str) -> Fallible<Vec<u8>> {
        let format = format_named(format)?;
        let positions = positions_of(positions, self.mesh.positions.len())?;
        let simplices = self.mesh.simplices.clone();
        let mesh = SurfaceMesh {
            positions,
            simplices,
        };
        Ok(io::write(&mesh, format))
    }

    /// Positions, n × 3, interleaved (a copy).
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float64Array {
        flat3(&self.mesh.positions)
    }

    /// Triangles, m × 3 (a copy).
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Uint32Array {
        Uint32Array::from(self.mesh.simplices.as_flattened())
    }

    /// Texture coordinates the file came with, k × 2, interleaved.
    #[wasm_bindgen(getter, js_name = textureCoordinates)]
    pub fn texture_coordinates(&self) -> Option<Float64Array> {
        self.texture
            .as_ref()
            .map(|texture| flat2(&texture.coordinates))
    }

    /// For every corner of every triangle (m × 3) the index of its texture coordinate.
    #[wasm_bindgen(getter, js_name = textureCorners)]
    pub fn texture_corners(&self) -> Option<Uint32Array> {
        let corners = &self.texture.as_ref()?.corners;
        Some(Uint32Array::from(corners.as_flattened()))
    }

    /// What reading mended or noticed, in words.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

impl WasmMesh {
    pub(super) fn mesh(&self) -> &SurfaceMesh {
        &self.mesh
    }
}

/// A sample shape.
#[derive(Debug, Serialize, Tsify)]
pub struct ShapeInfo {
    /// What `generate` takes.
    pub name: &'static str,
    /// What people call it.
    pub title: &'static str,
    /// One sentence.
    pub description: &'static str,
}

/// The sample shapes.
#[wasm_bindgen(unchecked_return_type = "ShapeInfo[]")]
pub fn shapes() -> Fallible<JsValue> {
    let shapes: Vec<_> = Shape::ALL
        .iter()
        .map(|shape| ShapeInfo {
            name: shape.name(),
            title: shape.title(),
            description: shape.describe(),
        })
        .collect();
    serde_wasm_bindgen::to_value(&shapes).map_err(JsValue::from)
}

/// Interleaved coordinates as points.
pub(super) fn positions3(values: &[f64]) -> Fallible<Vec<DVec3>> {
    let (points, rest) = values.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(invalid_argument(
            "positions",
            "the length is not a multiple of 3",
        ));
    }
    Ok(points.iter().copied().map(DVec3::from_array).collect())
}

/// The same, which have to be so many.
pub(super) fn positions_of(values: &[f64], count: usize) -> Fallible<Vec<DVec3>> {
    let positions = positions3(values)?;
    if positions.len() != count {
        let what = format!("{} points of {count}", positions.len());
        return Err(invalid_argument("positions", &what));
    }
    Ok(positions)
}

/// A format that can be written, by its name.
pub(super) fn format_named(name: &str) -> Fallible<Format> {
    let format = Format::ALL.into_iter().find(|f| f.name() == name);
    format.ok_or_else(|| {
        let known = Format::ALL.map(Format::name).join(", ");
        invalid_argument("format", &format!("\"{name}\": {known} are known"))
    })
}

pub(super) fn flat3(points: &[DVec3]) -> Float64Array {
    let flat: Vec<f64> = points.iter().flat_map(|point| point.to_array()).collect();
    Float64Array::from(flat.as_slice())
}

/// Points in single precision.
pub(super) fn single3(points: &[DVec3]) -> Float32Array {
    let single: Vec<f32> = points.iter().flat_map(|p| p.as_vec3().to_array()).collect();
    Float32Array::from(single.as_slice())
}

/// Points as interleaved coordinates.
pub(super) fn flat2(points: &[DVec2]) -> Float64Array {
    let flat: Vec<f64> = points.iter().flat_map(|point| point.to_array()).collect();
    Float64Array::from(flat.as_slice())
}
