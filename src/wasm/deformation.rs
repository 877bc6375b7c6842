//! A deformation, step by step.

use super::error::{Fallible, invalid_argument, invalid_option, thrown};
use super::mesh::{WasmMesh, flat3, positions3, single3};
use super::options::{deformation_options, lim_options};
use super::report::StepReport;
use super::solid::WasmSolid;
use super::to_js;
use crate::deformation::{Deformation, Target};
use crate::optim::Field;
use glam::DVec3;
use js_sys::{Float32Array, Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

/// A solid, or triangles in their plane, being deformed. `free()` it when done.
#[wasm_bindgen]
pub struct WasmDeformation {
    inner: Deformation,
}

#[wasm_bindgen]
impl WasmDeformation {
    /// Checks rest shape, start (n × 3; `undefined`: at rest), pins and targets (vertices, and a point
    /// for each), and builds the solver.
    #[wasm_bindgen(constructor)]
    pub fn new(
        solid: &WasmSolid,
        #[wasm_bindgen(unchecked_param_type = "DeformationSettings | LimSettings | undefined")]
        options: &JsValue,
        start: Option<Vec<f64>>,
        pins: &[u32],
        target_vertices: &[u32],
        target_positions: &[f64],
    ) -> Fallible<WasmDeformation> {
        let lim = lim_options(options, false)?;
        let rest = solid.mesh();
        let start = started(start, &rest.positions)?;
        let targets = targets(target_vertices, target_positions)?;
        let inner = match &lim {
            Some(lim) => Deformation::locally_injective(rest, &start, pins, &targets, lim),
            None => {
                let options = deformation_options(options)?;
                Deformation::with_targets(rest, &start, pins, &targets, &options)
            }
        };
        let inner = inner.map_err(thrown)?;
        Ok(Self { inner })
    }

    /// The same of triangles in a plane z = constant, which locally injective mappings deform.
    #[wasm_bindgen(js_name = ofMesh)]
    pub fn of_mesh(
        mesh: &WasmMesh,
        #[wasm_bindgen(unchecked_param_type = "LimSettings | undefined")] options: &JsValue,
        start: Option<Vec<f64>>,
        pins: &[u32],
        target_vertices: &[u32],
        target_positions: &[f64],
    ) -> Fallible<WasmDeformation> {
        let Some(options) = lim_options(options, true)? else {
            let what = "triangles in the plane are deformed by lim alone";
            return Err(invalid_option("method", what));
        };
        let rest = mesh.mesh();
        let start = started(start, &rest.positions)?;
        let targets = targets(target_vertices, target_positions)?;
        let inner = Deformation::locally_injective_in_plane(rest, &start, pins, &targets, &options);
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

    /// Replaces all targets: pinned vertices are moved there, springs pull at the free ones.
    #[wasm_bindgen(js_name = setTargets)]
    pub fn set_targets(&mut self, vertices: &[u32], positions: &[f64]) -> Fallible<()> {
        let targets = targets(vertices, positions)?;
        self.inner.set_targets(&targets).map_err(thrown)
    }

    /// The positions, n × 3, interleaved, in the units of the input.
    pub fn positions(&self) -> Float64Array {
        flat3(&self.inner.positions())
    }

    /// The positions in single precision: half the bytes, enough to draw.
    #[wasm_bindgen(js_name = positionsSingle)]
    pub fn positions_single(&self) -> Float32Array {
        single3(&self.inner.positions())
    }

    /// The handles that locally injective mappings have not brought to their targets yet,
    #[wasm_bindgen(js_name = subTargetVertices)]
    pub fn sub_target_vertices(&self) -> Uint32Array {
        let targets = self.inner.sub_targets();
        let vertices: Vec<u32> = targets.iter().map(|target| target.vertex).collect();
        Uint32Array::from(vertices.as_slice())
    }

    /// and where the last step led each of them, n × 3.
    #[wasm_bindgen(js_name = subTargetPositions)]
    pub fn sub_target_positions(&self) -> Float64Array {
        let targets = self.inner.sub_targets();
        let points: Vec<DVec3> = targets.iter().map(|target| target.position).collect();
        flat3(&points)
    }

    /// A field, one value an element, infinite where inverted.
    pub fn field(
        &self,
        #[wasm_bindgen(unchecked_param_type = "Field")] name: JsValue,
    ) -> Fallible<Float32Array> {
        let field: Field = serde_wasm_bindgen::from_value(name)
            .map_err(|error| invalid_argument("field", &error.to_string()))?;
        Ok(Float32Array::from(self.inner.field(field).as_slice()))
    }

    /// Weight over rest weight a tetrahedron; empty where the method has no weights.
    pub fn weights(&self) -> Float32Array {
        Float32Array::from(self.inner.solver().inspect().weights.as_slice())
    }

    /// The exact checks of the newest iterate.
    #[wasm_bindgen(unchecked_return_type = "SolidCertificate | Certificate")]
    pub fn certificate(&self) -> Fallible<JsValue> {
        match self.inner.certificate_in_plane() {
            Some(certificate) => to_js(&certificate),
            None => to_js(&self.inner.certificate()),
        }
    }

    /// What was mended or chosen, in words.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    /// Seconds that the checks and the factorisation took.
    #[wasm_bindgen(getter, js_name = setupSeconds)]
    pub fn setup_seconds(&self) -> f64 {
        self.inner.setup_seconds()
    }
}

/// The start, or else the rest shape.
pub(super) fn started(start: Option<Vec<f64>>, rest: &[DVec3]) -> Fallible<Vec<DVec3>> {
    match start {
        Some(start) => positions3(&start),
        None => Ok(rest.to_vec()),
    }
}

/// Vertices and a point for each.
pub(super) fn targets(vertices: &[u32], positions: &[f64]) -> Fallible<Vec<Target>> {
    let (points, rest) = positions.as_chunks::<3>();
    if !rest.is_empty() || points.len() != vertices.len() {
        let (found, expected) = (positions.len(), 3 * vertices.len());
        let what = format!("positions: the length is {found}, expected {expected}");
        return Err(invalid_argument("targets", &what));
    }
    let pairs = vertices.iter().zip(points);
    Ok(pairs
        .map(|(&vertex, &point)| Target {
            vertex,
            position: DVec3::from_array(point),
        })
        .collect())
}
