//! One mode's bench, in JavaScript's hands.

use std::cell::RefCell;
use std::rc::Rc;

use eframe::egui;
use glam::Vec3;
use wasm_bindgen::prelude::*;

use super::bench::Bench;
use super::race::Race;
use super::solid::{Body, Cut};
use super::stage::{Mode, Stage};
use crate::history::{Record, State};
use crate::solid::contact::Contact;
use crate::solid::field::Field;

/// The bench of a mode. All arrays are copied.
#[wasm_bindgen]
pub struct BenchHandle {
    stage: Rc<RefCell<Stage>>,
    context: egui::Context,
    mode: Mode,
}

impl BenchHandle {
    pub(super) fn new(stage: Rc<RefCell<Stage>>, context: egui::Context, mode: Mode) -> Self {
        Self {
            stage,
            context,
            mode,
        }
    }

    fn change<R>(&self, f: impl FnOnce(&mut Bench) -> R) -> R {
        let mut stage = self.stage.borrow_mut();
        if stage.mode() == self.mode {
            self.context.request_repaint();
        }
        f(stage.bench(self.mode))
    }

    fn race(&self, f: impl FnOnce(&mut Race)) {
        self.change(|bench| {
            if let Some(race) = &mut bench.race {
                f(race);
            }
        });
    }

    fn body<R: Default>(&self, f: impl FnOnce(&mut Body) -> R) -> R {
        self.change(|bench| bench.body.as_mut().map(f).unwrap_or_default())
    }
}

#[wasm_bindgen]
impl BenchHandle {
    /// Puts a surface on the bench: positions (n×3) in its own unit, triangles (m×3).
    #[wasm_bindgen(js_name = setProblem)]
    pub fn set_problem(&self, positions: &[f64], indices: &[u32]) {
        let n = positions.len() / 3;
        if indices.iter().all(|i| (*i as usize) < n) {
            self.change(|bench| bench.set_problem(positions, indices));
        }
    }

    /// Puts a solid on the bench: rest positions (n×3), tetrahedra (m×4), triangles of the skin (k×3).
    #[wasm_bindgen(js_name = setSolid)]
    pub fn set_solid(&self, positions: &[f64], tetrahedra: &[u32], skin: &[u32]) {
        let n = positions.len() / 3;
        if tetrahedra.iter().chain(skin).all(|i| (*i as usize) < n) {
            self.change(|bench| bench.set_solid(positions, tetrahedra, skin));
        }
    }

    /// Puts triangles (m×3) of a plane z = constant on the bench, to be deformed in it: rest positions (n×3).
    #[wasm_bindgen(js_name = setPlanar)]
    pub fn set_planar(&self, positions: &[f64], triangles: &[u32]) {
        let n = positions.len() / 3;
        if triangles.iter().all(|i| (*i as usize) < n) {
            self.change(|bench| bench.set_planar(positions, triangles));
        }
    }

    /// Begins a run of a method from a start, with an energy (kebab-case names as in the options).
    #[wasm_bindgen(js_name = beginRun)]
    pub fn begin_run(&self, method: &str, start: &str, energy: &str) {
        self.change(|bench| bench.begin_run(method, start, energy));
    }

    /// Adds an iterate: ten numbers (iteration, energy, inverted, gradient norm, smallest σ, largest σ,
    /// L-BFGS iterations, reweighted, seconds, iteration of the switch or −1; of locally injective mappings α, μ, σ,
    /// positional error, barrier, handles that have arrived, and all), three numbers a phase (kind, count,
    /// milliseconds), and the map (n×2).
    #[wasm_bindgen(js_name = pushFrame)]
    pub fn push_frame(&self, numbers: &[f64], phases: &[f64], map: Vec<f32>) {
        if let Some(record) = Record::from_numbers(numbers, phases) {
            self.change(|bench| bench.push(record, map));
        }
    }

    /// Begins a comparison of these methods, with an energy.
    #[wasm_bindgen(js_name = beginRace)]
    pub fn begin_race(&self, methods: Vec<String>, energy: &str) {
        self.change(|bench| {
            bench.energy = energy.into();
            bench.pan.follows = true;
        });
        self.race(|race| race.begin(&methods));
    }

    /// Adds an iterate of one of the solvers that are compared: numbers and phases as for `pushFrame`, and the map.
    #[wasm_bindgen(js_name = pushLane)]
    pub fn push_lane(&self, lane: usize, numbers: &[f64], phases: &[f64], map: Vec<f32>) {
        if let Some(record) = Record::from_numbers(numbers, phases) {
            self.change(|bench| bench.push_lane(lane, record, map));
        }
    }

    /// Says how one of them ended, or (`failed`) what went wrong.
    #[wasm_bindgen(js_name = endLane)]
    pub fn end_lane(&self, lane: usize, words: &str, failed: bool) {
        self.race(|race| {
            if let Some(lane) = race.lanes.get_mut(lane) {
                match failed {
                    true => lane.error = Some(words.into()),
                    false => lane.ending = words.into(),
                }
            }
        });
    }

