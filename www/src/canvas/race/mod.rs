//! Several solvers on one surface, from one start and on one clock: what is known of each.

pub mod curves;
pub mod panes;
pub mod table;

use eframe::egui::{Color32, Painter, Pos2, Shape, Stroke};
use glam::Vec2;

use super::bench::{Bench, Problem};
use super::painting::{Painted, Painting};
use super::{gpu, style};
use crate::camera::Pan;
use crate::colour::curve_style;
use crate::frames::Frames;
use crate::history::{Record, Run};

/// Solvers that are compared at most.
pub const MOST_LANES: usize = 4;

/// Memory for the iterates of one of them.
const FRAME_BUDGET: usize = 64 << 20;

/// One solver.
pub struct Lane {
    /// Its method and its iterates' numbers.
    pub run: Run,
    /// Its maps.
    pub frames: Frames,
    /// Which record is shown.
    pub shown: usize,
    /// What went wrong, once something has.
    pub error: Option<String>,
    /// How it ended, once it has.
    pub ending: String,
    /// Inverted or collapsed triangles of its map on show.
    pub inverted: Vec<u32>,
    /// Every how many triangles one is drawn.
    pub thinning: usize,
    /// Lower left and upper right of its map on show.
    box_of_map: [f32; 4],
    stale: bool,
}

impl Lane {
    fn new(method: &str) -> Self {
        Self {
            run: Run {
                method: method.into(),
                ..Run::default()
            },
            frames: Frames::new(FRAME_BUDGET),
            shown: 0,
            error: None,
            ending: String::new(),
            inverted: Vec::new(),
            thinning: 1,
            box_of_map: [0.0; 4],
            stale: false,
        }
    }

    /// The record on show.
    pub fn record(&self) -> Option<&Record> {
        self.run.records.get(self.shown)
    }

    /// The map on show.
    pub fn map(&self) -> Option<&[f32]> {
        self.frames.at(self.shown).map(|(_, map)| map)
    }

    /// The colour of its method.
    pub fn ink(&self, dark: bool) -> Color32 {
        let own = curve_style(&self.run.method);
        style::colour(if dark { own.dark } else { own.light })
    }
}

/// The solvers, and where on their clock they are shown.
#[derive(Default)]
pub struct Race {
    /// The solvers, in the order of their panes.
    pub lanes: Vec<Lane>,
    /// The lowest energy, from which the gaps count.
    pub best: Option<f64>,
    /// Whether `best` is that of a solver that has converged.
    pub settled: bool,
    /// Whether the clock counts seconds of solving (else iterations).
    pub seconds: bool,
    /// The time on the clock.
    pub at: f64,
    /// The pane that a phone shows.
    pub pane: usize,
}

impl Race {
    /// Begins with these methods.
    pub fn begin(&mut self, methods: &[String]) {
        self.lanes = methods
            .iter()
            .take(MOST_LANES)
            .map(|m| Lane::new(m))
            .collect();
        (self.best, self.settled, self.at) = (None, false, 0.0);
    }

    /// Adds an iterate of one of them.
    pub fn push(&mut self, index: usize, record: Record, map: Vec<f32>) {
        if let Some(lane) = self.lanes.get_mut(index) {
            lane.frames.push(lane.run.records.len(), map);
            lane.run.records.push(record);
            lane.stale |= lane.run.records.len() == 1;
        }
    }

    /// Shows a record of each, at a time of the clock.
    pub fn show(&mut self, at: f64, shown: &[u32]) {
        self.at = at;
        for (lane, &index) in self.lanes.iter_mut().zip(shown) {
            let index = (index as usize).min(lane.run.records.len().saturating_sub(1));
            lane.stale |= index != lane.shown;
            lane.shown = index;
        }
    }

    /// Brings the GPU up to date with the iterates on show.
    pub fn refresh(&mut self, problem: &Problem, painting: &mut Painting) {
        for (index, lane) in self.lanes.iter_mut().enumerate() {
            if !std::mem::take(&mut lane.stale) {
                continue;
            }
            let Some((_, map)) = lane.frames.at(lane.shown) else {
                continue;
            };
            lane.box_of_map = bounds(map);
            let Painted {
                inverted, thinning, ..
            } = painting.paint(problem, map, |data| {
                gpu::with(|gpu| gpu.set_pane(index, data));
            });
            (lane.inverted, lane.thinning) = (inverted, thinning);
        }
    }

    /// The window that shows all of every map on show.
    pub fn fitting(&self, size: Vec2) -> Pan {
        let drawn = self.lanes.iter().filter(|lane| lane.map().is_some());
        let corners: Vec<f32> = drawn.flat_map(|lane| lane.box_of_map).collect();
        Pan::fitting(&corners, size)
    }

    /// The time of a record on the clock.
    pub fn time(&self, record: &Record) -> f64 {
        if self.seconds {
            record.seconds
        } else {
            f64::from(record.iteration)
        }
    }

    /// How far the energy of a record is above the lowest.
    pub fn gap(&self, record: &Record) -> Option<f64> {
        let gap = record.energy - self.best?;
        gap.is_finite().then_some(gap)
    }
}

/// The corners of the box around a map's finite points.
fn bounds(map: &[f32]) -> [f32; 4] {
    let points = map.as_chunks::<2>().0.iter().map(|&p| Vec2::from_array(p));
    let (low, high) = points
        .filter(|p| p.is_finite())
        .fold((Vec2::MAX, Vec2::MIN), |(l, h), p| (l.min(p), h.max(p)));
    [low.x, low.y, high.x, high.y]
}

impl Bench {
    /// Adds an iterate of one of the solvers that are compared.
    pub fn push_lane(&mut self, index: usize, record: Record, map: Vec<f32>) {
        if map.len() == 2 * self.problem.vertices
            && let Some(race) = &mut self.race
        {
            race.push(index, record, map);
        }
    }
}

/// A piece of a method's curve, as a key.
fn key(painter: &Painter, [from, to]: [Pos2; 2], method: &str, width: f32, ink: Color32) {
    let dash = curve_style(method).dash;
    let stroke = Stroke::new(width, ink);
    if dash.is_empty() {
        painter.line_segment([from, to], stroke);
        return;
    }
    let (dashes, gaps): (Vec<f32>, Vec<f32>) = dash
        .as_chunks::<2>()
        .0
        .iter()
        .map(|[d, g]| (*d, *g))
        .unzip();
    painter.extend(Shape::dashed_line_with_offset(
        &[from, to],
        stroke,
        &dashes,
        &gaps,
        0.0,
    ));
}
