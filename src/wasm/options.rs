//! Options from a JavaScript object. Unknown keys and wrong kinds of value are errors that name the key.

use super::error::{Fallible, invalid_option};
use crate::parameterization::ParameterizationOptions;
use js_sys::{Object, Reflect};
use wasm_bindgen::prelude::*;

/// `undefined` and `null` stand for the defaults.
pub(super) fn parameterization_options(value: &JsValue) -> Fallible<ParameterizationOptions> {
    if value.is_undefined() || value.is_null() {
        return Ok(ParameterizationOptions::default());
    }
    let Some(object) = value.dyn_ref::<Object>() else {
        return Err(invalid_option("options", "an object is needed"));
    };
    // serde-wasm-bindgen reads only the fields a struct has, so the keys are compared here.
    let known = Object::keys(&default_options()?.into());
    let given = Object::new();
    for key in Object::keys(object) {
        let value = Reflect::get(object, &key)?;
        if value.is_undefined() {
            continue;
        }
        let name = key.as_string().unwrap_or_default();
        if !known.includes(&key, 0) {
            let names: Vec<_> = known.iter().filter_map(|key| key.as_string()).collect();
            let what = format!("there is no such option; there are {}", names.join(", "));
            return Err(invalid_option(&name, &what));
        }
        let alone = Object::new();
        Reflect::set(&alone, &key, &value)?;
        read(alone.into()).map_err(|what| invalid_option(&name, &what))?;
        Reflect::set(&given, &key, &value)?;
    }
    read(given.into()).map_err(|what| invalid_option("options", &what))
}

fn read(value: JsValue) -> Result<ParameterizationOptions, String> {
    serde_wasm_bindgen::from_value(value).map_err(|error| error.to_string())
}

/// The default options as a JavaScript object.
#[wasm_bindgen(js_name = defaultOptions, unchecked_return_type = "ParameterizationOptions")]
pub fn default_options() -> Fallible<JsValue> {
    serde_wasm_bindgen::to_value(&ParameterizationOptions::default()).map_err(JsValue::from)
}
