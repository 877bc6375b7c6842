//! The dense engine: all roundings on the Schur complement of the integers, step by step.

use super::lattice::{Enumeration, Proof, Reduction};
use super::options::{MixedIntegerOptions, Rounding};
use super::reduced::Reduced;
use super::report::{Action, Level, Rounded};
use super::rounding_error::RoundingError;
use super::search::{ExactGreedy, IntegerForm, TwoOpt};
use crate::linalg::Cholesky;

/// Exchanges of basis vectors, and nodes of the enumeration, in one step.
const EXCHANGES: u64 = 2_000;
const NODES: u64 = 1 << 18;

/// What the next step does.
enum Phase {
    Round(ExactGreedy),
    Improve(Box<TwoOpt>),
    Reduce,
    Enumerate(Box<Enumeration>),
    Done,
}

/// The state of the search.
pub struct Dense {
    form: IntegerForm,
    phase: Phase,
    /// The best integers known, or estimates.
    z: Vec<f64>,
    /// The lattice's basis, which outlives a change of the right-hand side.
    reduction: Option<Reduction>,
    /// Least energy above the relaxed one that was not excluded.
    pub bound: Option<f64>,
    /// Was everything better excluded?
    pub proven: bool,
    pub rounded: usize,
    pub improvements: usize,
    pub nodes: u64,
}

impl Dense {
    /// From the factor of the reduced matrix, whose order ends with the integers.
    pub fn new(reduced: &Reduced, cholesky: &Cholesky) -> Self {
        let k = reduced.integers().len();
        let form = IntegerForm {
            k,
            factor: cholesky.trailing(k),
            center: vec![0.0; k],
        };
        Self {
            form,
            phase: Phase::Done,
            z: Vec::new(),
            reduction: None,
            bound: None,
            proven: false,
            rounded: 0,
            improvements: 0,
            nodes: 0,
        }
    }

    /// Begins at a relaxed solution (in elimination order).
    pub fn start(&mut self, relaxed: &[f64], rounding: Rounding) {
        let first = relaxed.len() - self.form.k;
        self.form.center.copy_from_slice(&relaxed[first..]);
        self.z.clone_from(&self.form.center);
        (self.bound, self.proven) = (None, false);
        (self.rounded, self.improvements, self.nodes) = (0, 0, 0);
        self.phase = match rounding {
            Rounding::Lattice => Phase::Reduce,
            _ if self.form.k == 0 => Phase::Done,
            _ => Phase::Round(ExactGreedy::new(&self.form)),
        };
        if let Some(reduction) = &mut self.reduction {
            reduction.set_center(&self.form);
        }
    }

    pub fn is_done(&self) -> bool {
        matches!(self.phase, Phase::Done)
    }
    /// Integers without a value.
    pub fn remaining(&self) -> usize {
        match &self.phase {
            Phase::Round(greedy) => greedy.remaining(),
            Phase::Reduce => self.form.k,
            _ => 0,
        }
    }
    /// Energy above the relaxed one.
    pub fn energy(&self) -> f64 {
        match &self.phase {
            Phase::Round(greedy) => greedy.energy(),
            _ => self.form.energy(&self.z),
        }
    }
    /// Exchanges of basis vectors.
    pub fn exchanges(&self) -> u64 {
        self.reduction.as_ref().map_or(0, Reduction::exchanges)
    }

    /// One step.
    pub fn step(
        &mut self,
        reduced: &Reduced,
        cholesky: &mut Cholesky,
        relaxed: &[f64],
        options: &MixedIntegerOptions,
    ) -> Action {
        match std::mem::replace(&mut self.phase, Phase::Done) {
            Phase::Round(greedy) => self.round(reduced, greedy, options),
            Phase::Improve(two_opt) => self.improve(reduced, two_opt),
            Phase::Reduce => self.reduce(),
            Phase::Enumerate(enumeration) => {
                self.enumerate(enumeration, options.nodes, &mut || {
                    RoundingError::new(reduced, cholesky, relaxed)
                })
            }
            Phase::Done => Action::Improve {
                changed: Vec::new(),
            },
        }
    }

