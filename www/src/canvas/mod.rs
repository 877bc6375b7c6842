//! The drawing half: an eframe app on the page's canvas, and what JavaScript may ask of it.

mod app;
mod bench;
mod gpu;
mod handle;
mod inspector;
mod legend;
mod map;
mod painting;
mod plot;
mod race;
mod shape;
mod solid;
mod stage;
mod style;

use std::cell::RefCell;
use std::rc::Rc;

use eframe::egui;
use wasm_bindgen::prelude::*;
use web_sys::HtmlCanvasElement;

use crate::layout::View;
use bench::Bench;
use handle::BenchHandle;
use stage::{Mode, Stage};

/// The canvas of the page. All arrays are copied.
#[wasm_bindgen]
pub struct Canvas {
    stage: Rc<RefCell<Stage>>,
    context: egui::Context,
    _runner: eframe::WebRunner,
}

#[wasm_bindgen]
impl Canvas {
    /// Starts drawing on a canvas element. `listen(name, value)` hears what people do on it:
    /// `show` (an iterate was chosen on the plot: its index); where solvers are compared `moment` (of their
    /// clock, chosen on the plot); on a solid `pin` (vertices),
    /// `select` (a handle's index or -1), `grab-handle` (its index), `grab-vertex` (the vertex), `drag`
    /// (x y z, how far it has come since), `turn` (by how many radians since), `drop`.
    pub async fn start(
        element: HtmlCanvasElement,
        listen: js_sys::Function,
    ) -> Result<Canvas, JsValue> {
        let stage = Rc::new(RefCell::new(Stage::new()));
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
            let (stage, context, element) = (stage.clone(), context.clone(), element.clone());
            move |creation: &eframe::CreationContext<'_>| {
                gpu::start(&element).map_err(|error| format!("{error:?}"))?;
                style::install(&creation.egui_ctx);
                *context.borrow_mut() = Some(creation.egui_ctx.clone());
                Ok(Box::new(app::Page::new(stage, listen)) as Box<dyn eframe::App>)
            }
        };
        runner.start(element, options, Box::new(app)).await?;
        let context = context
            .take()
            .ok_or_else(|| JsValue::from_str("the canvas did not start"))?;
        Ok(Self {
            stage,
            context,
            _runner: runner,
        })
    }

    /// The bench of a mode (`flatten`, `deform`, `compare`), or of the mode on show.
    pub fn bench(&self, mode: &str) -> BenchHandle {
        let mode = Mode::from_name(mode).unwrap_or_else(|| self.stage.borrow().mode());
        BenchHandle::new(self.stage.clone(), self.context.clone(), mode)
    }

    /// Shows the bench of a mode (`flatten`, `deform`, `compare`).
    #[wasm_bindgen(js_name = setMode)]
    pub fn set_mode(&self, name: &str) {
        if let Some(mode) = Mode::from_name(name) {
            self.stage.borrow_mut().choose(mode);
            self.context.request_repaint();
        }
    }

    /// Light or dark.
    #[wasm_bindgen(js_name = setTheme)]
    pub fn set_theme(&self, dark: bool) {
        self.all(|bench| bench.set_dark(dark));
    }

    /// Size of text, 1 for a desk.
    #[wasm_bindgen(js_name = setTextScale)]
    pub fn set_text_scale(&self, scale: f32) {
        self.all(|bench| bench.text = scale.clamp(0.5, 4.0));
    }

    /// Whether nothing may glide.
    #[wasm_bindgen(js_name = setReducedMotion)]
    pub fn set_reduced_motion(&self, reduced: bool) {
        self.all(|bench| bench.reduced_motion = reduced);
    }

    /// Shows one view (`shape`, `map`, `plot`, `inspector`) or, with any other name, all.
    #[wasm_bindgen(js_name = setView)]
    pub fn set_view(&self, name: &str) {
        self.all(|bench| bench.alone = View::from_name(name));
    }

    /// Shows or hides the inspector.
    #[wasm_bindgen(js_name = setInspector)]
    pub fn set_inspector(&self, shown: bool) {
        self.all(|bench| bench.inspector = shown);
    }

    /// Turns a switch of the bench on show: `wireframe`, `tinted`, `gap`, `seconds`.
    pub fn toggle(&self, name: &str) {
        self.change(|bench| match name {
            "wireframe" => bench.wireframe = !bench.wireframe,
            "tinted" => bench.tinted = !bench.tinted,
            "gap" => bench.plot_height = bench.plot_height.other(),
            "seconds" => bench.plot_seconds = !bench.plot_seconds,
            _ => {}
        });
    }

    /// Fits what is on show into its views again.
    #[wasm_bindgen(js_name = fitViews)]
    pub fn fit_views(&self) {
        self.change(|bench| {
            bench.orbit.zoom = 1.0;
            bench.pan.follows = true;
        });
    }

    /// Inverted or collapsed elements of the iterate on show, as drawn.
    #[wasm_bindgen(getter, js_name = drawnInverted)]
    pub fn drawn_inverted(&self) -> usize {
        let mut stage = self.stage.borrow_mut();
        let bench = stage.shown_mut();
        bench.refresh();
        bench.drawn_inverted()
    }

    fn change(&self, f: impl FnOnce(&mut Bench)) {
        f(self.stage.borrow_mut().shown_mut());
        self.context.request_repaint();
    }

    fn all(&self, f: impl Fn(&mut Bench)) {
        self.stage.borrow_mut().all().iter_mut().for_each(f);
        self.context.request_repaint();
    }
}

fn is_key(event: &egui::Event) -> bool {
    use egui::Event::{Copy, Cut, Ime, Key, Paste, Text};
    matches!(event, Key { .. } | Text(_) | Copy | Cut | Paste(_) | Ime(_))
}
