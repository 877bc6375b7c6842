//! The maps of the solvers that are compared, next to each other, in one window.

use eframe::egui::{self, Align2, FontId, Pos2, Rect, Sense, Stroke, pos2, vec2};
use glam::{Mat4, Vec2, Vec3};

use super::{Lane, key};
use crate::canvas::bench::Bench;
use crate::canvas::{gpu, legend, map, style};
use crate::distortion::{corners_of, triangle_at};
use crate::layout;
use crate::scale::{duration, number, whole};
use crate::words::method_name;

/// Draws the view and answers the pointer; returns the triangle under it.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) -> Option<usize> {
    let count = bench.race.as_ref().map_or(0, |race| race.lanes.len());
    let one = bench
        .alone
        .and(bench.race.as_ref())
        .map(|race| race.pane.min(count.saturating_sub(1)));
    let cells: Vec<(usize, Rect)> = match one {
        Some(index) if count > 0 => vec![(index, rect)],
        _ => layout::grid(count, rect.width(), rect.height())
            .iter()
            .map(|a| Rect::from_min_size(rect.min + vec2(a.x, a.y), vec2(a.w, a.h)))
            .enumerate()
            .collect(),
    };
    let size = cells.first().map_or(Vec2::ONE, |(_, cell)| {
        let inner = inside(*cell, bench.text);
        Vec2::new(inner.width(), inner.height()).max(Vec2::ONE)
    });
    let follow = if bench.reduced_motion { 1.0 } else { 0.35 };
    let goal = bench.race.as_ref().map(|race| race.fitting(size));
    if goal.is_some_and(|goal| bench.pan.follow(goal, follow)) {
        ui.ctx().request_repaint();
    }
    let mut found = None;
    for (index, cell) in &cells {
        let here = pane(ui, *cell, bench, *index, size);
        found = found.or(here);
    }
    let line = Stroke::new(1.0, style::colour(bench.theme.line));
    for (_, cell) in &cells {
        if cell.left() > rect.left() + 1.0 {
            ui.painter().vline(cell.left(), cell.y_range(), line);
        }
        if cell.top() > rect.top() + 1.0 {
            ui.painter().hline(cell.x_range(), cell.top(), line);
        }
    }
    found
}

/// Where the map itself stands in a pane: clear of its heading and of the legend.
fn inside(cell: Rect, text: f32) -> Rect {
    Rect::from_min_max(
        cell.min + vec2(4.0, 46.0 * text),
        cell.max - vec2(4.0, 48.0 * text),
    )
}

fn pane(
    ui: &mut egui::Ui,
    cell: Rect,
    bench: &mut Bench,
    index: usize,
    size: Vec2,
) -> Option<usize> {
    let inner = inside(cell, bench.text);
    let salt = ui.scope_id().with(("pane", index));
    let response = ui.interact(cell, salt, Sense::click_and_drag());
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
    let lane = bench.race.as_ref()?.lanes.get(index)?;
    let painter = ui.painter().with_clip_rect(cell);
    if lane.map().is_some() {
        draw(
            &painter,
            cell,
            inner,
            bench,
            index,
            size,
            ui.pixels_per_point(),
        );
        map::rings(&painter, inner, bench, lane.map(), &lane.inverted);
    }
    if index == 0 || bench.alone.is_some() {
        legend::ramp(&painter, cell, bench, &map::LEGEND);
    }
    heading(&painter, cell, bench, lane);
    if let Some(error) = &lane.error {
        message(&painter, inner, bench, lane, error);
    }
    let pointed = response.hover_pos().filter(|_| !response.dragged())?;
    let at = bench.pan.to_map(from_screen(pointed), size);
    let found = triangle_at(&bench.problem.indices, lane.map()?, at.to_array())?;
    if let Some(words) = describe(bench, found) {
        response.on_hover_text_at_pointer(words);
    }
    Some(found)
}

fn draw(
    painter: &egui::Painter,
    cell: Rect,
    inner: Rect,
    bench: &Bench,
    index: usize,
    size: Vec2,
    pixel: f32,
) {
    let half = Vec2::new(0.5 * cell.width(), 0.5 * cell.height());
    let scale = bench.pan.scale(size);
    let rise = (cell.center().y - inner.center().y) / half.y;
    let matrix = Mat4::from_translation(Vec3::new(0.0, rise, 0.0))
        * Mat4::from_scale(Vec3::new(scale / half.x, scale / half.y, 1.0))
        * Mat4::from_translation(-bench.pan.centre.extend(0.0));
    let look = bench.look(pixel);
    painter.add(egui::PaintCallback {
        rect: cell,
        callback: std::sync::Arc::new(eframe::egui_glow::CallbackFn::new(move |_, _| {
            gpu::with(|gpu| gpu.draw_pane(index, matrix, look));
        })),
    });
}

