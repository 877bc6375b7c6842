//! `foldfree check`.

use crate::arguments::Check;
use crate::failure::Failure;
use crate::report::CheckReport;
use crate::{Outcome, files, say};
use foldfree::certificate::Certificate;
use foldfree::mesh::prepare;
use foldfree::optim::Stopwatch;

/// Reads the map, examines it and says what was found.
pub fn run(arguments: &Check) -> Result<Outcome, Failure> {
    if let Some(path) = &arguments.report {
        files::check_writable(path)?;
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
