//! An untangling, step by step.

use super::deformation::{started, targets};
use super::error::{Fallible, invalid_argument, thrown};
use super::mesh::{WasmMesh, flat3, single3};
use super::options::untangle_options;
use super::report::StepReport;
use super::solid::WasmSolid;
use super::to_js;
use crate::deformation::Untangling;
use crate::gini::PolishState;
use js_sys::{Float32Array, Float64Array, Uint32Array};
use wasm_bindgen::prelude::*;

/// A solid, or triangles in their plane, being untangled. `free()` it when done.
#[wasm_bindgen]
pub struct WasmUntangling {
    inner: Untangling,
}

#[wasm_bindgen]
impl WasmUntangling {
    /// Checks rest shape, start (n × 3; `undefined`: at rest), pins and targets (vertices, and a point
    /// for each), and builds the solver.
    #[wasm_bindgen(constructor)]
    pub fn new(
        solid: &WasmSolid,
        #[wasm_bindgen(unchecked_param_type = "Partial<UntangleSettings> | undefined")]
        options: &JsValue,
        start: Option<Vec<f64>>,
        pins: &[u32],
        target_vertices: &[u32],
        target_positions: &[f64],
    ) -> Fallible<WasmUntangling> {
        let (material, options, flow) = untangle_options(options)?;
        let rest = solid.mesh();
        let start = started(start, &rest.positions)?;
        let targets = targets(target_vertices, target_positions)?;
        let new = match flow {
            true => Untangling::through_flow,
            false => Untangling::of_solid,
        };
        let inner = new(rest, &start, pins, &targets, material, &options).map_err(thrown)?;
        Ok(Self { inner })
    }

    /// The same of triangles in a plane z = constant.
    #[wasm_bindgen(js_name = ofMesh)]
    pub fn of_mesh(
        mesh: &WasmMesh,
        #[wasm_bindgen(unchecked_param_type = "Partial<UntangleSettings> | undefined")]
        options: &JsValue,
        start: Option<Vec<f64>>,
        pins: &[u32],
        target_vertices: &[u32],
        target_positions: &[f64],
    ) -> Fallible<WasmUntangling> {
        let (material, options, flow) = untangle_options(options)?;
        let rest = mesh.mesh();
        let start = started(start, &rest.positions)?;
        let targets = targets(target_vertices, target_positions)?;
        let new = match flow {
            true => Untangling::through_flow_in_plane,
            false => Untangling::of_plane,
        };
        let inner = new(rest, &start, pins, &targets, material, &options).map_err(thrown)?;
        Ok(Self { inner })
    }

    /// One step: local step, quadratic problem, polisher.
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

    /// x, n × 3, interleaved, in the units of the input: the state that is handed out.
    pub fn positions(&self) -> Float64Array {
        flat3(&self.inner.positions())
    }

    /// The same in single precision: half the bytes, enough to draw.
    #[wasm_bindgen(js_name = positionsSingle)]
    pub fn positions_single(&self) -> Float32Array {
        single3(&self.inner.positions())
    }

    /// x̄, n × 3: the state of the primary solver, which may fold.
    #[wasm_bindgen(js_name = primaryPositions)]
    pub fn primary_positions(&self) -> Float64Array {
        flat3(&self.inner.primary_positions())
    }

    /// The same in single precision.
    #[wasm_bindgen(js_name = primaryPositionsSingle)]
    pub fn primary_positions_single(&self) -> Float32Array {
        single3(&self.inner.primary_positions())
    }

    /// Keeps the polisher's states of every step from here on, or no more.
    #[wasm_bindgen(js_name = setTrace)]
    pub fn set_trace(&mut self, on: bool) {
        self.inner.set_trace(on);
    }

    /// How many of them the newest step has.
    #[wasm_bindgen(getter, js_name = traceLength)]
    pub fn trace_length(&self) -> usize {
        self.inner.trace().len()
    }

    /// x̂ of one of them, n × 3.
    #[wasm_bindgen(js_name = tracePositions)]
    pub fn trace_positions(&self, state: usize) -> Fallible<Float64Array> {
        let state = self.state(state)?;
        Ok(flat3(&self.inner.trace_positions(state)))
    }

    /// The zone of violated constraints that each element is in, the first being 1; 0: in none.
    #[wasm_bindgen(js_name = traceZones)]
    pub fn trace_zones(&self, state: usize) -> Fallible<Uint32Array> {
        Ok(Uint32Array::from(&*self.state(state)?.zones))
    }

    /// Its elements that are inverted or flat, and its constraints below their η.
    #[wasm_bindgen(js_name = traceCounts)]
    pub fn trace_counts(&self, state: usize) -> Fallible<Vec<u32>> {
        let state = self.state(state)?;
        Ok(vec![state.inverted as u32, state.violated as u32])
    }

    /// What is known of x, by exact predicates.
    #[wasm_bindgen(unchecked_return_type = "Outcome")]
    pub fn outcome(&self) -> Fallible<JsValue> {
        to_js(&self.inner.outcome())
    }

    /// Why no map of these pins can be injective, and what is inverted, in plain sentences.
    pub fn obstacles(&self) -> Vec<String> {
        self.inner.outcome().obstacles()
    }

    /// The exact checks of x.
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

    /// With `flow`: how the start's boundary was parted.
    #[wasm_bindgen(getter, unchecked_return_type = "Flowed | undefined")]
    pub fn flowed(&self) -> Fallible<JsValue> {
        to_js(&self.inner.flowed())
    }

    /// Seconds that the checks and the factorisation took.
    #[wasm_bindgen(getter, js_name = setupSeconds)]
    pub fn setup_seconds(&self) -> f64 {
        self.inner.setup_seconds()
    }
}

impl WasmUntangling {
    fn state(&self, state: usize) -> Fallible<&PolishState> {
        let missing = || invalid_argument("state", "the newest step has no such state");
        self.inner.trace().get(state).ok_or_else(missing)
    }
}