/// The method with its kind of line, its energy, its iteration, and what is inverted.
fn heading(painter: &egui::Painter, cell: Rect, bench: &Bench, lane: &Lane) {
    let (theme, text) = (bench.theme, bench.text);
    let ink = lane.ink(theme.dark);
    let top = cell.top() + 10.0;
    let middle = top + 0.62 * style::BODY * text;
    let left = cell.left() + 14.0;
    let ends = [pos2(left, middle), pos2(left + 28.0 * text, middle)];
    let Some(record) = lane.record() else {
        key(painter, ends, &lane.run.method, 2.4 * text, ink);
        let at = pos2(ends[1].x + 8.0, top);
        let font = style::medium(style::BODY * text);
        let name = method_name(&lane.run.method);
        painter.text(at, Align2::LEFT_TOP, name, font, ink);
        return;
    };
    let state = if record.inverted == 0 {
        ("none inverted".to_owned(), theme.quiet)
    } else {
        (
            format!("{} inverted", whole(record.inverted as usize)),
            theme.warn,
        )
    };
    let small = || style::regular(style::SMALL * text);
    legend::count_key(painter, cell, bench, record.inverted > 0, &state.0, state.1);
    key(painter, ends, &lane.run.method, 2.4 * text, ink);
    let at = pos2(ends[1].x + 8.0, top);
    let font = style::medium(style::BODY * text);
    painter.text(
        at,
        Align2::LEFT_TOP,
        method_name(&lane.run.method),
        font,
        ink,
    );
    let energy = format!("energy {}", number(record.energy, 6));
    let time = if bench.race.as_ref().is_some_and(|race| race.seconds) {
        format!(
            "iteration {}, {}",
            record.iteration,
            duration(record.seconds)
        )
    } else {
        format!("iteration {}", record.iteration)
    };
    let last = record.iteration > 0 && lane.shown + 1 == lane.run.records.len();
    let ended = if last && !lane.ending.is_empty() {
        format!(", {}", lane.ending)
    } else {
        String::new()
    };
    let second = top + 19.0 * text;
    let quiet = style::colour(theme.quiet);
    let room = cell.right() - 10.0 - left;
    let whole_line = format!("{energy} · {time}{ended}");
    let short = format!("{} · {time}{ended}", number(record.energy, 5));
    let lines = [whole_line, short, time];
    let fits = |words: &String| {
        painter
            .layout_no_wrap(words.clone(), small(), quiet)
            .size()
            .x
            <= room
    };
    let words = lines.iter().find(|words| fits(words)).unwrap_or(&lines[2]);
    painter.text(pos2(left, second), Align2::LEFT_TOP, words, small(), quiet);
    if let Some(switched) = record.switched_at {
        let then = lane.run.method.split('+').next_back().unwrap_or_default();
        let words = format!("{} since iteration {switched}", method_name(then));
        let at = pos2(cell.right() - 14.0, cell.bottom() - 12.0);
        painter.text(at, Align2::RIGHT_BOTTOM, words, small(), ink);
    }
}

/// What went wrong, in the middle of the pane.
fn message(painter: &egui::Painter, inner: Rect, bench: &Bench, lane: &Lane, error: &str) {
    let (theme, text) = (bench.theme, bench.text);
    let width = (inner.width() - 36.0).min(300.0 * text);
    let title = if lane.run.records.len() > 1 {
        format!("{} stopped", method_name(&lane.run.method))
    } else {
        format!("{} could not start", method_name(&lane.run.method))
    };
    let lay = |words: String, font: FontId, ink| painter.layout(words, font, ink, width);
    let (warn, ink) = (style::colour(theme.warn), style::colour(theme.ink));
    let title = lay(title, style::medium(style::BODY * text), warn);
    let words = lay(error.to_owned(), style::regular(style::SMALL * text), ink);
    let tall = title.size().y + 4.0 + words.size().y;
    let size = vec2(title.size().x.max(words.size().x), tall);
    let place = Rect::from_center_size(inner.center(), size);
    let ground = style::colour(theme.ground).gamma_multiply(0.9);
    painter.rect_filled(place.expand(12.0), 6.0, ground);
    painter.rect_stroke(
        place.expand(12.0),
        6.0,
        Stroke::new(1.0, style::colour(theme.line)),
        egui::StrokeKind::Inside,
    );
    let below = pos2(place.left(), place.top() + title.size().y + 4.0);
    painter.galley(place.min, title, warn);
    painter.galley(below, words, ink);
}

/// The stretch of a triangle in every map.
fn describe(bench: &Bench, t: usize) -> Option<String> {
    let triangle = bench.problem.indices.as_chunks::<3>().0.get(t)?;
    let lanes = bench.race.as_ref()?.lanes.iter();
    let lines = lanes.filter_map(|lane| {
        let stretch = bench
            .problem
            .rest
            .stretch(t, corners_of(triangle, lane.map()?));
        let state = if stretch.smallest > 0.0 {
            ""
        } else {
            ", inverted"
        };
        Some(format!(
            "\n{}: σ₁ {}   σ₂ {}{state}",
            method_name(&lane.run.method),
            number(stretch.largest, 4),
            number(stretch.smallest, 4)
        ))
    });
    Some(format!(
        "triangle {} (relative){}",
        whole(t),
        lines.collect::<String>()
    ))
}
