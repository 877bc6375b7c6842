//! What is wrong with an untangled body, part by part of its steps: constraints that are violated, elements that are
//! inverted, facets of the boundary that cross (figure 1 of Overby et al. 2021, at its right).

use eframe::egui::{self, Align2, Color32, Pos2, Rect, Sense, Shape, Stroke, pos2, vec2};

use super::names;
use crate::canvas::bench::{Bench, Event};
use crate::canvas::style;
use crate::colour::{Rgb, curve_style};
use crate::history::{Moment, Part, Record};
use crate::scale::{LogAxis, power_of_ten, whole};
use crate::words::moment_name;

/// The least number of parts that the width has room for.
const LEAST_WIDTH: usize = 12;

/// A count, and how it is drawn.
struct Curve {
    name: &'static str,
    value: fn(&Moment) -> Option<u32>,
    ink: Color32,
    width: f32,
    dashed: bool,
}

/// Where things stand.
struct Place {
    area: Rect,
    axis: LogAxis,
    floor: f32,
    parts: usize,
}

impl Place {
    fn x(&self, index: usize) -> f32 {
        self.area.left() + self.area.width() * index as f32 / self.parts as f32
    }

    fn y(&self, count: u32) -> f32 {
        match self.axis.position(f64::from(count)) {
            Some(t) => self.area.bottom() - self.floor - t * (self.area.height() - self.floor),
            None => self.area.bottom(),
        }
    }
}

/// Draws the view and answers the pointer.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let painter = ui.painter().clone();
    let (theme, text) = (bench.theme, bench.text);
    let heading = style::heading(&painter, bench, rect, rect.right(), "Violations", "");
    let words = match bench.moment().and_then(|m| m.meeting) {
        Some(_) => format!("{} and pairs, log scale", bench.nouns().elements),
        None => format!("{}, log scale", bench.nouns().elements),
    };
    let words = format!("{words}, by iterations of the quadratic problem (QP) and the polisher");
    let at = pos2(heading.right() + 12.0, heading.center().y);
    style::label(&painter, bench, at, Align2::LEFT_CENTER, &words, true);
    let area = Rect::from_min_max(
        rect.min + vec2(54.0, 50.0) * text,
        rect.max - vec2((150.0 * text).min(0.36 * rect.width()), 12.0 * text),
    );
    if area.width() < 40.0 || area.height() < 30.0 {
        return;
    }
    let records = &bench.run.records;
    let own = curve_style("gini");
    let curves = [
        Curve {
            name: "below η",
            value: |m| m.violated,
            ink: style::colour(theme.quiet),
            width: 1.2,
            dashed: true,
        },
        Curve {
            name: "pairs that cross",
            value: |m| m.meeting,
            ink: style::colour(crossing(theme.dark)),
            width: 1.6,
            dashed: true,
        },
        Curve {
            name: "inverted, handed out",
            value: |m| Some(m.inverted[1]),
            ink: style::colour(if theme.dark { own.dark } else { own.light }),
            width: 2.4,
            dashed: false,
        },
        Curve {
            name: "inverted, polished",
            value: |m| Some(m.inverted[0]),
            ink: style::colour(theme.warn),
            width: 1.4,
            dashed: false,
        },
    ];
    let moments = || records.iter().filter_map(|r| r.moment.as_ref());
    let counts = moments().flat_map(|m| curves.iter().filter_map(|c| (c.value)(m).map(f64::from)));
    let place = Place {
        area,
        axis: LogAxis::over(counts.chain([1.0])),
        floor: 15.0 * text,
        parts: records.len().saturating_sub(1).max(LEAST_WIDTH),
    };
    axes(&painter, &place, bench);
    steps(&painter, &place, bench);
    polisher(&painter, &place, bench);
    let mut ends: Vec<(f32, &str, Color32)> = Vec::new();
    for curve in &curves {
        let points: Vec<Pos2> = records
            .iter()
            .enumerate()
            .filter_map(|(i, r)| {
                Some(pos2(
                    place.x(i),
                    place.y((curve.value)(r.moment.as_ref()?)?),
                ))
            })
            .collect();
        let Some(last) = points.last().copied() else {
            continue;
        };
        draw(&painter, &place, curve, points);
        ends.push((last.y, curve.name, curve.ink));
    }
    names::beside(&painter, area.right(), area.bottom(), &mut ends, text);
    answer(ui, rect, &place, bench);
}

/// The colour of pairs that cross: that of no solver and of no zone.
fn crossing(dark: bool) -> Rgb {
    if dark {
        [200, 150, 240]
    } else {
        [110, 50, 160]
    }
}

fn draw(painter: &egui::Painter, place: &Place, curve: &Curve, points: Vec<Pos2>) {
    let stroke = Stroke::new(curve.width, curve.ink);
    if place.area.width() / place.parts as f32 > 6.0 {
        for point in &points {
            painter.circle_filled(*point, 1.4 * curve.width, curve.ink);
        }
    }
    match curve.dashed {
        true => painter.extend(Shape::dashed_line(&points, stroke, 5.0, 3.0)),
        false => {
            painter.add(Shape::line(points, stroke));
        }
    }
}

fn axes(painter: &egui::Painter, place: &Place, bench: &Bench) {
    let (theme, text, area) = (bench.theme, bench.text, place.area);
    let font = style::regular(style::SMALL * text);
    let quiet = style::colour(theme.quiet);
    let hair = Stroke::new(1.0, style::colour(theme.line));
    let row = |y: f32, name: String| {
        painter.line_segment([pos2(area.left(), y), pos2(area.right(), y)], hair);
        let at = pos2(area.left() - 8.0, y);
        painter.text(at, Align2::RIGHT_CENTER, name, font.clone(), quiet);
    };
    let rows = (area.height() / (26.0 * text)).floor().max(2.0) as usize;
    for value in place.axis.ticks(rows) {
        row(place.y(value as u32), power_of_ten(value));
    }
    row(area.bottom(), "0".into());
}

