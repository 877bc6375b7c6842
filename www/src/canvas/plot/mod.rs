//! Energy, worst distortion and inverted elements against iteration or time, on a log scale; the worst
//! stretch of a solid on a log scale of its own, at the right.

mod inversions;
mod names;
pub(super) mod switch;
pub(super) mod violations;

use eframe::egui::{self, Align2, Color32, Pos2, Rect, Sense, Shape, Stroke, pos2, vec2};

use super::bench::{Bench, Event, PlotHeight};
use super::style;
use crate::colour::{CurveStyle, curve_style};
use crate::history::Record;
use crate::scale::{LogAxis, linear_ticks, number, power_of_ten, time_tick};
use crate::words::energy_caption;

/// The least relative gap that is drawn.
const LEAST_GAP: f64 = 1e-12;

/// Energies of a solid below this part of the greatest are drawn at the bottom.
const LEAST_OF_MOST: f64 = 1e-9;

/// Where things stand in a plot.
pub(super) struct Frame {
    /// Inside the axes.
    pub area: Rect,
    /// The height.
    pub axis: LogAxis,
    /// Where the width ends.
    pub end: f64,
    /// Whether the width is seconds.
    pub seconds: bool,
    /// The energy from which gaps count, where gaps are plotted.
    pub gap: Option<f64>,
    /// Room below the axis for what is zero.
    pub floor: f32,
    /// Where the axis of the worst stretch ends, where it has one of its own; it begins at 1.
    pub stretch: Option<f64>,
}

/// The ends an axis of stretches may have; their square roots are round, too.
const STRETCH_ENDS: [f64; 7] = [1.21, 1.44, 2.25, 4.0, 9.0, 25.0, 100.0];

impl Frame {
    pub fn x(&self, record: &Record) -> f32 {
        let value = if self.seconds {
            record.seconds
        } else {
            f64::from(record.iteration)
        };
        self.area.left() + self.area.width() * (value / self.end).clamp(0.0, 1.0) as f32
    }

    pub fn y(&self, value: f64) -> Option<f32> {
        self.axis
            .position(value)
            .map(|t| self.area.bottom() - self.floor - t * (self.area.height() - self.floor))
    }

    /// Height of a worst distortion, on its own axis if it has one.
    fn worst(&self, value: f64) -> Option<f32> {
        let Some(end) = self.stretch else {
            return self.y(value);
        };
        let t = (value.max(1.0).ln() / end.ln()).min(1.0) as f32;
        Some(self.area.bottom() - self.floor - t * (self.area.height() - self.floor))
    }

    fn energy(&self, record: &Record) -> Option<f64> {
        let value = match self.gap {
            None => record.energy,
            Some(lowest) => (record.energy - lowest) / lowest.abs().max(1e-300),
        };
        let least = if self.gap.is_some() {
            LEAST_GAP
        } else {
            f64::MIN_POSITIVE
        };
        (value.is_finite() && value >= least).then_some(value)
    }

    /// A curve of the records, at most one point a pixel (the worst of them), broken where undefined.
    pub fn curve(
        &self,
        records: &[Record],
        height: impl Fn(&Record) -> Option<f32>,
    ) -> Vec<Vec<Pos2>> {
        let mut pieces: Vec<Vec<Pos2>> = vec![Vec::new()];
        for record in records {
            let point = height(record).map(|y| pos2(self.x(record), y));
            match (point, pieces.last_mut()) {
                (Some(p), Some(piece)) => match piece.last_mut() {
                    Some(last)
                        if piece_is_dense(records.len(), self.area.width())
                            && (p.x - last.x).abs() < 0.7 =>
                    {
                        last.y = last.y.min(p.y);
                    }
                    _ => piece.push(p),
                },
                (None, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
                _ => {}
            }
        }
        pieces
    }
}

fn piece_is_dense(count: usize, width: f32) -> bool {
    count as f32 > 1.2 * width
}

/// Draws the view and answers the pointer.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let painter = ui.painter().clone();
    let (theme, text) = (bench.theme, bench.text);
    let names = if bench.body.is_some() { 142.0 } else { 112.0 };
    let margin = [54.0 * text, 34.0 * text, names * text, 26.0 * text];
    let area = Rect::from_min_max(
        rect.min + vec2(margin[0], margin[1]),
        rect.max - vec2(margin[2].min(0.3 * rect.width()), margin[3]),
    );
    heading(ui, rect, bench);
    if area.width() < 40.0 || area.height() < 30.0 {
        return;
    }
    let frame = frame(bench, area);
    axes(&painter, &frame, bench);

