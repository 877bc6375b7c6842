//! The count of inverted elements in a plot.

use eframe::egui::{self, Pos2, Shape, Stroke, pos2};

use super::Frame;
use crate::canvas::style;
use crate::colour::VERMILION;
use crate::history::Record;

/// The count of inverted elements as a stepped line with a dot at every iterate while they are few.
pub fn steps(painter: &egui::Painter, frame: &Frame, records: &[Record]) {
    let ink = style::colour(VERMILION);
    let place = |r: &Record| {
        pos2(
            frame.x(r),
            frame
                .y(f64::from(r.inverted))
                .unwrap_or(frame.area.bottom()),
        )
    };
    let mut line: Vec<Pos2> = Vec::new();
    for record in records {
        let p = place(record);
        if let Some(last) = line.last().copied() {
            if last.y == p.y && line.len() > 1 && line[line.len() - 2].y == p.y {
                line.pop();
            } else if last.y != p.y {
                line.push(pos2(p.x, last.y));
            }
        }
        line.push(p);
    }
    painter.add(Shape::line(line, Stroke::new(1.2, ink)));
    if frame.area.width() / (records.len().max(1) as f32) > 7.0 {
        for record in records {
            painter.circle_filled(place(record), 2.4, ink);
        }
    }
}
