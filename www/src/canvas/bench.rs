//! The state of the bench: the problem, its runs, what is shown and how.

use glam::{Vec2, Vec3};

use super::gpu::{self, Look};
use super::painting::{Painted, Painting};
use super::race::Race;
use super::solid::Body;
use crate::camera::{Orbit, Pan};
use crate::colour::{DARK, LIGHT, Theme};
use crate::distortion::RestShapes;
use crate::frames::Frames;
use crate::history::{Moment, Part, Record, Run, State};
use crate::layout::View;
use crate::outline;
use crate::solid::contact::Contact;
use crate::words::{Nouns, PLANAR, SOLID, SURFACE};

/// Memory for the iterates of one run.
const FRAME_BUDGET: usize = 192 << 20;

/// Iterates, the newest, whose phases are kept: a person may drag for hours.
const MOST_PHASES: usize = 5000;

/// Earlier runs kept as curves.
const MOST_EARLIER_RUNS: usize = 6;

/// A surface on the bench.
#[derive(Default)]
pub struct Problem {
    /// Triangles, three vertices each.
    pub indices: Vec<u32>,
    /// Rest shapes of the triangles.
    pub rest: RestShapes,
    /// Boundary edges.
    pub boundary: Vec<[u32; 2]>,
    /// Vertices.
    pub vertices: usize,
}

/// What the plot's height means.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum PlotHeight {
    /// The values themselves.
    Values,
    /// Energy above the lowest any run on this problem has reached, relative.
    Gap,
}

impl PlotHeight {
    /// The one it is not.
    pub fn other(self) -> Self {
        match self {
            Self::Values => Self::Gap,
            Self::Gap => Self::Values,
        }
    }
}

/// Something the page must hear of.
pub enum Event {
    /// A person chose an iterate on the plot.
    Show(usize),
    /// Vertices are to be held together.
    Pin(Vec<u32>),
    /// A person chose a moment of a comparison's clock.
    Moment(f64),
    /// A handle was chosen, or none.
    Select(Option<usize>),
    /// A handle is being dragged from now on.
    GrabHandle(usize),
    /// A vertex is being pulled from now on.
    GrabVertex(u32),
    /// How far what is dragged has come since it was grabbed.
    Drag(Vec3),
    /// How far what is dragged is turned, in radians, about an axis the page knows.
    Turn(f32),
    /// It was let go.
    Drop,
}

/// The whole state; the views draw it, the page's JavaScript changes it.
pub struct Bench {
    /// The surface, where a surface is on the bench.
    pub problem: Problem,
    /// The solid, where a solid is on the bench.
    pub body: Option<Body>,
    /// Several solvers on the surface, where they are compared.
    pub race: Option<Race>,
    /// The run on the bench.
    pub run: Run,
    /// Its maps.
    pub frames: Frames,
    /// Of an untangling, beside what its steps work on: the state that is handed out, and the primary solver's.
    pub states: [Frames; 2],
    /// Which of the three is shown.
    pub state: State,
    /// Curves of the runs before it on this problem.
    pub earlier: Vec<Run>,
    /// Which record is shown.
    pub shown: usize,
    /// Which record the map on show belongs to (older than `shown` if that map was dropped).
    pub shown_map: usize,
    /// Energy, kebab-case.
    pub energy: String,
    /// Lines of the inspector about the problem: name, value.
    pub facts: Vec<[String; 2]>,
    /// Colours.
    pub theme: Theme,
    /// Size of text; 2 on a projector.
    pub text: f32,
    /// Whether nothing may glide.
    pub reduced_motion: bool,
    /// The view that is shown alone, if one is.
    pub alone: Option<View>,
    /// Whether the inspector is shown.
    pub inspector: bool,
    /// Whether all triangle edges are drawn.
    pub wireframe: bool,
    /// Whether the surface takes distortion colours.
    pub tinted: bool,
    /// Camera of the surface.
    pub orbit: Orbit,
    /// Window over the map.
    pub pan: Pan,
    /// What the plot's height means.
    pub plot_height: PlotHeight,
    /// Whether the plot's width is seconds (else iterations).
    pub plot_seconds: bool,
    /// Triangle under the pointer.
    pub hover: Option<usize>,
    /// Inverted or collapsed triangles of the map on show.
    pub inverted: Vec<u32>,
    /// Every how many triangles one is drawn in the map: 1 unless it covers itself many times.
    pub thinning: usize,
    /// How many times the map on show covers its bounding box.
    pub layers: usize,
    /// Pairs of boundary edges that meet in the newest map, by its certificate.
    pub crossings: Vec<[[u32; 2]; 2]>,
    /// Events for the page.
    pub events: Vec<Event>,
    stale: bool,
    painting: Painting,
}