    for run in &bench.earlier {
        let style = curve_style(&run.method);
        draw(
            &painter,
            &frame.curve(&run.records, |r| frame.energy(r).and_then(|v| frame.y(v))),
            style,
            1.2,
            theme.dark,
            0.75,
        );
    }
    let records = &bench.run.records;
    let mut ends: Vec<(f32, &str, Color32)> = Vec::new();
    if frame.gap.is_none() {
        let quiet = style::colour(theme.quiet);
        let worst = frame.curve(records, |r| {
            Some(r.worst_distortion())
                .filter(|v| v.is_finite())
                .and_then(|v| frame.worst(v))
        });
        for piece in &worst {
            painter.extend(Shape::dashed_line(piece, Stroke::new(1.2, quiet), 5.0, 3.0));
        }
        if let Some(p) = worst.iter().rev().find_map(|piece| piece.last()) {
            ends.push((p.y, bench.nouns().worst, quiet));
        }
        inversions::steps(&painter, &frame, records);
        if let Some(last) = records.last() {
            let y = frame.y(f64::from(last.inverted)).unwrap_or(area.bottom());
            ends.push((y, "inverted", style::colour(theme.warn)));
        }
    }
    let own = curve_style(&bench.run.method);
    let curves = frame.curve(records, |r| frame.energy(r).and_then(|v| frame.y(v)));
    draw(&painter, &curves, own, 2.0, theme.dark, 1.0);
    if let Some(p) = curves.iter().rev().find_map(|piece| piece.last()) {
        let ink = if theme.dark { own.dark } else { own.light };
        ends.push((p.y, "energy", style::colour(ink)));
    }
    if frame.gap.is_none() {
        let ticks = if frame.stretch.is_some() {
            34.0 * text
        } else {
            0.0
        };
        names::beside(
            &painter,
            area.right() + ticks,
            area.bottom(),
            &mut ends,
            text,
        );
    } else {
        names::of_methods(&painter, &frame, bench);
    }
    let y = |r: &Record| frame.energy(r).and_then(|v| frame.y(v));
    switch::mark(&painter, &frame, bench, records, y);
    cursor(ui, rect, &frame, bench);
}

fn heading(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let end = style::heading(ui.painter(), bench, rect, rect.right(), "Convergence", "");
    let gap = bench.plot_height == PlotHeight::Gap;
    let vertical = if gap && bench.lowest_energy().is_none() {
        "(E − lowest) / lowest, once nothing is inverted"
    } else if gap {
        "(E − lowest) / lowest"
    } else {
        energy_caption(&bench.energy, bench.body.is_some())
    };
    let horizontal = if bench.plot_seconds {
        "seconds"
    } else {
        "iterations"
    };
    let x = toggle(
        ui,
        bench,
        pos2(end.right() + 12.0, end.center().y),
        vertical,
        "What the height is: the values, or how far above the lowest energy any run has reached here (E)",
    );
    if x.1 {
        bench.plot_height = bench.plot_height.other();
    }
    let by = style::label(
        ui.painter(),
        bench,
        pos2(x.0 + 6.0, end.center().y),
        Align2::LEFT_CENTER,
        "by",
        true,
    );
    let x = toggle(
        ui,
        bench,
        pos2(by.right() + 6.0, end.center().y),
        horizontal,
        "What the width is: iterations, or seconds of solving (X)",
    );
    if x.1 {
        bench.plot_seconds = !bench.plot_seconds;
    }
}

