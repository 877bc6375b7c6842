//! `foldfree miqp`.

use crate::arguments::{names, threads, tolerance};
use crate::failure::Failure;
use crate::report::{self, snake_keys};
use crate::{Outcome, files, say};
use clap::Args;
use foldfree::mixed_integer::{
    Action, Engine, MixedInteger, MixedIntegerOptions, MixedIntegerReport, MixedIntegerStep,
    Problem, Rounding,
};
use foldfree::optim::{CancelToken, Status, Stopwatch};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Solve a mixed-integer quadratic problem; exit code 2 when an optimum could not be proven within --nodes.
#[derive(Debug, Args)]
pub struct Miqp {
    /// The problem: .sys, also with .gz behind.
    #[arg(value_name = "IN.sys")]
    pub input: PathBuf,
    /// How integers are found.
    #[arg(long, default_value = "greedy", value_parser = names::<Rounding>(&Rounding::NAMES))]
    pub rounding: Rounding,
    /// What they are found with; two-opt and lattice need dense.
    #[arg(long, default_value = "automatic", value_parser = names::<Engine>(&["automatic", "dense", "three-level"]))]
    pub engine: Engine,
    /// Eliminate constraint rows in the order of the file instead of the shortest first.
    #[arg(long)]
    pub no_reordering: bool,
    /// What counts as 0, relatively, where coefficients or constants of rows cancel.
    #[arg(long, value_name = "T", default_value_t = MixedIntegerOptions::default().tolerance, value_parser = tolerance)]
    pub tolerance: f64,
    /// Round the nearest integers together as long as their distances add up to at most this (0 to 0.5;
    /// 0: one at a time). If left out: 0.5 with three levels, else 0.
    #[arg(long, value_name = "B", value_parser = tolerance)]
    pub budget: Option<f64>,
    /// Unknowns that local Gauss-Seidel looks at after each rounding; 0: level not used.
    #[arg(long, value_name = "N", default_value_t = MixedIntegerOptions::default().gauss_seidel)]
    pub gauss_seidel: u32,
    /// Iterations of conjugate gradients after each rounding; 0: level not used.
    #[arg(long, value_name = "N", default_value_t = MixedIntegerOptions::default().conjugate_gradients)]
    pub conjugate_gradients: u32,
    /// No sparse Cholesky as third level.
    #[arg(long)]
    pub no_cholesky: bool,
    /// Nodes that the enumeration of lattice visits before it gives a gap instead of a proof.
    #[arg(long, value_name = "N", default_value_t = MixedIntegerOptions::default().nodes)]
    pub nodes: u64,
    /// Threads; 0: as many as the machine has.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads)]
    pub threads: usize,
    /// Solve so many times and report the run at the lower quartile of the times.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub repeat: u16,
    /// Write the solution: one number a line.
    #[arg(long, value_name = "X.txt")]
    pub out: Option<PathBuf>,
    /// Write what happened as JSON.
    #[arg(long, value_name = "REPORT.json")]
    pub report: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

impl Miqp {
    fn options(&self) -> MixedIntegerOptions {
        MixedIntegerOptions {
            rounding: self.rounding,
            engine: self.engine,
            reorder: !self.no_reordering,
            tolerance: self.tolerance,
            budget: self.budget,
            gauss_seidel: self.gauss_seidel,
            conjugate_gradients: self.conjugate_gradients,
            cholesky: !self.no_cholesky,
            nodes: self.nodes,
            ..MixedIntegerOptions::default()
        }
    }
}

/// The report. `solution` holds the energies, the row report and the counts of the library's report.
#[derive(Debug, Serialize)]
struct MiqpReport<'a> {
    program: &'static str,
    input: String,
    /// `converged`, `max-iterations`.
    status: &'static str,
    #[serde(serialize_with = "snake_keys")]
    options: &'a MixedIntegerOptions,
    threads: usize,
    unknowns: usize,
    constraint_rows: usize,
    integers: usize,
    read_seconds: f64,
    /// Everything but reading and writing.
    seconds: f64,
    #[serde(flatten, serialize_with = "snake_keys")]
    solution: serde_json::Value,
    iterations: Vec<Iteration>,
}

