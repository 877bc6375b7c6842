//! The single-thread build in a headless browser: `npm test`, or `wasm-pack test` as it calls it.
#![cfg(target_arch = "wasm32")]

use foldfree::wasm::{WasmMesh, WasmParameterization, check_map};
use foldfree_wasm_tests::{field, flatten, options};
use js_sys::{Object, Reflect};
use wasm_bindgen::JsValue;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_dedicated_worker);

#[wasm_bindgen_test]
fn flattens_without_a_fold() {
    let (mesh, solver) = flatten("bumpy-cap", 1000, 200);
    let report: JsValue = solver.report().expect("a report");
    assert_eq!(field(&report, "status"), JsValue::from("converged"));
    assert_eq!(field(&report, "inverted"), JsValue::from(0));
    assert!(field(&report, "phases").is_object());
    let certificate = solver.certificate().expect("a certificate");
    assert_eq!(field(&certificate, "locallyInjective"), JsValue::TRUE);
    let again = check_map(&mesh, &solver.uv().to_vec()).expect("a disk needs no cut");
    assert_eq!(
        field(&again, "symmetricDirichlet"),
        field(&certificate, "symmetricDirichlet")
    );
}

#[wasm_bindgen_test]
fn the_same_bits_twice() {
    let run = || flatten("terrain", 1000, 10).1.uv().to_vec();
    assert_eq!(run(), run());
}

#[wasm_bindgen_test]
fn exports_what_it_reads_back() {
    let (mesh, solver) = flatten("torus", 600, 3);
    assert!(solver.seam_edges() > 0);
    let again = WasmMesh::from_bytes(&solver.export_obj(), "obj").expect("own export");
    assert_eq!(again.indices().length(), mesh.indices().length());
    assert_eq!(again.positions().length(), mesh.positions().length());
    let corners = again.texture_corners().expect("texture coordinates");
    assert_eq!(corners.to_vec(), solver.indices().to_vec());
}

#[wasm_bindgen_test]
fn errors_are_typed() {
    let error =
        WasmMesh::from_bytes(b"v 0 0 0\nv 1 0 0\nf 1 2 9\n", "obj").expect_err("no vertex 9");
    assert_eq!(field(&error, "name"), JsValue::from("FoldfreeError"));
    assert_eq!(field(&error, "code"), JsValue::from("parse"));
    assert_eq!(field(&field(&error, "details"), "line"), JsValue::from(3));

    let sphere = WasmMesh::generate("sphere", 100).expect("a shape");
    let refuse = options(&[("cut", "refuse".into())]);
    let error = WasmParameterization::new(&sphere, &refuse, &[], &[], &[])
        .err()
        .expect("a sphere is no disk");
    assert_eq!(field(&error, "code"), JsValue::from("not-a-disk"));

    let unknown = Object::new();
    Reflect::set(&unknown, &"iterations".into(), &5.into()).expect("a fresh object");
    let error = WasmParameterization::new(&sphere, &unknown, &[], &[], &[])
        .err()
        .expect("no such option");
    assert_eq!(field(&error, "code"), JsValue::from("invalid-option"));
}
