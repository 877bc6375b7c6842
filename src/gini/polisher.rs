//! The polisher (12), (13): Levenberg and Marquardt's method on each zone of constraints.

mod normal;

use super::constraint::Constraint;
use super::simplex::corners;
use super::zones::Zones;
use crate::parallel;
use normal::Row;

/// Range of γ (13b).
const DAMPING: [f64; 2] = [1e-4, 1e-1];

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 12;

/// Zones that are one piece of work.
const CHUNK: usize = 4;

/// Constraints of a zone that are one piece of work.
const MEMBERS: usize = 1024;

/// What an iteration did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Polished {
    /// Zones with violated constraints.
    pub zones: usize,
    /// h before and after, in squares of lengths (11).
    pub before: f64,
    /// See `before`.
    pub after: f64,
}

/// A zone's work and result.
#[derive(Default)]
struct Job<const D: usize> {
    zone: u32,
    /// Positions of its vertices, before and after.
    x: Vec<[f64; D]>,
    damping: f64,
    before: f64,
    after: f64,
}

/// One iteration (12) on all zones with violated constraints; those of one zone keep one γ.
pub fn polish<const D: usize>(
    constraints: &mut [Constraint],
    zones: &mut Zones,
    movable: &[bool],
    x: &mut [[f64; D]],
) -> Polished {
    zones.build(constraints, movable);
    let violated = |c: &u32| constraints[*c as usize].is_violated(x);
    let mut jobs: Vec<Job<D>> = (0..zones.len())
        .filter(|&z| zones.constraints(z).iter().any(violated))
        .map(|z| Job {
            zone: z as u32,
            ..Default::default()
        })
        .collect();
    let (old, all, shared) = (&*x, &*constraints, &*zones);
    parallel::for_each_chunk(&mut jobs, CHUNK, |_, jobs| {
        jobs.iter_mut().for_each(|job| step(job, all, shared, old));
    });
    let mut sum = Polished::default();
    for job in &jobs {
        let zone = job.zone as usize;
        for (&slot, position) in zones.vertices(zone).iter().zip(&job.x) {
            x[slot as usize] = *position;
        }
        for &c in zones.constraints(zone) {
            constraints[c as usize].damping = job.damping;
        }
        sum.zones += 1;
        sum.before += job.before;
        sum.after += job.after;
    }
    sum
}

fn step<const D: usize>(
    job: &mut Job<D>,
    constraints: &[Constraint],
    zones: &Zones,
    x: &[[f64; D]],
) {
    let zone = job.zone as usize;
    let members = zones.constraints(zone);
    let vertices = zones.vertices(zone);
    let gamma = members
        .iter()
        .map(|&c| constraints[c as usize].damping)
        .fold(f64::INFINITY, f64::min);
    let mut parts: Vec<Vec<Row<D>>> = Vec::new();
    parts.resize_with(members.len().div_ceil(MEMBERS), Vec::new);
    parallel::for_each_chunk(&mut parts, 1, |part, rows| {
        let members = members[part * MEMBERS..].iter().take(MEMBERS);
        rows[0].extend(members.filter_map(|&c| violated_row(&constraints[c as usize], zones, x)));
    });
    let rows = match parts.len() {
        1 => parts.swap_remove(0),
        _ => parts.into_iter().flatten().collect(),
    };
    job.before = rows.iter().map(|row| 0.5 * row.error * row.error).sum();
    let most = rows.iter().map(Row::square).fold(0.0, f64::max);
    let shift = gamma * most;
    let direction = match shift > 0.0 {
        true => normal::direction(&rows, shift, vertices.len()),
        false => vec![[0.0; D]; vertices.len()],
    };

    let mut errors = vec![0.0; members.len()];
    let mut value = |x: &[[f64; D]], held: &[[f64; D]]| -> f64 {
        parallel::for_each_chunk(&mut errors, MEMBERS, |part, errors| {
            for (error, &c) in errors.iter_mut().zip(&members[part * MEMBERS..]) {
                let constraint = &constraints[c as usize];
                if constraint.skipped {
                    continue;
                }
                let p = constraint.slots.map(|slot| match zones.local(slot) {
                    Zones::HELD => held[slot as usize],
                    local => x[local as usize],
                });
                *error = (constraint.value_at(&p) - constraint.offset).min(0.0);
            }
        });
        errors.iter().map(|e| 0.5 * e * e).sum()
    };
    let from: Vec<[f64; D]> = vertices.iter().map(|&s| x[s as usize]).collect();
    let mut alpha = 1.0;
    let mut to = from.clone();
    let mut taken = 0.0;
    job.after = job.before;
    for _ in 0..=MOST_HALVINGS {
        for ((to, from), d) in to.iter_mut().zip(&from).zip(&direction) {
            for i in 0..D {
                to[i] = from[i] + alpha * d[i];
            }
        }
        let after = value(&to, x);
        if after < job.before {
            (taken, job.after) = (alpha, after);
            break;
        }
        alpha *= 0.5;
    }
    job.x = if taken > 0.0 { to } else { from };
    let scale = match taken {
        a if a > 0.75 => 1.0 / 3.0,
        a if a < 0.25 => 2.0,
        _ => 1.0,
    };
    job.damping = (gamma * scale).clamp(DAMPING[0], DAMPING[1]);
}

/// The row of a constraint, if it is violated.
fn violated_row<const D: usize>(
    constraint: &Constraint,
    zones: &Zones,
    x: &[[f64; D]],
) -> Option<Row<D>> {
    if constraint.skipped {
        return None;
    }
    let p = corners(x, &constraint.slots);
    let error = constraint.value_at(&p) - constraint.offset;
    let mut gradient = (error < 0.0).then(|| constraint.gradient_at(&p))?;
    let vertices = constraint.slots.map(|slot| zones.local(slot));
    for (vertex, g) in vertices.iter().zip(&mut gradient) {
        if *vertex == Zones::HELD {
            *g = [0.0; D];
        }
    }
    Some(Row {
        vertices: vertices.map(|v| if v == Zones::HELD { 0 } else { v }),
        gradient,
        error,
    })
}
