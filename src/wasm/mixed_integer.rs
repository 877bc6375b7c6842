//! Mixed-integer quadratic problems, step by step.

use super::error::{Fallible, thrown};
use super::options::mixed_integer_options;
use super::to_js;
use crate::mixed_integer::{Action, MixedInteger, MixedIntegerStep, Problem, ProblemBuilder};
use crate::optim::Status;
use js_sys::{Float64Array, Uint32Array};
use serde::Serialize;
use tsify::Tsify;
use wasm_bindgen::prelude::*;

/// What one step did and where it led.
#[derive(Debug, Serialize, Tsify)]
#[serde(rename_all = "camelCase")]
pub struct MixedIntegerStepReport<'a> {
    /// 0: the relaxed solution.
    pub iteration: u32,
    /// Where the solver stands after the step: `max-iterations` where it ran out of nodes before it had
    /// a proof, `stalled` where double precision does not carry the problem.
    #[tsify(type = "'running' | 'converged' | 'max-iterations' | 'stalled' | 'cancelled'")]
    pub status: &'static str,
    /// Is the status `converged`?
    pub converged: bool,
    /// What was done.
    pub action: &'a Action,
    /// Greedy: the least energy with the integers rounded so far (with three levels: that of the
    /// iterate); afterwards that of the best point known.
    pub energy: f64,
    /// Integers without a value.
    pub remaining: u32,
    /// Seconds spent in steps so far.
    pub seconds: f64,
}

impl<'a> From<&'a MixedIntegerStep> for MixedIntegerStepReport<'a> {
    fn from(step: &'a MixedIntegerStep) -> Self {
        Self {
            iteration: step.iteration as u32,
            status: step.status.name(),
            converged: matches!(step.status, Status::Converged(_)),
            action: &step.action,
            energy: step.energy,
            remaining: step.remaining as u32,
            seconds: step.seconds,
        }
    }
}

/// A problem being collected; making a solver of it uses it up.
#[wasm_bindgen]
#[derive(Debug)]
pub struct WasmProblem {
    builder: ProblemBuilder,
}

#[wasm_bindgen]
impl WasmProblem {
    /// A as triplets, both triangles; b (length n); the integer unknowns.
    #[wasm_bindgen(constructor)]
    pub fn new(
        rows: &[u32],
        columns: &[u32],
        values: &[f64],
        linear: &[f64],
        integers: &[u32],
    ) -> WasmProblem {
        let builder = Problem::builder(linear.len())
            .quadratics(rows, columns, values)
            .linear(linear)
            .integers(integers);
        Self { builder }
    }

    /// With constraint rows as triplets, and the constant of each.
    pub fn constrained(
        self,
        rows: &[u32],
        unknowns: &[u32],
        coefficients: &[f64],
        constants: &[f64],
    ) -> WasmProblem {
        let builder = self
            .builder
            .constraints(rows, unknowns, coefficients, constants);
        Self { builder }
    }
}

/// A mixed-integer problem being solved. `free()` it when done.
#[wasm_bindgen]
pub struct WasmMixedInteger {
    inner: MixedInteger,
}

#[wasm_bindgen]
impl WasmMixedInteger {
    /// Checks the problem, eliminates its constraints, factors, and solves the relaxed problem.
    #[wasm_bindgen(constructor)]
    pub fn new(
        problem: WasmProblem,
        #[wasm_bindgen(unchecked_param_type = "Partial<MixedIntegerOptions> | undefined")]
        options: &JsValue,
    ) -> Fallible<WasmMixedInteger> {
        Self::begin(problem.builder.build().map_err(thrown)?, options)
    }

    /// The same for a `.sys` file.
    #[wasm_bindgen(js_name = fromSys)]
    pub fn from_sys(
        bytes: &[u8],
        #[wasm_bindgen(unchecked_param_type = "Partial<MixedIntegerOptions> | undefined")]
        options: &JsValue,
    ) -> Fallible<WasmMixedInteger> {
        Self::begin(Problem::from_sys(bytes).map_err(thrown)?, options)
    }

    fn begin(problem: Problem, options: &JsValue) -> Fallible<Self> {
        let options = mixed_integer_options(options)?;
        let inner = MixedInteger::new(problem, options).map_err(thrown)?;
        Ok(Self { inner })
    }

    /// A rounding, an improvement, a part of the reduction or of the enumeration.
    #[wasm_bindgen(unchecked_return_type = "MixedIntegerStepReport")]
    pub fn step(&mut self) -> Fallible<JsValue> {
        let step = self.inner.step().map_err(thrown)?;
        to_js(&MixedIntegerStepReport::from(step))
    }

    /// The newest step again.
    #[wasm_bindgen(js_name = lastStep, unchecked_return_type = "MixedIntegerStepReport")]
    pub fn last_step(&self) -> Fallible<JsValue> {
        to_js(&MixedIntegerStepReport::from(self.inner.last_step()))
    }

    /// All unknowns at the newest step, length n.
    pub fn iterate(&mut self) -> Float64Array {
        Float64Array::from(self.inner.iterate())
    }

    /// The unknowns that have to be integers, ascending.
    #[wasm_bindgen(getter)]
    pub fn integers(&self) -> Uint32Array {
        Uint32Array::from(self.inner.problem().integers())
    }

    /// Another b, other constants, or both; nothing is factored again.
    pub fn resolve(
        &mut self,
        linear: Option<Vec<f64>>,
        constants: Option<Vec<f64>>,
    ) -> Fallible<()> {
        self.inner
            .resolve(linear.as_deref(), constants.as_deref())
            .map_err(thrown)
    }

    /// What is known so far.
    #[wasm_bindgen(unchecked_return_type = "MixedIntegerReport")]
    pub fn report(&self) -> Fallible<JsValue> {
        to_js(self.inner.report())
    }
}
