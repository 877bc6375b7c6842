//! Enumeration of lattice points from near to far (Schnorr & Euchner 1994), within the distance of the
//! best point so far. Its first point is Babai's nearest plane. What it has excluded when it is stopped
//! gives a lower bound.

use super::Reduction;

/// A depth-first search that can be interrupted. Level i is the choice of w_i; the last level is chosen
/// first.
#[derive(Debug, Clone)]
pub struct Enumeration {
    k: usize,
    /// R'_ij / R'_ii, row by row, above the diagonal.
    ratio: Vec<f64>,
    /// R'_ii².
    length: Vec<f64>,
    /// R'⁻¹ y.
    center: Vec<f64>,
    /// `sums[i * (k + 1) + j]`: the center of w_i as far as w_j, w_j+1, … move it.
    sums: Vec<f64>,
    /// The highest level, i or above, whose change the sums of level i − 1 have not seen.
    stale: Vec<usize>,
    /// The present choices, their centers, and the step to the next choice.
    w: Vec<f64>,
    middle: Vec<f64>,
    step: Vec<f64>,
    /// Squared distance of the choices from level i on; length k + 1.
    distance: Vec<f64>,
    level: usize,
    best: f64,
    best_w: Vec<f64>,
    nodes: u64,
    improvements: u32,
    finished: bool,
}

/// A point has to be nearer by this part of the squared distance to count as better: what is equal by
/// symmetry is not enumerated.
const EQUAL: f64 = 1e-11;

impl Enumeration {
    /// Of a reduced basis.
    pub fn new(reduction: &Reduction) -> Self {
        let (k, r) = (reduction.dimension(), reduction.basis());
        let mut ratio = vec![0.0; k * k];
        for i in 0..k {
            for j in i + 1..k {
                ratio[i * k + j] = r[j * k + i] / r[i * k + i];
            }
        }
        let mut center = reduction.target().to_vec();
        for i in (0..k).rev() {
            center[i] /= r[i * k + i];
            for j in 0..i {
                center[j] -= r[i * k + j] * center[i];
            }
        }
        let mut sums = vec![0.0; k * (k + 1)];
        for i in 0..k {
            sums[i * (k + 1) + k] = center[i];
        }
        let mut this = Self {
            k,
            ratio,
            length: (0..k).map(|i| r[i * k + i] * r[i * k + i]).collect(),
            center,
            sums,
            stale: vec![k.saturating_sub(1); k],
            w: vec![0.0; k],
            middle: vec![0.0; k],
            step: vec![0.0; k],
            distance: vec![0.0; k + 1],
            level: k.saturating_sub(1),
            best: f64::INFINITY,
            best_w: vec![0.0; k],
            nodes: 0,
            improvements: 0,
            finished: false,
        };
        if k == 0 {
            (this.best, this.finished, this.improvements) = (0.0, true, 1);
        } else {
            this.enter(k - 1);
        }
        this
    }

    /// The best point so far, w; `None` before the first.
    pub fn best(&self) -> Option<&[f64]> {
        (self.improvements > 0).then_some(&self.best_w)
    }
    /// Nodes visited.
    pub fn nodes(&self) -> u64 {
        self.nodes
    }
    /// Better points found, the first included.
    pub fn improvements(&self) -> u32 {
        self.improvements
    }

    /// No point has a squared distance below this, rounding errors apart.
    pub fn bound(&self) -> f64 {
        if self.finished {
            return self.best * (1.0 - EQUAL);
        }
        // what is left hangs below the present choice, and below later choices of the levels above
        let mut bound = self
            .best
            .min(self.distance_of(self.level, self.w[self.level]));
        for i in self.level + 1..self.k {
            bound = bound.min(self.distance_of(i, self.w[i] + self.step[i]));
        }
        bound
    }

    fn distance_of(&self, level: usize, w: f64) -> f64 {
        let d = w - self.middle[level];
        self.distance[level + 1] + self.length[level] * d * d
    }

    /// Begins a level at the nearest choice.
    #[inline]
    fn enter(&mut self, level: usize) {
        let k = self.k;
        let sums = &mut self.sums[level * (k + 1)..(level + 1) * (k + 1)];
        let ratio = &self.ratio[level * k..(level + 1) * k];
        let stale = self.stale[level];
        let mut sum = sums[(stale + 1).min(k)];
        for j in (level + 1..=stale).rev() {
            sum -= ratio[j] * (self.w[j] - self.center[j]);
            sums[j] = sum;
        }
        self.middle[level] = sum;
        let nearest = sum.round();
        self.w[level] = nearest;
        self.step[level] = if sum >= nearest { 1.0 } else { -1.0 };
    }

    /// The next nearest choice of a level: to the one side and the other.
    #[inline]
    fn advance(&mut self, level: usize) {
        let step = self.step[level];
        self.w[level] += step;
        self.step[level] = -step - step.signum();
    }

    /// Visits up to `nodes` more; is everything done?
    pub fn run(&mut self, nodes: u64) -> bool {
        let end = self.nodes.saturating_add(nodes);
        while !self.finished && self.nodes < end {
            self.nodes += 1;
            let level = self.level;
            let distance = self.distance_of(level, self.w[level]);
            if distance >= self.best * (1.0 - EQUAL) {
                // later choices of this level are further away still
                if level + 1 == self.k {
                    self.finished = true;
                    break;
                }
                self.level = level + 1;
                self.advance(level + 1);
            } else if level == 0 {
                self.best = distance;
                self.best_w.copy_from_slice(&self.w);
                self.improvements += 1;
                self.advance(0);
            } else {
                self.distance[level] = distance;
                self.level = level - 1;
                self.stale[level - 1] = self.stale[level - 1].max(self.stale[level]);
                self.stale[level] = level;
                self.enter(level - 1);
            }
        }
        self.finished
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mixed_integer::search::IntegerForm;

    /// A form whose cells are neither round nor thin, as random as it has to be.
    fn form(k: usize, seed: u32) -> IntegerForm {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1u32 << 24) - 0.5
        };
        let mut factor = vec![0.0; k * k];
        for i in 0..k {
            (0..i).for_each(|j| factor[i * k + j] = next());
            factor[i * k + i] = 0.7 + next();
        }
        let center = (0..k).map(|_| 10.0 * next()).collect();
        IntegerForm { k, factor, center }
    }

    #[test]
    fn distances_are_those_of_the_form_however_often_it_is_interrupted() {
        for seed in 0..60 {
            let form = form(9, seed);
            let mut reduction = Reduction::new(&form);
            assert!(reduction.run(u64::MAX / 2));
            let mut whole = Enumeration::new(&reduction);
            assert!(whole.run(u64::MAX));
            let energy = form.energy(&reduction.integers(whole.best().expect("a point")));
            assert!((2.0 * energy - whole.best).abs() < 1e-9, "{seed}");
            let mut parts = Enumeration::new(&reduction);
            let mut bound = 0.0;
            while !parts.run(1) {
                assert!(parts.bound() >= bound - 1e-12 && parts.bound() <= whole.best);
                bound = parts.bound();
            }
            assert_eq!((parts.best(), parts.nodes()), (whole.best(), whole.nodes()));
        }
    }
}
