//! The eframe app: lays out the views and draws them.

use std::cell::RefCell;
use std::rc::Rc;

use eframe::egui::{self, Rect, Stroke, UiBuilder, pos2, vec2};
use wasm_bindgen::JsValue;

use super::bench::{Bench, Event};
use super::{inspector, map, plot, shape, style};
use crate::colour::Theme;
use crate::layout::{self, View};

/// The app.
pub struct Page {
    bench: Rc<RefCell<Bench>>,
    listen: js_sys::Function,
    styled: Option<(Theme, f32)>,
}

impl Page {
    /// An app that draws `bench` and reports to `listen`.
    pub fn new(bench: Rc<RefCell<Bench>>, listen: js_sys::Function) -> Self {
        Self {
            bench,
            listen,
            styled: None,
        }
    }
}

impl eframe::App for Page {
    fn clear_color(&self, _: &egui::Visuals) -> [f32; 4] {
        style::colour(self.bench.borrow().theme.ground).to_normalized_gamma_f32()
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let events = {
            let mut bench = self.bench.borrow_mut();
            if self.styled != Some((bench.theme, bench.text)) {
                self.styled = Some((bench.theme, bench.text));
                style::follow(ui.ctx(), &bench);
            }
            bench.refresh();
            draw(ui, &mut bench);
            std::mem::take(&mut bench.events)
        };
        // The bench is free again: the page may answer at once.
        for event in events {
            let (name, value) = match event {
                Event::Show(index) => ("show", index as f64),
            };
            let _ = self.listen.call2(
                &JsValue::NULL,
                &JsValue::from_str(name),
                &JsValue::from_f64(value),
            );
        }
    }
}

fn draw(ui: &mut egui::Ui, bench: &mut Bench) {
    let all = ui.max_rect();
    let views = layout::arrange(
        all.width(),
        all.height(),
        bench.alone,
        bench.inspector,
        bench.text,
    );
    let mut hover = None;
    for (view, area) in &views {
        let rect = Rect::from_min_size(all.min + vec2(area.x, area.y), vec2(area.w, area.h));
        ui.scope_builder(UiBuilder::new().max_rect(rect).id_salt(*view as u8), |ui| {
            ui.set_clip_rect(rect);
            match view {
                View::Shape => shape::show(ui, rect, bench),
                View::Map => hover = map::show(ui, rect, bench),
                View::Plot => plot::show(ui, rect, bench),
                View::Inspector => inspector::show(ui, rect, bench),
            }
        });
    }
    if hover != bench.hover {
        bench.hover = hover;
        ui.ctx().request_repaint();
    }
    let line = Stroke::new(1.0, style::colour(bench.theme.line));
    for (_, area) in &views {
        let (left, top) = (all.left() + area.x, all.top() + area.y);
        if area.x > 0.0 {
            ui.painter()
                .line_segment([pos2(left, top), pos2(left, top + area.h)], line);
        }
        if area.y > 0.0 {
            ui.painter()
                .line_segment([pos2(left, top), pos2(left + area.w, top)], line);
        }
    }
}
