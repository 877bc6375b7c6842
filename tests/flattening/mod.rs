//! Runs of a flattening that several tests share.
#![allow(dead_code)]

use foldfree::mesh::SurfaceMesh;
use foldfree::optim::StepReport;
use foldfree::parameterization::{Method, Parameterization, ParameterizationOptions, Start};

/// The options of a method that does not stop by itself.
pub fn endless(method: Method) -> ParameterizationOptions {
    ParameterizationOptions {
        method,
        tolerance: 0.0,
        max_iterations: usize::MAX,
        ..Default::default()
    }
}

/// The same from another start.
pub fn from(start: Start, method: Method) -> ParameterizationOptions {
    ParameterizationOptions {
        start,
        ..endless(method)
    }
}

/// A flattening and its reports, that of the start first.
pub struct Run {
    pub parameterization: Parameterization,
    pub reports: Vec<StepReport>,
}

impl Run {
    pub fn new(mesh: &SurfaceMesh, options: &ParameterizationOptions) -> Self {
        let parameterization = Parameterization::new(mesh, options).unwrap();
        let reports = vec![parameterization.solver().report().clone()];
        Self {
            parameterization,
            reports,
        }
    }

    /// Steps while `on` holds of the newest report.
    pub fn while_true(mut self, on: impl Fn(&StepReport) -> bool) -> Self {
        while on(&self.reports[self.reports.len() - 1]) {
            self.reports.push(self.parameterization.step().unwrap());
        }
        self
    }

    /// A number of steps.
    pub fn steps(self, count: usize) -> Self {
        self.while_true(|r| r.iteration < count)
    }

    pub fn last(&self) -> &StepReport {
        &self.reports[self.reports.len() - 1]
    }

    pub fn energies(&self) -> Vec<f64> {
        self.reports.iter().map(|r| r.energy).collect()
    }

    /// The first iterate without inverted triangles whose energy is at most `bound`.
    pub fn reaches(&self, bound: f64) -> Option<usize> {
        self.reports
            .iter()
            .position(|r| r.inverted == 0 && r.energy <= bound)
    }
}
