//! How far each of the solvers is above the lowest energy, against iterations or seconds, on a log scale.

use eframe::egui::{self, Align2, Pos2, Rect, Sense, Stroke, pos2, vec2};

use super::{Lane, Race, key};
use crate::canvas::bench::{Bench, Event, PlotHeight};
use crate::canvas::plot::{self, Frame, switch};
use crate::canvas::style;
use crate::colour::curve_style;
use crate::history::Record;
use crate::scale::{LogAxis, duration, number};
use crate::words::{energy_caption, method_name};

/// The least gap that is told from none: energies of order 1 are sums of thousands of rounded terms.
const LEAST_GAP: f64 = 1e-13;

/// A gap in words: what is less than rounding is none.
pub fn gap_words(gap: f64) -> String {
    number(if gap > LEAST_GAP { gap } else { 0.0 }, 3)
}

/// Whether gaps are plotted: they are wanted, and there is something to count them from.
fn plots_gaps(bench: &Bench, race: &Race) -> bool {
    bench.plot_height == PlotHeight::Gap && race.best.is_some()
}

/// Draws the view and answers the pointer.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let painter = ui.painter().clone();
    let text = bench.text;
    heading(ui, rect, bench);
    let Some(race) = &bench.race else { return };
    let top = legend(&painter, rect, bench, race);
    let area = Rect::from_min_max(
        pos2(rect.left() + 58.0 * text, top),
        rect.max - vec2(26.0 * text, 26.0 * text),
    );
    if area.width() < 40.0 || area.height() < 30.0 {
        return;
    }
    let frame = frame(bench, race, area);
    plot::axes(&painter, &frame, bench);
    for lane in &race.lanes {
        let pieces = frame.curve(&lane.run.records, |r| height(bench, race, &frame, r));
        let own = curve_style(&lane.run.method);
        plot::draw(&painter, &pieces, own, 2.0, bench.theme.dark, 1.0);
    }
    for lane in &race.lanes {
        let Some(record) = begun_at(lane) else {
            continue;
        };
        if let Some(y) = height(bench, race, &frame, record) {
            let at = pos2(frame.x(record), y);
            let ground = style::colour(bench.theme.ground);
            switch::diamond(&painter, at, lane.ink(bench.theme.dark), ground);
        }
    }
    if let Some(at) = cursor(ui, rect, &frame, bench, race) {
        bench.events.push(Event::Moment(at));
    }
}

/// The iterate with which a hybrid's second method began.
fn begun_at(lane: &Lane) -> Option<&Record> {
    let at = lane.run.records.last()?.switched_at?;
    lane.run.records.iter().find(|r| r.iteration == at)
}

/// Height of a record: its gap, or its energy; what is at the lowest lies on the floor.
fn height(bench: &Bench, race: &Race, frame: &Frame, record: &Record) -> Option<f32> {
    if !plots_gaps(bench, race) {
        return frame.y(Some(record.energy).filter(|e| e.is_finite())?);
    }
    let gap = race.gap(record)?;
    if gap > LEAST_GAP {
        frame.y(gap)
    } else {
        Some(frame.area.bottom())
    }
}

fn frame(bench: &Bench, race: &Race, area: Rect) -> Frame {
    let records = || race.lanes.iter().flat_map(|lane| &lane.run.records);
    let seconds = bench.plot_seconds;
    let end = if seconds {
        records().map(|r| r.seconds).fold(1e-3, f64::max)
    } else {
        records()
            .map(|r| f64::from(r.iteration))
            .fold(10.0, f64::max)
    };
    let gaps = plots_gaps(bench, race);
    let values = records().filter_map(|r| match gaps {
        true => race.gap(r).filter(|gap| *gap > LEAST_GAP),
        false => Some(r.energy).filter(|e| e.is_finite()),
    });
    Frame {
        area,
        axis: LogAxis::over(values),
        end,
        seconds,
        gap: None,
        floor: if gaps { 17.0 * bench.text } else { 0.0 },
        stretch: None,
    }
}

fn heading(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let end = style::heading(ui.painter(), bench, rect, rect.right(), "Convergence", "");
    let race = bench.race.as_ref();
    let (begun, settled) = race.map_or((false, false), |race| (race.best.is_some(), race.settled));
    let vertical = match (bench.plot_height, begun, settled) {
        (PlotHeight::Values, ..) => energy_caption(&bench.energy, false),
        (PlotHeight::Gap, false, _) => "energy, until a map has no inversions",
        (PlotHeight::Gap, true, true) => "E − E*",
        (PlotHeight::Gap, true, false) => "E − lowest so far",
    };
    let hint = "What the height is: how far the energy is above E*, the lowest that any of them has reached, or the energy itself (E)";
    let (right, flipped) = plot::toggle(
        ui,
        bench,
        pos2(end.right() + 12.0, end.center().y),
        vertical,
        hint,
    );
    if flipped {
        bench.plot_height = bench.plot_height.other();
    }
    let at = pos2(right + 6.0, end.center().y);
    let by = style::label(ui.painter(), bench, at, Align2::LEFT_CENTER, "by", true);
    let horizontal = if bench.plot_seconds {
        "seconds"
    } else {
        "iterations"
    };
    let hint = "What the width is: iterations, or seconds of solving (X)";
    let at = pos2(by.right() + 6.0, end.center().y);
    if plot::toggle(ui, bench, at, horizontal, hint).1 {
        bench.plot_seconds = !bench.plot_seconds;
    }
}

