//! What holds a body in place: pins and targets, for every component.

use crate::disjoint_sets::DisjointSets;
use crate::mesh::{SimplicialMesh, counted};
use crate::optim::{BuildError, Spring};
use glam::DVec3;

/// Where a vertex is wanted. A pinned vertex is moved there, a free one pulled by a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// The vertex.
    pub vertex: u32,
    /// Where to, in the units of the mesh.
    pub position: DVec3,
}

/// The held vertices and the components of a mesh.
#[derive(Debug, Clone)]
pub struct Supports {
    /// Is the vertex held where it is: pinned, or part of no element?
    pub is_held: Vec<bool>,
    /// For each vertex the lowest of its component; itself if it is part of no element.
    component: Vec<u32>,
    /// Is the vertex part of an element?
    used: Vec<bool>,
    /// Is a vertex of this component pinned? (At the component's lowest vertex.)
    pinned: Vec<bool>,
}

fn wrong<T>(option: &'static str, what: String) -> Result<T, BuildError> {
    Err(BuildError::InvalidOption { option, what })
}

impl Supports {
    /// Of a mesh with these pins.
    ///
    /// # Errors
    /// `InvalidOption` for pins out of range, or that leave nothing free.
    pub fn new<const K: usize>(
        mesh: &SimplicialMesh<K>,
        pins: &[u32],
        notes: &mut Vec<String>,
    ) -> Result<Self, BuildError> {
        let n = mesh.positions.len();
        if let Some(&bad) = pins.iter().find(|&&v| v as usize >= n) {
            return wrong("pins", format!("vertex {bad} of {n} (the first is 0)"));
        }
        let mut is_held = vec![false; n];
        pins.iter().for_each(|&v| is_held[v as usize] = true);
        let mut components = DisjointSets::new(n);
        let mut used = vec![false; n];
        for simplex in &mesh.simplices {
            for &v in simplex {
                used[v as usize] = true;
                components.join(simplex[0], v);
            }
        }
        let component: Vec<u32> = (0..n as u32).map(|v| components.find(v)).collect();
        let mut pinned = vec![false; n];
        for v in 0..n {
            pinned[component[v] as usize] |= is_held[v];
        }
        let unused = used.iter().filter(|used| !**used).count();
        if unused > 0 {
            let vertices = counted(unused, "vertex");
            notes.push(format!("{vertices} in no element: left where they start"));
        }
        for (held, used) in is_held.iter_mut().zip(&used) {
            *held |= !used;
        }
        if is_held.iter().all(|&held| held) {
            let what = "hold all vertices: there is nothing to solve for";
            return wrong("pins", what.into());
        }
        Ok(Self {
            is_held,
            component,
            used,
            pinned,
        })
    }

    /// The held vertices, in ascending order.
    pub fn held(&self) -> Vec<u32> {
        let vertices = 0..self.is_held.len() as u32;
        vertices.filter(|&v| self.is_held[v as usize]).collect()
    }

    /// Checks that every component has a pin or one of these targets.
    ///
    /// # Errors
    /// `InvalidOption` names the lowest vertex of one that has neither.
    pub fn check(&self, targets: impl Iterator<Item = u32>) -> Result<(), BuildError> {
        let mut fixed = self.pinned.clone();
        targets.for_each(|v| fixed[self.component[v as usize] as usize] = true);
        let floats = |&v: &usize| self.used[v] && !fixed[self.component[v] as usize];
        match (0..self.used.len()).find(floats) {
            Some(v) => wrong(
                "pins",
                format!(
                    "the component of vertex {v} has no pin and no target: it could float away"
                ),
            ),
            None => Ok(()),
        }
    }

    /// Targets as moves of held vertices and springs on free ones. Every component must have a pin or a target.
    #[allow(clippy::type_complexity)]
    pub fn split(
        &self,
        targets: &[Target],
        stiffness: &[f64],
    ) -> Result<(Vec<(u32, [f64; 3])>, Vec<Spring>), BuildError> {
        let parts = self.split_free(targets, stiffness)?;
        self.check(targets.iter().map(|t| t.vertex))?;
        Ok(parts)
    }

    /// The same where components may be free.
    #[allow(clippy::type_complexity)]
    pub fn split_free(
        &self,
        targets: &[Target],
        stiffness: &[f64],
    ) -> Result<(Vec<(u32, [f64; 3])>, Vec<Spring>), BuildError> {
        let n = self.is_held.len();
        let wrong = |what| wrong("targets", what);
        let (mut moved, mut springs) = (Vec::new(), Vec::new());
        let mut has_target = vec![false; n];
        for &Target { vertex, position } in targets {
            let v = vertex as usize;
            if v >= n {
                return wrong(format!("vertex {v} of {n} (the first is 0)"));
            }
            if !position.is_finite() {
                return wrong(format!("the target of vertex {v} is not finite"));
            }
            if has_target[v] {
                return wrong(format!("vertex {v} has two targets"));
            }
            has_target[v] = true;
            let target = position.to_array();
            match self.is_held[v] {
                true => moved.push((vertex, target)),
                false => springs.push(Spring {
                    vertex,
                    stiffness: stiffness[v],
                    target,
                }),
            }
        }
        Ok((moved, springs))
    }
}
