//! GINI until the map is injective, then a second-order method for low distortion.

use super::curvature::{Curvature, OnCorners, Projected};
use super::majorization::CompositeMajorization;
use super::{Newton, NewtonOptions};
use crate::energy::{Energy, SymmetricDirichlet};
use crate::gini::{Gini, GiniOptions, GiniProblem, Outcome};
use crate::optim::{BuildError, Inspection, SolveError, Solver, Status, StepReport};
use crate::space::{Plane, Space};
use crate::wrapd::{External, Problem};
use core::marker::PhantomData;

/// GINI, which begins anywhere, until it has converged; from there on Newton's method, none of whose steps inverts an
/// element or, where overlap counts, has the boundary pass through itself (Overby, Kaufman & Narain 2021, §8.2, where
/// "time to convergence" is measured so). The energy falls, and what GINI has reached is kept.
///
/// Where an energy is least folded (ARAP), elements end as flat as numbers allow: this is for energies that mind.
///
/// Nothing pushes bodies in contact apart: Newton's method stalls where the way to less energy leads through a contact.
/// After each of its steps what GINI has reached is checked again, exactly; a step that does not pass is taken back, and
/// the run has stalled.
pub struct GiniThenNewton<const D: usize> {
    first: Gini<D>,
    second: Newton,
    switched: bool,
    report: StepReport,
}

impl GiniThenNewton<2> {
    /// GINI, then composite majorization, for the symmetric Dirichlet energy of a planar map.
    ///
    /// # Errors
    /// As [`Self::projected`].
    pub fn composite_majorization(
        problem: GiniProblem,
        first: GiniOptions,
        second: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let curvature = Box::new(CompositeMajorization);
        Self::with_curvature::<Plane, _>(problem, SymmetricDirichlet, curvature, (first, second))
    }
}

impl<const D: usize> GiniThenNewton<D> {
    /// GINI, then Newton's method with the projected Hessian.
    ///
    /// # Errors
    /// As [`Gini::new`], and options of Newton's method out of range.
    pub fn projected<S: Space, E: Energy<S>>(
        problem: GiniProblem,
        energy: E,
        first: GiniOptions,
        second: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let curvature = Box::new(OnCorners::<S, _>(Projected(energy), PhantomData));
        Self::with_curvature::<S, E>(problem, energy, curvature, (first, second))
    }

    fn with_curvature<S: Space, E: Energy<S>>(
        problem: GiniProblem,
        energy: E,
        curvature: Box<dyn Curvature>,
        (first, second): (GiniOptions, NewtonOptions),
    ) -> Result<Self, BuildError> {
        let overlap = first.overlap;
        let stiffness = first.target_stiffness;
        let mut first = Gini::new::<S, E>(problem, energy, first)?;
        let external = External {
            springs: problem.absolute_springs::<S, E>(&energy, stiffness),
            ..Default::default()
        };
        // of what floats no energy knows where it is
        let floating = problem.floating(D);
        let mut pins = problem.pins.to_vec();
        pins.extend(floating.iter().map(|component| component[0]));
        let same = Problem {
            rest: problem.rest,
            start: problem.start,
            pins: &pins,
            external: (!external.springs.is_empty()).then_some(&external),
        };
        let mut second = Newton::with_curvature::<S, E>(same, energy, curvature, 0.0, second)?;
        second.keep_positive();
        if overlap {
            second.keep_apart(problem.rest, first.gap())?;
        }
        let mut this = Self {
            report: first.report().clone(),
            first,
            second,
            switched: false,
        };
        this.switch();
        Ok(this)
    }

    /// GINI, as far as it has gone.
    pub fn first(&self) -> &Gini<D> {
        &self.first
    }

    /// As [`Gini::set_trace`].
    pub fn set_trace(&mut self, on: bool) {
        self.first.set_trace(on);
    }

    /// Has pinned vertices move elsewhere: GINI goes on from where the map is.
    ///
    /// # Errors
    /// As [`Gini::move_pins`]; nothing has changed then.
    pub fn move_pins(&mut self, pins: &[(u32, [f64; D])]) -> Result<(), BuildError> {
        self.first.check_pins(pins)?;
        if self.switched {
            let seconds = self.report.seconds;
            self.first.restart(self.second.positions(), seconds);
        }
        self.first.move_pins(pins)?;
        self.switched = false;
        self.report = self.first.report().clone();
        self.switch();
        Ok(())
    }

    /// What is known of the newest positions.
    pub fn outcome(&self) -> Outcome {
        self.first.outcome_of(self.positions())
    }

    /// Hands over, if GINI has converged and Newton's method can begin where it ended.
    fn switch(&mut self) {
        if !matches!(self.report.status, Status::Converged(_)) {
            return;
        }
        self.second.restart(self.first.positions(), &self.report);
        self.second.count_from_here();
        let gap = self.first.gap();
        self.second.set_gap(gap);
        if self.second.is_broken() || self.second.report().inverted > 0 {
            // flat to rounding: as injective as GINI left it, and that is all
            self.report.status = Status::Stalled;
            return;
        }
        self.switched = true;
        self.report = StepReport {
            switched_at: Some(self.report.iteration),
            phases: core::mem::take(&mut self.report.phases),
            gini: self.report.gini.take(),
            ..self.second.report().clone()
        };
    }
}

impl<const D: usize> Solver for GiniThenNewton<D> {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        if self.switched {
            let switched_at = self.report.switched_at;
            let before = self.second.positions().to_vec();
            self.report = self.second.step()?;
            if !self.first.proves(self.second.positions()) {
                self.second.restart(&before, &self.report);
                self.report = StepReport {
                    status: Status::Stalled,
                    phases: core::mem::take(&mut self.report.phases),
                    ..self.second.report().clone()
                };
            }
            self.report.switched_at = switched_at;
        } else {
            self.report = self.first.step()?;
            self.switch();
        }
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        match self.switched {
            true => self.second.positions(),
            false => self.first.positions(),
        }
    }
    fn dimension(&self) -> usize {
        D
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        match self.switched {
            true => self.second.inspect(),
            false => self.first.inspect(),
        }
    }
}