/// The methods with their kinds of line: beside the heading, or below it where that is too narrow; returns where
/// the plot may begin.
fn legend(painter: &egui::Painter, rect: Rect, bench: &Bench, race: &Race) -> f32 {
    let text = bench.text;
    let font = || style::regular(style::SMALL * text);
    let line = 26.0 * text;
    let names: Vec<_> = race
        .lanes
        .iter()
        .map(|lane| {
            let name = method_name(&lane.run.method).to_owned();
            painter.layout_no_wrap(name, font(), lane.ink(bench.theme.dark))
        })
        .collect();
    let width = |galley: &egui::Galley| line + 6.0 + galley.size().x + 16.0 * text;
    let total: f32 = names.iter().map(|name| width(name)).sum::<f32>() - 16.0 * text;
    let beside = rect.width() - total > 340.0 * text;
    let first = rect.top() + 10.0 + 0.62 * style::BODY * text;
    let (mut x, y) = if beside {
        (rect.right() - 26.0 * text - total, first)
    } else {
        (rect.left() + 14.0, first + 20.0 * text)
    };
    for (lane, name) in race.lanes.iter().zip(names) {
        let ink = lane.ink(bench.theme.dark);
        key(
            painter,
            [pos2(x, y), pos2(x + line, y)],
            &lane.run.method,
            2.0,
            ink,
        );
        let at = pos2(x + line + 6.0, y - 0.5 * name.size().y);
        x += width(&name);
        painter.galley(at, name, ink);
    }
    rect.top() + (if beside { 38.0 } else { 56.0 }) * text
}

/// The time on the clock and each solver's iterate at it; a drag chooses another time, which is returned.
fn cursor(ui: &egui::Ui, rect: Rect, frame: &Frame, bench: &Bench, race: &Race) -> Option<f64> {
    let area = frame.area;
    let salt = ui.scope_id().with("curves");
    let response = ui.interact(
        area.expand(8.0).intersect(rect),
        salt,
        Sense::click_and_drag(),
    );
    let on_clock = frame.seconds == race.seconds;
    let value = |p: Pos2| {
        let part = ((p.x - area.left()) / area.width()).clamp(0.0, 1.0);
        f64::from(part) * frame.end
    };
    let theme = bench.theme;
    if on_clock && !race.lanes.is_empty() {
        let x = area.left() + area.width() * (race.at / frame.end).clamp(0.0, 1.0) as f32;
        let line = Stroke::new(1.2, style::colour(theme.accent).gamma_multiply(0.8));
        ui.painter()
            .line_segment([pos2(x, area.top() - 4.0), pos2(x, area.bottom())], line);
    }
    for lane in &race.lanes {
        let Some(record) = lane.record() else {
            continue;
        };
        let Some(y) = height(bench, race, frame, record) else {
            continue;
        };
        let at = pos2(frame.x(record), y);
        let ink = lane.ink(theme.dark);
        ui.painter()
            .circle_filled(at, 4.5, style::colour(theme.ground));
        ui.painter().circle_stroke(at, 4.5, Stroke::new(2.2, ink));
    }
    if let Some(p) = response.hover_pos() {
        let x = value(p);
        let words = if frame.seconds {
            duration(x)
        } else {
            format!("iteration {}", x.round())
        };
        let lines = race.lanes.iter().filter_map(|lane| {
            let record = at(lane, frame.seconds, x)?;
            let gap = race.gap(record).map_or("–".into(), gap_words);
            let name = method_name(&lane.run.method);
            Some(format!(
                "\n{name}: {}, {gap} above",
                number(record.energy, 6)
            ))
        });
        let words = words + &lines.collect::<String>();
        response.clone().on_hover_text_at_pointer(words);
    }
    let moved = response.dragged() || response.clicked();
    let x = value(response.interact_pointer_pos().filter(|_| moved)?);
    if on_clock {
        return Some(x);
    }
    // By another clock than the one that runs: the time at which the solver nearest to the pointer was there.
    let p = response.interact_pointer_pos()?;
    let candidates = race.lanes.iter().filter_map(|lane| {
        let record = at(lane, frame.seconds, x)?;
        let y = height(bench, race, frame, record)?;
        Some(((y - p.y).abs(), race.time(record)))
    });
    candidates
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, time)| time)
}

/// The newest record of a solver at a time.
fn at(lane: &Lane, seconds: bool, time: f64) -> Option<&Record> {
    let records = &lane.run.records;
    let after = records.partition_point(|r| {
        let value = if seconds {
            r.seconds
        } else {
            f64::from(r.iteration) - 0.5
        };
        value <= time
    });
    records.get(after.saturating_sub(1))
}
