//! Where each of the solvers is, in numbers.

use eframe::egui::{self, Align2, Rect, pos2, vec2};

use super::curves::gap_words;
use super::key;
use crate::canvas::bench::Bench;
use crate::canvas::inspector::Column;
use crate::canvas::style;
use crate::scale::{duration, number};
use crate::words::{citation, handover, method_name};

/// Draws the view.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    egui::ScrollArea::vertical()
        .auto_shrink(false)
        .show(ui, |ui| {
            let top = ui.cursor().top();
            let mut column = Column::new(ui, bench, rect, top + 10.0);
            lanes(&mut column, bench);
            column.facts();
            let used = column.y - top;
            ui.allocate_space(vec2(rect.width() - 4.0, used));
        });
}

fn lanes(column: &mut Column, bench: &Bench) {
    let Some(race) = &bench.race else { return };
    let clock = if race.seconds {
        format!("after {}", duration(race.at))
    } else {
        format!("iteration {}", race.at)
    };
    column.section("Side by side", &clock);
    // the one ahead, where it is by more than rounding
    let records = race.lanes.iter().filter_map(|lane| lane.record());
    let mut energies: Vec<f64> = records
        .filter(|r| r.inverted == 0)
        .map(|r| r.energy)
        .collect();
    energies.sort_by(f64::total_cmp);
    let leader = match energies[..] {
        [first, second, ..] if second - first > 1e-9 * first.abs() => Some(first),
        _ => None,
    };
    for lane in &race.lanes {
        let ink = lane.ink(bench.theme.dark);
        let (left, right) = (column.left, column.right);
        let middle = column.y + 0.5 * column.line();
        let ends = [pos2(left, middle), pos2(left + 28.0, middle)];
        let name = method_name(&lane.run.method);
        key(column.painter(), ends, &lane.run.method, 2.2, ink);
        let end = column.text(left + 36.0, middle, Align2::LEFT_CENTER, name, true, false);
        let at = pos2(end.right() + 8.0, middle);
        let room = right - at.x;
        let small = style::regular(style::SMALL * bench.text);
        let quiet = style::colour(bench.theme.quiet);
        let by = column
            .painter()
            .layout_no_wrap(citation(&lane.run.method).into(), small, quiet);
        if by.size().x < room {
            let place = Align2::RIGHT_CENTER.anchor_size(pos2(right, middle), by.size());
            column.painter().galley(place.min, by, quiet);
        }
        column.y += column.line();
        if let Some(error) = &lane.error {
            column.words(error);
            column.y += 6.0;
        }
        let Some(record) = lane.record() else {
            column.y += 4.0;
            continue;
        };
        let ahead = leader == Some(record.energy) && record.inverted == 0;
        let hint =
            "Surface scaled to unit area; an isometry has 1 (symmetric Dirichlet) or 0 (ARAP).";
        let energy = number(record.energy, 7);
        column.pair(
            if ahead {
                "energy, the lowest"
            } else {
                "energy"
            },
            &energy,
            hint,
        );
        let gap = race.gap(record).map_or("–".into(), gap_words);
        column.pair(
            "E − E*",
            &gap,
            "How far above the lowest energy that any of them has reached.",
        );
        let spent = format!("{} · {}", record.iteration, duration(record.seconds));
        column.pair("iteration · time", &spent, "Seconds of solving as the solver itself counts them: setup, drawing and the other solvers apart.");
        column.pair(
            "inverted",
            &record.inverted.to_string(),
            "Triangles that lie upside down.",
        );
        if !lane.ending.is_empty() && lane.shown + 1 == lane.run.records.len() {
            column.pair("ended", &lane.ending, "");
        }
        if let Some(words) = handover(&lane.run.method, record.switched_at) {
            column.words(&words);
        }
        column.rule();
    }
}
