//! L-BFGS-B for convex quadratic functions of variables that must not be negative.
//!
//! The method of Byrd, Lu, Nocedal & Zhu (1995): a limited-memory model B = θI − W M Wᵀ of the Hessian, the
//! generalised Cauchy point (the first minimum of the model along the projected gradient path), then the model's
//! minimum over the variables that are free there, projected to the bounds as in version 3.0 (Morales & Nocedal
//! 2011). As the function is quadratic, the line search is exact and costs nothing: an iteration applies the
//! Hessian once, to the step.

use super::compact::Compact;
use super::vectors::dot;

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LbfgsbOptions {
    /// Pairs in the model.
    pub history: usize,
    /// Most iterations.
    pub max_iterations: usize,
    /// Stop when no component of the projected gradient is larger than this.
    pub tolerance: f64,
}

/// Minimises f over λ ≥ 0. `lambda` (≥ 0) and `gradient` are those of the start, then of the result. `apply` takes a
/// direction and returns the Hessian times it; it is told the step along the direction afterwards by `moved`, so
/// that the caller can keep what depends on λ up to date. Returns the number of iterations.
pub fn minimize<Q: Quadratic>(
    quadratic: &mut Q,
    lambda: &mut [f64],
    gradient: &mut [f64],
    options: LbfgsbOptions,
) -> usize {
    let n = lambda.len();
    let mut model = Compact::new(options.history);
    let (mut cauchy, mut direction) = (vec![0.0; n], vec![0.0; n]);
    let mut curvature = vec![0.0; n];
    for iteration in 0..options.max_iterations {
        if !(projected_norm(lambda, gradient) > options.tolerance) {
            return iteration;
        }
        if iteration == 0 {
            // the scale of the first model: the Rayleigh quotient of the projected gradient
            for i in 0..n {
                direction[i] = if lambda[i] > 0.0 || gradient[i] < 0.0 {
                    -gradient[i]
                } else {
                    0.0
                };
            }
            quadratic.apply(&direction, &mut curvature);
            let (square, bend) = (dot(&direction, &direction), dot(&direction, &curvature));
            if !(bend > 0.0 && square > 0.0) {
                return iteration;
            }
            model.theta = bend / square;
        }
        cauchy_point(&mut model, lambda, gradient, &mut cauchy);
        subspace_step(&model, lambda, gradient, &cauchy, &mut direction);
        let slope = dot(&direction, gradient);
        if !(slope < 0.0) {
            return iteration;
        }
        quadratic.apply(&direction, &mut curvature);
        let bend = dot(&direction, &curvature);
        let exact = if bend > 0.0 { -slope / bend } else { 1.0 };
        let room = room(lambda, &direction);
        let step = exact.min(room);
        if !(step > 0.0 && step.is_finite()) {
            return iteration;
        }
        quadratic.moved(step);
        for i in 0..n {
            let next = lambda[i] + step * direction[i];
            // what reaches its bound is put there exactly
            let at_bound = direction[i] < 0.0 && next <= 1e-14 * lambda[i];
            lambda[i] = if at_bound { 0.0 } else { next };
            gradient[i] += step * curvature[i];
            direction[i] *= step;
            curvature[i] *= step;
        }
        quadratic.visited(lambda);
        model.push(&direction, &curvature);
    }
    options.max_iterations
}

/// A convex quadratic function, by its Hessian.
pub trait Quadratic {
    /// H times `direction`.
    fn apply(&mut self, direction: &[f64], out: &mut [f64]);
    /// λ has moved by `step` times the direction of the last [`Self::apply`].
    fn moved(&mut self, step: f64);
    /// An iteration has ended at this λ.
    fn visited(&mut self, _lambda: &[f64]) {}
}

/// The largest component of the projected gradient.
pub fn projected_norm(lambda: &[f64], gradient: &[f64]) -> f64 {
    let components = lambda.iter().zip(gradient);
    components.fold(0.0, |most, (&l, &g)| {
        most.max(if l > 0.0 { g.abs() } else { -g })
    })
}