impl Bench {
    /// An empty bench.
    pub fn new() -> Self {
        Self {
            problem: Problem::default(),
            body: None,
            race: None,
            run: Run::default(),
            frames: Frames::new(FRAME_BUDGET),
            states: [(); 2].map(|()| Frames::new(FRAME_BUDGET)),
            state: State::default(),
            earlier: Vec::new(),
            shown: 0,
            shown_map: 0,
            energy: "symmetric-dirichlet".into(),
            facts: Vec::new(),
            theme: LIGHT,
            text: 1.0,
            reduced_motion: false,
            alone: None,
            inspector: true,
            wireframe: false,
            tinted: true,
            orbit: Orbit::around(&[]),
            pan: Pan::default(),
            plot_height: PlotHeight::Values,
            plot_seconds: false,
            hover: None,
            inverted: Vec::new(),
            thinning: 1,
            layers: 1,
            crossings: Vec::new(),
            events: Vec::new(),
            stale: false,
            painting: Painting::default(),
        }
    }

    /// An empty bench on which solvers are compared.
    pub fn comparing() -> Self {
        Self {
            race: Some(Race::default()),
            plot_height: PlotHeight::Gap,
            ..Self::new()
        }
    }

    /// Puts a surface on the bench and forgets the runs on the last one.
    pub fn set_problem(&mut self, positions: &[f64], indices: &[u32]) {
        let same = self.problem.indices == indices && self.problem.vertices == positions.len() / 3;
        self.problem = Problem {
            indices: indices.to_vec(),
            rest: RestShapes::new(positions, indices),
            boundary: outline::boundary_edges(indices),
            vertices: positions.len() / 3,
        };
        // A camera a person has turned stays when the very same surface comes again.
        if !same {
            self.orbit = Orbit::around(positions);
            self.pan = Pan::default();
        }
        self.forget_runs();
        if self.race.is_some() {
            return; // where solvers are compared only their maps are drawn
        }
        let single: Vec<f32> = positions.iter().map(|p| *p as f32).collect();
        let normals = outline::vertex_normals(positions, indices);
        let (mut corners, mut corner_normals, mut seam) = (Vec::new(), Vec::new(), Vec::new());
        outline::per_corner(indices, &single, 3, &mut corners);
        outline::per_corner(indices, &normals, 3, &mut corner_normals);
        for v in self.problem.boundary.as_flattened() {
            seam.extend_from_slice(&single[3 * *v as usize..][..3]);
        }
        gpu::with(|gpu| gpu.set_surface(&corners, &corner_normals, &seam));
    }

    /// Forgets all runs.
    pub fn forget_runs(&mut self) {
        self.earlier.clear();
        self.crossings.clear();
        self.run = Run::default();
        self.clear_frames();
        self.hover = None;
        (self.shown, self.shown_map) = (0, 0);
    }

    /// Begins a run; the one before it stays as a curve if it has one.
    pub fn begin_run(&mut self, method: &str, start: &str, energy: &str) {
        let before = std::mem::replace(
            &mut self.run,
            Run {
                method: method.into(),
                start: start.into(),
                records: Vec::new(),
            },
        );
        if energy != self.energy {
            self.earlier.clear();
            self.energy = energy.into();
        } else if before.records.len() > 2 {
            self.earlier
                .retain(|run| run.method != before.method || run.start != before.start);
            self.earlier.push(before);
            let excess = self.earlier.len().saturating_sub(MOST_EARLIER_RUNS);
            self.earlier.drain(..excess);
        }
        self.crossings.clear();
        self.clear_frames();
        self.pan.follows = true;
        (self.shown, self.shown_map) = (0, 0);
    }

    /// Adds an iterate to the run: its map, or the solid's positions and stresses.
    pub fn push(&mut self, record: Record, map: Vec<f32>) {
        let fits = self.body.as_ref().map_or_else(
            || map.len() == 2 * self.problem.vertices,
            |body| body.fits(&map),
        );
        if !fits {
            return;
        }
        self.push_with(record, map, Vec::new());
    }

    /// Adds an iterate that fits.
    fn push_with(&mut self, record: Record, map: Vec<f32>, contacts: Vec<Contact>) {
        let index = self.run.records.len();
        self.frames.push_with(index, map, contacts);
        self.keep(record);
        if self.run.records.len() == 1 {
            self.show(0);
        }
    }

    /// Adds a moment of an untangling: what its step works on with the zones of its elements, the state that is handed
    /// out, and the primary solver's; contacts of the first.
    pub fn push_moment(
        &mut self,
        record: Record,
        trial: Vec<f32>,
        others: [Vec<f32>; 2],
        contacts: Vec<Contact>,
    ) {
        let Some(body) = &mut self.body else { return };
        if !body.fits(&trial) || !others.iter().all(|other| body.fits(other)) {
            return;
        }
        body.zones = true;
        let index = self.run.records.len();
        for (frames, other) in self.states.iter_mut().zip(others) {
            frames.push(index, other);
        }
        self.push_with(record, trial, contacts);
    }

    fn clear_frames(&mut self) {
        self.frames.clear();
        self.states.iter_mut().for_each(Frames::clear);
    }

    /// The iterates of the state on show.
    fn chosen(&self) -> &Frames {
        let others = &self.states;
        match self.state {
            State::Result if !others[0].is_empty() => &others[0],
            State::Primary if !others[1].is_empty() => &others[1],
            _ => &self.frames,
        }
    }

