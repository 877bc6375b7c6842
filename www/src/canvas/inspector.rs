//! What the step on show did, its numbers, and the problem.

mod moment;

use eframe::egui::{self, Align2, Rect, Sense, Stroke, pos2, vec2};

use super::bench::Bench;
use super::style;
use crate::colour::curve_style;
use crate::history::{LimStep, Phase, PhaseKind};
use crate::scale::number;
use crate::words::{citation, explain, handover, method_name, stage};

/// Writes lines from the top down.
pub(super) struct Column<'a> {
    ui: &'a mut egui::Ui,
    bench: &'a Bench,
    pub(super) left: f32,
    pub(super) right: f32,
    pub(super) y: f32,
}

/// Draws the view.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let mut clear = false;
    egui::ScrollArea::vertical()
        .auto_shrink(false)
        .show(ui, |ui| {
            let top = ui.cursor().top();
            let mut column = Column::new(ui, bench, rect, top + 10.0);
            column.step();
            column.iterate();
            clear = column.runs();
            column.facts();
            let used = column.y - top;
            ui.allocate_space(vec2(rect.width() - 4.0, used));
        });
    if clear {
        bench.earlier.clear();
    }
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters
        .next()
        .map(|first| first.to_uppercase().chain(letters).collect())
        .unwrap_or_default()
}

impl<'a> Column<'a> {
    pub(super) fn new(ui: &'a mut egui::Ui, bench: &'a Bench, rect: Rect, y: f32) -> Self {
        Self {
            ui,
            bench,
            left: rect.left() + 16.0,
            right: rect.right() - 16.0,
            y,
        }
    }

    pub(super) fn painter(&self) -> &egui::Painter {
        self.ui.painter()
    }

    pub(super) fn text(
        &self,
        x: f32,
        y: f32,
        anchor: Align2,
        text: &str,
        medium: bool,
        quiet: bool,
    ) -> Rect {
        let theme = self.bench.theme;
        let size = self.bench.text * if quiet { style::SMALL } else { style::BODY };
        let font = if medium {
            style::medium(size)
        } else {
            style::regular(size)
        };
        self.ui.painter().text(
            pos2(x, y),
            anchor,
            text,
            font,
            style::colour(if quiet { theme.quiet } else { theme.ink }),
        )
    }

    pub(super) fn line(&self) -> f32 {
        19.0 * self.bench.text
    }

    pub(super) fn section(&mut self, title: &str, rest: &str) {
        let end = self.text(self.left, self.y, Align2::LEFT_TOP, title, true, false);
        if !rest.is_empty() {
            self.text(
                self.right,
                end.center().y,
                Align2::RIGHT_CENTER,
                rest,
                false,
                true,
            );
        }
        self.y = end.bottom() + 6.0;
    }

    pub(super) fn rule(&mut self) {
        self.y += 6.0;
        let stroke = Stroke::new(1.0, style::colour(self.bench.theme.line));
        self.ui
            .painter()
            .line_segment([pos2(self.left, self.y), pos2(self.right, self.y)], stroke);
        self.y += 11.0;
    }

    pub(super) fn pair(&mut self, name: &str, value: &str, hint: &str) {
        let middle = self.y + 0.5 * self.line();
        let room = self.right - self.left;
        let first = self.text(self.left, middle, Align2::LEFT_CENTER, name, false, true);
        let font = style::regular(style::BODY * self.bench.text);
        let ink = style::colour(self.bench.theme.ink);
        let width = room - first.width() - 14.0;
        let mut job = egui::text::LayoutJob::simple(value.to_owned(), font, ink, width);
        job.halign = egui::Align::RIGHT;
        let galley = self.ui.painter().layout_job(job);
        let tall = galley.size().y.max(self.line() - 2.0);
        let at = pos2(self.right, middle - 0.5 * galley.size().y.min(self.line()));
        self.ui.painter().galley(at, galley, ink);
        if !hint.is_empty() {
            let row = Rect::from_min_max(pos2(self.left, self.y), pos2(self.right, self.y + tall));
            self.ui
                .interact(row, self.ui.scope_id().with((name, "pair")), Sense::hover())
                .on_hover_text(hint);
        }
        self.y += tall + 2.0;
    }