    /// Shows a record of each of them, at a time of their clock.
    #[wasm_bindgen(js_name = showMoment)]
    pub fn show_moment(&self, at: f64, shown: &[u32]) {
        self.race(|race| race.show(at, shown));
        self.change(Bench::redraw);
    }

    /// The lowest energy (not a number: none yet), and whether it is that of a solver that has converged.
    #[wasm_bindgen(js_name = setBest)]
    pub fn set_best(&self, energy: f64, settled: bool) {
        self.race(|race| {
            (race.best, race.settled) = (Some(energy).filter(|e| e.is_finite()), settled);
        });
    }

    /// Whether the clock counts seconds (else iterations); the plot follows it.
    #[wasm_bindgen(js_name = setClock)]
    pub fn set_clock(&self, seconds: bool) {
        self.race(|race| race.seconds = seconds);
        self.change(|bench| bench.plot_seconds = seconds);
    }

    /// The map that a phone shows.
    #[wasm_bindgen(js_name = setPane)]
    pub fn set_pane(&self, pane: usize) {
        self.race(|race| race.pane = pane);
    }

    /// Adds an iterate of a solid: numbers as for `pushFrame`, positions (n×3), and the stress of every
    /// tetrahedron (m), or nothing.
    #[wasm_bindgen(js_name = pushSolid)]
    pub fn push_solid(&self, numbers: &[f64], phases: &[f64], positions: &[f32], stress: &[f32]) {
        if let Some(record) = Record::from_numbers(numbers, phases) {
            self.change(|bench| bench.push(record, [positions, stress].concat()));
        }
    }

    /// Adds an iterate that is not drawn: numbers as for `pushFrame`.
    #[wasm_bindgen(js_name = pushNumbers)]
    pub fn push_numbers(&self, numbers: &[f64], phases: &[f64]) {
        if let Some(record) = Record::from_numbers(numbers, phases) {
            self.change(|bench| bench.push_numbers(record));
        }
    }

    /// Adds a moment of an untangling: numbers as for `pushFrame`, with the eighteen of a moment behind the first ten; what
    /// the step works on (n×3) and the zone of every element (m, or nothing); the state that is handed out and the
    /// primary solver's (n×3 each); its contacts, seven numbers each: vertices, two edges or not,
    /// active or not, zone.
    #[wasm_bindgen(js_name = pushMoment)]
    pub fn push_moment(
        &self,
        numbers: &[f64],
        phases: &[f64],
        trial: &[f32],
        zones: &[f32],
        result: Vec<f32>,
        primary: Vec<f32>,
        contacts: &[u32],
    ) {
        if let Some(record) = Record::from_numbers(numbers, phases) {
            let contacts = Contact::from_numbers(contacts, primary.len() / 3);
            let trial = [trial, zones].concat();
            self.change(|bench| bench.push_moment(record, trial, [result, primary], contacts));
        }
    }

    /// Which state of an untangling is shown: `trial`, `result`, `primary`.
    #[wasm_bindgen(js_name = setState)]
    pub fn set_state(&self, name: &str) {
        if let Some(state) = State::from_name(name) {
            self.change(|bench| {
                bench.state = state;
                bench.redraw();
            });
        }
    }

    /// Looks at where these positions (n×3) are, and cuts there, instead of at those at rest.
    #[wasm_bindgen(js_name = lookAt)]
    pub fn look_at(&self, positions: &[f64]) {
        self.change(|bench| bench.look_at(positions));
    }

    /// Shows an iterate.
    #[wasm_bindgen(js_name = showFrame)]
    pub fn show_frame(&self, index: usize) {
        self.change(|bench| bench.show(index));
    }

    /// What the inspector says about the problem: names and values in turn.
    #[wasm_bindgen(js_name = setFacts)]
    pub fn set_facts(&self, facts: Vec<String>) {
        let facts = facts.as_chunks::<2>().0.to_vec();
        self.change(|bench| bench.facts = facts);
    }

    /// Pairs of boundary edges that meet where they should not in the newest map: four vertices each.
    #[wasm_bindgen(js_name = setCrossings)]
    pub fn set_crossings(&self, vertices: &[u32]) {
        self.change(|bench| {
            let n = bench.problem.vertices;
            let pairs = vertices.as_chunks::<4>().0.iter();
            bench.crossings = pairs
                .filter(|pair| pair.iter().all(|v| (*v as usize) < n))
                .map(|&[a, b, c, d]| [[a, b], [c, d]])
                .collect();
        });
    }

    /// The handles of the solid: their vertices one after the other, and how many each has.
    #[wasm_bindgen(js_name = setHandles)]
    pub fn set_handles(&self, vertices: &[u32], sizes: &[u32]) {
        self.body(|body| {
            let n = body.solid.vertices;
            let mut rest = vertices;
            body.handles.clear();
            for &size in sizes {
                let (handle, after) = rest.split_at((size as usize).min(rest.len()));
                rest = after;
                body.handles.push(
                    handle
                        .iter()
                        .copied()
                        .filter(|v| (*v as usize) < n)
                        .collect(),
                );
            }
        });
    }

