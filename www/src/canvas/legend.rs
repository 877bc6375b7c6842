//! Legends: the ramp of the colours, the count of what is inverted.

use eframe::egui::{self, Align2, Color32, Rect, Shape, Stroke, pos2, vec2};

use super::bench::Bench;
use super::style;
use crate::colour::{Rgb, VERMILION};
use crate::scale::whole;

/// What the colours of a view mean.
pub struct Legend {
    /// The quantity, with its symbol.
    pub caption: &'static str,
    /// The quantity, where room is short.
    pub short: &'static str,
    /// The colours.
    pub ramp: fn(f64) -> Rgb,
    /// Where on the ramp a value lies.
    pub position: fn(f64) -> f32,
    /// Values that are named.
    pub ticks: &'static [(f64, &'static str)],
    /// Whether the ramp is clamped at its upper end.
    pub clamped_above: bool,
    /// Whether the ramp is clamped at its lower end too.
    pub clamped_below: bool,
}

/// The ramp with its ticks and the mark of clamped values, at the lower left of a view; returns what it covers.
pub fn ramp(painter: &egui::Painter, rect: Rect, bench: &Bench, legend: &Legend) -> Rect {
    let (theme, text) = (bench.theme, bench.text);
    let small = || style::regular(style::SMALL * text);
    let quiet = style::colour(theme.quiet);
    let width = (0.36 * rect.width()).clamp(90.0, 190.0 * text);
    let bar_height = 9.0 * text;
    let cap = 16.0 * text;
    let left = rect.left() + 16.0 + if legend.clamped_below { cap } else { 0.0 };
    let bottom = rect.bottom() - 14.0 - 16.0 * text;
    let bar = Rect::from_min_max(pos2(left, bottom - bar_height), pos2(left + width, bottom));
    let above = Rect::from_min_size(bar.right_top(), vec2(cap, bar_height));
    let below = Rect::from_min_size(bar.left_top() - vec2(cap, 0.0), vec2(cap, bar_height));
    let caption = if rect.width() > 260.0 * text {
        legend.caption
    } else {
        legend.short
    };
    let ground = Rect::from_min_max(
        pos2(rect.left() + 8.0, bar.top() - 22.0 * text),
        pos2(
            (above.right() + 12.0).max(left + 205.0 * text),
            rect.bottom() - 8.0,
        ),
    );
    painter.rect_filled(
        ground,
        4.0,
        style::colour(theme.ground).gamma_multiply(0.85),
    );
    painter.text(
        pos2(rect.left() + 16.0, bar.top() - 4.0),
        Align2::LEFT_BOTTOM,
        caption,
        small(),
        quiet,
    );
    const STEPS: usize = 96;
    for i in 0..STEPS {
        let t = (i as f64 + 0.5) / STEPS as f64;
        let x = |k: usize| bar.left() + bar.width() * k as f32 / STEPS as f32;
        let cell = Rect::from_min_max(pos2(x(i), bar.top()), pos2(x(i + 1) + 0.5, bar.bottom()));
        painter.rect_filled(cell, 0.0, style::colour((legend.ramp)(t)));
    }
    if legend.clamped_above {
        clamped(painter, above, (legend.ramp)(1.0));
    }
    if legend.clamped_below {
        clamped(painter, below, (legend.ramp)(0.0));
    }
    for &(value, name) in legend.ticks {
        let x = bar.left() + bar.width() * (legend.position)(value);
        painter.line_segment(
            [pos2(x, bar.bottom()), pos2(x, bar.bottom() + 3.0)],
            Stroke::new(1.0, quiet),
        );
        let at = pos2(x, bar.bottom() + 4.0);
        painter.text(at, Align2::CENTER_TOP, name, small(), quiet);
    }
    ground
}

/// A swatch with the dots that mark values beyond the ramp.
fn clamped(painter: &egui::Painter, swatch: Rect, colour: Rgb) {
    painter.rect_filled(swatch, 0.0, style::colour(colour));
    let dark = colour.iter().map(|c| u32::from(*c)).sum::<u32>() < 300;
    let ink = if dark {
        Color32::from_rgb(235, 230, 220)
    } else {
        Color32::from_rgb(90, 72, 0)
    };
    for (i, j) in [(0, 0), (1, 1), (2, 0)] {
        let dot = swatch.min
            + vec2(
                swatch.width() * (i as f32 + 0.5) / 3.0,
                swatch.height() * (0.3 + 0.4 * j as f32),
            );
        painter.circle_filled(dot, 1.0, ink);
    }
}

/// How many are inverted, with their hatch; returns its left edge.
///
/// `drawn` is their number as drawn, for when the solver has not counted.
pub fn inverted_key(painter: &egui::Painter, rect: Rect, bench: &Bench, drawn: usize) -> f32 {
    let theme = bench.theme;
    let reported = bench.reported_inverted().map_or(drawn, |n| n as usize);
    let words = if reported == 0 {
        "none inverted".to_owned()
    } else {
        format!("{} inverted", whole(reported))
    };
    let ink = if reported == 0 {
        theme.quiet
    } else {
        theme.warn
    };
    count_key(painter, rect, bench, reported > 0, &words, ink)
}

/// A count of what is inverted in words, with the hatch if there is any; returns its left edge.
pub fn count_key(
    painter: &egui::Painter,
    rect: Rect,
    bench: &Bench,
    any: bool,
    words: &str,
    ink: Rgb,
) -> f32 {
    let (theme, text) = (bench.theme, bench.text);
    let at = pos2(rect.right() - 14.0, rect.top() + 10.0);
    let galley = painter.layout_no_wrap(
        words.to_owned(),
        style::medium(style::BODY * text),
        style::colour(ink),
    );
    let place = Align2::RIGHT_TOP.anchor_size(at, galley.size());
    painter.rect_filled(
        place.expand2(vec2(26.0 * text, 3.0)).intersect(rect),
        4.0,
        style::colour(theme.ground).gamma_multiply(0.8),
    );
    let middle = place.center().y;
    painter.galley(place.min, galley, style::colour(ink));
    let side = 13.0 * text;
    let key = Rect::from_center_size(
        pos2(place.left() - 0.5 * side - 7.0, middle),
        vec2(side, side),
    );
    if !any {
        return place.left() - 12.0;
    }
    painter.rect_filled(key, 0.0, Color32::from_rgb(255, 230, 209));
    let clip = painter.with_clip_rect(key);
    for k in -3..4 {
        let x = key.center().x + k as f32 * 5.0 * text;
        clip.add(Shape::line_segment(
            [
                pos2(x - side, key.center().y - side),
                pos2(x + side, key.center().y + side),
            ],
            Stroke::new(2.4 * text, style::colour(VERMILION)),
        ));
    }
    let outline = if theme.dark { theme.ink } else { theme.outline };
    painter.rect_stroke(
        key,
        0.0,
        Stroke::new(1.0, style::colour(outline)),
        egui::StrokeKind::Inside,
    );
    key.left() - 12.0
}