    /// The phases of the iteration on show.
    fn step(&mut self) {
        let nouns = self.bench.nouns();
        let run = self.bench.run.method.as_str();
        let Some(record) = self.bench.record() else {
            self.section("This step", "");
            return;
        };
        if let Some(moment) = &record.moment {
            return self.moment(record, moment);
        }
        if record.iteration == 0 {
            self.section(
                "The start",
                &format!("{}, {}", method_name(run), citation(run)),
            );
            self.words("No step has been made. Play or step to see what an iteration does.");
            self.rule();
            return;
        }
        let method = stage(run, record.iteration, record.switched_at);
        let title = format!("Iteration {}", record.iteration);
        self.section(
            &title,
            &format!("{}, {}", method_name(method), citation(method)),
        );
        let total: f64 = record.phases.iter().map(|p| p.milliseconds).sum();
        let done = |p: &&Phase| p.count > 0 || p.kind != PhaseKind::Reweight;
        for phase in record.phases.iter().filter(done) {
            let words = explain(method, phase.kind);
            let top = self.y;
            let line = self.line();
            let time = if phase.milliseconds > 0.0 {
                format!("{} ms", number(phase.milliseconds, 2))
            } else {
                "–".into()
            };
            let middle = top + 0.5 * line;
            let name = self.text(
                self.left,
                middle,
                Align2::LEFT_CENTER,
                words.name,
                true,
                false,
            );
            if let Some(unit) = words.unit {
                let count = format!("{} {}", phase.count, unit[usize::from(phase.count != 1)]);
                self.text(
                    name.right() + 8.0,
                    middle,
                    Align2::LEFT_CENTER,
                    &count,
                    false,
                    true,
                );
            }
            self.text(
                self.right,
                middle,
                Align2::RIGHT_CENTER,
                &time,
                false,
                false,
            );
            let second = top + 1.45 * line;
            self.text(
                self.left,
                second,
                Align2::LEFT_CENTER,
                words.symbol,
                false,
                true,
            );
            self.text(
                self.right,
                second,
                Align2::RIGHT_CENTER,
                words.equation,
                false,
                true,
            );
            let share = if total > 0.0 {
                (phase.milliseconds / total) as f32
            } else {
                0.0
            };
            let bar = top + 2.05 * line;
            let painter = self.ui.painter();
            let track = Stroke::new(2.0, style::colour(self.bench.theme.line));
            let fill = Stroke::new(2.0, style::colour(self.bench.theme.accent));
            painter.line_segment([pos2(self.left, bar), pos2(self.right, bar)], track);
            painter.line_segment(
                [
                    pos2(self.left, bar),
                    pos2(self.left + share * (self.right - self.left), bar),
                ],
                fill,
            );
            let row = Rect::from_min_max(pos2(self.left, top), pos2(self.right, bar + 2.0));
            self.ui
                .interact(
                    row,
                    self.ui.scope_id().with((phase.kind as u8, "phase")),
                    Sense::hover(),
                )
                .on_hover_text(words.sentence(nouns));
            self.y = bar + 9.0;
        }
        if record.phases.is_empty() {
            self.pair("phases", "not reported", "");
        }
        let weights = if record.reweighted {
            "changed, (23) held"
        } else {
            "kept"
        };
        if matches!(method, "wrapd" | "w-admm") {
            self.pair("weights", weights, &format!("Weights change only when that of some {} is off by more than γ = 1.5, equation (23); then the Laplacian is factored again and the L-BFGS history is dropped.", nouns.element));
        }
        if let Some(lim) = record.lim {
            self.parameters(lim);
        }
        if let Some(words) = handover(run, record.switched_at) {
            self.words(&words);
        }
        self.rule();
    }

    /// What a step of a locally injective mapping was made with.
    fn parameters(&mut self, lim: LimStep) {
        self.pair("α, pull of the handles", &number(lim.alpha, 3), "Weight of the squared distances to the targets, equations (7) and (8): it only grows, with the ratio of energy and distance.");
        let mu = match lim.mu {
            0.0 => "0: definite as it is".into(),
            mu => number(mu, 3),
        };
        self.pair("μ, shift", &mu, "What is added to the diagonal so that the matrix is positive definite (Levenberg and Marquardt).");
        self.pair(
            "σ, step",
            &number(lim.sigma, 3),
            "The part of the direction that was gone.",
        );
        let part = format!("{} of the way", number(1.0 / (1.0 + lim.mu * lim.mu), 3));
        self.pair("sub-step (6)", &part, "How far the handles were led towards their targets: 1/(1 + μ²). The small circle on the way is where.");
        let [arrived, all] = lim.arrived;
        self.pair(
            "handles at their targets",
            &format!("{arrived} of {all}"),
            "A handle that is there to one part in 10⁹ of the size is put there exactly, and held.",
        );
        self.pair(
            "farthest (relative)",
            &number(lim.error, 3),
            "Distance of the farthest handle from its target, of a body of area or volume 1.",
        );
        self.pair(
            "barrier βΣφ",
            &number(lim.barrier, 3),
            "The barrier’s energy, which the plotted energy leaves out. Without a barrier 0.",
        );
    }

    /// A sentence or two over the width of the column.
    pub(super) fn words(&mut self, words: &str) {
        let font = style::regular(style::SMALL * self.bench.text);
        let quiet = style::colour(self.bench.theme.quiet);
        let painter = self.ui.painter();
        let galley = painter.layout(words.into(), font, quiet, self.right - self.left);
        let height = galley.size().y;
        painter.galley(pos2(self.left, self.y), galley, quiet);
        self.y += height;
    }

