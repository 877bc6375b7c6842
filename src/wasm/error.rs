//! Errors as JavaScript sees them: `Error` objects with a `code` and the fields of the Rust error.

use crate::Error;
use js_sys::{Object, Reflect};
use std::sync::atomic::{AtomicU32, Ordering};
use wasm_bindgen::prelude::*;

/// What a fallible export returns.
pub(super) type Fallible<T> = Result<T, JsValue>;

/// A JavaScript `Error` with `name`, `code` and a message.
fn with_code(code: &str, message: &str) -> JsValue {
    let error: JsValue = js_sys::Error::new(message).into();
    // Setting a property of a fresh object cannot fail.
    let _ = Reflect::set(&error, &"name".into(), &"FoldfreeError".into());
    let _ = Reflect::set(&error, &"code".into(), &code.into());
    error
}

/// A library error, with the fields of its variant (`line`, `vertex`, `face` …) as `details`.
pub(super) fn thrown(error: impl Into<Error>) -> JsValue {
    let error = error.into();
    let object = with_code(error.code(), &error.to_string());
    let details = serde_wasm_bindgen::to_value(&error).unwrap_or_else(|_| Object::new().into());
    let _ = Reflect::set(&object, &"details".into(), &details);
    object
}

/// An option that does not exist, or has a value of the wrong kind.
pub(super) fn invalid_option(option: &str, what: &str) -> JsValue {
    let object = with_code("invalid-option", &format!("option {option}: {what}"));
    let details = Object::new();
    let _ = Reflect::set(&details, &"option".into(), &option.into());
    let _ = Reflect::set(&object, &"details".into(), &details);
    object
}

/// An argument that is not what the call takes.
pub(super) fn invalid_argument(argument: &str, what: &str) -> JsValue {
    with_code("invalid-argument", &format!("{argument}: {what}"))
}

#[wasm_bindgen]
extern "C" {
    /// Absent in most places; the package's workers have it in their global scope.
    type BroadcastChannel;
    #[wasm_bindgen(constructor, catch)]
    fn new(name: &str) -> Result<BroadcastChannel, JsValue>;
    #[wasm_bindgen(method, js_name = postMessage, catch)]
    fn post_message(this: &BroadcastChannel, message: &JsValue) -> Result<(), JsValue>;
}

/// The number by which this instance's client listens for panics; 0: nobody does.
static INSTANCE: AtomicU32 = AtomicU32::new(0);

/// Names this instance, so that its client hears of panics in any of its threads, on the
/// `BroadcastChannel` `foldfree-panic-` + the number.
#[wasm_bindgen(js_name = setInstance)]
pub fn set_instance(instance: u32) {
    INSTANCE.store(instance, Ordering::Relaxed);
}

/// Tells the client of a panic. In the threaded build a pool thread that panics leaves the thread
/// that waits for it blocked for good, so only a broadcast can still be heard.
pub(super) fn announce(message: &JsValue) {
    let instance = INSTANCE.load(Ordering::Relaxed);
    if instance == 0 {
        return;
    }
    if let Ok(channel) = BroadcastChannel::new(&format!("foldfree-panic-{instance}")) {
        let _ = channel.post_message(message);
    }
}
