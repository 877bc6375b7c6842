//! α, μ and σ of locally injective mappings, step by step: three strips over one axis of iterations.

use eframe::egui::{self, Align2, Rect, Shape, Stroke, pos2, vec2};

use super::{Body, cut};
use crate::canvas::bench::Bench;
use crate::canvas::{legend, style};
use crate::colour::curve_style;
use crate::history::{LimStep, Record};
use crate::scale::{LogAxis, linear_ticks, number, power_of_ten};

/// A strip: its name, what it means, the value, and what zero means there.
struct Strip {
    name: &'static str,
    meaning: &'static str,
    value: fn(&LimStep) -> f64,
    zero: &'static str,
}

const STRIPS: [Strip; 4] = [
    Strip {
        name: "α",
        meaning: "pull of the handles",
        value: |lim| lim.alpha,
        zero: "",
    },
    Strip {
        name: "μ",
        meaning: "shift that made the matrix definite",
        value: |lim| lim.mu,
        zero: "0",
    },
    Strip {
        name: "σ",
        meaning: "part of the step that was gone",
        value: |lim| lim.sigma,
        zero: "0",
    },
    Strip {
        name: "‖Cv − d‖",
        meaning: "farthest handle from its target",
        value: |lim| lim.error,
        zero: "there",
    },
];

/// Draws the view: below the cut, where there is one.
pub fn show_with_cut(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let is_cut = |body: &Body| body.cut.is_some() && !body.solid.planar;
    if !bench.body.as_ref().is_some_and(is_cut) {
        return show(ui, rect, bench);
    }
    let (above, below) = rect.split_top_bottom_at_fraction(0.52);
    cut::show(ui, above, bench);
    show(ui, below, bench);
}

fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let painter = ui.painter().clone();
    let text = bench.text;
    let right = match &bench.body {
        Some(body) => legend::inverted_key(&painter, rect, bench, body.inverted.len()),
        None => rect.right(),
    };
    style::heading(&painter, bench, rect, right, "Parameters", "");
    let area = Rect::from_min_max(
        rect.min + vec2(54.0 * text, 36.0 * text),
        rect.max - vec2(20.0 * text, 26.0 * text),
    );
    if area.width() < 60.0 || area.height() < 80.0 {
        return;
    }
    let records = &bench.run.records;
    let first = records.first().map_or(0, |r| r.iteration);
    let end = f64::from(records.last().map_or(0, |r| r.iteration).max(first + 10));
    let x = |r: &Record| area.left() + area.width() * (f64::from(r.iteration) / end) as f32;
    let height = area.height() / STRIPS.len() as f32;
    for (i, strip) in STRIPS.iter().enumerate() {
        let top = area.top() + height * i as f32;
        let own = Rect::from_min_max(
            pos2(area.left(), top + 20.0 * text),
            pos2(area.right(), top + height - 8.0 * text),
        );
        draw(&painter, bench, own, strip, x);
    }
    axis(&painter, bench, area, end);
    if let Some(record) = bench.record() {
        let ink = style::colour(bench.theme.ink).gamma_multiply(0.5);
        let line = [pos2(x(record), area.top()), pos2(x(record), area.bottom())];
        painter.line_segment(line, Stroke::new(1.0, ink));
    }
}

/// The iterations, below all strips.
fn axis(painter: &egui::Painter, bench: &Bench, area: Rect, end: f64) {
    let quiet = style::colour(bench.theme.quiet);
    for value in linear_ticks(end, (area.width() / (80.0 * bench.text)) as usize) {
        let x = area.left() + area.width() * (value / end) as f32;
        painter.line_segment(
            [pos2(x, area.bottom()), pos2(x, area.bottom() + 4.0)],
            Stroke::new(1.0, quiet),
        );
        painter.text(
            pos2(x, area.bottom() + 6.0),
            Align2::CENTER_TOP,
            format!("{value}"),
            style::regular(style::SMALL * bench.text),
            quiet,
        );
    }
}

/// One strip, logarithmic, with a place for zero at its bottom.
fn draw(
    painter: &egui::Painter,
    bench: &Bench,
    area: Rect,
    strip: &Strip,
    x: impl Fn(&Record) -> f32,
) {
    let (theme, text) = (bench.theme, bench.text);
    let quiet = style::colour(theme.quiet);
    let font = style::regular(style::SMALL * text);
    let hair = Stroke::new(1.0, style::colour(theme.line));
    let now = bench.record().and_then(|r| r.lim);
    let value = now.map_or(String::new(), |lim| match (strip.value)(&lim) {
        0.0 => format!(
            " = {}",
            if strip.zero.is_empty() {
                "0"
            } else {
                strip.zero
            }
        ),
        value => format!(" = {}", number(value, 3)),
    });
    let name = format!("{}{value}", strip.name);
    let name = painter.text(
        pos2(area.left(), area.top() - 4.0),
        Align2::LEFT_BOTTOM,
        name,
        style::medium(style::SMALL * text),
        style::colour(theme.ink),
    );
    painter.text(
        pos2(name.right() + 8.0, name.center().y),
        Align2::LEFT_CENTER,
        strip.meaning,
        font.clone(),
        quiet,
    );
    // Iteration 0 is no step.
    let steps = || {
        let steps = bench.run.records.iter().filter(|r| r.iteration > 0);
        steps.filter_map(|r| Some((r, (strip.value)(r.lim.as_ref()?))))
    };
    let axis = LogAxis::over(steps().map(|(_, value)| value));
    let floor = if strip.zero.is_empty() {
        0.0
    } else {
        9.0 * text
    };
    let y = |value: f64| match axis.position(value) {
        Some(t) => area.bottom() - floor - t * (area.height() - floor),
        None => area.bottom(),
    };
    let mark = |at: f32, name: String| {
        painter.line_segment([pos2(area.left(), at), pos2(area.right(), at)], hair);
        painter.text(
            pos2(area.left() - 8.0, at),
            Align2::RIGHT_CENTER,
            name,
            font.clone(),
            quiet,
        );
    };
    if steps().any(|(_, value)| value > 0.0) {
        let rows = (area.height() / (24.0 * text)).floor().max(1.0) as usize;
        // None over another, nor over the name of zero.
        let mut below = area.bottom();
        for value in axis.ticks(rows) {
            if floor == 0.0 && below == area.bottom() || below - y(value) >= 11.0 * text {
                below = y(value);
                mark(below, power_of_ten(value));
            }
        }
    }
    if floor > 0.0 {
        mark(area.bottom(), strip.zero.into());
    }
    let ink = curve_style("lim");
    let ink = style::colour(if theme.dark { ink.dark } else { ink.light });
    let points: Vec<_> = steps().map(|(r, value)| pos2(x(r), y(value))).collect();
    let sparse = area.width() / points.len().max(1) as f32 > 6.0;
    if sparse {
        for point in &points {
            painter.circle_filled(*point, 2.0, ink);
        }
    }
    painter.add(Shape::line(points, Stroke::new(1.4, ink)));
}
