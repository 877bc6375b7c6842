//! Contacts in the constraint set (§6.1): found by continuous collision detection from x to x̂.

use super::constraint::{Constraint, Key, Law};
use super::contact::weights;
use super::elements::FIRST_DAMPING;
use super::set::ConstraintSet;
use super::simplex::{corners, signed_measure};
use crate::collision::vector::{dot, normal, sub};
use crate::collision::{Boundary, BroadPhase, Candidate, Impact, Pair, intersections, overlaps};

/// By how much the η of a contact is reduced where the polisher has not succeeded, and what it is not reduced below,
/// relative to the first.
const FACTOR: f64 = 0.5;
const LEAST: f64 = 0.1;

/// How near two parts may come on the way between two accepted states, in units of the least η: much less than what the
/// constraints ask for at its end, so that pairs that meet these are free.
const GAP: f64 = 1e-3;

/// Volumes of air below this part of its size cubed have no sign: the edges are as good as in one plane.
const FLAT: f64 = 1e-10;

/// The boundary, and what is known of its contacts.
pub struct Contacts<const D: usize> {
    boundary: Boundary<D>,
    broad: BroadPhase<D>,
    /// D + 1 slots for each element.
    elements: Vec<u32>,
    /// η where none has been reduced.
    offset: f64,
    /// By slot: η relative to that; of a contact it is the least of its vertices'.
    relative: Vec<f64>,
    taken: Taken,
}

/// What has a contact: by slot, by facet, by edge.
struct Taken {
    vertices: Vec<bool>,
    facets: Vec<bool>,
    edges: Vec<bool>,
}

impl Taken {
    fn clear(&mut self) {
        self.vertices.fill(false);
        self.facets.fill(false);
        self.edges.fill(false);
    }

    /// Marks both parts of a contact. Was one of them without?
    fn take(&mut self, contact: &Candidate) -> bool {
        let mark = |mark: &mut bool| !std::mem::replace(mark, true);
        match *contact {
            Candidate::VertexFacet { vertex, facet } => {
                mark(&mut self.vertices[vertex as usize]) | mark(&mut self.facets[facet as usize])
            }
            Candidate::EdgeEdge { edges: [e, f] } => {
                mark(&mut self.edges[e as usize]) | mark(&mut self.edges[f as usize])
            }
        }
    }
}

impl<const D: usize> Contacts<D> {
    /// Of a boundary of slots.
    pub fn new(boundary: Boundary<D>, elements: Vec<u32>, slots: usize, offset: f64) -> Self {
        Self {
            taken: Taken {
                vertices: vec![false; slots],
                facets: vec![false; boundary.facets.len()],
                edges: vec![false; boundary.edges.len()],
            },
            boundary,
            broad: BroadPhase::default(),
            elements,
            offset,
            relative: vec![1.0; slots],
        }
    }

    /// The facets, by slots.
    pub fn facets(&self) -> &[[u32; D]] {
        &self.boundary.facets
    }

    /// Pairs of facets that meet, at most so many. Exact.
    pub fn intersections(&mut self, x: &[[f64; D]], limit: usize) -> Vec<[u32; 2]> {
        intersections(&self.boundary, x, &mut self.broad, limit)
    }

    /// The same with a tree of its own.
    pub fn meeting(&self, x: &[[f64; D]], limit: usize) -> Vec<[u32; 2]> {
        intersections(&self.boundary, x, &mut BroadPhase::default(), limit)
    }

    /// Has the next tree built anew.
    pub fn forget(&mut self) {
        self.broad.forget();
    }

    /// Parts of the boundary that are inside elements. Exact.
    pub fn overlaps(&self, x: &[[f64; D]]) -> Vec<[u32; 2]> {
        overlaps(&self.boundary, &self.elements, x)
    }

