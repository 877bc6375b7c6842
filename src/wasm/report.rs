//! A step's report as JavaScript sees it.

use crate::optim::{self, Criterion, GiniStep, LimStep, Phase, Status};
use serde::Serialize;
use tsify::Tsify;

/// What one step did. The energy of a map is relative to an isometry (1 of symmetric Dirichlet, 0 of the
/// others), its surface scaled to unit area; that of a solid is in the unit of its moduli times volume, and with
/// locally injective mappings of a body scaled to a measure of 1, without the barrier.
#[derive(Debug, Serialize, Tsify)]
#[serde(rename_all = "camelCase")]
pub struct StepReport<'a> {
    /// 0 is the start, before any step.
    pub iteration: u32,
    /// Where the solver stands after the step.
    #[tsify(type = "'running' | 'converged' | 'max-iterations' | 'stalled' | 'cancelled'")]
    pub status: &'static str,
    /// What converged, once it has.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[tsify(optional)]
    pub criterion: Option<Criterion>,
    /// Is the status `converged`?
    pub converged: bool,
    /// The energy of the iterate; while elements are inverted, of the local variables.
    pub energy: f64,
    /// Number of inverted or degenerate elements.
    pub inverted: u32,
    /// Norm of the energy's gradient (infinite while inverted).
    pub gradient_norm: f64,
    /// Smallest signed singular value of any element.
    pub smallest_sigma: f64,
    /// Largest singular value of any element.
    pub largest_sigma: f64,
    /// L-BFGS iterations of the global step.
    pub lbfgs_iterations: u32,
    /// Did the element weights change in this step?
    pub reweighted: bool,
    /// Of a method in two stages: the iteration with which the first ended, once it has.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[tsify(optional)]
    pub switched_at: Option<u32>,
    /// Of a locally injective mapping: the parameters of the step.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[tsify(optional)]
    pub lim: Option<LimStep>,
    /// Of a globally injective map: its quadratic problem, and its polisher.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[tsify(optional)]
    pub gini: Option<&'a GiniStep>,
    /// Seconds since the first step began, setup apart.
    pub seconds: f64,
    /// What the step consisted of, in order.
    pub phases: &'a [Phase],
}

impl<'a> From<&'a optim::StepReport> for StepReport<'a> {
    fn from(report: &'a optim::StepReport) -> Self {
        let criterion = match report.status {
            Status::Converged(criterion) => Some(criterion),
            _ => None,
        };
        Self {
            iteration: report.iteration as u32,
            status: report.status.name(),
            criterion,
            converged: criterion.is_some(),
            energy: report.energy,
            inverted: report.inverted as u32,
            gradient_norm: report.gradient_norm,
            smallest_sigma: report.smallest_sigma,
            largest_sigma: report.largest_sigma,
            lbfgs_iterations: report.lbfgs_iterations as u32,
            reweighted: report.reweighted,
            switched_at: report.switched_at.map(|k| k as u32),
            lim: report.lim,
            gini: report.gini.as_ref(),
            seconds: report.seconds,
            phases: &report.phases,
        }
    }
}
