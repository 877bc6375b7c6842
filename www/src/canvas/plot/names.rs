//! Names at the ends of the curves, none over another.

use eframe::egui::{self, Align2, Color32, Rect, pos2, vec2};

use super::Frame;
use crate::canvas::bench::Bench;
use crate::canvas::style;
use crate::colour::curve_style;
use crate::words::method_name;

/// Methods' names where their curves end (when only energies are plotted), none over another.
pub fn of_methods(painter: &egui::Painter, frame: &Frame, bench: &Bench) {
    let mut taken: Vec<Rect> = Vec::new();
    for run in [&bench.run].into_iter().chain(&bench.earlier) {
        let end = run.records.iter().rev().find_map(|r| {
            let y = frame.energy(r).and_then(|v| frame.y(v))?;
            Some(pos2(frame.x(r) + 6.0, y))
        });
        let Some(at) = end else { continue };
        let ink = curve_style(&run.method);
        let ink = style::colour(if bench.theme.dark {
            ink.dark
        } else {
            ink.light
        });
        let font = style::regular(style::SMALL * bench.text);
        let galley = painter.layout_no_wrap(method_name(&run.method).to_owned(), font, ink);
        let mut rect = Align2::LEFT_CENTER.anchor_size(at, galley.size());
        while let Some(other) = taken.iter().find(|other| other.intersects(rect)) {
            rect = rect.translate(vec2(0.0, other.top() - rect.bottom() - 1.0));
        }
        painter.rect_filled(rect, 2.0, style::colour(bench.theme.ground));
        painter.galley(rect.min, galley, ink);
        taken.push(rect);
    }
}

/// Names at the ends of the curves, moved apart until none overlaps.
pub fn beside(
    painter: &egui::Painter,
    left: f32,
    bottom: f32,
    ends: &mut [(f32, &str, Color32)],
    text: f32,
) {
    let height = 14.0 * text;
    ends.sort_by(|a, b| a.0.total_cmp(&b.0));
    for i in 1..ends.len() {
        ends[i].0 = ends[i].0.max(ends[i - 1].0 + height);
    }
    let low = bottom + 4.0;
    for i in (0..ends.len()).rev() {
        let most = if i + 1 < ends.len() {
            ends[i + 1].0 - height
        } else {
            low
        };
        ends[i].0 = ends[i].0.min(most);
    }
    for (y, name, ink) in ends.iter() {
        painter.text(
            pos2(left + 8.0, *y),
            Align2::LEFT_CENTER,
            *name,
            style::regular(style::SMALL * text),
            *ink,
        );
    }
}
