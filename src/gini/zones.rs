//! Zones: constraints that share vertices that move, directly or through others (§5).

use super::constraint::Constraint;
use crate::disjoint_sets::DisjointSets;

/// The zones of a constraint set.
#[derive(Default)]
pub struct Zones {
    /// Where each zone's constraints begin, and all of them.
    begin: Vec<u32>,
    constraints: Vec<u32>,
    /// Where each zone's vertices begin, and their slots.
    vertex_begin: Vec<u32>,
    vertices: Vec<u32>,
    /// Of each slot its place in its zone.
    local: Vec<u32>,
}

impl Zones {
    /// The place of a vertex that is held, or in no zone.
    pub const HELD: u32 = u32::MAX;

    /// Of a mesh with so many slots.
    pub fn new(slots: usize) -> Self {
        Self {
            local: vec![Self::HELD; slots],
            ..Default::default()
        }
    }

    /// Finds the zones, in the order of their first constraints.
    pub fn build(&mut self, constraints: &[Constraint], movable: &[bool]) {
        for &slot in &self.vertices {
            self.local[slot as usize] = Self::HELD;
        }
        // of each vertex the first constraint it is met in
        let mut sets = DisjointSets::new(constraints.len());
        for (c, constraint) in constraints.iter().enumerate() {
            for &slot in &constraint.slots {
                let first = &mut self.local[slot as usize];
                if !movable[slot as usize] {
                    continue;
                }
                match *first {
                    Self::HELD => *first = c as u32,
                    first => {
                        sets.join(first, c as u32);
                    }
                }
            }
        }
        // a zone is numbered by its lowest constraint, which is the root of its set
        let mut number = vec![0u32; constraints.len()];
        let mut count = 0;
        for c in 0..constraints.len() as u32 {
            number[c as usize] = match sets.find(c) {
                root if root == c => {
                    count += 1;
                    count - 1
                }
                root => number[root as usize],
            };
        }
        let zones = count as usize;
        self.begin.clear();
        self.begin.resize(zones + 1, 0);
        number.iter().for_each(|&z| self.begin[z as usize + 1] += 1);
        for z in 0..zones {
            self.begin[z + 1] += self.begin[z];
        }
        let mut next = self.begin.clone();
        self.constraints.resize(constraints.len(), 0);
        for (c, &z) in number.iter().enumerate() {
            self.constraints[next[z as usize] as usize] = c as u32;
            next[z as usize] += 1;
        }
        self.vertices.clear();
        self.vertex_begin.clear();
        self.vertex_begin.push(0);
        for z in 0..zones {
            for &c in &self.constraints[self.begin[z] as usize..self.begin[z + 1] as usize] {
                let first = self.vertices.len();
                for &slot in &constraints[c as usize].slots {
                    // a vertex is taken with the first constraint it is met in, and once
                    let is_first = self.local[slot as usize] == c;
                    if is_first && !self.vertices[first..].contains(&slot) {
                        self.vertices.push(slot);
                    }
                }
            }
            self.vertex_begin.push(self.vertices.len() as u32);
        }
        for z in 0..zones {
            let range = self.vertex_begin[z] as usize..self.vertex_begin[z + 1] as usize;
            for (local, &slot) in self.vertices[range].iter().enumerate() {
                self.local[slot as usize] = local as u32;
            }
        }
    }

    /// Number of zones.
    pub fn len(&self) -> usize {
        self.begin.len().saturating_sub(1)
    }

    /// The constraints of a zone.
    pub fn constraints(&self, zone: usize) -> &[u32] {
        &self.constraints[self.begin[zone] as usize..self.begin[zone + 1] as usize]
    }

    /// Slots of the vertices of a zone that move.
    pub fn vertices(&self, zone: usize) -> &[u32] {
        &self.vertices[self.vertex_begin[zone] as usize..self.vertex_begin[zone + 1] as usize]
    }

    /// The place of a vertex in its zone.
    pub fn local(&self, slot: u32) -> u32 {
        self.local[slot as usize]
    }
}
