//! Where a hybrid went over to its second method.

use eframe::egui::{self, Align2, Color32, Pos2, Shape, Stroke, pos2, vec2};

use super::Frame;
use crate::canvas::bench::Bench;
use crate::canvas::style;
use crate::colour::curve_style;
use crate::history::Record;
use crate::words::method_name;

/// A diamond on a hybrid's curve, where its second method began, with that method's name.
pub fn mark(
    painter: &egui::Painter,
    frame: &Frame,
    bench: &Bench,
    records: &[Record],
    height: impl Fn(&Record) -> Option<f32>,
) {
    let Some(last) = records.last().and_then(|r| r.switched_at) else {
        return;
    };
    let begun = records.iter().find(|r| r.iteration == last);
    let Some((record, y)) = begun.and_then(|r| Some((r, height(r)?))) else {
        return;
    };
    let at = pos2(frame.x(record), y);
    let own = curve_style(&bench.run.method);
    let ink = style::colour(if bench.theme.dark {
        own.dark
    } else {
        own.light
    });
    let then = bench.run.method.split('+').next_back().unwrap_or_default();
    diamond(painter, at, ink, style::colour(bench.theme.ground));
    let words = format!("{} begins", method_name(then));
    style::label(
        painter,
        bench,
        at - vec2(0.0, 24.0 * bench.text),
        Align2::CENTER_CENTER,
        &words,
        true,
    );
}

/// A small diamond with a soft rim.
pub fn diamond(painter: &egui::Painter, at: Pos2, ink: Color32, ground: Color32) {
    for (reach, fill) in [(7.0, ground), (5.0, ink)] {
        let corners = [
            vec2(0.0, -reach),
            vec2(reach, 0.0),
            vec2(0.0, reach),
            vec2(-reach, 0.0),
        ];
        let corners = corners.map(|corner| at + corner).to_vec();
        painter.add(Shape::convex_polygon(corners, fill, Stroke::NONE));
    }
}
