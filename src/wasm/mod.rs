//! The WebAssembly surface: thin newtypes over the library, typed arrays in and out, typed errors.
//!
//! Nothing here computes; nothing in the library knows of it. Its JavaScript half is `src/js`.

// The glue that `#[wasm_bindgen]` writes is unsafe; there is none of our own.
#![allow(unsafe_code)]
#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod deformation;
mod error;
mod mesh;
mod mixed_integer;
mod options;
mod parameterization;
mod report;
mod solid;
mod untangling;

pub use deformation::WasmDeformation;
pub use mesh::{WasmMesh, shapes};
pub use mixed_integer::{WasmMixedInteger, WasmProblem};
pub use options::{
    default_deformation_options, default_lim_options, default_mixed_integer_options,
    default_options, default_untangle_options,
};
pub use parameterization::{WasmParameterization, check_corners, check_map};
pub use solid::{WasmSolid, check_solid, solid_shapes};
pub use untangling::WasmUntangling;
#[cfg(feature = "threads")]
pub use wasm_bindgen_rayon::init_thread_pool;

use js_sys::Reflect;
use wasm_bindgen::prelude::*;

/// The property of `globalThis` that holds the message of the newest panic of this thread.
const PANIC_PROPERTY: &str = "foldfreePanic";

/// Runs when the module is instantiated: a panic leaves its message where the worker finds it, since
/// the exception JavaScript sees says only "unreachable".
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| {
        let message = JsValue::from_str(&panic.to_string());
        let _ = Reflect::set(&js_sys::global(), &PANIC_PROPERTY.into(), &message);
        error::announce(&message);
    }));
}

/// The version of the library.
#[wasm_bindgen]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// Bytes of linear memory in use; memory never shrinks, so it is also the peak.
#[wasm_bindgen(js_name = memoryBytes)]
pub fn memory_bytes() -> f64 {
    core::arch::wasm32::memory_size(0) as f64 * 65536.0
}

/// The worker threads a parallel loop uses (1: none but the caller).
#[wasm_bindgen(js_name = threadCount)]
pub fn thread_count() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    return 1;
}

fn to_js(value: &impl serde::Serialize) -> Result<JsValue, JsValue> {
    serde_wasm_bindgen::to_value(value).map_err(JsValue::from)
}
