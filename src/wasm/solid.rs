//! Tetrahedral meshes in and out.

use super::error::{Fallible, invalid_argument, thrown};
use super::mesh::{flat3, positions3};
use crate::mesh::{MeshError, SolidMesh};
use js_sys::{Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

/// A tetrahedral mesh in wasm memory.
#[wasm_bindgen]
#[derive(Debug)]
pub struct WasmSolid {
    mesh: SolidMesh,
    notes: Vec<String>,
}

#[wasm_bindgen]
impl WasmSolid {
    /// Takes positions (n × 3, interleaved) and tetrahedra (m × 4, 0-based).
    #[wasm_bindgen(js_name = fromArrays)]
    pub fn from_arrays(positions: &[f64], tetrahedra: &[u32]) -> Fallible<WasmSolid> {
        let positions = positions3(positions)?;
        let (simplices, rest) = tetrahedra.as_chunks::<4>();
        if !rest.is_empty() {
            let what = "the length is not a multiple of 4";
            return Err(invalid_argument("tetrahedra", what));
        }
        let vertices = positions.len();
        for (face, tetrahedron) in simplices.iter().enumerate() {
            if let Some(&index) = tetrahedron.iter().find(|&&v| v as usize >= vertices) {
                return Err(thrown(MeshError::IndexOutOfRange {
                    face,
                    index: index.into(),
                    vertices,
                }));
            }
        }
        let simplices = simplices.to_vec();
        Ok(Self {
            mesh: SolidMesh {
                positions,
                simplices,
            },
            notes: Vec::new(),
        })
    }

    /// Positions, n × 3, interleaved (a copy).
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float64Array {
        flat3(&self.mesh.positions)
    }

    /// Tetrahedra, m × 4 (a copy).
    #[wasm_bindgen(getter)]
    pub fn tetrahedra(&self) -> Uint32Array {
        Uint32Array::from(self.mesh.simplices.as_flattened())
    }

    /// The triangles of the boundary, k × 3, seen counter-clockwise from outside.
    #[wasm_bindgen(getter)]
    pub fn surface(&self) -> Uint32Array {
        Uint32Array::from(boundary(&self.mesh.simplices).as_flattened())
    }

    /// What reading mended or noticed, in words.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

impl WasmSolid {
    pub(super) fn mesh(&self) -> &SolidMesh {
        &self.mesh
    }
}

fn boundary(tetrahedra: &[[u32; 4]]) -> Vec<[u32; 3]> {
    let mut faces: Vec<([u32; 3], [u32; 3])> = Vec::new();
    for &[a, b, c, d] in tetrahedra {
        for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
            let mut key = face;
            key.sort_unstable();
            faces.push((key, face));
        }
    }
    faces.sort_unstable();
    let same = faces.chunk_by(|a, b| a.0 == b.0);
    same.filter(|c| c.len() == 1).map(|c| c[0].1).collect()
}