/// Text that can be clicked; returns its right end and whether it was.
pub(super) fn toggle(
    ui: &mut egui::Ui,
    bench: &Bench,
    at: Pos2,
    text: &str,
    hint: &str,
) -> (f32, bool) {
    let font = style::regular(style::SMALL * bench.text);
    let galley =
        ui.painter()
            .layout_no_wrap(text.to_owned(), font, style::colour(bench.theme.accent));
    let rect = Align2::LEFT_CENTER.anchor_size(at, galley.size());
    let response = ui
        .interact(rect.expand(4.0), ui.scope_id().with(hint), Sense::click())
        .on_hover_text(hint);
    if response.hovered() {
        ui.ctx().set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    let line = Stroke::new(1.0, style::colour(bench.theme.accent).gamma_multiply(0.4));
    ui.painter()
        .line_segment([rect.left_bottom(), rect.right_bottom()], line);
    ui.painter()
        .galley(rect.min, galley, style::colour(bench.theme.accent));
    (rect.right(), response.clicked())
}

fn frame(bench: &Bench, area: Rect) -> Frame {
    let runs = || bench.earlier.iter().chain([&bench.run]);
    let last = |value: fn(&Record) -> f64| {
        runs()
            .filter_map(|run| run.records.last())
            .map(value)
            .fold(0.0, f64::max)
    };
    let seconds = bench.plot_seconds;
    let end = if seconds {
        last(|r| r.seconds).max(1e-3)
    } else {
        last(|r| f64::from(r.iteration)).max(10.0)
    };
    let gap = (bench.plot_height == PlotHeight::Gap)
        .then(|| bench.lowest_energy())
        .flatten();
    let mut frame = Frame {
        area,
        axis: LogAxis::over([1.0]),
        end,
        seconds,
        gap,
        floor: 0.0,
        stretch: None,
    };
    let mut values: Vec<f64> = runs()
        .flat_map(|run| run.records.iter().filter_map(|r| frame.energy(r)))
        .collect();
    if bench.body.is_some() && gap.is_none() {
        // What is zero but for rounding (a solid at rest) does not stretch the axis.
        let most = values.iter().copied().fold(0.0, f64::max);
        values.retain(|v| *v >= LEAST_OF_MOST * most);
    }
    if gap.is_none() {
        frame.floor = 17.0 * bench.text;
        let records = &bench.run.records;
        values.extend(records.iter().map(|r| f64::from(r.inverted)));
        let worst = records.iter().map(Record::worst_distortion);
        if bench.body.is_some() {
            // Next to energies of many decades a stretch between 1 and 2 would be a flat line.
            let most = worst.filter(|v| v.is_finite()).reduce(f64::max);
            let end = |most| STRETCH_ENDS.into_iter().find(|end| *end >= most);
            frame.stretch =
                most.map(|most| end(most).unwrap_or(STRETCH_ENDS[STRETCH_ENDS.len() - 1]));
        } else {
            values.extend(worst);
        }
    }
    frame.axis = LogAxis::over(values);
    frame
}

pub(super) fn axes(painter: &egui::Painter, frame: &Frame, bench: &Bench) {
    let (theme, text) = (bench.theme, bench.text);
    let font = style::regular(style::SMALL * text);
    let quiet = style::colour(theme.quiet);
    let hair = Stroke::new(1.0, style::colour(theme.line));
    let area = frame.area;
    let rows = (area.height() / (26.0 * text)).floor().max(2.0) as usize;
    for value in frame.axis.ticks(rows) {
        if let Some(y) = frame.y(value) {
            painter.line_segment([pos2(area.left(), y), pos2(area.right(), y)], hair);
            painter.text(
                pos2(area.left() - 8.0, y),
                Align2::RIGHT_CENTER,
                power_of_ten(value),
                font.clone(),
                quiet,
            );
        }
    }
    if let Some(end) = frame.stretch {
        let middle = format!("{}", (100.0 * end.sqrt()).round() / 100.0);
        for (value, name) in [(1.0, "1"), (end.sqrt(), &middle), (end, &format!("{end}"))] {
            if let Some(y) = frame.worst(value) {
                painter.line_segment(
                    [pos2(area.right(), y), pos2(area.right() + 4.0, y)],
                    Stroke::new(1.0, quiet),
                );
                painter.text(
                    pos2(area.right() + 7.0, y),
                    Align2::LEFT_CENTER,
                    name,
                    font.clone(),
                    quiet,
                );
            }
        }
    }
    if frame.floor > 0.0 {
        let y = area.bottom();
        painter.line_segment([pos2(area.left(), y), pos2(area.right(), y)], hair);
        painter.text(
            pos2(area.left() - 8.0, y),
            Align2::RIGHT_CENTER,
            "0",
            font.clone(),
            quiet,
        );
    }
    for value in linear_ticks(frame.end, (area.width() / (90.0 * text)) as usize) {
        let x = area.left() + area.width() * (value / frame.end) as f32;
        painter.line_segment(
            [pos2(x, area.bottom()), pos2(x, area.bottom() + 4.0)],
            Stroke::new(1.0, quiet),
        );
        let name = if frame.seconds {
            time_tick(value, frame.end)
        } else {
            format!("{value}")
        };
        painter.text(
            pos2(x, area.bottom() + 6.0),
            Align2::CENTER_TOP,
            name,
            font.clone(),
            quiet,
        );
    }
}

pub(super) fn draw(
    painter: &egui::Painter,
    pieces: &[Vec<Pos2>],
    style: CurveStyle,
    width: f32,
    dark: bool,
    opacity: f32,
) {
    let ink = style::colour(if dark { style.dark } else { style.light }).gamma_multiply(opacity);
    let stroke = Stroke::new(width, ink);
    for piece in pieces {
        if let [only] = piece.as_slice() {
            painter.circle_filled(*only, 1.3 * width, ink);
        } else if style.dash.is_empty() {
            painter.add(Shape::line(piece.clone(), stroke));
        } else {
            let (dashes, gaps): (Vec<f32>, Vec<f32>) = style
                .dash
                .as_chunks::<2>()
                .0
                .iter()
                .map(|[d, g]| (*d, *g))
                .unzip();
            painter.extend(Shape::dashed_line_with_offset(
                piece, stroke, &dashes, &gaps, 0.0,
            ));
        }
    }
}

fn cursor(ui: &mut egui::Ui, rect: Rect, frame: &Frame, bench: &mut Bench) {
    let body = Rect::from_min_max(pos2(rect.left(), frame.area.top() - 8.0), rect.max);
    let response = ui.interact(body, ui.scope_id().with("plot"), Sense::click_and_drag());
    let records = &bench.run.records;
    let nearest = |p: Pos2| {
        let after = records.partition_point(|r| frame.x(r) < p.x);
        let closer = |i: &usize| {
            records
                .get(*i)
                .map_or(f32::MAX, |r| (frame.x(r) - p.x).abs())
        };
        [
            after.saturating_sub(1),
            after.min(records.len().saturating_sub(1)),
        ]
        .into_iter()
        .min_by(|a, b| closer(a).total_cmp(&closer(b)))
    };
    if (response.dragged() || response.clicked())
        && let Some(index) = response.interact_pointer_pos().and_then(nearest)
        && index != bench.shown
    {
        bench.events.push(Event::Show(index));
    }
    let Some(record) = bench.record() else { return };
    let (theme, x) = (bench.theme, frame.x(record));
    let painter = ui.painter();
    let line = Stroke::new(1.2, style::colour(theme.accent));
    painter.line_segment(
        [
            pos2(x, frame.area.top() - 4.0),
            pos2(x, frame.area.bottom()),
        ],
        line,
    );
    if let Some(y) = frame.energy(record).and_then(|v| frame.y(v)) {
        painter.circle_filled(pos2(x, y), 4.0, style::colour(theme.ground));
        painter.circle_stroke(
            pos2(x, y),
            4.0,
            Stroke::new(2.0, style::colour(theme.accent)),
        );
    }
    if let Some(p) = response.hover_pos()
        && let Some(r) = nearest(p).and_then(|i| records.get(i))
    {
        let x = frame.x(r);
        let faint = Stroke::new(1.0, style::colour(theme.quiet).gamma_multiply(0.5));
        painter.line_segment(
            [pos2(x, frame.area.top()), pos2(x, frame.area.bottom())],
            faint,
        );
        let worst = number(r.worst_distortion(), 4);
        let text = format!(
            "iteration {} · {} s\nenergy {}\n{} {worst}\n{} inverted",
            r.iteration,
            number(r.seconds, 3),
            number(r.energy, 6),
            bench.nouns().worst,
            r.inverted
        );
        response.on_hover_text_at_pointer(text);
    }
}
