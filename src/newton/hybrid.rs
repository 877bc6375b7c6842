//! WRAPD until nothing is inverted, then a second-order method.

use super::curvature::{Curvature, OnCorners, Projected};
use super::majorization::CompositeMajorization;
use super::{Newton, NewtonOptions};
use crate::energy::{Energy, SymmetricDirichlet};
use crate::optim::{
    BuildError, Deformer, Field, Inspection, SolveError, Solver, Spring, Status, StepReport,
};
use crate::space::{Plane, Space};
use crate::wrapd::{Problem, RotationAware, Wrapd, WrapdOptions};
use core::marker::PhantomData;

/// Most iterations of WRAPD from a start without inverted elements.
const MOST_FIRST: usize = 30;

/// WRAPD, which is fast early and begins anywhere, up to its first iterate (the start not counted) without
/// inverted elements; from there on Newton's method, which is fast late (Brown & Narain 2021, §7.2).
///
/// Where the start has no inverted elements itself, it is where Newton's method begins if WRAPD has found nothing
/// better when it ends, or nothing at all in 30 iterations: on a bad mesh it can be long in mending what it
/// inverts.
///
/// Both are analysed beforehand. Moving handles begins with WRAPD again.
pub struct Hybrid {
    first: Wrapd,
    second: Newton,
    /// Which of the two stands for the whole.
    switched: bool,
    /// Iterations before WRAPD began last.
    base: usize,
    report: StepReport,
}

impl Hybrid {
    /// WRAPD, then composite majorization, for the symmetric Dirichlet energy of a planar map; triangles turn along
    /// its steps ([`NewtonOptions::turning`]).
    ///
    /// # Errors
    /// As [`Wrapd::new`]; the start may be inverted.
    pub fn composite_majorization(
        problem: Problem,
        first: WrapdOptions,
        second: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let curvature = Box::new(CompositeMajorization);
        let second = NewtonOptions {
            turning: true,
            ..second
        };
        Self::with_curvature::<Plane, _>(problem, SymmetricDirichlet, curvature, first, second)
    }

    /// WRAPD, then Newton's method with the projected Hessian.
    ///
    /// # Errors
    /// As [`Wrapd::new`]; the start may be inverted.
    pub fn projected<S: Space, E: Energy<S>>(
        problem: Problem,
        energy: E,
        first: WrapdOptions,
        second: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let curvature = Box::new(OnCorners::<S, _>(Projected(energy), PhantomData));
        Self::with_curvature::<S, E>(problem, energy, curvature, first, second)
    }

    fn with_curvature<S: Space, E: Energy<S>>(
        problem: Problem,
        energy: E,
        curvature: Box<dyn Curvature>,
        first: WrapdOptions,
        second: NewtonOptions,
    ) -> Result<Self, BuildError> {
        let first = Wrapd::new::<S, RotationAware, E>(problem, energy, first)?;
        Ok(Self {
            report: first.report().clone(),
            second: Newton::with_curvature::<S, E>(problem, energy, curvature, 0.0, second)?,
            first,
            switched: false,
            base: 0,
        })
    }

    fn current(&self) -> &dyn Deformer {
        match self.switched {
            true => &self.second,
            false => &self.first,
        }
    }

    fn iterate(&mut self) -> Result<(), SolveError> {
        if self.switched {
            let switched_at = self.report.switched_at;
            self.report = self.second.step()?;
            self.report.switched_at = switched_at;
            return Ok(());
        }
        let seconds = self.report.seconds - self.first.report().seconds;
        let step = self.first.step()?;
        self.report = StepReport {
            iteration: self.base + step.iteration,
            seconds: seconds + step.seconds,
            ..step.clone()
        };
        if self.report.status != Status::Running {
            return Ok(());
        }
        // the second still stands at the start
        let begun = self.second.report();
        let could_begin = begun.inverted == 0 && !self.second.is_broken();
        let injective = step.inverted == 0;
        let late = step.iteration >= MOST_FIRST;
        if could_begin && (late || (injective && begun.energy <= step.energy)) {
            self.second.take_over(&self.report);
            self.switch();
        } else if injective {
            self.second.restart(self.first.positions(), &self.report);
            if !self.second.is_broken() {
                self.switch();
            }
        }
        Ok(())
    }
}

impl Hybrid {
    /// From here on the second stands for the whole.
    fn switch(&mut self) {
        self.switched = true;
        self.report = StepReport {
            switched_at: Some(self.report.iteration),
            phases: core::mem::take(&mut self.report.phases),
            ..self.second.report().clone()
        };
    }
}

impl Solver for Hybrid {
    fn step(&mut self) -> Result<StepReport, SolveError> {
        self.iterate()?;
        Ok(self.report.clone())
    }
    fn positions(&self) -> &[f64] {
        self.current().positions()
    }
    fn dimension(&self) -> usize {
        self.first.dimension()
    }
    fn status(&self) -> Status {
        self.report.status
    }
    fn report(&self) -> &StepReport {
        &self.report
    }
    fn inspect(&self) -> Inspection {
        self.current().inspect()
    }
}

impl Deformer for Hybrid {
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError> {
        if self.switched {
            self.first.restart(self.second.positions());
            self.base = self.report.iteration;
            self.switched = false;
        }
        self.first.retarget(positions, springs)?;
        self.second.retarget(positions, springs)?;
        self.report = StepReport {
            iteration: self.base + self.first.report().iteration,
            seconds: self.report.seconds,
            ..self.first.report().clone()
        };
        Ok(())
    }

    fn field(&self, field: Field) -> Vec<f32> {
        self.current().field(field)
    }
}
