//! Elimination of the constraints (paper, §2.2), without losing or inventing an integer solution.
//!
//! A row with a real unknown is solved for a real unknown, which restricts no integer. What remains are
//! rows of integers alone. Divided by what their coefficients have in common, such a row either has a
//! coefficient ±1, for which it is solved, or unimodular substitutions z_j = z_j' − Σ qᵢ zᵢ (Euclid's
//! algorithm on the coefficients) make one: together they bring the integer rows to Hermite normal form.
//! Every solution of the rows then corresponds to exactly one point of the lattice of the integers that
//! are left.

mod affine;
mod constants;
mod integer_row;
mod order;
mod pairs;
mod rows;

use super::{MixedIntegerError as Error, Problem};
pub use affine::AffineMap;
use constants::{ConstantStep, Constants};
use order::Queue;
use pairs::Pairs;
use rows::Rows;

/// What became of a constraint row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case", tag = "outcome", content = "unknown")]
pub enum RowOutcome {
    /// It was solved for this unknown.
    Eliminates(u32),
    /// The other rows imply it.
    Redundant,
}

/// x_variable = Σ coefficient · x + factor · (constant of a row), in the unknowns that are left after this
/// step.
#[derive(Debug, Clone)]
struct Substitution {
    variable: u32,
    terms: Vec<(u32, f64)>,
    /// Row and factor; `None`: a unimodular change of an integer.
    constant: Option<(u32, f64)>,
}

/// The constraints in solved form: what depends on their coefficients, once; what depends on their
/// constants, as often as these change.
#[derive(Debug, Clone)]
pub struct Elimination {
    substitutions: Vec<Substitution>,
    steps: Vec<ConstantStep>,
    outcomes: Vec<RowOutcome>,
    tolerance: f64,
    /// Of each row, for what may count as 0 in it.
    scale: Vec<f64>,
    changes_of_integers: usize,
}

impl Elimination {
    /// Eliminates all constraint rows of a problem, the row with the fewest terms first (unless not
    /// `reordered`: then as they were given). `tolerance` is relative: what remains of a coefficient or a
    /// constant when larger ones cancel is 0 below it.
    ///
    /// # Errors
    /// `Contradictory`, `Infeasible`, `NotRational`, `CoefficientsTooLarge`, each with the row.
    pub fn new(problem: &Problem, reordered: bool, tolerance: f64) -> Result<Self, Error> {
        let mut rows = Rows::new(problem);
        let mut queue = Queue::new(&rows, reordered);
        let mut constants = Constants::new(problem.constants());
        let mut this = Self {
            substitutions: Vec::with_capacity(problem.rows()),
            steps: Vec::new(),
            outcomes: vec![RowOutcome::Redundant; problem.rows()],
            tolerance,
            scale: rows.scales(),
            changes_of_integers: 0,
        };
        // as long as there is no longer row to eliminate
        let mut pairs = reordered.then(|| Pairs::new(problem.unknowns()));
        while let Some(row) = queue.pop(&rows) {
            if let Some(mut solved) = pairs.take_if(|_| !Pairs::takes(&rows, row)) {
                for other in 0..problem.rows() as u32 {
                    if rows.is_open(other) {
                        solved.rewrite(&mut rows, other, &mut this, &mut constants)?;
                        queue.changed(other, &rows);
                    }
                }
                // it may not be the shortest any more
                queue.put_back(row, &rows);
                continue;
            }
            rows.drop_noise(row, tolerance);
            if rows.terms(row).is_empty() {
                let scale = this.scale[row as usize];
                this.apply(&mut constants, ConstantStep::Vanish { row, scale })?;
                rows.close(row);
                continue;
            }
            let pivot = match rows.real_pivot(row) {
                Some(pivot) => pivot,
                None => this.integer_pivot(&mut rows, &mut queue, &mut constants, row)?,
            };
            this.eliminate(
                &mut rows,
                &mut queue,
                &mut constants,
                (row, pivot),
                pairs.as_mut(),
            )?;
        }
        Ok(this)
    }

