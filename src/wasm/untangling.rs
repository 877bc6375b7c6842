//! An untangling, step by step.

use super::deformation::{started, targets};
use super::error::{Fallible, invalid_argument, thrown};
use super::mesh::{WasmMesh, flat3, single3};
use super::options::untangle_options;
use super::report::StepReport;
use super::solid::WasmSolid;
use super::to_js;
use crate::collision::Pair;
use crate::deformation::Untangling;
use crate::gini::TraceState;
use glam::DVec3;
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
        let inner = new(rest, &start, pins, &targets, material, options).map_err(thrown)?;
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
        let inner = new(rest, &start, pins, &targets, material, options).map_err(thrown)?;
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

    /// With `overlap`: has pinned vertices move to these points (k × 3), and the run go on.
    #[wasm_bindgen(js_name = movePins)]
    pub fn move_pins(&mut self, vertices: &[u32], positions: &[f64]) -> Fallible<()> {
        let targets = targets(vertices, positions)?;
        let pins: Vec<(u32, DVec3)> = targets.iter().map(|t| (t.vertex, t.position)).collect();
        self.inner.move_pins(&pins).map_err(thrown)
    }

    /// Keeps the states inside of every step from here on, or no more.
    #[wasm_bindgen(js_name = setTrace)]
    pub fn set_trace(&mut self, on: bool) {
        self.inner.set_trace(on);
    }

    /// How many of them the newest step has: those of the quadratic problem, which come first, and the polisher's.
    #[wasm_bindgen(getter, js_name = traceLengths)]
    pub fn trace_lengths(&self) -> Vec<u32> {
        let [first, second] = self.states().map(<[TraceState]>::len);
        vec![first as u32, second as u32]
    }

    /// x̄ or x̂ of one of them, n × 3.
    #[wasm_bindgen(js_name = tracePositions)]
    pub fn trace_positions(&self, state: usize) -> Fallible<Float64Array> {
        let state = self.state(state)?;
        Ok(flat3(&self.inner.trace_positions(state)))
    }

    /// The zone of violated constraints that each element is in, the first being 1; 0: in none. Of the polisher's states.
    #[wasm_bindgen(js_name = traceZones)]
    pub fn trace_zones(&self, state: usize) -> Fallible<Uint32Array> {
        Ok(Uint32Array::from(&*self.state(state)?.zones))
    }

    /// Its elements that are inverted or flat, its elements below their η, and, with `overlap`, pairs of boundary
    /// facets that meet.
    #[wasm_bindgen(js_name = traceCounts)]
    pub fn trace_counts(&self, state: usize) -> Fallible<Vec<u32>> {
        let state = self.state(state)?;
        let counts = [Some(state.inverted), Some(state.violated), state.meeting];
        Ok(counts.iter().flatten().map(|&n| n as u32).collect())
    }

    /// The contacts in its constraint set, seven numbers each: the vertices, 1 for two edges (0: a vertex and a facet), 1
    /// where it is active, its zone.
    #[wasm_bindgen(js_name = traceContacts)]
    pub fn trace_contacts(&self, state: usize) -> Fallible<Vec<u32>> {
        let mut numbers = Vec::new();
        for c in &self.state(state)?.contacts {
            numbers.extend(c.vertices);
            let edges = c.pair == Pair::EdgeEdge;
            numbers.extend([edges.into(), c.active.into(), c.zone]);
        }
        Ok(numbers)
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
    fn states(&self) -> [&[TraceState]; 2] {
        [self.inner.quadratic_trace(), self.inner.trace()]
    }

    fn state(&self, state: usize) -> Fallible<&TraceState> {
        let missing = || invalid_argument("state", "the newest step has no such state");
        let mut all = self.states().into_iter().flatten();
        all.nth(state).ok_or_else(missing)
    }
}