    /// Brings contacts up to date: what has come to collide between x and x̂ joins the set, the first contact of every
    /// vertex, facet and edge that has none; those that do not collide become proximal. Returns how many pairs collide.
    pub fn update(
        &mut self,
        set: &mut ConstraintSet,
        x: &[[f64; D]],
        trial: &[[f64; D]],
        movable: &[bool],
    ) -> usize {
        let gap = self.gap();
        let boundary = &self.boundary;
        let hits = self.broad.collisions(boundary, x, trial, gap, |c| {
            c.vertices(boundary).iter().any(|&v| movable[v as usize])
        });
        let hit = |contact: Candidate| {
            let place = hits.binary_search_by_key(&contact, |h| h.0).ok()?;
            Some(hits[place].1)
        };
        self.taken.clear();
        let mut known = Vec::new();
        for constraint in &mut set.list {
            let Key::Contact(contact) = constraint.key else {
                continue;
            };
            let impact = hit(contact);
            constraint.proximal = impact.is_none();
            constraint.law = constraint.base;
            if let Some(impact) = impact {
                insist(constraint, contact.pair(), impact, x, trial);
            }
            constraint.skipped = constraint.proximal && !is_opposite(constraint, trial);
            known.push(contact);
            self.taken.take(&contact);
        }
        known.sort_unstable();
        let mut new = hits.clone();
        new.retain(|(c, _)| known.binary_search(c).is_err());
        new.sort_unstable_by(|a, b| a.1.time.total_cmp(&b.1.time).then(a.0.cmp(&b.0)));
        let before = set.list.len();
        // where everything has a contact already and yet collides, once more as if nothing had one
        for round in 0..2 {
            for &(c, impact) in &new {
                if self.taken.take(&c) {
                    let mut constraint = self.constraint(&c, x, trial, impact.time);
                    insist(&mut constraint, c.pair(), impact, x, trial);
                    set.list.push(constraint);
                }
            }
            if round > 0 || new.is_empty() || set.list.len() > before {
                break;
            }
            self.taken.clear();
        }
        hits.len()
    }

    /// The slots of pairs that collide between x and x̂.
    pub fn colliding(
        &mut self,
        x: &[[f64; D]],
        trial: &[[f64; D]],
        movable: &[bool],
    ) -> Vec<[u32; 4]> {
        let boundary = &self.boundary;
        let hits = self.broad.collisions(boundary, x, trial, self.gap(), |c| {
            c.vertices(boundary).iter().any(|&v| movable[v as usize])
        });
        hits.iter().map(|hit| hit.0.vertices(boundary)).collect()
    }

    /// The largest of a few lengths between this and η that no two parts are nearer to each other than.
    pub fn room(&mut self, x: &[[f64; D]], movable: &[bool]) -> f64 {
        let least = self.gap();
        let mut room = least / GAP;
        while room > 2.0 * least {
            let boundary = &self.boundary;
            let near = self.broad.collisions(boundary, x, x, room, |c| {
                c.vertices(boundary).iter().any(|&v| movable[v as usize])
            });
            if near.is_empty() {
                return room;
            }
            room *= 0.25;
        }
        least
    }

    /// How near two parts may come on the way.
    fn gap(&self) -> f64 {
        let least = self.relative.iter().copied().fold(1.0, f64::min);
        GAP * least * self.offset
    }

    /// The constraint of a pair that collides at this time.
    fn constraint(
        &self,
        c: &Candidate,
        x: &[[f64; D]],
        trial: &[[f64; D]],
        time: f64,
    ) -> Constraint {
        let mut slots = c.vertices(&self.boundary);
        let law = match c.pair() {
            Pair::EdgeEdge => {
                let signed = [1.0, 0.5, 0.0].iter().find_map(|part| {
                    let p = between(&slots, x, trial, part * time);
                    let surface = surface(&p);
                    let volume = signed_measure(&p);
                    (volume.abs() > FLAT * surface.powf(1.5)).then(|| (volume, 2.0 / surface))
                });
                match signed {
                    Some((volume, scale)) => {
                        // positive before it happens
                        if volume < 0.0 {
                            slots.swap(2, 3);
                        }
                        Law::Measure { scale }
                    }
                    // in one plane all the time
                    None => Law::Measure { scale: 0.0 },
                }
            }
            Pair::VertexFace => Law::Gap,
        };
        Constraint {
            key: Key::Contact(*c),
            slots,
            law,
            base: law,
            offset: self.offset(&slots),
            lambda: 0.0,
            damping: FIRST_DAMPING,
            proximal: false,
            skipped: false,
        }
    }

