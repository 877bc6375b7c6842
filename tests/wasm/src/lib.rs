//! What the tests of both wasm builds share.
#![cfg(target_arch = "wasm32")]

use foldfree::wasm::{WasmMesh, WasmParameterization};
use js_sys::{Object, Reflect};
use wasm_bindgen::JsValue;

/// A property of a JavaScript object.
pub fn field(object: &JsValue, name: &str) -> JsValue {
    Reflect::get(object, &name.into()).unwrap_or(JsValue::UNDEFINED)
}

/// An options object.
pub fn options(entries: &[(&str, JsValue)]) -> JsValue {
    let object = Object::new();
    for (name, value) in entries {
        Reflect::set(&object, &(*name).into(), value).expect("a fresh object");
    }
    object.into()
}

/// A generated shape and its parameterization after at most so many steps.
pub fn flatten(shape: &str, triangles: usize, steps: u32) -> (WasmMesh, WasmParameterization) {
    let mesh = WasmMesh::generate(shape, triangles).expect("a known shape");
    let options = options(&[("maxIterations", steps.into())]);
    let mut solver =
        WasmParameterization::new(&mesh, &options, &[], &[], &[]).expect("a good mesh");
    for _ in 0..steps {
        let report: JsValue = solver.step().expect("a step");
        if Reflect::get(&report, &"status".into()) != Ok("running".into()) {
            break;
        }
    }
    (mesh, solver)
}
