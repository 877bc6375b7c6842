//! A parameterization, step by step.

use super::error::{Fallible, invalid_argument, thrown};
use super::mesh::{WasmMesh, flat2, flat3};
use super::options::parameterization_options;
use super::report::StepReport;
use super::to_js;
use crate::certificate::{Certificate, CornerMap};
use crate::mesh::io::{self, CornerTexture};
use crate::mesh::{SurfaceMesh, prepare};
use crate::parameterization::{Landmark, Parameterization};
use glam::DVec2;
use js_sys::{Float32Array, Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

/// A map being computed. `free()` it when done.
#[wasm_bindgen]
pub struct WasmParameterization {
    inner: Parameterization,
}

#[wasm_bindgen]
impl WasmParameterization {
    /// Validates, cuts, computes the start and builds the solver. Landmarks: vertices of the input, two
    /// coordinates for each, and 1 for those that are held there (0: pulled).
    #[wasm_bindgen(constructor)]
    pub fn new(
        mesh: &WasmMesh,
        #[wasm_bindgen(unchecked_param_type = "ParameterizationOptions | undefined")]
        options: &JsValue,
        landmark_vertices: &[u32],
        landmark_places: &[f64],
        landmark_hard: &[u8],
    ) -> Fallible<WasmParameterization> {
        let options = parameterization_options(options)?;
        let landmarks = landmarks(landmark_vertices, landmark_places, landmark_hard)?;
        let inner = Parameterization::with_landmarks(mesh.mesh(), &options, &landmarks);
        let inner = inner.map_err(thrown)?;
        Ok(Self { inner })
    }

    /// One iteration of the method.
    #[wasm_bindgen(unchecked_return_type = "StepReport")]
    pub fn step(&mut self) -> Fallible<JsValue> {
        let report = self.inner.step().map_err(thrown)?;
        to_js(&StepReport::from(&report))
    }

    /// The newest report: iteration 0 before any step.
    #[wasm_bindgen(unchecked_return_type = "StepReport")]
    pub fn report(&self) -> Fallible<JsValue> {
        to_js(&StepReport::from(self.inner.solver().report()))
    }

    /// The map, n × 2, interleaved, in the units of the input.
    pub fn uv(&self) -> Float64Array {
        flat2(&self.inner.uv())
    }

    /// The map in single precision: half the bytes, enough to draw.
    #[wasm_bindgen(js_name = uvSingle)]
    pub fn uv_single(&self) -> Float32Array {
        let flat: Vec<f32> = self
            .inner
            .uv()
            .iter()
            .flat_map(|uv| uv.as_vec2().to_array())
            .collect();
        Float32Array::from(flat.as_slice())
    }

    /// Symmetric Dirichlet density a triangle, 1 where isometric, infinite where inverted.
    pub fn distortion(&self) -> Float32Array {
        Float32Array::from(self.inner.solver().inspect().distortion.as_slice())
    }

    /// Weight over rest weight a triangle; empty where the method has no weights.
    pub fn weights(&self) -> Float32Array {
        Float32Array::from(self.inner.solver().inspect().weights.as_slice())
    }

    /// Positions of the disk that is flattened, n × 3, interleaved.
    #[wasm_bindgen(getter)]
    pub fn positions(&self) -> Float64Array {
        flat3(&self.inner.mesh().positions)
    }

    /// Triangles of that disk, m × 3, in the order of the input's.
    #[wasm_bindgen(getter)]
    pub fn indices(&self) -> Uint32Array {
        Uint32Array::from(self.inner.mesh().simplices.as_flattened())
    }

    /// For every vertex of that disk its index in the input mesh.
    #[wasm_bindgen(getter, js_name = inputVertices)]
    pub fn input_vertices(&self) -> Uint32Array {
        Uint32Array::from(self.inner.input_vertices())
    }

    /// Number of edges that were cut.
    #[wasm_bindgen(getter, js_name = seamEdges)]
    pub fn seam_edges(&self) -> usize {
        self.inner.seam_edges()
    }

    /// What was mended or chosen, in words.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// The start that was used.
    #[wasm_bindgen(getter, js_name = startKind, unchecked_return_type = "Start")]
    pub fn start_kind(&self) -> Fallible<JsValue> {
        to_js(&self.inner.start_kind())
    }

    /// Seconds that validation, cutting, the start and the factorisation took.
    #[wasm_bindgen(getter, js_name = setupSeconds)]
    pub fn setup_seconds(&self) -> f64 {
        self.inner.setup_seconds()
    }

    /// The exact checks of the newest map.
    #[wasm_bindgen(unchecked_return_type = "Certificate")]
    pub fn certificate(&self) -> Fallible<JsValue> {
        to_js(&self.inner.certificate())
    }

    /// The input surface as OBJ with the map as texture coordinates.
    #[wasm_bindgen(js_name = exportObj)]
    pub fn export_obj(&self) -> Vec<u8> {
        let disk = self.inner.mesh();
        let input = self.inner.input_vertices();
        // Seams close again: every corner names its input vertex, and its own texture coordinate.
        let vertices = input.iter().max().map_or(0, |&last| last as usize + 1);
        let mut positions = vec![glam::DVec3::ZERO; vertices];
        for (&vertex, &position) in input.iter().zip(&disk.positions) {
            positions[vertex as usize] = position;
        }
        let simplices = disk
            .simplices
            .iter()
            .map(|face| face.map(|v| input[v as usize]))
            .collect();
        let texture = CornerTexture {
            coordinates: self.inner.uv(),
            corners: disk.simplices.clone(),
        };
        io::write_obj(
            &SurfaceMesh {
                positions,
                simplices,
            },
            Some(&texture),
        )
    }
}

fn landmarks(vertices: &[u32], places: &[f64], hard: &[u8]) -> Fallible<Vec<Landmark>> {
    if places.len() != 2 * vertices.len() || hard.len() != vertices.len() {
        let what = "every vertex needs two coordinates, and whether it is held";
        return Err(invalid_argument("landmarks", what));
    }
    let places = places.as_chunks::<2>().0.iter();
    Ok(vertices
        .iter()
        .zip(places)
        .zip(hard)
        .map(|((&vertex, &place), &hard)| Landmark {
            vertex,
            uv: DVec2::from_array(place),
            hard: hard != 0,
        })
        .collect())
}

/// Checks a map that came from anywhere: `uv` is n × 2, interleaved, one a vertex of `mesh`.
#[wasm_bindgen(js_name = checkMap, unchecked_return_type = "Certificate")]
pub fn check_map(mesh: &WasmMesh, uv: &[f64]) -> Fallible<JsValue> {
    let (points, rest) = uv.as_chunks::<2>();
    let vertices = mesh.mesh().positions.len();
    if !rest.is_empty() || points.len() != vertices {
        return Err(invalid_argument(
            "uv",
            &format!("the length is {}, expected {}", uv.len(), 2 * vertices),
        ));
    }
    let points: Vec<DVec2> = points.iter().copied().map(DVec2::from_array).collect();
    to_js(&Certificate::try_of_map(mesh.mesh(), &points).map_err(thrown)?)
}

/// Checks a map with seams: `corners` has the image of every corner of every triangle (m × 3 × 2), as texture
/// coordinates do. Triangles are turned to agree with their neighbours first.
#[wasm_bindgen(js_name = checkCorners, unchecked_return_type = "Certificate")]
pub fn check_corners(mesh: &WasmMesh, corners: &[f64]) -> Fallible<JsValue> {
    let triangles = mesh.mesh().simplices.len();
    let (images, _) = corners.as_chunks::<6>();
    if corners.len() != 6 * triangles {
        let what = format!(
            "the length is {}, expected {}",
            corners.len(),
            6 * triangles
        );
        return Err(invalid_argument("corners", &what));
    }
    let images: Vec<[DVec2; 3]> = images
        .iter()
        .map(|&[a, b, c, d, e, f]| [DVec2::new(a, b), DVec2::new(c, d), DVec2::new(e, f)])
        .collect();
    let mut map = CornerMap::new(mesh.mesh(), &images);
    // What else may be wrong with the surface is for the certificate to say.
    if let Ok(prepared) = prepare(&map.mesh) {
        map.mesh = prepared.mesh;
    }
    to_js(&Certificate::try_of_map(&map.mesh, &map.uv).map_err(thrown)?)
}
