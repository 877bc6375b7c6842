//! Level 1: local Gauss–Seidel. Only unknowns whose residual is above the tolerance are looked at; each
//! that moves calls its neighbours.

use super::system::System;
use std::collections::VecDeque;

/// The queue, without duplicates, and what has moved.
#[derive(Debug, Clone, Default)]
pub(super) struct GaussSeidel {
    queue: VecDeque<u32>,
    is_queued: Vec<bool>,
    has_moved: Vec<bool>,
    moved: Vec<u32>,
}

impl GaussSeidel {
    pub fn new(unknowns: usize) -> Self {
        Self {
            is_queued: vec![false; unknowns],
            has_moved: vec![false; unknowns],
            ..Self::default()
        }
    }

    fn push(&mut self, i: u32) {
        if !std::mem::replace(&mut self.is_queued[i as usize], true) {
            self.queue.push_back(i);
        }
    }

    /// Works off the residuals around what was changed, looking at no more than `most` unknowns: how many
    /// it were, and whether nothing is left to do.
    pub fn run(
        &mut self,
        system: &mut System,
        changed: &[u32],
        most: u32,
        tolerance: f64,
    ) -> (u32, bool) {
        for &i in changed {
            for &(j, _) in system.neighbours(i as usize) {
                if system.is_open(j as usize, tolerance) {
                    self.push(j);
                }
            }
        }
        let mut pops = 0;
        while pops < most
            && let Some(i) = self.queue.pop_front()
        {
            pops += 1;
            let k = i as usize;
            self.is_queued[k] = false;
            if !system.is_open(k, tolerance) {
                continue;
            }
            system.change(k, system.residual[k] / system.diagonal[k]);
            if !std::mem::replace(&mut self.has_moved[k], true) {
                self.moved.push(i);
            }
            for &(j, _) in system.neighbours(k) {
                if system.is_open(j as usize, tolerance) {
                    self.push(j);
                }
            }
        }
        let settled = self.queue.is_empty();
        for i in self.queue.drain(..) {
            self.is_queued[i as usize] = false;
        }
        (pops, settled)
    }

    /// What has moved since the last call, in the order in which it did.
    pub fn take_moved(&mut self) -> Vec<u32> {
        for &i in &self.moved {
            self.has_moved[i as usize] = false;
        }
        std::mem::take(&mut self.moved)
    }
}
