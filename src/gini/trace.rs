//! What a step goes through, for those who want to see it: the iterations of the quadratic problem, then the polisher's.

use super::constraint::{Constraint, Key};
use super::dual::Visited;
use super::solver::Gini;
use crate::collision::Pair;
use crate::optim::{Phase, Stopwatch};

/// Pairs of facets that meet are counted up to here.
const MOST_MEETING: usize = 100_000;

/// A state inside a step: x̄ as the quadratic problem has it after so many of its iterations, or x̂ before an iteration
/// of the polisher or after the last; and what is worked on there.
#[derive(Debug, Clone, PartialEq)]
pub struct TraceState {
    /// Vertices × dimension, interleaved.
    pub positions: Vec<f64>,
    /// Elements that are inverted or flat, in floating point.
    pub inverted: usize,
    /// Elements below their η.
    pub violated: usize,
    /// Where overlap counts: pairs of boundary facets that meet, exactly, up to 100 000.
    pub meeting: Option<usize>,
    /// The contacts in the constraint set, those apart that do not count for now (§6.1).
    pub contacts: Vec<TraceContact>,
    /// Of each element the zone of violated constraints that it is in, the first being 1; 0: in none. Empty of states of
    /// the quadratic problem, which has no zones.
    pub zones: Vec<u32>,
}

/// Two parts of the boundary that must not pass through each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TraceContact {
    /// A vertex and those of a facet (the last of an edge in the plane twice), or those of two edges.
    pub vertices: [u32; 4],
    /// Which of the two.
    pub pair: Pair,
    /// In the quadratic problem: its multiplier is not 0. In the polisher: the two collide on the way from x to x̂. Those
    /// that are not active are proximal: they did collide before, and keep their place in the set.
    pub active: bool,
    /// Of the polisher: the zone of violated constraints that it is in, the first being 1; 0: in none.
    pub zone: u32,
}

/// What is kept of a step.
pub struct Trace<const D: usize> {
    quadratic: Vec<TraceState>,
    polisher: Vec<TraceState>,
    /// Where the quadratic problem writes what it goes through, in the main step only.
    path: Option<Vec<Visited<D>>>,
    /// Vertex of each slot.
    vertex: Vec<u32>,
    /// Spent on it in the phase under way: no work of the method's.
    milliseconds: f64,
}

impl<const D: usize> Trace<D> {
    /// Where the quadratic problem writes what it goes through, if that is wanted.
    pub fn path(&mut self) -> Option<&mut Vec<Visited<D>>> {
        self.path.as_mut()
    }
}

impl<const D: usize> Gini<D> {
    /// Keeps the states inside of every step from here on, or no more.
    pub fn set_trace(&mut self, on: bool) {
        self.trace = on.then(|| {
            let mut vertex = vec![0; self.slot.len()];
            for (v, &slot) in self.slot.iter().enumerate() {
                vertex[slot as usize] = v as u32;
            }
            Trace {
                quadratic: Vec::new(),
                polisher: Vec::new(),
                path: None,
                vertex,
                milliseconds: 0.0,
            }
        });
    }

    /// The polisher's states in the newest step: one before each of its iterations, and one after the last. Empty
    /// before the first step, and where they are not kept.
    pub fn trace(&self) -> &[TraceState] {
        self.trace.as_ref().map_or(&[], |trace| &trace.polisher)
    }

    /// The states of the quadratic problem in the newest step: x̄(λ) (9) with the multipliers of the step before, and
    /// after each iteration of L-BFGS-B. The last is where the polisher begins.
    pub fn quadratic_trace(&self) -> &[TraceState] {
        self.trace.as_ref().map_or(&[], |trace| &trace.quadratic)
    }

    /// A step begins.
    pub(super) fn begin_trace(&mut self) {
        if let Some(trace) = &mut self.trace {
            trace.quadratic.clear();
            trace.polisher.clear();
            trace.path = Some(Vec::new());
            trace.milliseconds = 0.0;
        }
    }

