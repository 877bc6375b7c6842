//! The polisher (12), (13): Levenberg and Marquardt's method on each zone of constraints.

use super::constraint::Constraint;
use super::simplex::corners;
use super::zones::Zones;
use crate::parallel;

/// Range of γ (13b).
const DAMPING: [f64; 2] = [1e-4, 1e-1];

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 12;

/// Up to so many violated constraints JJᵀ + U is factored, beyond conjugate gradients are used.
const DENSE: usize = 40;

/// Most iterations of conjugate gradients, and when they end: the residual relative to the right-hand side.
const MOST_CG: usize = 60;
const CG_TOLERANCE: f64 = 1e-2;

/// Zones that are one piece of work.
const CHUNK: usize = 4;

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

/// A violated constraint of a zone: e < 0 and its gradient on the zone's vertices.
struct Row<const D: usize> {
    vertices: [u32; 4],
    gradient: [[f64; D]; 4],
    error: f64,
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
    let mut rows: Vec<Row<D>> = Vec::new();
    for &c in members {
        let constraint = &constraints[c as usize];
        let p = corners(x, &constraint.slots);
        let error = constraint.value_at(&p) - constraint.offset;
        if error < 0.0 && !constraint.skipped {
            job.before += 0.5 * error * error;
            let mut gradient = constraint.gradient_at(&p);
            let vertices = constraint.slots.map(|slot| zones.local(slot));
            for (vertex, g) in vertices.iter().zip(&mut gradient) {
                if *vertex == Zones::HELD {
                    *g = [0.0; D];
                }
            }
            rows.push(Row {
                vertices: vertices.map(|v| if v == Zones::HELD { 0 } else { v }),
                gradient,
                error,
            });
        }
    }
    let diagonal = |row: &Row<D>| row.gradient.iter().flatten().map(|g| g * g).sum::<f64>();
    let most = rows.iter().map(diagonal).fold(0.0, f64::max);
    let shift = gamma * most;
    let y = if !(shift > 0.0) {
        vec![0.0; rows.len()]
    } else if rows.len() <= DENSE {
        solve_dense(&rows, shift)
    } else {
        solve_iteratively(&rows, shift, vertices.len())
    };
    let mut direction = vec![[0.0; D]; vertices.len()];
    spread(&rows, &y, -1.0, &mut direction);

    let value = |x: &[[f64; D]], held: &[[f64; D]]| -> f64 {
        let mut sum = 0.0;
        for &c in members {
            let constraint = &constraints[c as usize];
            if constraint.skipped {
                continue;
            }
            let p = constraint.slots.map(|slot| match zones.local(slot) {
                Zones::HELD => held[slot as usize],
                local => x[local as usize],
            });
            let e = (constraint.value_at(&p) - constraint.offset).min(0.0);
            sum += 0.5 * e * e;
        }
        sum
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

/// Adds factor · Jᵀ y.
fn spread<const D: usize>(rows: &[Row<D>], y: &[f64], factor: f64, out: &mut [[f64; D]]) {
    for (row, y) in rows.iter().zip(y) {
        let factor = factor * y;
        for corner in 0..4 {
            let out = &mut out[row.vertices[corner] as usize];
            for i in 0..D {
                out[i] += factor * row.gradient[corner][i];
            }
        }
    }
}

fn gather<const D: usize>(row: &Row<D>, x: &[[f64; D]]) -> f64 {
    let mut sum = 0.0;
    for corner in 0..4 {
        let x = &x[row.vertices[corner] as usize];
        for i in 0..D {
            sum += x[i] * row.gradient[corner][i];
        }
    }
    sum
}

/// (JJᵀ + shift) y = e by Cholesky's factorisation. The shift keeps the pivots positive.
fn solve_dense<const D: usize>(rows: &[Row<D>], shift: f64) -> Vec<f64> {
    let m = rows.len();
    let mut matrix = vec![0.0; m * m];
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows[..=i].iter().enumerate() {
            let mut sum = 0.0;
            for (va, ga) in a.vertices.iter().zip(&a.gradient) {
                for (vb, gb) in b.vertices.iter().zip(&b.gradient) {
                    if va == vb {
                        sum += ga.iter().zip(gb).map(|(a, b)| a * b).sum::<f64>();
                    }
                }
            }
            matrix[i * m + j] = sum;
        }
        matrix[i * m + i] += shift;
    }
    let mut y: Vec<f64> = rows.iter().map(|row| row.error).collect();
    for j in 0..m {
        let (done, rest) = matrix.split_at_mut((j + 1) * m);
        let row = &mut done[j * m..];
        let square: f64 = row[..j].iter().map(|l| l * l).sum();
        let pivot = (row[j] - square).max(0.5 * shift).sqrt();
        row[j] = pivot;
        let row = &done[j * m..];
        for below in rest.chunks_exact_mut(m) {
            let product: f64 = below[..j].iter().zip(row).map(|(a, b)| a * b).sum();
            below[j] = (below[j] - product) / pivot;
        }
    }
    for i in 0..m {
        let sum: f64 = (0..i).map(|j| matrix[i * m + j] * y[j]).sum();
        y[i] = (y[i] - sum) / matrix[i * m + i];
    }
    for i in (0..m).rev() {
        let sum: f64 = (i + 1..m).map(|j| matrix[j * m + i] * y[j]).sum();
        y[i] = (y[i] - sum) / matrix[i * m + i];
    }
    y
}

/// The same by conjugate gradients, of which a step needs no more than a direction: the matrix is applied as
/// J(Jᵀy), never formed.
fn solve_iteratively<const D: usize>(rows: &[Row<D>], shift: f64, vertices: usize) -> Vec<f64> {
    let m = rows.len();
    let mut y = vec![0.0; m];
    let mut residual: Vec<f64> = rows.iter().map(|row| row.error).collect();
    let mut direction = residual.clone();
    let mut image = vec![0.0; m];
    let mut moved = vec![[0.0; D]; vertices];
    let norm = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>();
    let mut square = norm(&residual);
    let goal = CG_TOLERANCE * CG_TOLERANCE * square;
    for _ in 0..MOST_CG {
        if !(square > goal) {
            break;
        }
        moved.fill([0.0; D]);
        spread(rows, &direction, 1.0, &mut moved);
        let mut bend = 0.0;
        for ((image, row), d) in image.iter_mut().zip(rows).zip(&direction) {
            *image = gather(row, &moved) + shift * d;
            bend += *image * d;
        }
        let step = square / bend;
        for i in 0..m {
            y[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = norm(&residual);
        let factor = next / square;
        square = next;
        for (d, r) in direction.iter_mut().zip(&residual) {
            *d = r + factor * *d;
        }
    }
    y
}
