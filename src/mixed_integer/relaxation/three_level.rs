//! Greedy and direct rounding with the three-level solver (paper, §3.2).

use super::cholesky;
use super::conjugate_gradients::ConjugateGradients;
use super::gauss_seidel::GaussSeidel;
use super::system::System;
use crate::linalg::{Cholesky, NotPositiveDefinite};
use crate::mixed_integer::options::MixedIntegerOptions;
use crate::mixed_integer::reduced::Reduced;
use crate::mixed_integer::report::{Level, LevelCounts, Rounded};
use crate::mixed_integer::search::{nearest, preference};
use std::collections::BTreeSet;

/// The state of rounding.
pub struct ThreeLevel {
    system: System,
    gauss_seidel: GaussSeidel,
    gradients: ConjugateGradients,
    /// Integers that are not fixed, the nearest first; ties by number of their unknown.
    queue: BTreeSet<(u32, u32)>,
    /// What each integer is queued under.
    key: Vec<u32>,
    /// Which integer a position is.
    integer_at: Vec<u32>,
    counts: LevelCounts,
}

const NONE: u32 = u32::MAX;

impl ThreeLevel {
    /// For this reduced problem; begins with [`Self::start`].
    pub fn new(reduced: &Reduced) -> Self {
        let m = reduced.dimension();
        let mut integer_at = vec![NONE; m];
        for (k, &position) in reduced.integers().iter().enumerate() {
            integer_at[position as usize] = k as u32;
        }
        Self {
            system: System::new(reduced.matrix()),
            gauss_seidel: GaussSeidel::new(m),
            gradients: ConjugateGradients::new(m),
            queue: BTreeSet::new(),
            key: vec![0; reduced.integers().len()],
            integer_at,
            counts: LevelCounts::default(),
        }
    }

    /// Begins at the relaxed solution.
    pub fn start(&mut self, reduced: &Reduced, relaxed: &[f64]) {
        self.system.start(reduced, relaxed);
        self.counts = LevelCounts::default();
        self.queue_all(reduced);
    }

    /// The iterate, in elimination order.
    pub fn iterate(&self) -> &[f64] {
        &self.system.y
    }
    /// Its energy.
    pub fn energy(&self) -> f64 {
        self.system.energy
    }
    /// Integers that are not fixed.
    pub fn remaining(&self) -> usize {
        self.queue.len()
    }
    /// How often each level finished.
    pub fn counts(&self) -> LevelCounts {
        self.counts
    }

    fn queue_all(&mut self, reduced: &Reduced) {
        self.queue.clear();
        for (k, &position) in reduced.integers().iter().enumerate() {
            if !self.system.fixed[position as usize] {
                self.key[k] = preference(self.system.y[position as usize]);
                self.queue.insert((self.key[k], k as u32));
            }
        }
    }

    /// Rounds the nearest, and more of them as long as their distances add up to at most `budget`; then
    /// lets the others follow. Says which level finished and how many unknowns moved.
    pub fn step(
        &mut self,
        reduced: &Reduced,
        cholesky: &mut Cholesky,
        options: &MixedIntegerOptions,
        budget: f64,
    ) -> Result<(Vec<Rounded>, Level, usize), NotPositiveDefinite> {
        let mut spent = 0.0;
        let mut rounded: Vec<Rounded> = Vec::new();
        let mut changed: Vec<u32> = Vec::new();
        while let Some(&(_, k)) = self.queue.first() {
            let position = reduced.integers()[k as usize];
            let from = self.system.y[position as usize];
            let to = nearest(from);
            spent += (to - from).abs();
            if !rounded.is_empty() && spent > budget {
                break;
            }
            self.queue.pop_first();
            changed.push(position);
            rounded.push(Rounded {
                unknown: reduced.unknown(position),
                from,
                to,
            });
        }
        for (&position, r) in changed.iter().zip(&rounded) {
            self.system.fix(position as usize, r.to);
        }
        let (level, spread) = self.follow(reduced, cholesky, options, &changed)?;
        Ok((rounded, level, spread))
    }

    /// Rounds all integers at once (paper, §3.1); the reals follow in [`Self::finish`].
    pub fn direct(&mut self, reduced: &Reduced) -> Vec<Rounded> {
        self.queue.clear();
        let round = |&position: &u32| {
            let from = self.system.y[position as usize];
            Rounded {
                unknown: reduced.unknown(position),
                from,
                to: nearest(from),
            }
        };
        let rounded: Vec<Rounded> = reduced.integers().iter().map(round).collect();
        for (&position, r) in reduced.integers().iter().zip(&rounded) {
            self.system.fix(position as usize, r.to);
        }
        rounded
    }

    /// With all integers fixed: the reals, by Cholesky and once again for the last digits.
    pub fn finish(
        &mut self,
        reduced: &Reduced,
        cholesky: &mut Cholesky,
    ) -> Result<(), NotPositiveDefinite> {
        self.system.refresh(reduced);
        cholesky::solve(cholesky, reduced, &mut self.system, 2)
    }

    /// The three levels.
    fn follow(
        &mut self,
        reduced: &Reduced,
        cholesky: &mut Cholesky,
        options: &MixedIntegerOptions,
        changed: &[u32],
    ) -> Result<(Level, usize), NotPositiveDefinite> {
        let tolerance = options.residual;
        let mut settled = false;
        if options.gauss_seidel > 0 {
            let (pops, done) =
                self.gauss_seidel
                    .run(&mut self.system, changed, options.gauss_seidel, tolerance);
            self.counts.pops += u64::from(pops);
            settled = done;
        }
        let moved = self.gauss_seidel.take_moved();
        if settled {
            self.counts.gauss_seidel += 1;
            for &position in &moved {
                let k = self.integer_at[position as usize];
                if k == NONE {
                    continue;
                }
                let new = preference(self.system.y[position as usize]);
                let key = &mut self.key[k as usize];
                if *key != new && self.queue.remove(&(*key, k)) {
                    *key = new;
                    self.queue.insert((new, k));
                }
            }
            return Ok((Level::GaussSeidel, moved.len()));
        }
        let mut level = Level::None;
        if options.conjugate_gradients > 0 {
            let most = options.conjugate_gradients;
            let (iterations, done) = self.gradients.run(&mut self.system, most, tolerance);
            self.counts.iterations += u64::from(iterations);
            if done {
                level = Level::ConjugateGradients;
            }
        }
        if level == Level::None && self.system.is_settled(tolerance) {
            // nothing to do, and no level was asked
            level = Level::ConjugateGradients;
        }
        if level == Level::None && options.cholesky {
            cholesky::solve(cholesky, reduced, &mut self.system, 1)?;
            level = Level::Cholesky;
        }
        match level {
            Level::ConjugateGradients => self.counts.conjugate_gradients += 1,
            Level::Cholesky => self.counts.cholesky += 1,
            _ => self.counts.none += 1,
        }
        self.queue_all(reduced);
        let spread = self.system.fixed.iter().filter(|fixed| !**fixed).count();
        Ok((level, spread))
    }
}
