//! Greedy rounding with exact updates (paper, §3.2): the estimates of the others follow every rounded
//! integer as the conditional means of a Gaussian would.

use super::{IntegerForm, nearest, preference};

/// An integer that was rounded: index, estimate, value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fixed {
    /// Index among the integers.
    pub index: usize,
    /// Its estimate before.
    pub from: f64,
    /// Its value.
    pub to: f64,
}

/// The state of greedy rounding on k integers; O(k²) a rounding.
#[derive(Debug, Clone)]
pub struct ExactGreedy {
    k: usize,
    /// Inverse of S on the free integers (what belongs to rounded ones is not read).
    covariance: Vec<f64>,
    /// Rounded values, and the estimates of the others.
    estimate: Vec<f64>,
    free: Vec<bool>,
    remaining: usize,
    /// Energy above the relaxed one.
    energy: f64,
}

impl ExactGreedy {
    /// All integers free.
    pub fn new(form: &IntegerForm) -> Self {
        Self {
            k: form.k,
            covariance: form.inverse(),
            estimate: form.center.clone(),
            free: vec![true; form.k],
            remaining: form.k,
            energy: 0.0,
        }
    }

    /// Rounded values and estimates, length k.
    pub fn estimate(&self) -> &[f64] {
        &self.estimate
    }
    /// Integers without a value.
    pub fn remaining(&self) -> usize {
        self.remaining
    }
    /// The least energy above the relaxed one with what is rounded so far.
    pub fn energy(&self) -> f64 {
        self.energy
    }

    /// Rounds the nearest, and more of them as long as their distances add up to at most `budget`; says
    /// which, and how many estimates of others moved by more than 1e-3.
    pub fn step(&mut self, budget: f64) -> (Vec<Fixed>, usize) {
        let mut order: Vec<(u32, usize)> = (0..self.k)
            .filter(|&i| self.free[i])
            .map(|i| (preference(self.estimate[i]), i))
            .collect();
        if budget > 0.0 {
            order.sort_unstable();
        } else {
            order = order.into_iter().min().into_iter().collect();
        }
        let mut spent = 0.0;
        let mut fixed: Vec<Fixed> = Vec::new();
        for (_, index) in order {
            let from = self.estimate[index];
            let to = nearest(from);
            spent += (to - from).abs();
            if !fixed.is_empty() && spent > budget {
                break;
            }
            fixed.push(Fixed { index, from, to });
        }
        let before = self.estimate.clone();
        for &Fixed { index, to, .. } in &fixed {
            self.fix(index, to);
        }
        let moved = |i: usize| self.free[i] && (self.estimate[i] - before[i]).abs() > 1e-3;
        let spread = (0..self.k).filter(|&i| moved(i)).count();
        (fixed, spread)
    }

    /// Rounds all to the nearest of their present estimates.
    pub fn direct(&mut self) -> Vec<Fixed> {
        let estimates = self.estimate.clone();
        let all = (0..self.k).filter(|&i| self.free[i]);
        let round = |index: usize| Fixed {
            index,
            from: estimates[index],
            to: nearest(estimates[index]),
        };
        let fixed: Vec<Fixed> = all.map(round).collect();
        for f in &fixed {
            self.fix(f.index, f.to);
        }
        fixed
    }

    fn fix(&mut self, index: usize, value: f64) {
        let k = self.k;
        self.free[index] = false;
        self.remaining -= 1;
        let change = value - self.estimate[index];
        let variance = self.covariance[index * k + index];
        self.energy += 0.5 * change * change / variance;
        self.estimate[index] = value;
        let column = self.covariance[index * k..(index + 1) * k].to_vec();
        for i in (0..k).filter(|&i| self.free[i]) {
            let factor = column[i] / variance;
            self.estimate[i] += factor * change;
            let row = &mut self.covariance[i * k..(i + 1) * k];
            for (h, c) in row.iter_mut().zip(&column) {
                *h -= factor * c;
            }
        }
    }
}
