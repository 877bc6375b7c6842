//! A deformation, step by step.

use super::error::{Fallible, invalid_argument, thrown};
use super::mesh::{flat3, positions3};
use super::options::deformation_options;
use super::report::StepReport;
use super::solid::WasmSolid;
use super::to_js;
use crate::deformation::{Deformation, Target};
use crate::optim::Field;
use glam::DVec3;
use js_sys::{Float32Array, Float64Array};
use wasm_bindgen::prelude::*;

/// A solid being deformed. `free()` it when done.
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
        #[wasm_bindgen(unchecked_param_type = "DeformationSettings | undefined")] options: &JsValue,
        start: Option<Vec<f64>>,
        pins: &[u32],
        target_vertices: &[u32],
        target_positions: &[f64],
    ) -> Fallible<WasmDeformation> {
        let options = deformation_options(options)?;
        let start = match start {
            Some(start) => positions3(&start)?,
            None => solid.mesh().positions.clone(),
        };
        let targets = targets(target_vertices, target_positions)?;
        let inner = Deformation::with_targets(solid.mesh(), &start, pins, &targets, &options);
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
        let positions = self.inner.solver().positions();
        let single: Vec<f32> = positions.iter().map(|&x| x as f32).collect();
        Float32Array::from(single.as_slice())
    }

    /// A field, one value a tetrahedron, infinite where inverted.
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
    #[wasm_bindgen(unchecked_return_type = "SolidCertificate")]
    pub fn certificate(&self) -> Fallible<JsValue> {
        to_js(&self.inner.certificate())
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

fn targets(vertices: &[u32], positions: &[f64]) -> Fallible<Vec<Target>> {
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
