//! Tetrahedral meshes in and out.

use super::error::{Fallible, invalid_argument, thrown};
use super::mesh::{ShapeInfo, flat3, format_named, positions_of, positions3};
use super::to_js;
use crate::certificate::SolidCertificate;
use crate::mesh::io::{self, Format};
use crate::mesh::{MeshError, SolidMesh, SolidShape, generate_solid};
use js_sys::{Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

/// A tetrahedral mesh in wasm memory.
#[wasm_bindgen]
#[derive(Debug)]
pub struct WasmSolid {
    mesh: SolidMesh,
    /// Of the boundary, with the solid's vertices.
    surface: Vec<[u32; 3]>,
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
        for (element, tetrahedron) in simplices.iter().enumerate() {
            if let Some(&index) = tetrahedron.iter().find(|&&v| v as usize >= vertices) {
                return Err(thrown(MeshError::IndexOutOfRange {
                    face: element,
                    index: index.into(),
                    vertices,
                }));
            }
        }
        let simplices = simplices.to_vec();
        Self::new(
            SolidMesh {
                positions,
                simplices,
            },
            Vec::new(),
        )
    }

    /// Reads a file's bytes; `format` is the name of a format that holds tetrahedra.
    #[wasm_bindgen(js_name = fromBytes)]
    pub fn from_bytes(bytes: &[u8], format: &str) -> Fallible<WasmSolid> {
        let known = Format::ALL.into_iter().filter(|f| f.holds_solids());
        let Some(format) = known.clone().find(|f| f.name() == format) else {
            let known: Vec<_> = known.map(Format::name).collect();
            let what = format!("\"{format}\": {}, node are known", known.join(", "));
            return Err(invalid_argument("format", &what));
        };
        let file = io::read_solid(bytes, format).map_err(thrown)?;
        Self::new(file.mesh, file.notes)
    }

    /// Reads the bytes of a .node file and of its .ele file.
    #[wasm_bindgen(js_name = fromNodeAndEle)]
    pub fn from_node_and_ele(node: &[u8], ele: &[u8]) -> Fallible<WasmSolid> {
        let nodes = io::read_node(node).map_err(thrown)?;
        Self::new(io::read_ele(ele, nodes).map_err(thrown)?, Vec::new())
    }

    /// These tetrahedra with their vertices elsewhere, n × 3, as a file; a format of surfaces
    /// gets the boundary.
    pub fn write(&self, positions: &[f64], format: &str) -> Fallible<Vec<u8>> {
        let format = format_named(format)?;
        let positions = positions_of(positions, self.mesh.positions.len())?;
        let solid = SolidMesh {
            positions,
            simplices: self.mesh.simplices.clone(),
        };
        match io::write_solid(&solid, format) {
            Some(bytes) => Ok(bytes),
            None => {
                let boundary = solid.boundary().map_err(thrown)?;
                Ok(io::write(&boundary.mesh, format))
            }
        }
    }

    /// Generates a sample solid of about so many tetrahedra; the names are those of `solidShapes()`.
    pub fn generate(name: &str, tetrahedra: usize) -> Fallible<WasmSolid> {
        let shape = SolidShape::from_name(name)
            .ok_or_else(|| invalid_argument("name", &format!("there is no solid \"{name}\"")))?;
        Self::new(generate_solid(shape, tetrahedra), Vec::new())
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
        Uint32Array::from(self.surface.as_flattened())
    }

    /// What reading mended or noticed, in words.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }
}

impl WasmSolid {
    fn new(mesh: SolidMesh, notes: Vec<String>) -> Fallible<Self> {
        let boundary = mesh.boundary().map_err(thrown)?;
        let vertex = |v: u32| boundary.vertices[v as usize];
        let triangles = boundary.mesh.simplices.iter();
        Ok(Self {
            surface: triangles.map(|t| t.map(vertex)).collect(),
            mesh,
            notes,
        })
    }

    pub(super) fn mesh(&self) -> &SolidMesh {
        &self.mesh
    }
}

/// The sample solids.
#[wasm_bindgen(js_name = solidShapes, unchecked_return_type = "ShapeInfo[]")]
pub fn solid_shapes() -> Fallible<JsValue> {
    let shapes: Vec<_> = SolidShape::ALL
        .iter()
        .map(|shape| ShapeInfo {
            name: shape.name(),
            title: shape.title(),
            description: shape.describe(),
        })
        .collect();
    to_js(&shapes)
}

/// Checks a deformation that came from anywhere: `positions` is n × 3, interleaved, one a vertex of `solid`,
/// which is the rest shape.
#[wasm_bindgen(js_name = checkSolid, unchecked_return_type = "SolidCertificate")]
pub fn check_solid(solid: &WasmSolid, positions: &[f64]) -> Fallible<JsValue> {
    let positions = positions3(positions)?;
    to_js(&SolidCertificate::try_of_solid(&solid.mesh, &positions).map_err(thrown)?)
}
