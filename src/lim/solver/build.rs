//! What is done once.

use super::Lim;
use crate::geometry::{Elimination, RestShape};
use crate::lim::barrier::Barrier;
use crate::lim::constraints::{Constraints, Handle};
use crate::lim::elements::{Law, Mesh, Sums};
use crate::lim::laplacian::quadratic_form;
use crate::lim::objective::Objective;
use crate::lim::problem::inverted;
use crate::lim::system::LimSystem;
use crate::lim::{LimEnergy, LimOptions, LimProblem};
use crate::optim::{BuildError, Status, StepReport, Yardstick};
use crate::parallel;
use crate::space::Space;
use crate::wrapd::External;
use crate::wrapd::external::Terms;

/// ε of (3), relative to the least measure of an element at rest (the paper's text has 1e-5, its authors' code
/// this).
const EPSILON: f64 = 1e-4;

/// An energy of an element at rest that a strain of 1.1e-4 has, relative to its stiffness: changes are measured
/// against it where the energy itself is less (as in `energy`).
const FLOOR: f64 = 6.5e-9;

impl Lim {
    /// Checks the problem and does all symbolic work, in a space of d = k.
    ///
    /// # Errors
    /// Lengths that do not fit, options out of range, a start that is not finite; `InvertedStart` where there is a
    /// barrier and the start has inverted or degenerate elements, as an exact predicate says.
    pub fn new<S: Space>(problem: LimProblem, options: LimOptions) -> Result<Self, BuildError> {
        options.validate()?;
        problem.validate(S::DIM)?;
        if options.barrier
            && let (inverted, Some(first)) = inverted(S::DIM, &problem.rest.vertices, problem.start)
        {
            return Err(BuildError::InvertedStart { inverted, first });
        }
        parallel::in_pool(|| Self::build::<S>(problem, options))
    }

    fn build<S: Space>(problem: LimProblem, options: LimOptions) -> Result<Self, BuildError> {
        let (d, rest) = (S::DIM, problem.rest);
        let n = problem.start.len() / d;
        let measure: f64 = rest.measure.iter().sum();
        let scale = match d {
            2 => measure.sqrt().recip(),
            _ => measure.cbrt().recip(),
        };
        let form = quadratic_form(options.energy, rest, n, scale);
        let elimination = Elimination::with_couplings(rest, n, &[], &form);
        let slot = elimination.slot.clone();
        let by_slot = |positions: &[f64]| {
            let mut out = vec![0.0; positions.len()];
            for (position, &s) in positions.chunks_exact(d).zip(&slot) {
                out[s as usize * d..][..d].copy_from_slice(position);
            }
            out
        };
        let law = Law {
            energy: options.energy,
            hessian: options.hessian,
            beta: options.beta(),
        };
        let x = by_slot(problem.start);
        let weight = |&m: &f64| match options.energy {
            LimEnergy::GreenStrain => 1.0,
            _ => m / measure,
        };
        let weights = rest.measure.iter().map(weight).collect();
        let mut mesh = Mesh::<S>::new(rest, &slot, weights, Vec::new());
        mesh.set_barriers(barriers(
            rest,
            &mesh.determinants(&x),
            options.barrier_reach,
        ));
        let quadratic = (!form.is_empty()).then(|| {
            let external = External {
                stiffness: form.clone(),
                ..Default::default()
            };
            Terms::new(&external, problem.rest_positions, &slot, n)
        });
        let rest_positions = by_slot(problem.rest_positions);
        let objective = Objective::new(Box::new(mesh), law, d, quadratic, rest_positions.clone());
        let mut system = LimSystem::new(&objective, d, &elimination, &form)?;
        let constraints = constraints(&problem, d, scale, &slot);

        // the body's own stiffness, without barrier and handles
        let alone = Constraints {
            dimension: d,
            scale,
            held: vec![false; n],
            ..Default::default()
        };
        system.assemble(&objective, &alone, &rest_positions, 0.0);
        let mut diagonal = vec![0.0; n];
        system.mean_diagonal(&mut diagonal);
        let rest_diagonal = slot.iter().map(|&s| diagonal[s as usize]).collect();

        let stiffness = match options.energy {
            LimEnergy::GreenStrain => 8.0 * rest.len() as f64,
            _ => 1.0,
        };
        let mut this = Self {
            options,
            dimension: d,
            objective,
            constraints,
            system,
            slot,
            trial: x.clone(),
            x,
            positions: problem.start.to_vec(),
            gradient: vec![0.0; n * d],
            whole_gradient: vec![0.0; n * d],
            direction: vec![0.0; n * d],
            rest_diagonal,
            sums: Sums::default(),
            yardstick: Yardstick {
                floor: FLOOR * stiffness,
                force: FLOOR.sqrt() * stiffness,
                rounding: 0.0,
            },
            quiet: 0,
            kept: 1.0,
            report: StepReport::at_start(),
            counted_from: 0,
        };
        this.constraints.hold_arrived(&this.x);
        this.look();
        this.report.lim = Some(this.parameters(0.0, 0.0));
        if options.max_iterations == 0 {
            this.report.status = Status::MaxIterations;
        }
        Ok(this)
    }

    /// How stiff the body is at a vertex at rest: the mean diagonal entry of the second derivatives of its energy,
    /// in units of the energy per squared length.
    pub fn stiffness_at(&self, vertex: usize) -> f64 {
        self.rest_diagonal[vertex]
    }
}

/// The walls: at ε (3) of what an element has at rest, or nearer to 0 where it starts with less.
fn barriers(rest: &RestShape, determinants: &[f64], reach: f64) -> Vec<Barrier> {
    let least = rest.measure.iter().copied().fold(f64::INFINITY, f64::min);
    let elements = rest.measure.iter().zip(determinants);
    elements
        .map(|(measure, &start)| {
            let wall = EPSILON * least / measure;
            Barrier::new(wall.min(0.5 * start).max(0.0), reach)
        })
        .collect()
}

/// Handles where they start, and what is part of no element.
fn constraints(problem: &LimProblem, d: usize, scale: f64, slot: &[u32]) -> Constraints {
    let n = slot.len();
    let mut used = vec![false; n];
    problem
        .rest
        .vertices
        .iter()
        .for_each(|&v| used[v as usize] = true);
    let mut is_handle = used.iter().map(|used| !used).collect::<Vec<bool>>();
    problem
        .handles
        .iter()
        .for_each(|&v| is_handle[v as usize] = true);
    let mut handles: Vec<Handle> = (0..n)
        .filter(|&v| is_handle[v])
        .map(|v| {
            let mut target = [0.0; 3];
            target[..d].copy_from_slice(&problem.start[v * d..][..d]);
            Handle {
                slot: slot[v],
                target,
                sub_target: target,
                led_to: target,
                arrived: true,
            }
        })
        .collect();
    handles.sort_unstable_by_key(|handle| handle.slot);
    let mut constraints = Constraints {
        dimension: d,
        scale,
        handles,
        held: vec![false; n],
        ..Default::default()
    };
    constraints.restart();
    constraints
}
