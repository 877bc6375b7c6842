//! The solid cut open, in the colours of a field.

use eframe::egui::{self, Align2, Pos2, Rect, Sense, pos2};
use glam::{DMat3, DVec3, Vec2, Vec3};

use super::{Body, contacts};
use crate::canvas::bench::Bench;
use crate::canvas::{gpu, legend, style};
use crate::scale::{number, whole};
use crate::solid::field::Field;
use crate::solid::pick::{Lens, triangle_at};
use crate::solid::slice::Plane;
use crate::solid::stretch::corners;

/// How near the plane a contact must be to be drawn, in radii of the solid.
const NEAR: f32 = 0.04;

/// Draws the view and answers the pointer.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let response = ui.interact(rect, ui.scope_id().with("cut"), Sense::click_and_drag());
    if response.dragged() {
        let d = response.drag_delta();
        bench
            .orbit
            .drag(Vec2::new(d.x, d.y), rect.size().min_elem());
    }
    if response.double_clicked() {
        bench.orbit.zoom = 1.0;
    }
    if response.hovered() {
        let (zoom, scroll) = ui.input(|i| (i.zoom_delta(), i.smooth_scroll_delta.y));
        bench.orbit.magnify(zoom * (scroll * 0.004).exp());
    }
    let Some(mut body) = bench.body.take() else {
        return;
    };
    let size = Vec2::new(rect.width(), rect.height()).max(Vec2::ONE);
    let lens = Lens::new(bench.orbit.matrix(rect.aspect_ratio()), size);
    let plane = body.plane(lens.towards_viewer(0.5 * (body.solid.low + body.solid.high)));
    if let Some(frame) = bench.map() {
        body.refresh_cut(frame, plane);
    }
    let look = bench.look(ui.pixels_per_point());
    let solid = body.look(&bench.orbit, rect.aspect_ratio(), 1.0, plane);
    ui.painter().add(egui::PaintCallback {
        rect,
        callback: std::sync::Arc::new(eframe::egui_glow::CallbackFn::new(move |_, _| {
            gpu::with(|gpu| gpu.draw_cut(solid, look));
        })),
    });
    let local = |p: Pos2| Vec2::new(p.x - rect.left(), p.y - rect.top());
    if let (Some(p), Some(frame)) = (response.hover_pos(), bench.map())
        && !response.dragged()
        && let Some(t) = under(&body, &lens, plane, frame, local(p))
    {
        response.on_hover_text_at_pointer(describe(&body, t, frame));
    }
    if let (Some(plane), Some(frame)) = (plane, bench.map()) {
        let near = NEAR * bench.orbit.radius;
        let shown = (body.positions(frame), body.field == Field::Zone);
        contacts::draw(ui.painter(), rect, &lens, bench, shown, |p| {
            plane.height(p).abs() < near
        });
    }
    legend::ramp(ui.painter(), rect, bench, &body.legend());
    let reported = if bench.shown_map == bench.shown {
        String::new()
    } else {
        format!("solid of iteration {}", bench.shown_map)
    };
    let title = if body.cut.is_some() {
        "Cut open"
    } else {
        "Coloured"
    };
    let right = crossing(ui, rect, bench, &body);
    style::heading(ui.painter(), bench, rect, right, title, &reported);
    bench.body = Some(body);
}

/// How many inverted tetrahedra the plane meets; returns its left edge.
fn crossing(ui: &egui::Ui, rect: Rect, bench: &Bench, body: &Body) -> f32 {
    if body.cut.is_none() || body.inverted.is_empty() {
        return rect.right();
    }
    let met = body
        .met
        .iter()
        .filter(|t| body.inverted.binary_search(t).is_ok())
        .count();
    let words = format!("{} of them cut here", whole(met));
    let at = pos2(rect.right() - 14.0, rect.top() + 10.0);
    style::label(ui.painter(), bench, at, Align2::RIGHT_TOP, &words, true).left()
}

/// The tetrahedron under the pointer: on the face of the cut, else on the skin.
fn under(body: &Body, lens: &Lens, plane: Option<Plane>, frame: &[f32], at: Vec2) -> Option<usize> {
    if let Some(plane) = plane {
        let (near, far) = (lens.unproject(at, 0.5), lens.unproject(at, 0.9));
        let along = far - near;
        let p = near - along * (plane.height(near) / plane.normal.dot(along));
        if p.is_finite()
            && let Some(t) = body
                .met
                .iter()
                .rev()
                .find(|t| contains(body, **t as usize, frame, p))
        {
            return Some(*t as usize);
        }
    }
    let kept = |triangle: &[u32; 3]| {
        plane.is_none_or(|plane| {
            triangle
                .iter()
                .all(|&v| plane.height(Vec3::from_slice(&frame[3 * v as usize..])) <= 0.0)
        })
    };
    let (triangle, _) = triangle_at(lens, &body.solid.skin, frame, at)?;
    kept(&body.solid.skin[triangle]).then(|| body.solid.owners[triangle] as usize)
}

fn contains(body: &Body, t: usize, frame: &[f32], p: Vec3) -> bool {
    let [a, b, c, d] = corners(body.solid.tetrahedra[t], frame);
    let edges = DMat3::from_cols(b - a, c - a, d - a);
    let weights: DVec3 = edges.inverse() * (p.as_dvec3() - a);
    weights.min_element() >= -1e-6 && weights.element_sum() <= 1.0 + 1e-6
}

fn describe(body: &Body, t: usize, frame: &[f32]) -> String {
    let s = body.stretches(t, frame);
    let stress = body
        .stress(t, frame)
        .filter(|s| s.is_finite())
        .map(|s| format!("\nstress {} of the stiffness", number(f64::from(s), 3)))
        .unwrap_or_default();
    let zone = body
        .zone(t, frame)
        .map(|zone| format!("\nin zone {zone}"))
        .unwrap_or_default();
    let state = if s.smallest > 0.0 { "" } else { "\ninverted" };
    format!(
        "tetrahedron {}\nσ {}   {}   {} (relative)\nvolume {} of rest{stress}{zone}{state}",
        whole(t),
        number(s.largest, 3),
        number(s.middle, 3),
        number(s.smallest, 3),
        number(s.volume(), 3),
    )
}
