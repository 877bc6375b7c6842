//! The command line: flatten a mesh, deform or untangle a body, solve a mixed-integer problem, check a map, make a sample mesh.
//!
//! Exit code 0: done (`parameterize`, `deform`, `cloth`, `miqp`: converged; `untangle`, `check`: nothing folds); 2: not (ran out of
//! iterations; the map folds); 1: an error, in one line on stderr.

mod arguments;
mod check;
mod cloth;
mod deform;
mod failure;
mod files;
mod generate;
mod handles;
mod injective;
mod miqp;
mod parameterize;
mod progress;
mod reference;
mod relaxation;
mod report;
mod solids;
mod untangle;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::io::Write;
use std::process::ExitCode;

/// How a command ended that did not fail.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    /// As wished.
    Done,
    /// The result is there, but not converged, or not free of folds.
    NotReached,
}

fn main() -> ExitCode {
    let result = match Arguments::try_parse() {
        Ok(arguments) => run(&arguments),
        Err(error) if !error.use_stderr() => {
            say(error.render().to_string().trim_end());
            return ExitCode::SUCCESS;
        }
        Err(error) => Err(Failure::usage(&error)),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::NotReached) => ExitCode::from(2),
        Err(failure) => {
            let _ = writeln!(std::io::stderr(), "foldfree: {failure}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    match &arguments.command {
        Command::Parameterize(options) => parameterize::run(options),
        Command::Deform(options) => deform::run(options),
        Command::Untangle(options) => untangle::run(options),
        Command::Cloth(options) => cloth::run(options),
        Command::Miqp(options) => miqp::run(options),
        Command::Check(options) => check::run(options),
        Command::Generate(options) => generate::run(options),
    }
}

/// A line on stdout. That nobody may be reading any more is not an error.
fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}
