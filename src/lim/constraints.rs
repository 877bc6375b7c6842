//! Positional constraints: handles, which are led to their targets (5)–(8), and springs.

use crate::optim::Spring;

/// The first α, of a body scaled to a measure of 1, and the most it grows to: t of (8).
const ALPHA: [f64; 2] = [1e8, 1e16];

/// r of (7).
const RATIO: f64 = 1e3;

/// A handle this near to its target, relative to the body's size, has arrived: it is put there and held.
pub const NEAR: f64 = 1e-9;

/// A vertex that is to be somewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Handle {
    /// Its slot.
    pub slot: u32,
    /// d of (1).
    pub target: [f64; 3],
    /// t of (5).
    pub sub_target: [f64; 3],
    /// t of the last step; d before the first after a change of targets.
    pub led_to: [f64; 3],
    /// Is it there, and held from now on?
    pub arrived: bool,
}

/// α ‖Cv − t‖² of the handles that have not arrived, and ½ k ‖x − t‖² of the springs. Positions by slot.
#[derive(Debug, Clone, Default)]
pub struct Constraints {
    /// d.
    pub dimension: usize,
    /// Length of 1 in the units of the positions of a body scaled to a measure of 1.
    pub scale: f64,
    /// By ascending slot.
    pub handles: Vec<Handle>,
    /// Vertices of springs are slots here.
    pub springs: Vec<Spring>,
    /// Which slots do not move: of handles that have arrived, and vertices of no element.
    pub held: Vec<bool>,
    /// α, for positions of a body scaled to a measure of 1.
    pub alpha: f64,
}

impl Constraints {
    /// Begins anew with α.
    pub fn restart(&mut self) {
        self.alpha = ALPHA[0];
    }

    fn away(&self, x: &[f64], slot: u32, point: &[f64; 3]) -> [f64; 3] {
        let at = slot as usize * self.dimension;
        let mut away = [0.0; 3];
        for i in 0..self.dimension {
            away[i] = x[at + i] - point[i];
        }
        away
    }

    fn waiting(&self) -> impl Iterator<Item = &Handle> {
        self.handles.iter().filter(|handle| !handle.arrived)
    }

    /// Have all handles arrived?
    pub fn all_arrived(&self) -> bool {
        self.waiting().next().is_none()
    }

    /// ‖Cv − d‖² of a body scaled to a measure of 1, with the targets themselves.
    pub fn square_error(&self, x: &[f64]) -> f64 {
        let errors = self.waiting().map(|handle| {
            let away = self.away(x, handle.slot, &handle.target);
            away.iter().map(|a| a * a).sum::<f64>()
        });
        self.scale * self.scale * errors.sum::<f64>()
    }

    /// The largest distance of a handle from its target, in the units of the positions.
    pub fn error(&self, x: &[f64]) -> f64 {
        let errors = self.waiting().map(|handle| {
            let away = self.away(x, handle.slot, &handle.target);
            away.iter().map(|a| a * a).sum::<f64>().sqrt()
        });
        errors.fold(0.0, f64::max)
    }

    /// α for the next step (7), (8): it only grows. `energy` is that of the body with its barrier.
    pub fn update_alpha(&mut self, energy: f64, x: &[f64]) {
        let error = self.square_error(x);
        if error > 0.0 && energy.is_finite() {
            let gamma = RATIO * energy / error;
            self.alpha = self.alpha.max(gamma).min(ALPHA[1]);
        }
    }

    /// Where the next step leads to (6).
    pub fn set_sub_targets(&mut self, x: &[f64], mu: f64) {
        let part = (1.0 + mu * mu).recip();
        let d = self.dimension;
        for handle in &mut self.handles {
            let at = handle.slot as usize * d;
            for i in 0..d {
                let (from, to) = (x[at + i], handle.target[i]);
                // 1 is exactly at the target
                handle.sub_target[i] = if part == 1.0 {
                    to
                } else {
                    from + part * (to - from)
                };
            }
        }
    }

    /// Remembers the sub-targets as those of the step that is being taken.
    pub fn remember_sub_targets(&mut self) {
        let handles = self.handles.iter_mut();
        handles.for_each(|handle| handle.led_to = handle.sub_target);
    }

    fn stiffness(&self) -> f64 {
        2.0 * self.alpha * self.scale * self.scale
    }

    /// The value at x.
    pub fn value(&self, x: &[f64]) -> f64 {
        let square = |away: [f64; 3]| away.iter().map(|a| a * a).sum::<f64>();
        let handles = self
            .waiting()
            .map(|handle| square(self.away(x, handle.slot, &handle.sub_target)));
        let springs = self.springs.iter().map(|spring| {
            0.5 * spring.stiffness * square(self.away(x, spring.vertex, &spring.target))
        });
        0.5 * self.stiffness() * handles.sum::<f64>() + springs.sum::<f64>()
    }

    /// Adds the gradient at x, and sets it to 0 where vertices are held.
    pub fn add_gradient(&self, x: &[f64], gradient: &mut [f64]) {
        let d = self.dimension;
        let handles = self
            .waiting()
            .map(|handle| (handle.slot, self.stiffness(), &handle.sub_target));
        let springs = self.springs.iter();
        let springs = springs.map(|spring| (spring.vertex, spring.stiffness, &spring.target));
        for (slot, stiffness, point) in handles.chain(springs) {
            let away = self.away(x, slot, point);
            for i in 0..d {
                gradient[slot as usize * d + i] += stiffness * away[i];
            }
        }
        for (g, &held) in gradient.chunks_exact_mut(d).zip(&self.held) {
            if held {
                g.fill(0.0);
            }
        }
    }

    /// The second derivatives: multiples of the identity at the slots.
    pub fn diagonal(&self, out: &mut [f64]) {
        out.fill(0.0);
        self.waiting()
            .for_each(|handle| out[handle.slot as usize] += self.stiffness());
        for spring in &self.springs {
            out[spring.vertex as usize] += spring.stiffness;
        }
    }

    /// Puts handles that are near their targets there; how many.
    pub fn arriving(&self, x: &mut [f64]) -> usize {
        let d = self.dimension;
        let mut count = 0;
        for handle in self.waiting() {
            let away = self.away(x, handle.slot, &handle.target);
            let distance = away.iter().map(|a| a * a).sum::<f64>().sqrt();
            if self.scale * distance <= NEAR {
                let at = handle.slot as usize * d;
                x[at..at + d].copy_from_slice(&handle.target[..d]);
                count += 1;
            }
        }
        count
    }

    /// Holds the handles that are at their targets.
    pub fn hold_arrived(&mut self, x: &[f64]) {
        let d = self.dimension;
        for handle in &mut self.handles {
            let at = handle.slot as usize * d;
            handle.arrived = x[at..at + d] == handle.target[..d];
            self.held[handle.slot as usize] = handle.arrived;
        }
    }
}
