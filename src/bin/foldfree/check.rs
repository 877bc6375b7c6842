//! `foldfree check`.

use crate::arguments::Check;
use crate::failure::Failure;
use crate::report::CheckReport;
use crate::{Outcome, files, say, solids};
use foldfree::certificate::{Certificate, SolidCertificate};
use foldfree::mesh::prepare;
use foldfree::optim::Stopwatch;
use glam::DVec3;

/// Reads the map, examines it and says what was found.
pub fn run(arguments: &Check) -> Result<Outcome, Failure> {
    if let Some(path) = &arguments.report {
        files::check_writable(path)?;
    }
    if let Some(positions) = solids::read_if_solid(&arguments.map)? {
        return run_on_solid(arguments, &positions);
    }
    let mut map = files::read_map(&arguments.map, arguments.rest.as_deref())?;
    let mut notes = Vec::new();
    // Neighbours have to agree on which side is up before one can say that a triangle is inverted.
    // What else may be wrong with the surface is for the certificate to say.
    if let Ok(prepared) = prepare(&map.mesh) {
        map.mesh = prepared.mesh;
        notes = prepared.notes;
    }
    let clock = Stopwatch::start();
    let certificate = Certificate::try_of_map(&map.mesh, &map.uv)
        .map_err(|error| Failure::of_file(&arguments.map, error))?;
    let certificate_seconds = clock.seconds();
    if !arguments.quiet {
        notes.iter().for_each(|note| say(note));
        say(&certificate.summary());
    }
    let fine = if arguments.global {
        certificate.globally_injective
    } else {
        certificate.is_free_of_folds()
    };
    finish(arguments, notes, certificate, certificate_seconds, fine)
}

/// The same for the deformed vertices of a solid.
fn run_on_solid(arguments: &Check, positions: &[DVec3]) -> Result<Outcome, Failure> {
    let Some(rest_path) = &arguments.rest else {
        let what = "a solid is deformed from its rest shape: give it with --rest";
        return Err(Failure::of_file(&arguments.map, what));
    };
    if arguments.global {
        let what = "--global is not known for solids: only what is around every point is examined";
        return Err(Failure::new(what));
    }
    let file = solids::read_solid(rest_path)?;
    let rest = file.mesh;
    if positions.len() != rest.positions.len() {
        let (found, expected) = (positions.len(), rest.positions.len());
        let what = format!("has {found} vertices, the rest shape {expected}");
        return Err(Failure::of_file(&arguments.map, what));
    }
    let clock = Stopwatch::start();
    let certificate = SolidCertificate::try_of_solid(&rest, positions)
        .map_err(|error| Failure::of_file(rest_path, error))?;
    let certificate_seconds = clock.seconds();
    if !arguments.quiet {
        say(&certificate.summary());
    }
    let fine = certificate.is_free_of_folds();
    finish(
        arguments,
        file.notes,
        certificate,
        certificate_seconds,
        fine,
    )
}

fn finish(
    arguments: &Check,
    notes: Vec<String>,
    certificate: impl serde::Serialize,
    certificate_seconds: f64,
    fine: bool,
) -> Result<Outcome, Failure> {
    if let Some(path) = &arguments.report {
        let report = CheckReport {
            program: crate::report::PROGRAM,
            map: arguments.map.display().to_string(),
            notes,
            certificate,
            certificate_seconds,
        };
        files::write(path, &crate::report::to_json(&report)?)?;
    }
    Ok(if fine {
        Outcome::Done
    } else {
        Outcome::NotReached
    })
}
