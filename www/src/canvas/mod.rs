//! The drawing half: an eframe app on the page's canvas, and what JavaScript may ask of it.

mod app;
mod bench;
mod gpu;
mod inspector;
mod map;
mod plot;
mod shape;
mod style;

use std::cell::RefCell;
use std::rc::Rc;

use eframe::egui;
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use crate::history::Record;
use crate::layout::View;
use bench::Bench;

/// The canvas of the page. All arrays are copied.
#[wasm_bindgen]
pub struct Canvas {
    bench: Rc<RefCell<Bench>>,
    context: egui::Context,
    _runner: eframe::WebRunner,
}

#[wasm_bindgen]
impl Canvas {
    /// Starts drawing on a canvas element. `listen(name, value)` hears what people do on it:
    /// `("show", index)` when an iterate is chosen on the plot.
    pub async fn start(
        element: HtmlCanvasElement,
        listen: js_sys::Function,
    ) -> Result<Canvas, JsValue> {
        let bench = Rc::new(RefCell::new(Bench::new()));
        let context = Rc::new(RefCell::new(None));
        let runner = eframe::WebRunner::new();
        let options = eframe::WebOptions {
            webgl_context_option: eframe::WebGlContextOption::WebGl2,
            dithering: false,
            // Keys belong to the page; wheel and touch belong to the canvas while over it.
            should_stop_propagation: Box::new(|event| !is_key(event)),
            should_prevent_default: Box::new(|event| !is_key(event)),
            ..Default::default()
        };
        let app = {
            let (bench, context, element) = (bench.clone(), context.clone(), element.clone());
            move |creation: &eframe::CreationContext<'_>| {
                gpu::start(&element).map_err(|error| format!("{error:?}"))?;
                style::install(&creation.egui_ctx);
                *context.borrow_mut() = Some(creation.egui_ctx.clone());
                Ok(Box::new(app::Page::new(bench, listen)) as Box<dyn eframe::App>)
            }
        };
        runner.start(element, options, Box::new(app)).await?;
        let context = context
            .take()
            .ok_or_else(|| JsValue::from_str("the canvas did not start"))?;
        Ok(Self {
            bench,
            context,
            _runner: runner,
        })
    }

    /// Puts a surface on the bench: positions (n×3) in its own unit, triangles (m×3).
    #[wasm_bindgen(js_name = setProblem)]
    pub fn set_problem(&self, positions: &[f64], indices: &[u32]) {
        let n = positions.len() / 3;
        if indices.iter().all(|i| (*i as usize) < n) {
            self.change(|bench| bench.set_problem(positions, indices));
        }
    }

    /// Begins a run of a method from a start, with an energy (kebab-case names as in the options).
    #[wasm_bindgen(js_name = beginRun)]
    pub fn begin_run(&self, method: &str, start: &str, energy: &str) {
        self.change(|bench| bench.begin_run(method, start, energy));
    }

    /// Adds an iterate: nine numbers (iteration, energy, inverted, gradient norm, smallest σ,
    /// largest σ, L-BFGS iterations, reweighted, seconds), three numbers a phase (kind, count,
    /// milliseconds), and the map (n×2).
    #[wasm_bindgen(js_name = pushFrame)]
    pub fn push_frame(&self, numbers: &[f64], phases: &[f64], map: Vec<f32>) {
        if let Some(record) = Record::from_numbers(numbers, phases) {
            self.change(|bench| bench.push(record, map));
        }
    }

    /// Shows an iterate.
    #[wasm_bindgen(js_name = showFrame)]
    pub fn show_frame(&self, index: usize) {
        self.change(|bench| bench.show(index));
    }

    /// The map of an iterate (n×2), or of the newest kept one before it.
    #[wasm_bindgen(js_name = frameMap)]
    pub fn frame_map(&self, index: usize) -> Vec<f32> {
        self.bench
            .borrow()
            .frames
            .at(index)
            .map(|(_, map)| map.to_vec())
            .unwrap_or_default()
    }

    /// What the inspector says about the problem: names and values in turn.
    #[wasm_bindgen(js_name = setFacts)]
    pub fn set_facts(&self, facts: Vec<String>) {
        let facts = facts.as_chunks::<2>().0.to_vec();
        self.change(|bench| bench.facts = facts);
    }

    /// Pairs of boundary edges that meet where they should not in the newest map: four vertices each.
    #[wasm_bindgen(js_name = setCrossings)]
    pub fn set_crossings(&self, vertices: &[u32]) {
        self.change(|bench| {
            let n = bench.problem.vertices;
            let pairs = vertices.as_chunks::<4>().0.iter();
            bench.crossings = pairs
                .filter(|pair| pair.iter().all(|v| (*v as usize) < n))
                .map(|&[a, b, c, d]| [[a, b], [c, d]])
                .collect();
        });
    }

    /// Forgets the curves of earlier runs.
    #[wasm_bindgen(js_name = clearCurves)]
    pub fn clear_curves(&self) {
        self.change(|bench| bench.earlier.clear());
    }

    /// Light or dark.
    #[wasm_bindgen(js_name = setTheme)]
    pub fn set_theme(&self, dark: bool) {
        self.change(|bench| bench.set_dark(dark));
    }

    /// Size of text, 1 for a desk.
    #[wasm_bindgen(js_name = setTextScale)]
    pub fn set_text_scale(&self, scale: f32) {
        self.change(|bench| bench.text = scale.clamp(0.5, 4.0));
    }

    /// Whether nothing may glide.
    #[wasm_bindgen(js_name = setReducedMotion)]
    pub fn set_reduced_motion(&self, reduced: bool) {
        self.change(|bench| bench.reduced_motion = reduced);
    }

    /// Shows one view (`shape`, `map`, `plot`, `inspector`) or, with any other name, all.
    #[wasm_bindgen(js_name = setView)]
    pub fn set_view(&self, name: &str) {
        self.change(|bench| bench.alone = View::from_name(name));
    }

    /// Shows or hides the inspector.
    #[wasm_bindgen(js_name = setInspector)]
    pub fn set_inspector(&self, shown: bool) {
        self.change(|bench| bench.inspector = shown);
    }

    /// Turns a switch: `wireframe`, `tinted`, `gap`, `seconds`.
    pub fn toggle(&self, name: &str) {
        self.change(|bench| match name {
            "wireframe" => bench.wireframe = !bench.wireframe,
            "tinted" => bench.tinted = !bench.tinted,
            "gap" => bench.plot_height = bench.plot_height.other(),
            "seconds" => bench.plot_seconds = !bench.plot_seconds,
            _ => {}
        });
    }

    /// Fits the surface and the map into their views again.
    #[wasm_bindgen(js_name = fitViews)]
    pub fn fit_views(&self) {
        self.change(|bench| {
            bench.orbit.zoom = 1.0;
            bench.pan.follows = true;
        });
    }

    /// Inverted or collapsed triangles of the map on show, as drawn.
    #[wasm_bindgen(getter, js_name = drawnInverted)]
    pub fn drawn_inverted(&self) -> usize {
        let mut bench = self.bench.borrow_mut();
        bench.refresh();
        bench.inverted.len()
    }

    fn change(&self, f: impl FnOnce(&mut Bench)) {
        f(&mut self.bench.borrow_mut());
        self.context.request_repaint();
    }
}

fn is_key(event: &egui::Event) -> bool {
    use egui::Event::{Copy, Cut, Ime, Key, Paste, Text};
    matches!(event, Key { .. } | Text(_) | Copy | Cut | Paste(_) | Ime(_))
}
