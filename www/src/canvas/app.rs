//! The eframe app: lays out the views and draws them.

use std::cell::RefCell;
use std::rc::Rc;

use eframe::egui::{self, Rect, Stroke, UiBuilder, pos2, vec2};
use wasm_bindgen::JsValue;

use super::bench::{Bench, Event};
use super::stage::Stage;
use super::{inspector, map, plot, race, shape, solid, style};
use crate::colour::Theme;
use crate::layout::{self, View};

/// The app.
pub struct Page {
    stage: Rc<RefCell<Stage>>,
    listen: js_sys::Function,
    styled: Option<(Theme, f32)>,
}

impl Page {
    /// An app that draws the bench on show and reports to `listen`.
    pub fn new(stage: Rc<RefCell<Stage>>, listen: js_sys::Function) -> Self {
        Self {
            stage,
            listen,
            styled: None,
        }
    }
}

impl eframe::App for Page {
    fn clear_color(&self, _: &egui::Visuals) -> [f32; 4] {
        style::colour(self.stage.borrow().shown().theme.ground).to_normalized_gamma_f32()
    }

    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let events = {
            let mut stage = self.stage.borrow_mut();
            let bench = stage.shown_mut();
            if self.styled != Some((bench.theme, bench.text)) {
                self.styled = Some((bench.theme, bench.text));
                style::follow(ui.ctx(), bench);
            }
            bench.refresh();
            draw(ui, bench);
            std::mem::take(&mut bench.events)
        };
        // The bench is free again: the page may answer at once.
        for event in events {
            let (name, value) = spell(event);
            let name = JsValue::from_str(name);
            let _ = self.listen.call2(&JsValue::NULL, &name, &value);
        }
    }
}

/// An event as the page hears it.
fn spell(event: Event) -> (&'static str, JsValue) {
    match event {
        Event::Show(index) => ("show", JsValue::from_f64(index as f64)),
        Event::Moment(at) => ("moment", JsValue::from_f64(at)),
        Event::Pin(vertices) => ("pin", js_sys::Uint32Array::from(&vertices[..]).into()),
        Event::Select(handle) => (
            "select",
            JsValue::from_f64(handle.map_or(-1.0, |i| i as f64)),
        ),
        Event::GrabHandle(handle) => ("grab-handle", JsValue::from_f64(handle as f64)),
        Event::GrabVertex(vertex) => ("grab-vertex", JsValue::from_f64(f64::from(vertex))),
        Event::Drag(delta) => {
            let delta = delta.as_dvec3().to_array();
            ("drag", js_sys::Float64Array::from(&delta[..]).into())
        }
        Event::Turn(angle) => ("turn", JsValue::from_f64(f64::from(angle))),
        Event::Drop => ("drop", JsValue::UNDEFINED),
    }
}

fn is_planar(bench: &Bench) -> bool {
    bench.body.as_ref().is_some_and(|body| body.solid.planar)
}

/// A figure that is untangled has nothing to cut open: it takes the room of both views.
fn whole_figure(bench: &Bench, mut views: Vec<(View, layout::Area)>) -> Vec<(View, layout::Area)> {
    if !(bench.is_untangling() && is_planar(bench)) {
        return views;
    }
    let map = views.iter().find(|(view, _)| *view == View::Map).copied();
    let shape = views.iter_mut().find(|(view, _)| *view == View::Shape);
    if let (Some((_, map)), Some((_, shape))) = (map, shape) {
        shape.w = shape.w.max(map.x + map.w - shape.x);
        shape.h = shape.h.max(map.y + map.h - shape.y);
        views.retain(|(view, _)| *view != View::Map);
    }
    views
}

fn draw(ui: &mut egui::Ui, bench: &mut Bench) {
    let all = ui.max_rect();
    let arrange = match bench.race {
        Some(_) => layout::arrange_race,
        None => layout::arrange,
    };
    let views = arrange(
        all.width(),
        all.height(),
        bench.alone,
        bench.inspector,
        bench.text,
    );
    let views = whole_figure(bench, views);
    let mut hover = None;
    for (view, area) in &views {
        let rect = Rect::from_min_size(all.min + vec2(area.x, area.y), vec2(area.w, area.h));
        ui.scope_builder(UiBuilder::new().max_rect(rect).id_salt(*view as u8), |ui| {
            ui.set_clip_rect(rect);
            match view {
                View::Shape if bench.body.is_some() => solid::show_skin(ui, rect, bench),
                View::Map if bench.is_untangling() && is_planar(bench) => {
                    solid::show_skin(ui, rect, bench);
                }
                View::Plot if bench.is_untangling() => plot::violations::show(ui, rect, bench),
                View::Map if bench.body.is_some() && bench.is_lim() => {
                    solid::show_cut_and_parameters(ui, rect, bench);
                }
                View::Map if bench.body.is_some() => solid::show_cut(ui, rect, bench),
                View::Map if bench.race.is_some() => hover = race::panes::show(ui, rect, bench),
                View::Plot if bench.race.is_some() => race::curves::show(ui, rect, bench),
                View::Inspector if bench.race.is_some() => race::table::show(ui, rect, bench),
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