    /// Makes the coefficients of an integer row whole numbers without a common divisor, one of them ±1:
    /// that of the unknown returned.
    fn integer_pivot(
        &mut self,
        rows: &mut Rows,
        queue: &mut Queue,
        constants: &mut Constants,
        row: u32,
    ) -> Result<u32, Error> {
        let coefficients: Vec<f64> = rows.terms(row).iter().map(|t| t.1).collect();
        let too_large = Error::CoefficientsTooLarge { row: row as usize };
        if coefficients.iter().any(|a| a.abs() >= integer_row::EXACT) {
            return Err(too_large);
        }
        let Some((factor, whole)) = integer_row::primitive(&coefficients) else {
            return Err(Error::NotRational { row: row as usize });
        };
        rows.set_coefficients(row, &whole);
        self.scale[row as usize] *= factor.abs();
        self.apply(constants, ConstantStep::Scale { row, factor })?;
        self.apply(constants, ConstantStep::Whole { row })?;
        loop {
            if let Some(pivot) = rows.unit_pivot(row) {
                return Ok(pivot);
            }
            let (variable, quotients) = integer_row::euclid(rows.terms(row));
            if quotients.is_empty() {
                // a common divisor has come up, which only inexact integers could do
                return Err(too_large);
            }
            rows.substitute(variable, &quotients, queue, row)?;
            let mut terms: Vec<(u32, f64)> = quotients.iter().map(|&(i, q)| (i, -q)).collect();
            terms.push((variable, 1.0));
            terms.sort_unstable_by_key(|t| t.0);
            self.changes_of_integers += 1;
            self.substitutions.push(Substitution {
                variable,
                terms,
                constant: None,
            });
        }
    }

    /// Solves a row for `pivot` and takes `pivot` out of the rows that are still open; with `pairs` out of those of
    /// two unknowns alone.
    fn eliminate(
        &mut self,
        rows: &mut Rows,
        queue: &mut Queue,
        constants: &mut Constants,
        (row, pivot): (u32, u32),
        pairs: Option<&mut Pairs>,
    ) -> Result<(), Error> {
        let longest = if pairs.is_some() { 2 } else { usize::MAX };
        let solved = rows.close(row);
        let at = |terms: &[(u32, f64)]| terms.binary_search_by_key(&pivot, |t| t.0);
        let Ok(place) = at(&solved) else {
            unreachable!("the pivot is one of the row's unknowns");
        };
        let a = solved[place].1;
        for target in rows.open_rows_of(pivot) {
            if rows.terms(target).len() > longest {
                continue;
            }
            let factor = rows.coefficient(target, pivot) / a;
            if factor == 0.0 {
                continue;
            }
            rows.subtract(target, factor, &solved, pivot);
            queue.changed(target, rows);
            self.subtract(constants, target, row, factor)?;
        }
        if let Some(pairs) = pairs {
            pairs.solved(row, pivot, &solved, self.substitutions.len());
        }
        rows.inherit(pivot, &solved);
        self.outcomes[row as usize] = RowOutcome::Eliminates(pivot);
        let others = solved.iter().filter(|t| t.0 != pivot);
        self.substitutions.push(Substitution {
            variable: pivot,
            terms: others.map(|&(i, c)| (i, -c / a)).collect(),
            constant: Some((row, -1.0 / a)),
        });
        Ok(())
    }

    /// Row `target` −= factor · row `source`: its constant, and the size of what may have cancelled in it.
    fn subtract(
        &mut self,
        constants: &mut Constants,
        target: u32,
        source: u32,
        factor: f64,
    ) -> Result<(), Error> {
        let scale = self.scale[source as usize] * factor.abs();
        self.scale[target as usize] = self.scale[target as usize].max(scale);
        let step = ConstantStep::Subtract {
            row: target,
            source,
            factor,
        };
        self.apply(constants, step)
    }

    fn apply(&mut self, constants: &mut Constants, step: ConstantStep) -> Result<(), Error> {
        constants.apply(step, self.tolerance)?;
        self.steps.push(step);
        Ok(())
    }

    /// What became of each row.
    pub fn outcomes(&self) -> &[RowOutcome] {
        &self.outcomes
    }

    /// Unimodular substitutions that integer rows without a coefficient ±1 took.
    pub fn changes_of_integers(&self) -> usize {
        self.changes_of_integers
    }

    /// Integers that rows were solved for.
    pub fn eliminated_integers(&self, problem: &Problem) -> usize {
        let is_integer = |o: &&RowOutcome| match o {
            RowOutcome::Eliminates(unknown) => problem.integers().binary_search(unknown).is_ok(),
            RowOutcome::Redundant => false,
        };
        self.outcomes.iter().filter(is_integer).count()
    }

    /// The constants of the solved rows for these constants of the problem's rows.
    ///
    /// # Errors
    /// `Contradictory` and `Infeasible`, with the row.
    fn replay(&self, constants: &[f64]) -> Result<Vec<f64>, Error> {
        let mut replayed = Constants::new(constants);
        for &step in &self.steps {
            replayed.apply(step, self.tolerance)?;
        }
        Ok(replayed.into_values())
    }
}