    /// Keeps what the quadratic problem went through. Its constraints are those it had.
    pub(super) fn trace_quadratic(&mut self) {
        let clock = Stopwatch::start();
        let path = self.trace.as_mut().and_then(|trace| trace.path.take());
        let mut states = Vec::new();
        for Visited { mut x, active } in path.unwrap_or_default() {
            if !x.as_flattened().iter().all(|x| x.is_finite()) {
                break; // it begins anew
            }
            self.keep_centroids_of(&mut x);
            let mut values = vec![0.0; self.order.len()];
            self.elements.values(&x, &mut values);
            let elements = || (0..values.len()).filter(|&e| self.elements.movable[e]);
            let inverted = elements().filter(|&e| !(values[e] > 0.0)).count();
            let below = |e: &usize| !(values[*e] >= self.elements.offset(*e));
            let violated = elements().filter(below).count();
            states.push(TraceState {
                contacts: self.traced_contacts(|c| active[c]),
                ..self.traced(&x, inverted, violated)
            });
        }
        if let Some(trace) = &mut self.trace {
            trace.quadratic = states;
            trace.milliseconds += clock.milliseconds();
        }
    }

    /// Keeps x̂, of which no zones are known yet.
    pub(super) fn trace_state(&mut self, inverted: usize, violated: usize) {
        if self.trace.is_none() {
            return;
        }
        let clock = Stopwatch::start();
        let state = TraceState {
            contacts: self.traced_contacts(|c| !self.set.list[c].proximal),
            zones: vec![0; self.order.len()],
            ..self.traced(&self.trial, inverted, violated)
        };
        if let Some(trace) = &mut self.trace {
            trace.polisher.push(state);
            trace.milliseconds += clock.milliseconds();
        }
    }

    /// What the trace has cost since the last phase ended, in milliseconds.
    pub(super) fn trace_milliseconds(&self) -> f64 {
        self.trace.as_ref().map_or(0.0, |trace| trace.milliseconds)
    }

    /// A phase that has ended, without what the trace has cost.
    pub(super) fn without_trace(&mut self, mut phase: Phase) -> Phase {
        phase.milliseconds -= self.trace_milliseconds();
        if let Some(trace) = &mut self.trace {
            trace.milliseconds = 0.0;
        }
        phase
    }

    /// A state by vertices, without contacts and zones.
    fn traced(&self, x: &[[f64; D]], inverted: usize, violated: usize) -> TraceState {
        let contacts = self.contacts.as_ref();
        TraceState {
            positions: self.slot.iter().flat_map(|&s| x[s as usize]).collect(),
            inverted,
            violated,
            meeting: contacts.map(|contacts| contacts.meeting(x, MOST_MEETING).len()),
            contacts: Vec::new(),
            zones: Vec::new(),
        }
    }

    /// The contacts of the set that count, by vertices.
    fn traced_contacts(&self, is_active: impl Fn(usize) -> bool) -> Vec<TraceContact> {
        let Some(trace) = &self.trace else {
            return Vec::new();
        };
        let all = self.set.list.iter().enumerate();
        all.filter_map(|(place, c)| match c.key {
            Key::Contact(candidate) if !c.skipped => Some(TraceContact {
                vertices: c.slots.map(|slot| trace.vertex[slot as usize]),
                pair: candidate.pair(),
                active: is_active(place),
                zone: 0,
            }),
            _ => None,
        })
        .collect()
    }

    /// Keeps the zones of the state that was kept last: those with violated constraints, as the polisher counts them.
    pub(super) fn trace_zones(&mut self) {
        let trace = self.trace.as_mut();
        let Some(state) = trace.and_then(|trace| trace.polisher.last_mut()) else {
            return;
        };
        // x̂ has been polished since: what was violated is what was at the state that was kept
        let mut before = self.trial.clone();
        let kept = state.positions.as_chunks::<D>().0.iter();
        for (position, &slot) in kept.zip(&self.slot) {
            before[slot as usize] = *position;
        }
        // of each constraint its place among the contacts that were kept
        let mut contacts = 0..state.contacts.len();
        let is_kept = |c: &Constraint| c.key.is_contact() && !c.skipped;
        let list = self.set.list.iter();
        let places: Vec<Option<usize>> = list
            .map(|c| is_kept(c).then(|| contacts.next()).flatten())
            .collect();
        let mut number = 0;
        for z in 0..self.zones.len() {
            let members = self.zones.constraints(z).iter();
            let all = members.clone().map(|&c| &self.set.list[c as usize]);
            if !all.clone().any(|c| c.is_violated(&before)) {
                continue;
            }
            number += 1;
            for (constraint, &place) in all.zip(members) {
                if let Key::Element(e) = constraint.key {
                    state.zones[self.order[e as usize] as usize] = number;
                } else if let Some(contact) = places[place as usize] {
                    state.contacts[contact].zone = number;
                }
            }
        }
    }
}
