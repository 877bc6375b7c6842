//! What an ADMM solver solves.

use super::External;
use crate::geometry::RestShape;
use crate::optim::BuildError;

/// What to solve: rest shapes, a start, and vertices held where they start.
#[derive(Debug, Clone, Copy)]
pub struct Problem<'a> {
    /// Rest shapes; of a map their total measure should be 1, which its reported energy expects.
    pub rest: &'a RestShape,
    /// Start, vertices × dimension, interleaved. May be inverted or collapsed.
    pub start: &'a [f64],
    /// Vertices held at their start; at least one, unless springs hold the rest in place.
    pub pins: &'a [u32],
    /// Terms beside the elements; `None` also means that springs never come.
    pub external: Option<&'a External>,
}

impl Problem<'_> {
    /// Checks that the parts fit together, and that something holds the rest in place.
    pub fn validate(&self, dimension: usize, stretches: usize) -> Result<(), BuildError> {
        self.validate_parts(dimension, stretches)?;
        let sprung = self.external.is_some_and(|e| !e.springs.is_empty());
        if self.pins.is_empty() && !sprung {
            return Err(BuildError::InvalidOption {
                option: "pins",
                what: "needs at least one vertex".into(),
            });
        }
        Ok(())
    }

    /// Checks that the parts fit together.
    pub fn validate_parts(&self, dimension: usize, stretches: usize) -> Result<(), BuildError> {
        let problem = self;
        let (rest, start) = (problem.rest, problem.start);
        let n = start.len() / dimension;
        let wrong = |argument, expected, found| {
            Err(BuildError::WrongLength {
                argument,
                expected,
                found,
            })
        };
        if start.len() != n * dimension {
            return wrong("start", n * dimension, start.len());
        }
        if rest.stretches != stretches {
            return wrong("rest.stretches", stretches, rest.stretches);
        }
        let corners = rest.len() * (stretches + 1);
        if rest.vertices.len() != corners {
            return wrong("rest.vertices", corners, rest.vertices.len());
        }
        let entries = rest.len() * stretches * stretches;
        if rest.inverse.len() != entries {
            return wrong("rest.inverse", entries, rest.inverse.len());
        }
        let highest = rest.vertices.iter().max().map_or(0, |&v| v as usize);
        if highest >= n {
            return wrong("start", (highest + 1) * dimension, start.len());
        }
        if rest.is_empty() {
            return Err(BuildError::InvalidOption {
                option: "rest",
                what: "has no elements".into(),
            });
        }
        for (index, &measure) in rest.measure.iter().enumerate() {
            if !(measure > 0.0 && measure.is_finite()) {
                return Err(BuildError::DegenerateElement { index, measure });
            }
        }
        if let Some(bad) = start.iter().position(|x| !x.is_finite()) {
            return Err(BuildError::InvalidOption {
                option: "start",
                what: format!("vertex {} is not finite", bad / dimension),
            });
        }
        if let Some(external) = problem.external {
            external.validate(n, dimension, problem.pins)?;
        }
        if problem.pins.iter().any(|&p| p as usize >= n) {
            return Err(BuildError::InvalidOption {
                option: "pins",
                what: format!("needs vertices below {n}"),
            });
        }
        Ok(())
    }
}
