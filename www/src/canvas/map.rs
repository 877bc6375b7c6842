//! The map in 2D: distortion colours, what is inverted, and the legend.

use eframe::egui::{self, Align2, Pos2, Rect, Sense, Stroke, pos2, vec2};
use glam::{Mat4, Vec2, Vec3};

use super::bench::Bench;
use super::legend::{self, Legend};
use super::{gpu, style};
use crate::colour::{self, VERMILION};
use crate::distortion::{corners_of, triangle_at};
use crate::outline::meeting;
use crate::scale::{number, whole};

/// Inverted triangles that get a ring when too small to see, at most.
const MOST_RINGS: usize = 80;

/// Crosses drawn where the boundary meets itself, at most.
const MOST_CROSSES: usize = 200;

pub(super) const LEGEND: Legend = Legend {
    caption: "stretch or squeeze, max(σ₁, 1/σ₂)",
    short: "stretch or squeeze",
    ramp: colour::cividis,
    position: |value| colour::ramp_position(value) as f32,
    ticks: &[
        (1.0, "1"),
        (1.5, "1.5"),
        (2.0, "2"),
        (3.0, "3"),
        (4.0, "4+"),
    ],
    clamped_above: true,
    clamped_below: false,
};

/// Draws the view and answers the pointer; returns the triangle under it.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) -> Option<usize> {
    // The map keeps clear of the heading and the legend.
    let text = bench.text;
    let inner = Rect::from_min_max(
        rect.min + vec2(0.0, 30.0 * text),
        rect.max - vec2(0.0, 52.0 * text),
    );
    let size = Vec2::new(inner.width(), inner.height()).max(Vec2::ONE);
    let response = ui.interact(rect, ui.scope_id().with("map"), Sense::click_and_drag());
    let from_screen = |p: Pos2| Vec2::new(p.x - inner.center().x, inner.center().y - p.y);
    if response.dragged() {
        let d = response.drag_delta();
        bench.pan.drag(Vec2::new(d.x, -d.y), size);
    }
    if response.double_clicked() {
        bench.pan.follows = true;
    }
    if let Some(p) = response.hover_pos() {
        let (zoom, scroll) = ui.input(|i| (i.zoom_delta(), i.smooth_scroll_delta.y));
        let factor = zoom * (scroll * 0.004).exp();
        if factor != 1.0 {
            bench.pan.magnify(factor, from_screen(p), size);
        }
    }
    let rate = if bench.reduced_motion || bench.shown == 0 {
        1.0
    } else {
        0.35
    };
    if bench.pan.follow(bench.fitting(size), rate) {
        ui.ctx().request_repaint();
    }

    let scale = bench.pan.scale(size);
    let half = Vec2::new(0.5 * rect.width(), 0.5 * rect.height());
    let rise = (rect.center().y - inner.center().y) / half.y;
    let matrix = Mat4::from_translation(Vec3::new(0.0, rise, 0.0))
        * Mat4::from_scale(Vec3::new(scale / half.x, scale / half.y, 1.0))
        * Mat4::from_translation(-bench.pan.centre.extend(0.0));
    let look = bench.look(ui.pixels_per_point());
    ui.painter().add(egui::PaintCallback {
        rect,
        callback: std::sync::Arc::new(eframe::egui_glow::CallbackFn::new(move |_, _| {
            gpu::with(|gpu| gpu.draw_map(matrix, look));
        })),
    });

    rings(ui.painter(), inner, bench, bench.map(), &bench.inverted);
    crossings(ui.painter(), inner, bench, size);
    let found = response
        .hover_pos()
        .filter(|_| !response.dragged())
        .and_then(|p| pick(bench, bench.pan.to_map(from_screen(p), size)));
    if let Some(text) = found.and_then(|t| describe(bench, t)) {
        response.on_hover_text_at_pointer(text);
    }
    legend::ramp(ui.painter(), rect, bench, &LEGEND);
    crossings_key(ui.painter(), rect, bench);
    let right = legend::inverted_key(ui.painter(), rect, bench, bench.inverted.len());
    let away = if bench.pan.follows {
        String::new()
    } else {
        "double-click to fit".into()
    };
    let dropped = if bench.thinning > 1 && bench.pan.follows {
        format!(
            "1 in {} triangles drawn: it covers itself {} times",
            bench.thinning, bench.layers
        )
    } else if bench.shown_map == bench.shown {
        away
    } else {
        format!(
            "map of iteration {} (older ones are thinned out)",
            bench.shown_map
        )
    };
    style::heading(ui.painter(), bench, rect, right, "Map", &dropped);
    found
}