/// The library's report, whose seconds are those of the steps alone, and the gap that is left.
fn solution(report: &MixedIntegerReport) -> serde_json::Value {
    let mut value = serde_json::to_value(report).unwrap_or_default();
    if let Some(fields) = value.as_object_mut() {
        fields.remove("seconds");
        fields.insert("stepsSeconds".into(), report.seconds.into());
        let gap = report.lower_bound.map(|bound| report.energy - bound);
        fields.insert("gap".into(), gap.into());
    }
    value
}

/// One step.
#[derive(Debug, Serialize)]
struct Iteration {
    iteration: usize,
    seconds: f64,
    energy: f64,
    remaining: usize,
    #[serde(flatten)]
    action: Action,
}

impl From<&MixedIntegerStep> for Iteration {
    fn from(step: &MixedIntegerStep) -> Self {
        Self {
            iteration: step.iteration,
            seconds: step.seconds,
            energy: step.energy,
            remaining: step.remaining,
            action: step.action.clone(),
        }
    }
}

/// Reads the problem, solves it, says what was found.
pub fn run(arguments: &Miqp) -> Result<Outcome, Failure> {
    for path in [&arguments.out, &arguments.report].into_iter().flatten() {
        files::check_writable(path)?;
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads)
        .build_global()
        .map_err(Failure::new)?;
    let clock = Stopwatch::start();
    let bytes = files::read_bytes(&arguments.input)?;
    let of_input = |error| Failure::of_file(&arguments.input, error);
    let problem = Problem::from_sys(&bytes).map_err(of_input)?;
    drop(bytes);
    let read_seconds = clock.seconds();
    let options = arguments.options();
    let mut runs: Vec<(f64, MixedInteger, Vec<Iteration>)> = Vec::new();
    for _ in 0..arguments.repeat {
        let problem = problem.clone();
        let clock = Stopwatch::start();
        let mut solver = MixedInteger::new(problem, options.clone()).map_err(of_input)?;
        let mut iterations = vec![Iteration::from(solver.last_step())];
        let record = |step: &MixedIntegerStep| iterations.push(Iteration::from(step));
        solver
            .run(record, &CancelToken::default())
            .map_err(of_input)?;
        runs.push((clock.seconds(), solver, iterations));
        // one of them is enough to have in memory, beside the fastest quarter
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        runs.truncate(arguments.repeat as usize / 4 + 1);
    }
    let Some((seconds, solver, iterations)) = runs.pop() else {
        return Err(Failure::new("nothing was solved"));
    };
    if let Some(path) = &arguments.out {
        files::write(path, &lines(solver.solution()))?;
    }
    let report = solver.report();
    if !arguments.quiet {
        summary(report, seconds);
    }
    if let Some(path) = &arguments.report {
        let report = MiqpReport {
            program: report::PROGRAM,
            input: arguments.input.display().to_string(),
            status: solver.status().name(),
            options: &options,
            threads: rayon::current_num_threads(),
            unknowns: problem.unknowns(),
            constraint_rows: problem.rows(),
            integers: problem.integers().len(),
            read_seconds,
            seconds,
            solution: solution(report),
            iterations,
        };
        write_report(path, &report)?;
    }
    Ok(match solver.status() {
        Status::Converged(_) => Outcome::Done,
        _ => Outcome::NotReached,
    })
}

fn write_report(path: &Path, report: &MiqpReport) -> Result<(), Failure> {
    files::write(path, &report::to_json(report)?)
}

/// One number a line, each in its shortest form that reads back as the same bits.
fn lines(x: &[f64]) -> Vec<u8> {
    let line = |x: &f64| match x.fract() == 0.0 && x.abs() < 1e15 {
        // without the sign of −0
        true => format!("{}\n", *x as i64),
        false => format!("{x:?}\n"),
    };
    x.iter().map(line).collect::<String>().into_bytes()
}

fn summary(report: &MixedIntegerReport, seconds: f64) {
    for row in &report.redundant_rows {
        say(&format!("constraint row {row} is implied by others"));
    }
    say(&format!(
        "{} unknowns and {} integers after elimination, {:.1} ms",
        report.reduced_unknowns,
        report.reduced_integers,
        1e3 * seconds
    ));
    say(&format!(
        "energy {:.9}, {:.6} above the relaxed one",
        report.energy,
        report.energy - report.relaxed_energy
    ));
    if let Some(bound) = report.lower_bound {
        let gap = report.energy - bound;
        say(&match report.proven {
            true => format!("optimal to within {gap:.1e}: {} nodes", report.nodes),
            false => format!("not proven optimal: at most {gap:.3e} above the optimum"),
        });
    }
}