    fn offset(&self, slots: &[u32; 4]) -> f64 {
        let relative = slots.iter().map(|&s| self.relative[s as usize]);
        self.offset * relative.fold(1.0, f64::min)
    }

    /// Contacts far apart at x̄ beside what they are at x are over (§6.2), and so is air between edges that do not
    /// collide. Those that are not opposite at x̄ do not count in the quadratic problem to come.
    pub fn remove(&self, set: &mut ConstraintSet, x: &[[f64; D]], iterate: &[[f64; D]]) {
        set.retain(|c| match c.key {
            Key::Element(_) => true,
            _ if !c.proximal => true,
            Key::Contact(Candidate::EdgeEdge { .. }) => false,
            _ => c.value(iterate) - c.value(x) <= 100.0 * c.offset,
        });
    }

    /// Before the quadratic problem: proximal contacts that are not opposite at x̄ do not count.
    pub fn skip(&self, set: &mut ConstraintSet, iterate: &[[f64; D]]) {
        for c in set.list.iter_mut().filter(|c| c.key.is_contact()) {
            c.skipped = c.proximal && !is_opposite(c, iterate);
        }
    }

    /// Reduces η at these slots.
    pub fn back_off(&mut self, slots: impl Iterator<Item = u32>) {
        let mut slots: Vec<u32> = slots.collect();
        slots.sort_unstable();
        slots.dedup();
        for s in slots {
            let relative = &mut self.relative[s as usize];
            *relative = (FACTOR * *relative).max(LEAST);
        }
    }

    /// Takes over the η of the vertices.
    pub fn set_offsets(&self, set: &mut ConstraintSet) {
        for c in set.list.iter_mut().filter(|c| c.key.is_contact()) {
            c.offset = self.offset(&c.slots);
        }
    }
}

/// Are the parts opposite to each other? Air between edges in one plane is never between them.
fn is_opposite<const D: usize>(constraint: &Constraint, x: &[[f64; D]]) -> bool {
    constraint.base != Law::Measure { scale: 0.0 } && constraint.is_opposite(x)
}

/// The corners at a time between x and x̂.
fn between<const D: usize>(
    slots: &[u32; 4],
    x: &[[f64; D]],
    trial: &[[f64; D]],
    time: f64,
) -> [[f64; D]; 4] {
    let (mut p, to) = (corners(x, slots), corners(trial, slots));
    for (p, to) in p.as_flattened_mut().iter_mut().zip(to.as_flattened()) {
        *p += time * (to - *p);
    }
    p
}

/// A contact that collides, but is content at x̂, is given the law of the impact.
fn insist<const D: usize>(
    constraint: &mut Constraint,
    pair: Pair,
    impact: Impact<D>,
    x: &[[f64; D]],
    trial: &[[f64; D]],
) {
    let content = match constraint.base {
        Law::Measure { scale: 0.0 } => true,
        _ => constraint.value(trial) >= constraint.offset,
    };
    if !content {
        return;
    }
    let mut normal = [0.0; 3];
    normal[..D].copy_from_slice(&impact.normal);
    constraint.law = Law::Impact {
        normal,
        weights: weights(pair, &between(&constraint.slots, x, trial, impact.time)),
    };
}

/// The area of the surface of a tetrahedron.
fn surface<const D: usize>(p: &[[f64; D]; 4]) -> f64 {
    let faces = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];
    let area = |[a, b, c]: [usize; 3]| {
        let n = normal(sub(p[b], p[a]), sub(p[c], p[a]));
        0.5 * dot(n, n).sqrt()
    };
    faces.map(area).iter().sum()
}