/// How far λ may go along `direction`.
fn room(lambda: &[f64], direction: &[f64]) -> f64 {
    let steps = lambda.iter().zip(direction);
    steps.fold(
        f64::INFINITY,
        |most, (&l, &d)| {
            if d < 0.0 { most.min(l / -d) } else { most }
        },
    )
}

/// The generalised Cauchy point (algorithm CP), and Wᵀ(it − λ) in the model.
fn cauchy_point(model: &mut Compact, lambda: &[f64], gradient: &[f64], cauchy: &mut [f64]) {
    cauchy.copy_from_slice(lambda);
    model.prepare();
    let size = model.size();
    let theta = model.theta;
    // breakpoints in ascending order; equal ones by number
    let mut breaks: Vec<(f64, u32)> = Vec::new();
    let mut p = vec![0.0; size];
    let mut square = 0.0;
    for (i, (&l, &g)) in lambda.iter().zip(gradient).enumerate() {
        if g > 0.0 {
            if l > 0.0 {
                breaks.push((l / g, i as u32));
            } else {
                continue;
            }
        }
        square += g * g;
        model.add_row(i, -g, &mut p);
    }
    breaks.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut c = vec![0.0; size];
    let (mut row, mut product) = (vec![0.0; size], vec![0.0; size]);
    let mut slope = -square;
    let mut bend = theta * square - model.form(&p, &p, &mut product);
    let floor = f64::EPSILON * theta * square;
    let mut reached = 0.0;
    let mut left = if bend > floor {
        -slope / bend
    } else {
        -slope / floor.max(f64::MIN_POSITIVE)
    };
    for &(t, index) in &breaks {
        let ahead = t - reached;
        if left < ahead {
            break;
        }
        let i = index as usize;
        let g = gradient[i];
        cauchy[i] = 0.0;
        for (c, p) in c.iter_mut().zip(&p) {
            *c += ahead * p;
        }
        model.row(i, &mut row);
        slope +=
            ahead * bend + g * g - theta * g * lambda[i] - g * model.form(&row, &c, &mut product);
        bend -= theta * g * g
            + 2.0 * g * model.form(&row, &p, &mut product)
            + g * g * model.form(&row, &row, &mut product);
        bend = bend.max(floor);
        for (p, w) in p.iter_mut().zip(&row) {
            *p += g * w;
        }
        left = if slope < 0.0 { -slope / bend } else { 0.0 };
        reached = t;
    }
    reached += left;
    for (c, p) in c.iter_mut().zip(&p) {
        *c += left * p;
    }
    for (i, x) in cauchy.iter_mut().enumerate() {
        let g = gradient[i];
        let fixed = g > 0.0 && lambda[i] <= reached * g;
        *x = if fixed { 0.0 } else { lambda[i] - reached * g };
    }
    model.along = c;
}

/// The step to the model's minimum over what is free at the Cauchy point, projected; where that does not
/// descend, cut at the first bound.
fn subspace_step(
    model: &Compact,
    lambda: &[f64],
    gradient: &[f64],
    cauchy: &[f64],
    step: &mut [f64],
) {
    let theta = model.theta;
    let is_free = |i: usize| cauchy[i] > 0.0;
    let pulled = model.times_m(&model.along);
    let reduced: Vec<f64> = (0..lambda.len())
        .map(|i| match is_free(i) {
            true => gradient[i] + theta * (cauchy[i] - lambda[i]) - model.row_dot(i, &pulled),
            false => 0.0,
        })
        .collect();
    let v = model.free_correction(&reduced, &is_free);
    let newton = |i: usize| -reduced[i] / theta - model.row_dot(i, &v) / (theta * theta);
    let mut within = 1.0f64;
    for i in 0..lambda.len() {
        let to = match is_free(i) {
            true => {
                let d = newton(i);
                if d < 0.0 {
                    within = within.min(cauchy[i] / -d);
                }
                (cauchy[i] + d).max(0.0)
            }
            false => cauchy[i],
        };
        step[i] = to - lambda[i];
    }
    if !(dot(step, gradient) < 0.0) {
        for i in 0..lambda.len() {
            let d = if is_free(i) { within * newton(i) } else { 0.0 };
            step[i] = cauchy[i] + d - lambda[i];
        }
    }
}