    /// Whether what is held of a body that is untangled may be dragged elsewhere.
    #[wasm_bindgen(js_name = setMovable)]
    pub fn set_movable(&self, on: bool) {
        self.body(|body| (body.movable, body.grabbed) = (on, false));
    }

    /// Contacts of the moment on show in the view of the skin: those of vertices and facets that there are, and of edges;
    /// and their glyphs, where many nearly in one place have one.
    #[wasm_bindgen(getter, js_name = drawnContacts)]
    pub fn drawn_contacts(&self) -> Vec<usize> {
        self.body(|body| body.drawn_contacts.to_vec())
    }

    /// Which handle keys act on; a negative number for none.
    #[wasm_bindgen(js_name = setSelected)]
    pub fn set_selected(&self, handle: i32) {
        self.body(|body| body.selected = usize::try_from(handle).ok());
    }

    /// The vertex that keys would pin; a number that is none for none.
    #[wasm_bindgen(js_name = setCursor)]
    pub fn set_cursor(&self, vertex: u32) {
        self.body(|body| {
            body.cursor = Some(vertex).filter(|v| (*v as usize) < body.solid.vertices);
        });
    }

    /// Where vertices are to go: vertices (k) and their targets (k×3).
    #[wasm_bindgen(js_name = setTargets)]
    pub fn set_targets(&self, vertices: &[u32], positions: &[f64]) {
        self.body(|body| {
            let n = body.solid.vertices;
            let pairs = vertices.iter().zip(positions.as_chunks::<3>().0);
            body.targets.clear();
            body.targets.extend(
                pairs
                    .filter(|(v, _)| (**v as usize) < n)
                    .map(|(v, p)| (*v, Vec3::from_array(p.map(|x| x as f32)))),
            );
        });
    }

    /// Where the newest step led vertices (k) that are not at their targets yet (k×3).
    #[wasm_bindgen(js_name = setSubTargets)]
    pub fn set_sub_targets(&self, vertices: &[u32], positions: &[f64]) {
        self.body(|body| {
            let n = body.solid.vertices;
            let pairs = vertices.iter().zip(positions.as_chunks::<3>().0);
            body.sub_targets.clear();
            body.sub_targets.extend(
                pairs
                    .filter(|(v, _)| (**v as usize) < n)
                    .map(|(v, p)| (*v, Vec3::from_array(p.map(|x| x as f32)))),
            );
        });
    }

    /// What the colours of a solid mean: `stretch`, `volume`, `stress`, `zone`.
    #[wasm_bindgen(js_name = setField)]
    pub fn set_field(&self, name: &str) {
        if let Some(field) = Field::from_name(name) {
            self.body(|body| body.field = field);
            self.change(Bench::redraw);
        }
    }

    /// Cuts the solid open across an axis (0, 1, 2; any other: not at all), 0–1 along its bounding box.
    #[wasm_bindgen(js_name = setCut)]
    pub fn set_cut(&self, axis: i32, at: f32) {
        let axis = usize::try_from(axis).ok().filter(|axis| *axis < 3);
        self.body(|body| {
            body.cut = axis.map(|axis| Cut {
                axis,
                at: at.clamp(0.0, 1.0),
            });
        });
    }

    /// Whether a drag spans a box of vertices to hold, without the shift key.
    #[wasm_bindgen(js_name = setBoxTool)]
    pub fn set_box_tool(&self, on: bool) {
        self.body(|body| body.box_tool = on);
    }

    /// Whether the skin takes the colours of the field.
    #[wasm_bindgen(js_name = setTinted)]
    pub fn set_tinted(&self, on: bool) {
        self.change(|bench| bench.tinted = on);
    }

    /// Whether it does.
    #[wasm_bindgen(getter)]
    pub fn tinted(&self) -> bool {
        self.change(|bench| bench.tinted)
    }

    /// Tetrahedra the plane of the cut meets, as drawn last.
    #[wasm_bindgen(getter, js_name = cutTetrahedra)]
    pub fn cut_tetrahedra(&self) -> usize {
        self.body(|body| body.met.len())
    }

    /// Where a vertex appears in the view of the skin, in points from the canvas's upper left corner;
    /// empty before it was drawn.
    #[wasm_bindgen(js_name = placeOf)]
    pub fn place_of(&self, vertex: usize) -> Vec<f32> {
        self.change(|bench| {
            let place = || {
                let positions = bench.map()?.as_chunks::<3>().0;
                let (rect, lens) = bench.body.as_ref()?.view?;
                let (at, _) = lens.project(Vec3::from_array(*positions.get(vertex)?));
                Some(vec![rect.left() + at.x, rect.top() + at.y])
            };
            place().unwrap_or_default()
        })
    }

    /// How far a handle moves in the model by a step to the right and one up in the view, at its
    /// depth: two vectors of `step` times the solid's radius.
    #[wasm_bindgen(js_name = cameraAxes)]
    pub fn camera_axes(&self, step: f32) -> Vec<f32> {
        self.change(|bench| {
            let back = bench.orbit.rotation.inverse();
            let reach = step * bench.orbit.radius;
            [back * Vec3::X * reach, back * Vec3::Y * reach]
                .iter()
                .flat_map(|v| v.to_array())
                .collect()
        })
    }
}