    /// The contacts of what the step on show works on, unless its map was dropped.
    pub fn contacts(&self) -> Option<&[Contact]> {
        self.frames.contacts(self.shown)
    }

    /// Whether the state on show is what its step works on: only that crosses, and has contacts. What is handed out never
    /// does, and the primary solver's state is worked on until the polisher takes it over.
    pub fn shows_work(&self) -> bool {
        match self.state {
            State::Trial => true,
            State::Result => false,
            State::Primary => self
                .moment()
                .is_some_and(|m| matches!(m.part, Part::Start | Part::Local | Part::Quadratic)),
        }
    }

    /// What is known of the moment on show, of an untangling.
    pub fn moment(&self) -> Option<&Moment> {
        self.record()?.moment.as_ref()
    }

    /// Inverted elements of the iterate and the state on show, as the solver counts them.
    pub fn reported_inverted(&self) -> Option<u32> {
        let record = self.record()?;
        let of_state = record.moment.map(|m| m.inverted[self.state as usize]);
        Some(of_state.unwrap_or(record.inverted))
    }

    /// Adds an iterate of which only the numbers are known.
    pub fn push_numbers(&mut self, record: Record) {
        if !self.run.records.is_empty() {
            self.keep(record);
        }
    }

    fn keep(&mut self, record: Record) {
        let records = &mut self.run.records;
        records.push(record);
        if let Some(old) = records.len().checked_sub(MOST_PHASES + 1) {
            records[old].phases = Vec::new();
        }
    }

    /// Draws the iterate on show anew.
    pub fn redraw(&mut self) {
        self.stale = true;
    }

    /// Shows an iterate, the newest if there is none such.
    pub fn show(&mut self, index: usize) {
        self.shown = index.min(self.run.records.len().saturating_sub(1));
        self.stale = true;
    }

    /// The record of the iterate on show.
    pub fn record(&self) -> Option<&Record> {
        self.run.records.get(self.shown)
    }

    /// The map on show.
    pub fn map(&self) -> Option<&[f32]> {
        self.chosen().at(self.shown).map(|(_, map)| map)
    }

    /// Brings the GPU up to date with the iterate on show.
    pub fn refresh(&mut self) {
        if !std::mem::take(&mut self.stale) {
            return;
        }
        if let Some(race) = &mut self.race {
            race.refresh(&self.problem, &mut self.painting);
            return;
        }
        if let Some(mut body) = self.body.take() {
            if let Some((index, map)) = self.chosen().at(self.shown) {
                body.refresh(map);
                self.shown_map = index;
            }
            self.body = Some(body);
            return;
        }
        let Some((index, map)) = self.frames.at(self.shown) else {
            return;
        };
        self.shown_map = index;
        let Painted {
            inverted,
            thinning,
            layers,
        } = self.painting.paint(&self.problem, map, |data| {
            gpu::with(|gpu| gpu.set_map(data));
        });
        (self.inverted, self.thinning, self.layers) = (inverted, thinning, layers);
    }

    /// The window that would show all of the map on show.
    pub fn fitting(&self, size: Vec2) -> Pan {
        self.map()
            .map_or_else(Pan::default, |map| Pan::fitting(map, size))
    }

    /// How the views are drawn.
    pub fn look(&self, pixel: f32) -> Look {
        Look {
            theme: self.theme,
            pixel,
            wireframe: self.wireframe,
            hover: self.hover,
            tint: if self.tinted { 0.62 } else { 0.0 },
        }
    }

    /// Whether what is on show was made by locally injective mappings.
    pub fn is_lim(&self) -> bool {
        self.run.method.starts_with("lim")
    }

    /// Whether what is on show is an untangling, also while a view has taken its body to draw it. Maps of surfaces have the
    /// same method, but neither.
    pub fn is_untangling(&self) -> bool {
        let parts = || self.record().is_some_and(|r| r.moment.is_some());
        self.run.method == "gini" && (self.body.is_some() || parts())
    }

    /// What things are called on this bench.
    pub fn nouns(&self) -> Nouns {
        match &self.body {
            Some(body) if body.solid.planar => PLANAR,
            Some(_) => SOLID,
            None => SURFACE,
        }
    }

    /// Inverted or collapsed elements of the iterate on show, as drawn.
    pub fn drawn_inverted(&self) -> usize {
        if let Some(race) = &self.race {
            return race.lanes.iter().map(|lane| lane.inverted.len()).sum();
        }
        self.body
            .as_ref()
            .map_or(self.inverted.len(), |body| body.inverted.len())
    }

    /// Follows the page's theme.
    pub fn set_dark(&mut self, dark: bool) {
        self.theme = if dark { DARK } else { LIGHT };
    }

    /// The lowest energy any run on this problem has reached without inversions.
    pub fn lowest_energy(&self) -> Option<f64> {
        self.earlier
            .iter()
            .chain([&self.run])
            .flat_map(|run| &run.records)
            .filter(|r| r.inverted == 0 && r.energy.is_finite())
            .map(|r| r.energy)
            .min_by(f64::total_cmp)
    }
}