    /// The numbers of the iterate on show.
    fn iterate(&mut self) {
        let Some(record) = self.bench.record() else {
            return;
        };
        let handed = if self.bench.is_untangling() {
            "What is handed out"
        } else {
            "This iterate"
        };
        self.section(handed, "");
        let nouns = self.bench.nouns();
        let energy = number(record.energy, 7);
        if self.bench.is_lim() {
            self.pair("energy (relative)", &energy, "Deformation energy of a body scaled to an area or volume of 1, the barrier and the pull of the handles left out.");
        } else if self.bench.body.is_some() {
            self.pair("energy (relative)", &energy, "Elastic energy over Young’s modulus times the volume at rest; over the volume alone for materials without moduli. While tetrahedra are inverted it is that of the local variables Z.");
        } else {
            let isometry = if self.bench.energy == "arap" {
                "0"
            } else {
                "1"
            };
            self.pair("energy (relative)", &energy, &format!("Surface scaled to unit area; an isometry has {isometry}. While triangles are inverted it is that of the local variables Z."));
        }
        let elements = nouns.elements;
        if !self.bench.is_untangling() {
            self.pair(
                &format!("inverted {elements}"),
                &record.inverted.to_string(),
                &format!(
                    "{} that are turned inside out: there the {} passes through itself.",
                    capital(elements),
                    nouns.whole
                ),
            );
        }
        self.pair(nouns.worst, &number(record.worst_distortion(), 4), &format!("{} over the {elements}; 1 where no length changes, without bound while one is inverted.", nouns.formula));
        let range = format!(
            "{} … {}",
            number(record.smallest_sigma, 3),
            number(record.largest_sigma, 3)
        );
        self.pair(
            "singular values",
            &range,
            "The least and the greatest factor by which a length is scaled (relative).",
        );
        let (name, hint) = if self.bench.body.is_some() {
            (
                "gradient (relative)",
                "Length of the gradient of the energy: all forces that are left, over Young’s modulus (where there is one) times the area of one face of a cube as large as the solid.",
            )
        } else {
            ("gradient", "Length of the gradient of the energy.")
        };
        self.pair(name, &number(record.gradient_norm, 3), hint);
        self.pair(
            "time",
            &format!("{} s", number(record.seconds, 3)),
            "Seconds of solving up to here, setup apart.",
        );
        self.rule();
    }

    /// The runs on this problem; returns whether to forget the earlier ones.
    fn runs(&mut self) -> bool {
        if self.bench.earlier.is_empty() || self.bench.is_untangling() {
            return false;
        }
        self.section("Runs on this problem", "");
        for run in self.bench.earlier.iter().chain([&self.bench.run]) {
            let own = std::ptr::eq(run, &self.bench.run);
            let style_of = curve_style(&run.method);
            let ink = style::colour(if self.bench.theme.dark {
                style_of.dark
            } else {
                style_of.light
            });
            let middle = self.y + 0.5 * self.line();
            let stroke = Stroke::new(if own { 2.4 } else { 1.4 }, ink);
            let ends = [pos2(self.left, middle), pos2(self.left + 26.0, middle)];
            if style_of.dash.is_empty() {
                self.ui.painter().line_segment(ends, stroke);
            } else {
                let (dashes, gaps): (Vec<f32>, Vec<f32>) = style_of
                    .dash
                    .as_chunks::<2>()
                    .0
                    .iter()
                    .map(|[d, g]| (*d, *g))
                    .unzip();
                self.ui
                    .painter()
                    .extend(egui::Shape::dashed_line_with_offset(
                        &ends, stroke, &dashes, &gaps, 0.0,
                    ));
            }
            let name = if run.start == self.bench.run.start {
                method_name(&run.method).to_owned()
            } else {
                format!("{}, {}", method_name(&run.method), run.start)
            };
            self.text(
                self.left + 34.0,
                middle,
                Align2::LEFT_CENTER,
                &name,
                own,
                false,
            );
            if let Some(last) = run.records.last() {
                let value = format!("{} it · {}", last.iteration, number(last.energy, 5));
                self.text(
                    self.right,
                    middle,
                    Align2::RIGHT_CENTER,
                    &value,
                    false,
                    true,
                );
            }
            self.y += self.line();
        }
        let font = style::regular(style::SMALL * self.bench.text);
        let accent = style::colour(self.bench.theme.accent);
        let rect = self.ui.painter().text(
            pos2(self.left, self.y + 2.0),
            Align2::LEFT_TOP,
            "forget the earlier runs",
            font,
            accent,
        );
        let response = self.ui.interact(
            rect.expand(3.0),
            self.ui.scope_id().with("clear"),
            Sense::click(),
        );
        self.y = rect.bottom() + 2.0;
        self.rule();
        response.clicked()
    }

    /// The problem.
    pub(super) fn facts(&mut self) {
        if self.bench.facts.is_empty() {
            return;
        }
        self.section("The problem", "");
        for [name, value] in &self.bench.facts {
            self.pair(name, value, "");
        }
        self.y += 10.0;
    }
}
