//! The threaded build in a headless browser, on a pool of two Web Workers.
#![cfg(all(target_arch = "wasm32", feature = "threads"))]

use foldfree_wasm_tests::flatten;
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_dedicated_worker);

/// One test, in this order: the pool can be made once, and this thread can leave it for a pool of its own
/// but not come back.
#[wasm_bindgen_test]
async fn two_threads_and_one_give_the_same_bits() {
    JsFuture::from(foldfree::wasm::init_thread_pool(2))
        .await
        .expect("a pool");
    assert_eq!(rayon::current_num_threads(), 2);
    let run = || -> Vec<Vec<f64>> {
        [
            ("bumpy-cap", 20_000, 5),
            ("terrain", 6000, 20),
            ("torus", 4000, 10),
        ]
        .map(|(shape, triangles, steps)| flatten(shape, triangles, steps).1.uv().to_vec())
        .into()
    };
    let two = run();
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build()
        .expect("a pool of this thread");
    assert_eq!(rayon::current_num_threads(), 1);
    let one = run();
    drop(alone);
    for (one, two) in one.iter().zip(&two) {
        assert!(one.iter().zip(two).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}