    fn unknown(reduced: &Reduced, index: usize) -> u32 {
        reduced.unknown(reduced.integers()[index])
    }

    fn round(
        &mut self,
        reduced: &Reduced,
        mut greedy: ExactGreedy,
        options: &MixedIntegerOptions,
    ) -> Action {
        let (fixed, spread) = match options.rounding {
            Rounding::Direct => (greedy.direct(), 0),
            _ => greedy.step(options.budget.unwrap_or(0.0)),
        };
        self.z.copy_from_slice(greedy.estimate());
        self.rounded += fixed.len();
        self.phase = match (greedy.remaining(), options.rounding) {
            (0, Rounding::TwoOpt) => Phase::Improve(Box::new(TwoOpt::new(&self.form, &self.z))),
            (0, _) => Phase::Done,
            _ => Phase::Round(greedy),
        };
        let rounded = fixed.iter().map(|f| Rounded {
            unknown: Self::unknown(reduced, f.index),
            from: f.from,
            to: f.to,
        });
        Action::Round {
            rounded: rounded.collect(),
            level: Level::Dense,
            spread,
        }
    }

    fn improve(&mut self, reduced: &Reduced, mut two_opt: Box<TwoOpt>) -> Action {
        let changed = two_opt.step().unwrap_or_default();
        let rounded = changed.iter().map(|&(index, by)| Rounded {
            unknown: Self::unknown(reduced, index),
            from: self.z[index],
            to: self.z[index] + by,
        });
        let rounded: Vec<Rounded> = rounded.collect();
        self.z.copy_from_slice(two_opt.integers());
        if !rounded.is_empty() {
            self.improvements += 1;
            self.phase = Phase::Improve(two_opt);
        }
        Action::Improve { changed: rounded }
    }

    fn reduce(&mut self) -> Action {
        let reduction = self
            .reduction
            .get_or_insert_with(|| Reduction::new(&self.form));
        let reduced = reduction.run(EXCHANGES);
        self.phase = match reduced {
            true => Phase::Enumerate(Box::new(Enumeration::new(reduction))),
            false => Phase::Reduce,
        };
        Action::Reduce {
            exchanges: reduction.exchanges(),
            reduced,
        }
    }

    fn enumerate(
        &mut self,
        mut enumeration: Box<Enumeration>,
        limit: u64,
        errors: &mut dyn FnMut() -> RoundingError,
    ) -> Action {
        // the first point is k nodes away
        let limit = limit.max(self.form.k as u64 + 1);
        let nodes = NODES.min(limit.saturating_sub(enumeration.nodes()));
        let proven = enumeration.run(nodes.max(1));
        if let (Some(reduction), Some(w)) = (&self.reduction, enumeration.best()) {
            self.z = reduction.integers(w);
        }
        self.nodes = enumeration.nodes();
        let action = Action::Enumerate {
            nodes: self.nodes,
            improvements: enumeration.improvements(),
            proven,
        };
        if !proven && self.nodes < limit {
            self.phase = Phase::Enumerate(enumeration);
            return action;
        }
        self.proven = proven;
        if let Some(reduction) = &self.reduction {
            let RoundingError { factor, relaxation } = errors();
            let proof = Proof::new(&self.form, reduction, factor, relaxation);
            // the relaxed energy itself is too high by ½ρ²
            let bound = proof.energy(enumeration.bound()) - 0.5 * relaxation * relaxation;
            self.bound = Some(bound);
        }
        if !proven {
            self.phase = Phase::Improve(Box::new(TwoOpt::new(&self.form, &self.z)));
        }
        action
    }

    /// All unknowns for the present integers or estimates: y = y_relaxed + Ã⁻¹ S (z − c).
    pub fn solve(&self, cholesky: &mut Cholesky, relaxed: &[f64], y: &mut [f64]) {
        let first = relaxed.len() - self.form.k;
        y.fill(0.0);
        let force = self.form.times(&self.form.offset(&self.z));
        y[first..].copy_from_slice(&force);
        cholesky.solve_in_place(y, 1);
        y.iter_mut().zip(relaxed).for_each(|(y, r)| *y += r);
        y[first..].copy_from_slice(&self.z);
    }
}
