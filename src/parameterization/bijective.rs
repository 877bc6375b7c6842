//! Maps that are injective as a whole, from any start (Overby, Kaufman & Narain 2021, §8.5).

use super::atlas::Atlas;
use super::shelves::lay_out;
use super::starts::start;
use super::{EnergyKind, Method, ParameterizationOptions, Start};
use crate::energy::{Arap, SymmetricDirichlet};
use crate::geometry::RestShape;
use crate::gini::{Gini, GiniOptions, GiniProblem, MOST_PAIRS};
use crate::newton::{GiniThenNewton, NewtonOptions};
use crate::optim::{BuildError, Solver};
use crate::space::Plane;
use core::ops::Range;
use glam::DVec2;

/// Once no vertex moves by more than this in a step, in units of the surface's size, composite majorization takes over:
/// earlier it would stop at contacts that GINI still pushes apart.
const SETTLE_BEFORE: f64 = 0.01;

/// GINI on the atlas, all charts of it in one plane, side by side; with [`Method::GiniCm`] composite majorization after
/// it. `map` is the start; where its boundary meets itself, x begins as Tutte's embedding, and x̄ there. Notes say so.
///
/// # Errors
/// As [`Gini::new`].
pub(super) fn bijective(
    atlas: &Atlas,
    rest: &RestShape,
    mut map: Vec<DVec2>,
    options: &ParameterizationOptions,
    scale: f64,
) -> Result<(Box<dyn Solver>, Option<String>), BuildError> {
    let charts: Vec<Range<u32>> = atlas.charts.iter().map(|c| c.vertices.clone()).collect();
    let room = room(atlas, scale);
    lay_out(&mut map, &charts, room);
    let first = GiniOptions {
        max_iterations: options.max_iterations,
        settle: match options.method {
            Method::GiniCm => SETTLE_BEFORE,
            _ => GiniOptions::overlap().settle,
        },
        ..GiniOptions::overlap()
    };
    let build = |start: &[f64], primary: Option<&[f64]>| -> Result<Box<dyn Solver>, BuildError> {
        let problem = GiniProblem {
            rest,
            start,
            primary,
            pins: &[],
            springs: &[],
        };
        if options.method == Method::GiniCm {
            let second = NewtonOptions {
                tolerance: options.tolerance,
                max_iterations: options.max_iterations,
                ..Default::default()
            };
            let solver = GiniThenNewton::composite_majorization(problem, first, second)?;
            return Ok(Box::new(solver));
        }
        Ok(match options.energy {
            EnergyKind::SymmetricDirichlet => Box::new(Gini::<2>::new::<Plane, _>(
                problem,
                SymmetricDirichlet,
                first,
            )?),
            EnergyKind::Arap => Box::new(Gini::<2>::new::<Plane, _>(problem, Arap, first)?),
        })
    };
    let positions = interleave(&map);
    match build(&positions, None) {
        Err(BuildError::IntersectingStart { pairs }) => {
            let (mut circle, _) = start(Start::Tutte, options.seed, atlas, rest, scale)?;
            lay_out(&mut circle, &charts, room);
            let more = if pairs.len() < MOST_PAIRS {
                ""
            } else {
                " or more"
            };
            let note = format!(
                "the boundary of the start meets itself (pairs of edges: {}{more}): the map begins in a circle instead, and the start is where the primary solver begins",
                pairs.len()
            );
            let solver = match build(&interleave(&circle), Some(&positions)) {
                // there is no flow here
                Err(BuildError::IntersectingStart { pairs }) => {
                    return Err(BuildError::InvalidOption {
                        option: "start",
                        what: format!(
                            "meets itself, and so does a circle in its place (pairs of edges: {})",
                            pairs.len()
                        ),
                    });
                }
                solver => solver?,
            };
            Ok((solver, Some(note)))
        }
        solver => Ok((solver?, None)),
    }
}

/// What charts need between them, so that none is in another's way: a map that keeps lengths is nowhere wider than half
/// its outline.
fn room(atlas: &Atlas, scale: f64) -> f64 {
    let length = |outline: &Vec<u32>| {
        let next = outline.iter().cycle().skip(1);
        let at = |&v: &u32| atlas.mesh.positions[v as usize];
        let edges = outline.iter().zip(next);
        edges.map(|(a, b)| at(a).distance(at(b))).sum::<f64>()
    };
    let lengths = atlas.charts.iter().map(|chart| length(&chart.outline));
    0.5 * scale * lengths.fold(0.0, f64::max)
}

fn interleave(map: &[DVec2]) -> Vec<f64> {
    map.iter().flat_map(|p| [p.x, p.y]).collect()
}