/// A line where each step begins, with its number where there is room.
fn steps(painter: &egui::Painter, place: &Place, bench: &Bench) {
    let (theme, text, area) = (bench.theme, bench.text, place.area);
    let line = Stroke::new(1.0, style::colour(theme.quiet).gamma_multiply(0.45));
    let records = &bench.run.records;
    let mut free = f32::NEG_INFINITY;
    for (i, pair) in records.windows(2).enumerate() {
        if pair[0].iteration == pair[1].iteration {
            continue;
        }
        let x = place.x(i) + 0.5 * (place.x(i + 1) - place.x(i));
        painter.line_segment(
            [pos2(x, area.top() - 12.0 * text), pos2(x, area.bottom())],
            line,
        );
        let left = x + 4.0;
        if left < free {
            continue;
        }
        let name = painter.text(
            pos2(left, area.top() - 13.0 * text),
            Align2::LEFT_TOP,
            format!("step {}", pair[1].iteration),
            style::regular(style::SMALL * text),
            style::colour(theme.quiet),
        );
        free = name.right() + 8.0;
    }
}

/// A line where the polisher begins, after the last iteration of the quadratic problem; with names where there is room.
fn polisher(painter: &egui::Painter, place: &Place, bench: &Bench) {
    let (theme, text, area) = (bench.theme, bench.text, place.area);
    let stroke = Stroke::new(1.2, style::colour(theme.ink).gamma_multiply(0.75));
    let records = &bench.run.records;
    let part = |i: usize| records.get(i).and_then(|r| r.moment).map(|m| m.part);
    let mut begun = 0;
    let mut free = f32::NEG_INFINITY;
    for i in 0..records.len() {
        if part(i) == Some(Part::Local) {
            begun = i;
        }
        if part(i) != Some(Part::Quadratic) || part(i + 1) == Some(Part::Quadratic) {
            continue;
        }
        // of the newest step it is known where its quadratic problem ends
        if records[i].moment.is_some_and(|m| m.polish[0] < m.solves) {
            continue;
        }
        let (from, x) = (place.x(begun), place.x(i));
        if x - from < 5.0 && x < free {
            continue;
        }
        painter.line_segment([pos2(x, area.top()), pos2(x, area.bottom())], stroke);
        let name = |at: Pos2, anchor: Align2, name: &str| {
            let font = style::regular(style::SMALL * text);
            let quiet = style::colour(theme.quiet);
            let galley = painter.layout_no_wrap(name.into(), font, quiet);
            let room = anchor.anchor_size(at, galley.size());
            painter.rect_filled(room.expand(1.0), 2.0, style::colour(theme.ground));
            painter.galley(room.min, galley, quiet);
            room
        };
        let y = area.top() + 1.0;
        if x - from > 34.0 * text && from + 6.0 > free {
            name(pos2(x - 4.0, y), Align2::RIGHT_TOP, "QP");
        }
        if x + 4.0 > free {
            free = name(pos2(x + 4.0, y), Align2::LEFT_TOP, "polisher").right() + 4.0;
        }
    }
}

fn answer(ui: &mut egui::Ui, rect: Rect, place: &Place, bench: &mut Bench) {
    let area = place.area;
    let body = Rect::from_min_max(pos2(rect.left(), area.top() - 12.0), rect.max);
    let response = ui.interact(
        body,
        ui.scope_id().with("violations"),
        Sense::click_and_drag(),
    );
    let records = &bench.run.records;
    let nearest = |p: Pos2| {
        let part = (p.x - area.left()) / area.width() * place.parts as f32;
        (part.round().max(0.0) as usize).min(records.len().saturating_sub(1))
    };
    if (response.dragged() || response.clicked())
        && let Some(index) = response.interact_pointer_pos().map(nearest)
        && index != bench.shown
    {
        bench.events.push(Event::Show(index));
    }
    let (theme, x) = (bench.theme, place.x(bench.shown));
    let accent = style::colour(theme.accent);
    let Some(moment) = bench.moment() else { return };
    let painter = ui.painter();
    let ends = [pos2(x, area.top() - 4.0), pos2(x, area.bottom())];
    painter.line_segment(ends, Stroke::new(1.2, accent));
    let at = pos2(x, place.y(moment.inverted[0]));
    painter.circle_filled(at, 4.0, style::colour(theme.ground));
    painter.circle_stroke(at, 4.0, Stroke::new(2.0, accent));
    if let Some(p) = response.hover_pos()
        && let Some(words) = records.get(nearest(p)).and_then(describe)
    {
        response.on_hover_text_at_pointer(words);
    }
}

fn describe(record: &Record) -> Option<String> {
    let m = record.moment?;
    if m.part == Part::Start {
        return Some(format!(
            "the start\n{} inverted",
            whole(m.inverted[0] as usize)
        ));
    }
    let below = m.violated.map_or(String::new(), |violated| {
        let (violated, zones) = (whole(violated as usize), whole(m.zones as usize));
        format!("\n{violated} below η, zones: {zones}")
    });
    let crossing = m.meeting.map_or(String::new(), |pairs| {
        format!("\n{} pairs cross", whole(pairs as usize))
    });
    Some(format!(
        "step {}, {}\n{} inverted{below}{crossing}\n{} inverted in what is handed out",
        record.iteration,
        moment_name(&m),
        whole(m.inverted[0] as usize),
        whole(m.inverted[1] as usize),
    ))
}
