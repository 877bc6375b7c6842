//! Pins, targets and the rubber band over a solid.

use eframe::egui::{self, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, vec2};
use glam::{Vec2, Vec3};

use super::{Body, Grab};
use crate::canvas::bench::Bench;
use crate::canvas::style;
use crate::colour::curve_style;
use crate::solid::pick::{Lens, nearest_in_front};

/// Handles of more vertices than this have a square of their own in their middle.
const FEW: usize = 3;

/// How near a pointer must come to a square, in points.
const REACH: f32 = 11.0;

fn at(positions: &[f32], v: u32) -> Vec3 {
    Vec3::from_slice(&positions[3 * v as usize..])
}

/// The middle of a handle.
pub fn middle(handle: &[u32], positions: &[f32]) -> Vec3 {
    handle.iter().map(|&v| at(positions, v)).sum::<Vec3>() / handle.len().max(1) as f32
}

/// The handle under the pointer, and where its grasped point is in the model.
pub fn under(body: &Body, lens: &Lens, positions: &[f32], pointer: Vec2) -> Option<(usize, Vec3)> {
    let middles = (0u32..)
        .zip(&body.handles)
        .filter(|(_, handle)| handle.len() > FEW)
        .map(|(i, handle)| (i, middle(handle, positions)));
    if let Some(i) = nearest_in_front(lens, middles, pointer, REACH + 2.0) {
        let i = i as usize;
        return Some((i, middle(&body.handles[i], positions)));
    }
    let vertices = body
        .handles
        .iter()
        .flatten()
        .map(|&v| (v, at(positions, v)));
    let vertex = nearest_in_front(lens, vertices, pointer, REACH)?;
    let i = body.handles.iter().position(|h| h.contains(&vertex))?;
    Some((i, at(positions, vertex)))
}

/// Draws pins as filled squares, targets as open circles with a line to their vertex.
pub fn draw(
    painter: &Painter,
    rect: Rect,
    lens: &Lens,
    bench: &Bench,
    body: &Body,
    positions: &[f32],
) {
    let theme = bench.theme;
    let place = |p: Vec3| {
        let (at, _) = lens.project(p);
        rect.min + vec2(at.x, at.y)
    };
    let accent = style::colour(theme.accent);
    let ground = style::colour(theme.ground);
    let newest = bench.shown + 1 == bench.run.records.len();
    let outside = |v: &&u32| body.solid.outside.binary_search(v).is_ok();
    // Squares on every vertex of the skin would hide what is inside.
    let shown = if all_is_held(bench, body) {
        &[]
    } else {
        body.handles.as_slice()
    };
    for (i, handle) in shown.iter().enumerate() {
        let few = handle.len() <= FEW;
        let side = match few {
            true => 9.0,
            false if bench.is_untangling() => 2.6,
            false => 3.6,
        };
        for &v in handle.iter().filter(outside) {
            let square = Rect::from_center_size(place(at(positions, v)), vec2(side, side));
            if few {
                painter.rect_filled(square.expand(1.5), 0.0, ground);
            }
            painter.rect_filled(square, 0.0, accent);
        }
        let centre = place(middle(handle, positions));
        if !few && (!bench.is_untangling() || body.movable) {
            let square = Rect::from_center_size(centre, vec2(13.0, 13.0));
            painter.rect_filled(square.expand(2.0), 0.0, ground);
            painter.rect_filled(square, 0.0, accent);
        }
        if body.selected == Some(i) {
            let ring = Rect::from_center_size(centre, vec2(23.0, 23.0));
            painter.rect_stroke(ring, 2.0, Stroke::new(3.5, ground), StrokeKind::Middle);
            painter.rect_stroke(ring, 2.0, Stroke::new(1.6, accent), StrokeKind::Middle);
        }
    }
    if newest {
        targets(painter, body, positions, bench, place);
        sub_targets(painter, body, positions, bench, place);
    }
    if let Some(v) = body.cursor {
        let ring = place(at(positions, v));
        painter.circle_stroke(ring, 9.0, Stroke::new(4.0, ground));
        painter.circle_stroke(ring, 9.0, Stroke::new(2.2, accent));
    }
    if let Some(v) = body.over.filter(|_| body.grab.is_none()) {
        let ring = place(at(positions, v));
        painter.circle_stroke(ring, 6.0, Stroke::new(3.0, ground));
        painter.circle_stroke(ring, 6.0, Stroke::new(1.4, style::colour(theme.ink)));
    }
}

/// Whether all of the outside of a body is held while it is untangled.
pub fn all_is_held(bench: &Bench, body: &Body) -> bool {
    let held = body.handles.iter().flatten();
    let outside = held.filter(|v| body.solid.outside.binary_search(v).is_ok());
    bench.is_untangling() && !body.movable && outside.count() == body.solid.outside.len()
}

