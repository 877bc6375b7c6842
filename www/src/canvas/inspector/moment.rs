//! The parts of a step of an untangling, one by one, and what is wrong after the one on show.

use eframe::egui::{Align2, Rect, Sense, Stroke, pos2};

use super::Column;
use crate::canvas::style;
use crate::history::{Fate, Moment, Part, PhaseKind, Record};
use crate::scale::{number, whole};
use crate::solid::contact::Contact;
use crate::words::{citation, explain, method_name};

/// A line about a part of the step.
struct Line<'a> {
    name: &'a str,
    count: String,
    symbol: &'a str,
    equation: &'a str,
    sentence: String,
    /// Milliseconds, where they are counted.
    time: Option<f64>,
    /// Whether this is the part on show.
    now: bool,
    /// Whether it is still to come.
    ahead: bool,
}

impl Column<'_> {
    /// The parts of the step on show.
    pub(super) fn moment(&mut self, record: &Record, moment: &Moment) {
        let source = format!("{}, {}", method_name("gini"), citation("gini"));
        if moment.part == Part::Start {
            self.section("The start", &source);
            self.words("No step has been made. Play, or make one step: it shows the parts of the method one by one.");
            self.rule();
            return;
        }
        self.section(&format!("Step {}", record.iteration), &source);
        let nouns = self.bench.nouns();
        let order = |part: Part| part as u32;
        let phase = |kind: PhaseKind| record.phases.iter().find(|p| p.kind == kind);
        for (part, kind) in [
            (Part::Local, PhaseKind::Local),
            (Part::Quadratic, PhaseKind::Global),
            (Part::Polish, PhaseKind::Evaluate),
        ] {
            let words = explain("gini", kind);
            let [at, of] = moment.polish;
            let count = match part {
                Part::Quadratic if moment.part == Part::Quadratic => {
                    format!("{at} of {}", moment.solves)
                }
                Part::Quadratic => format!("{} iterations", moment.solves),
                Part::Polish if moment.part == Part::Polish => format!("{at} of {of}"),
                Part::Polish => format!("{of} iterations"),
                _ => String::new(),
            };
            self.part(&Line {
                name: words.name,
                count,
                symbol: words.symbol,
                equation: words.equation,
                sentence: words.sentence(nouns),
                time: phase(kind).map(|p| p.milliseconds),
                now: moment.part == part,
                ahead: order(moment.part) < order(part),
            });
        }
        let (symbol, sentence) = match moment.fate {
            Fate::Reached => (
                "x moves there",
                "What was polished is handed out, since no element that is still inverted is worse than before.",
            ),
            Fate::Partway => (
                "x goes a part of the way",
                "Polishing ended with something wrong. What still collides, or would get worse, goes less far, everything else the whole way: of what is handed out still nothing crosses.",
            ),
            Fate::Stays => (
                "x stays",
                "Some element that is still inverted would be worse than before: what is handed out stays, and the constraints that were found stay for the next step.",
            ),
        };
        self.part(&Line {
            name: "Outcome",
            count: String::new(),
            symbol,
            equation: "section 5.1",
            sentence: sentence.into(),
            time: None,
            now: moment.part == Part::Outcome,
            ahead: order(moment.part) < order(Part::Outcome),
        });
        self.y += 2.0;
        self.counts(moment);
        self.rule();
    }

    fn part(&mut self, line: &Line) {
        let top = self.y;
        let height = self.line();
        let middle = top + 0.5 * height;
        let second = top + 1.45 * height;
        let bottom = top + 2.05 * height;
        let row = Rect::from_min_max(
            pos2(self.left - 8.0, top - 2.0),
            pos2(self.right + 8.0, bottom),
        );
        if line.now {
            let accent = style::colour(self.bench.theme.accent);
            self.painter()
                .rect_filled(row, 4.0, accent.gamma_multiply(0.10));
            let bar = [row.left_top(), row.left_bottom()];
            self.painter().line_segment(bar, Stroke::new(3.0, accent));
        }
        let name = self.text(
            self.left,
            middle,
            Align2::LEFT_CENTER,
            line.name,
            true,
            line.ahead,
        );
        if !line.count.is_empty() {
            self.text(
                name.right() + 8.0,
                middle,
                Align2::LEFT_CENTER,
                &line.count,
                false,
                true,
            );
        }
        if let Some(time) = line.time {
            let time = format!("{} ms", number(time, 2));
            self.text(
                self.right,
                middle,
                Align2::RIGHT_CENTER,
                &time,
                false,
                line.ahead,
            );
        }
        self.text(
            self.left,
            second,
            Align2::LEFT_CENTER,
            line.symbol,
            false,
            true,
        );
        self.text(
            self.right,
            second,
            Align2::RIGHT_CENTER,
            line.equation,
            false,
            true,
        );
        self.ui
            .interact(
                row,
                self.ui.scope_id().with((line.name, "part")),
                Sense::hover(),
            )
            .on_hover_text(&line.sentence);
        self.y = bottom + 5.0;
    }

    /// What is wrong now.
    fn counts(&mut self, moment: &Moment) {
        let elements = self.bench.nouns().elements;
        let [trial, result, primary] = moment.inverted.map(|n| whole(n as usize));
        self.pair(
            "inverted: polished",
            &trial,
            &format!("Inverted {elements} of what this step works on, x with a hat in the paper."),
        );
        self.pair("handed out", &result, &format!("Inverted {elements} of x, the state that is handed out: it moves only when none of them gets worse."));
        self.pair("primary solver", &primary, &format!("Inverted {elements} of the primary solver’s state, x with a bar in the paper: it may fold, and may unwind what polishing alone cannot."));
        let violated = moment.violated.map(|n| whole(n as usize));
        let violated = violated.unwrap_or_else(|| "not looked at".into());
        self.pair(
            "below η",
            &violated,
            &format!("{elements} with less measure than η, also those that are not inverted."),
        );
        let zones = match (moment.part, moment.zones) {
            (Part::Polish | Part::Outcome, zones) | (_, zones @ 1..) => whole(zones as usize),
            _ => "–".into(),
        };
        self.pair("zones", &zones, "Violated constraints that share vertices are one zone, and zones are polished apart; the colours tell them apart.");
        self.contacts(moment);
        let [all, active] = moment.constraints.map(|n| whole(n as usize));
        self.pair(
            "constraints, active",
            &format!("{all}, {active}"),
            "Of the quadratic problem; what is not active leaves the set after it.",
        );
        let [least, first] = moment.offset;
        let offset = match moment.reduced {
            0 => number(first, 2),
            reduced => format!(
                "{}, down to {} at {}",
                number(first, 2),
                number(least, 1),
                whole(reduced as usize)
            ),
        };
        self.pair("η (relative)", &offset, "The least measure that is asked for, relative to rest. It falls by itself where polishing ends with inverted elements: there it asks for more room than there is.");
        self.pair(
            "smallest measure",
            &number(moment.smallest, 3),
            "Of an element of what is handed out, relative to rest; below 0 inverted.",
        );
    }

    /// What must not pass through each other.
    fn contacts(&mut self, moment: &Moment) {
        let Some(meeting) = moment.meeting else {
            return;
        };
        self.pair(
            "pairs that cross",
            &whole(meeting as usize),
            "Facets of the boundary that meet where they should not, in what this step works on; exactly. In what is handed out none ever do.",
        );
        let Some(contacts) = self.bench.contacts() else {
            self.pair(
                "contacts",
                "no longer kept",
                "The history has grown too long to keep every state.",
            );
            return;
        };
        let (edges, corners): (Vec<&Contact>, Vec<&Contact>) =
            contacts.iter().partition(|c| c.edges);
        // the last state of the quadratic problem is the first of the polisher
        let [at, _] = moment.polish;
        let meaning = match moment.part {
            Part::Start | Part::Local => "",
            Part::Quadratic if at < moment.solves => {
                "Active ones push: their multipliers are above 0."
            }
            _ => {
                "Active ones still collide on the way from x to here, which is what is still wrong; the others did collide before, and stay constraints."
            }
        };
        for (name, list, hint) in [
            (
                "contacts ◆, active",
                corners,
                "Constraints between a vertex and a facet of the boundary: the vertex has to stay outside of it.",
            ),
            (
                "contacts ✕, active",
                edges,
                "Constraints between two edges of the boundary: the tetrahedron of air between them must not turn over.",
            ),
        ] {
            let active = list.iter().filter(|c| c.active).count();
            let words = format!("{}, {}", whole(list.len()), whole(active));
            self.pair(name, &words, format!("{hint} {meaning}").trim_end());
        }
    }
}
