//! A direct method as a solver of one step.

use crate::energy::SymmetricDirichlet;
use crate::energy::total::{distortion, total};
use crate::geometry::RestShape;
use crate::optim::{
    Criterion, Inspection, Phase, PhaseKind, SolveError, Solver, Status, StepReport, Stopwatch,
};
use crate::space::Plane;

/// A map that was found by one linear solve: the start, then the map. Its reports give the symmetric
/// Dirichlet energy.
pub struct DirectMap {
    rest: RestShape,
    x: Vec<f64>,
    map: Vec<f64>,
    seconds: f64,
    report: StepReport,
}

impl DirectMap {
    /// `start` and `map` are positions, interleaved; `seconds` is what finding the map took.
    pub fn new(rest: RestShape, start: Vec<f64>, map: Vec<f64>, seconds: f64) -> Self {
        let mut this = Self {
            rest,
            x: start,
            map,
            seconds,
            report: StepReport::at_start(),
        };
        this.evaluate();
        this
    }

    fn evaluate(&mut self) {
        let total = total::<Plane, _>(SymmetricDirichlet, &self.rest, &self.x);
        self.report.energy = total.energy;
        self.report.inverted = total.inverted;
        self.report.smallest_sigma = total.smallest_sigma;
        self.report.largest_sigma = total.largest_sigma;
        self.report.gradient_norm = if total.inverted > 0 {
            f64::INFINITY
        } else {
            total.gradient.iter().map(|g| g * g).sum::<f64>().sqrt()
        };
    }
}

impl Solver for DirectMap {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        if self.report.status == Status::Running {
            self.x.copy_from_slice(&self.map);
            let clock = Stopwatch::start();
            self.evaluate();
            self.report.iteration = 1;
            self.report.status = Status::Converged(Criterion::Direct);
            self.report.seconds = self.seconds;
            let evaluate = clock.milliseconds();
            self.report.phases = [
                (PhaseKind::Global, self.seconds * 1e3),
                (PhaseKind::Evaluate, evaluate),
            ]
            .map(|(kind, milliseconds)| Phase {
                kind,
                count: 1,
                milliseconds,
            })
            .to_vec();
        }
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        &self.x
    }
    fn dimension(&self) -> usize {
        2
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        Inspection {
            distortion: distortion::<Plane>(&self.rest, &self.x),
            weights: Vec::new(),
        }
    }
}