/// One mark for a handle of many vertices, one a vertex elsewhere.
fn targets(
    painter: &Painter,
    body: &Body,
    positions: &[f32],
    bench: &Bench,
    place: impl Fn(Vec3) -> Pos2,
) {
    let ink = style::colour(bench.theme.ink);
    let ground = style::colour(bench.theme.ground);
    let mark = |from: Vec3, to: Vec3| {
        let (from, to) = (place(from), place(to));
        if from.distance(to) > 3.5 {
            painter.line_segment([from, to], Stroke::new(1.0, ink));
            painter.circle(to, 4.5, ground, Stroke::new(1.4, ink));
        }
    };
    // Targets come handle by handle, then those of single vertices.
    let mut rest = body.targets.as_slice();
    for handle in &body.handles {
        let (own, after) = rest.split_at(handle.len().min(rest.len()));
        rest = after;
        if own.len() > FEW {
            let sum: Vec3 = own.iter().map(|(_, target)| *target).sum();
            mark(middle(handle, positions), sum / own.len() as f32);
        } else {
            own.iter().for_each(|(v, to)| mark(at(positions, *v), *to));
        }
    }
    rest.iter().for_each(|(v, to)| mark(at(positions, *v), *to));
}

/// Where the newest step led handles that are not there yet, between where they are and their targets: one small
/// circle a handle, in the colour of the method.
fn sub_targets(
    painter: &Painter,
    body: &Body,
    positions: &[f32],
    bench: &Bench,
    place: impl Fn(Vec3) -> Pos2,
) {
    let ink = curve_style("lim");
    let ink = style::colour(if bench.theme.dark {
        ink.dark
    } else {
        ink.light
    });
    let ground = style::colour(bench.theme.ground);
    for handle in &body.handles {
        let own = |v: u32| body.sub_targets.iter().find(|(w, _)| *w == v);
        let pairs: Vec<(Vec3, Vec3)> = handle
            .iter()
            .filter_map(|&v| own(v).map(|(_, to)| (at(positions, v), *to)))
            .collect();
        if pairs.is_empty() {
            continue;
        }
        let count = pairs.len() as f32;
        let from: Vec3 = pairs.iter().map(|(from, _)| *from).sum::<Vec3>() / count;
        let to: Vec3 = pairs.iter().map(|(_, to)| *to).sum::<Vec3>() / count;
        let (from, to) = (place(from), place(to));
        painter.line_segment([from, to], Stroke::new(1.6, ink));
        painter.circle(to, 3.6, ground, Stroke::new(1.8, ink));
    }
}

/// Draws the rubber band.
pub fn rubber(painter: &Painter, ui: &egui::Ui, bench: &Bench, body: &Body) {
    let Some(Grab::Box(from)) = body.grab else {
        return;
    };
    let Some(to) = ui.input(|i| i.pointer.latest_pos()) else {
        return;
    };
    let band = Rect::from_two_pos(from, to);
    let accent = style::colour(bench.theme.accent);
    painter.rect_filled(band, 0.0, accent.gamma_multiply(0.12));
    let corners = [
        band.left_top(),
        band.right_top(),
        band.right_bottom(),
        band.left_bottom(),
        band.left_top(),
    ];
    painter.extend(Shape::dashed_line(
        &corners,
        Stroke::new(1.3, accent),
        5.0,
        3.0,
    ));
}

/// Draws where the plane of the cut stands: its outline in the bounding box at rest.
pub fn plane_outline(painter: &Painter, rect: Rect, lens: &Lens, bench: &Bench, body: &Body) {
    let Some(cut) = body.cut else { return };
    let (low, high) = (body.solid.low, body.solid.high);
    let margin = 0.06 * (high - low).max_element();
    let (low, high) = (low - margin, high + margin);
    let level = body.solid.low[cut.axis] + cut.at * (body.solid.high - body.solid.low)[cut.axis];
    let (u, v) = ((cut.axis + 1) % 3, (cut.axis + 2) % 3);
    let corner = |on_u: Vec3, on_v: Vec3| {
        let mut p = Vec3::ZERO;
        p[cut.axis] = level;
        p[u] = on_u[u];
        p[v] = on_v[v];
        let (at, _) = lens.project(p);
        rect.min + vec2(at.x, at.y)
    };
    let corners = [
        corner(low, low),
        corner(high, low),
        corner(high, high),
        corner(low, high),
        corner(low, low),
    ];
    let stroke = Stroke::new(1.0, style::colour(bench.theme.quiet).gamma_multiply(0.8));
    painter.extend(Shape::dashed_line(&corners, stroke, 4.0, 4.0));
    // Its name stands under its lowest corner, which sticks out of the solid.
    let Some(corner) = corners.into_iter().max_by(|a, b| a.y.total_cmp(&b.y)) else {
        return;
    };
    let name = ["cut across x", "cut across y", "cut across z"][cut.axis.min(2)];
    let (x, y) = (corner.x, corner.y + 12.0);
    let at = egui::pos2(
        x.clamp(rect.left() + 14.0, rect.right() - 82.0),
        y.clamp(rect.top() + 34.0, rect.bottom() - 34.0),
    );
    style::label(painter, bench, at, egui::Align2::LEFT_TOP, name, true);
}
