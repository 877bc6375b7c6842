//! The progress bar, on stderr and only where that is a terminal.

use foldfree::optim::StepReport;
use indicatif::{ProgressBar, ProgressStyle};

/// Steps of the bar.
const LENGTH: f64 = 1000.0;

/// How far a solver is, judged by what will stop it: the change of the energy on its way down to the
/// tolerance (in orders of magnitude), or the iterations on their way up to their limit.
pub struct Progress {
    bar: ProgressBar,
    tolerance: f64,
    iterations: usize,
    last_energy: f64,
    fraction: f64,
}

impl Progress {
    pub fn new(quiet: bool, tolerance: f64, iterations: usize) -> Self {
        let bar = if quiet {
            ProgressBar::hidden()
        } else {
            let style = ProgressStyle::with_template("{bar:24} {msg}");
            ProgressBar::new(LENGTH as u64)
                .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        };
        Self {
            bar,
            tolerance,
            iterations,
            last_energy: f64::INFINITY,
            fraction: 0.0,
        }
    }

    pub fn show(&mut self, step: &StepReport) {
        let change = (self.last_energy - step.energy).abs() / step.energy.abs();
        self.last_energy = step.energy;
        let by_change = if step.inverted == 0 && self.tolerance > 0.0 && self.tolerance < 1.0 {
            change.ln() / self.tolerance.ln()
        } else {
            0.0
        };
        let by_count = step.iteration as f64 / self.iterations.max(1) as f64;
        // Never backwards; `max` leaves a NaN aside.
        self.fraction = self.fraction.max(by_change.min(1.0)).max(by_count);
        self.bar.set_position((self.fraction * LENGTH) as u64);
        self.bar.set_message(format!(
            "iteration {}, energy {:.6}, {} inverted",
            step.iteration, step.energy, step.inverted
        ));
    }

    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}
