//! The surface in 3D, with the checkerboard its map carries.

use eframe::egui::{self, Align2, Rect, Sense, pos2};
use glam::{Mat3, Vec2};

use super::bench::Bench;
use super::{gpu, style};
use crate::scale::whole;

/// Squares of the checkerboard along the side of a square of the surface's area.
const SQUARES: f32 = 18.0;

/// Draws the view and answers the pointer.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let response = ui.interact(rect, ui.scope_id().with("shape"), Sense::click_and_drag());
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

    let look = bench.look(ui.pixels_per_point());
    let matrix = bench.orbit.matrix(rect.aspect_ratio());
    let turn = Mat3::from_quat(bench.orbit.rotation);
    let squares = SQUARES
        / (bench.problem.rest.area() as f32)
            .max(f32::MIN_POSITIVE)
            .sqrt();
    ui.painter().add(egui::PaintCallback {
        rect,
        callback: std::sync::Arc::new(eframe::egui_glow::CallbackFn::new(move |_, _| {
            gpu::with(|gpu| gpu.draw_shape(matrix, turn, squares, look));
        })),
    });

    let triangles = bench.problem.indices.len() / 3;
    let size = if triangles > 0 {
        format!("{} triangles", whole(triangles))
    } else {
        String::new()
    };
    style::heading(ui.painter(), bench, rect, rect.right(), "Surface", &size);
    let hint = if bench.orbit.zoom > 1.5 {
        "double-click to fit"
    } else {
        ""
    };
    if !hint.is_empty() {
        style::label(
            ui.painter(),
            bench,
            pos2(rect.left() + 14.0, rect.bottom() - 12.0),
            Align2::LEFT_BOTTOM,
            hint,
            true,
        );
    }
}