fn pick(bench: &Bench, p: Vec2) -> Option<usize> {
    triangle_at(&bench.problem.indices, bench.map()?, p.to_array())
}

fn describe(bench: &Bench, t: usize) -> Option<String> {
    let triangle = bench.problem.indices.as_chunks::<3>().0.get(t)?;
    let stretch = bench
        .problem
        .rest
        .stretch(t, corners_of(triangle, bench.map()?));
    let state = if stretch.smallest > 0.0 {
        ""
    } else {
        "\ninverted"
    };
    Some(format!(
        "triangle {}\nσ₁ {}   σ₂ {} (relative){state}",
        whole(t),
        number(stretch.largest, 4),
        number(stretch.smallest, 4)
    ))
}

/// Rings around inverted triangles too small to be seen.
pub(super) fn rings(
    painter: &egui::Painter,
    rect: Rect,
    bench: &Bench,
    map: Option<&[f32]>,
    inverted: &[u32],
) {
    let Some(map) = map else { return };
    if inverted.is_empty() || inverted.len() > MOST_RINGS {
        return;
    }
    let size = Vec2::new(rect.width(), rect.height()).max(Vec2::ONE);
    let triangles = bench.problem.indices.as_chunks::<3>().0;
    for &t in inverted {
        let corners = corners_of(&triangles[t as usize], map)
            .map(|c| bench.pan.to_view(Vec2::from_array(c), size));
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let reach = corners
            .iter()
            .map(|c| c.distance(centre))
            .fold(0.0, f32::max);
        if reach < 7.0 {
            let at = rect.center() + vec2(centre.x, -centre.y);
            painter.circle_stroke(
                at,
                8.0,
                Stroke::new(3.5, style::colour(bench.theme.ground).gamma_multiply(0.8)),
            );
            painter.circle_stroke(at, 8.0, Stroke::new(1.6, style::colour(VERMILION)));
        }
    }
}

/// A cross wherever the boundary of the newest map meets itself.
fn crossings(painter: &egui::Painter, rect: Rect, bench: &Bench, size: Vec2) {
    let newest = bench.shown + 1 == bench.run.records.len();
    let Some(map) = bench
        .map()
        .filter(|_| newest && !bench.crossings.is_empty())
    else {
        return;
    };
    for edges in bench.crossings.iter().take(MOST_CROSSES) {
        let at = bench
            .pan
            .to_view(Vec2::from_array(meeting(edges, map)), size);
        let at = rect.center() + vec2(at.x, -at.y);
        for (width, ink) in [(4.5, bench.theme.ground), (1.8, VERMILION)] {
            for arm in [vec2(4.5, 4.5), vec2(4.5, -4.5)] {
                painter.line_segment([at - arm, at + arm], Stroke::new(width, style::colour(ink)));
            }
        }
    }
}

/// How often the boundary of the newest map meets itself.
fn crossings_key(painter: &egui::Painter, rect: Rect, bench: &Bench) {
    let newest = bench.shown + 1 == bench.run.records.len();
    if !newest || bench.crossings.is_empty() {
        return;
    }
    let words = match bench.crossings.len() {
        1 => "boundary crosses itself once".to_owned(),
        n => format!("boundary crosses itself {} times", whole(n)),
    };
    let at = pos2(rect.right() - 14.0, rect.top() + 10.0 + 19.0 * bench.text);
    let font = style::regular(style::SMALL * bench.text);
    let place = painter.text(
        at,
        Align2::RIGHT_TOP,
        words,
        font,
        style::colour(bench.theme.warn),
    );
    let middle = pos2(place.left() - 9.0, place.center().y);
    for arm in [vec2(3.5, 3.5), vec2(3.5, -3.5)] {
        painter.line_segment(
            [middle - arm, middle + arm],
            Stroke::new(1.8, style::colour(VERMILION)),
        );
    }
}
