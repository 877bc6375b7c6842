//! The global step.

use super::super::block::BlockSums;
use super::super::kernels::Pass;
use super::Wrapd;
use crate::optim::vectors::{add_combination, dot};

/// Steps that the global step takes as they come (§4.1). It needs two or three; one that needs many does
/// not descend, as happens where Z − U is far from any stretch, and from there on steps are shortened.
const TRUSTED: usize = 20;

/// Most times that a step is shortened.
const MOST_SHORTENINGS: usize = 4;

impl Wrapd {
    /// The global step: L-BFGS on (11) until (17). Returns its iterations and the final evaluation.
    pub(super) fn global_step(
        &mut self,
        local_pass: Pass,
        local: &BlockSums,
    ) -> (usize, BlockSums) {
        // below the rounding error of the Lagrangian there is nothing to be gained
        let rounding = f64::EPSILON * local.z_energy.abs();
        let bound = (self.shape.kappa * local.lagrangian_change.abs()).max(rounding);
        self.gather(local_pass);
        core::mem::swap(&mut self.gradient, &mut self.next_gradient);
        self.history.new_objective();
        let mut count = 0;
        loop {
            let mut slope = self.history.direction(
                &mut self.system.factor,
                self.shape.dimension,
                &self.gradient,
                &mut self.direction,
            );
            let uphill = !(slope < 0.0);
            if uphill {
                self.history.clear();
                self.direction
                    .iter_mut()
                    .zip(&self.gradient)
                    .for_each(|(d, g)| *d = -g);
                slope = -dot(&self.gradient, &self.gradient);
            }
            let unknowns = self.direction.len();
            add_combination(
                core::iter::once((1.0, &self.direction[..])),
                &mut self.x[..unknowns],
            );
            count += 1;
            let last = self.shape.linear
                || !(-slope > bound)
                || count >= self.options.max_global_iterations;
            let pass = if last { Pass::Last } else { Pass::Forces };
            let mut sums = self.pass(pass);
            self.gather(pass);
            if !self.shape.linear {
                // maps of the plane are left as the paper has them
                let shortenings = match count > TRUSTED && self.shape.dimension > 2 {
                    true => MOST_SHORTENINGS,
                    false => 0,
                };
                for _ in 0..shortenings {
                    let after = dot(&self.next_gradient, &self.direction);
                    // a parabola rises over a step that ends steeper than it began
                    if !(after > -slope) {
                        break;
                    }
                    // to where the slope vanishes, if it goes on as between the two ends
                    let t = slope / (slope - after);
                    self.retreat(t);
                    slope *= t;
                    sums = self.pass(pass);
                    self.gather(pass);
                }
                if !uphill {
                    self.history
                        .push(&self.direction, &self.gradient, &self.next_gradient);
                }
                core::mem::swap(&mut self.gradient, &mut self.next_gradient);
            }
            if last {
                return (count, sums);
            }
        }
    }

    /// Makes the last step `t` times as long.
    fn retreat(&mut self, t: f64) {
        let unknowns = self.direction.len();
        add_combination(
            core::iter::once((t - 1.0, &self.direction[..])),
            &mut self.x[..unknowns],
        );
        self.direction.iter_mut().for_each(|d| *d *= t);
        self.history.shorten(t);
    }
}
