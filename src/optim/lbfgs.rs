//! L-BFGS directions with a solve as the initial inverse Hessian.
//!
//! The two-loop recursion (Nocedal & Wright, algorithm 7.4) with H₀ = A⁻¹ and no y·s/y·y scaling. The
//! recursion itself runs on scalars: with all products s_i·y_j at hand, the first loop needs only
//! s_i·g and the second only y_i·r (r the solution), so that a direction reads each stored vector
//! twice and writes none. The products of a new pair come for free: s_i·y from s_i·g before and after
//! the step, s·y_j from the recursion.

use super::vectors::{add_combination, dot, dots, set_combination};
use crate::linalg::Cholesky;

/// A history of steps s and gradient changes y.
#[derive(Debug, Clone)]
pub struct Lbfgs {
    window: usize,
    /// Newest last; at most `window`.
    pairs: Vec<Pair>,
    /// Vectors of dropped pairs, to be used again.
    spare: Vec<Pair>,
    /// s_i·g for the gradient of the last direction.
    along_gradient: Vec<f64>,
    /// y_i·d for the last direction d.
    along_direction: Vec<f64>,
    /// g·d.
    slope: f64,
    /// Are `along_gradient` those of the gradient that comes next?
    fresh: bool,
    alpha: Vec<f64>,
    coefficient: Vec<f64>,
    products: Vec<f64>,
}

#[derive(Debug, Clone, Default)]
struct Pair {
    s: Vec<f64>,
    y: Vec<f64>,
    /// 1/(s·y).
    rho: f64,
    /// s·y_j for this pair's s and every pair j.
    against: Vec<f64>,
}

impl Lbfgs {
    /// An empty history of at most `window` pairs.
    pub fn new(window: usize) -> Self {
        let scalars = || Vec::with_capacity(window + 1);
        Self {
            window: window.max(1),
            pairs: Vec::with_capacity(window),
            spare: Vec::with_capacity(window),
            along_gradient: scalars(),
            along_direction: scalars(),
            slope: 0.0,
            fresh: false,
            alpha: scalars(),
            coefficient: scalars(),
            products: scalars(),
        }
    }

    /// Forgets everything (H₀ has changed).
    pub fn clear(&mut self) {
        self.spare.append(&mut self.pairs);
        self.along_gradient.clear();
        self.along_direction.clear();
        self.fresh = false;
    }

    /// Number of stored pairs.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Is the history empty?
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// The objective has changed, and so will the gradient at the same point.
    pub fn new_objective(&mut self) {
        self.fresh = false;
    }

    /// direction = −H g, with H₀ = `factor`⁻¹ applied to each of the `columns` interleaved unknowns
    /// per row. Returns g·direction. Unless [`Self::new_objective`] was called, `gradient` must be the
    /// one handed to the last [`Self::push`].
    pub fn direction(
        &mut self,
        factor: &mut Cholesky,
        columns: usize,
        gradient: &[f64],
        direction: &mut [f64],
    ) -> f64 {
        let m = self.pairs.len();
        if !self.fresh {
            dots(
                self.pairs.iter().map(|p| &p.s[..]),
                gradient,
                &mut self.along_gradient,
            );
        }
        self.fresh = false;
        let pairs = &self.pairs;
        self.alpha.clear();
        self.alpha.resize(m, 0.0);
        for i in (0..m).rev() {
            let newer: f64 = (i + 1..m)
                .map(|j| self.alpha[j] * pairs[i].against[j])
                .sum();
            self.alpha[i] = pairs[i].rho * (self.along_gradient[i] - newer);
        }
        // all with the opposite sign: the solution is −r
        set_combination(
            (-1.0, gradient),
            pairs.iter().zip(&self.alpha).map(|(p, a)| (*a, &p.y[..])),
            direction,
        );
        factor.solve_in_place(direction, columns);
        dots(
            pairs.iter().map(|p| &p.y[..]),
            direction,
            &mut self.along_direction,
        );
        self.coefficient.clear();
        for i in 0..m {
            let older: f64 = (0..i)
                .map(|j| self.coefficient[j] * pairs[j].against[i])
                .sum();
            let beta = pairs[i].rho * (older - self.along_direction[i]);
            self.coefficient.push(self.alpha[i] - beta);
        }
        add_combination(
            pairs
                .iter()
                .zip(&self.coefficient)
                .map(|(p, c)| (-c, &p.s[..])),
            direction,
        );
        for i in 0..m {
            let steps: f64 = (0..m)
                .map(|j| self.coefficient[j] * pairs[j].against[i])
                .sum();
            self.along_direction[i] -= steps;
        }
        self.slope = dot(gradient, direction);
        self.slope
    }

    /// The step along the last direction is `t` times as long: to be called before [`Self::push`] with
    /// that step.
    pub fn shorten(&mut self, t: f64) {
        self.slope *= t;
        self.along_direction.iter_mut().for_each(|a| *a *= t);
    }

    /// Remembers the last direction (shortened, if [`Self::shorten`] was called) as the step taken, and the gradients of the same
    /// objective before and after it. A pair without positive curvature (s·y ≤ 0 up to rounding) is
    /// not kept.
    pub fn push(&mut self, step: &[f64], gradient_before: &[f64], gradient_after: &[f64]) {
        debug_assert_eq!(
            self.along_direction.len(),
            self.pairs.len(),
            "push follows direction"
        );
        // s_i·g after the step, for the old pairs and the new
        dots(
            self.pairs
                .iter()
                .map(|p| &p.s[..])
                .chain(core::iter::once(step)),
            gradient_after,
            &mut self.products,
        );
        let m = self.pairs.len();
        let curvature = self.products[m] - self.slope;
        // |s·g| before and after bound the rounding error of their difference
        let noise = 1e-14 * (self.products[m].abs() + self.slope.abs());
        if curvature.is_nan() || curvature <= noise {
            self.products.truncate(m);
            core::mem::swap(&mut self.along_gradient, &mut self.products);
            self.fresh = true;
            return;
        }
        for (i, older) in self.pairs.iter_mut().enumerate() {
            older
                .against
                .push(self.products[i] - self.along_gradient[i]);
        }
        let mut pair = self.spare.pop().unwrap_or_default();
        pair.against.clear();
        pair.against.extend_from_slice(&self.along_direction);
        pair.against.push(curvature);
        pair.rho = curvature.recip();
        if m == self.window {
            for p in &mut self.pairs[1..] {
                p.against.remove(0);
            }
            pair.against.remove(0);
            self.products.remove(0);
            let oldest = self.pairs.remove(0);
            self.spare.push(oldest);
        }
        let nothing = core::iter::empty();
        pair.s.resize(step.len(), 0.0);
        set_combination((1.0, step), nothing, &mut pair.s);
        pair.y.resize(step.len(), 0.0);
        let before = core::iter::once((-1.0, gradient_before));
        set_combination((1.0, gradient_after), before, &mut pair.y);
        self.pairs.push(pair);
        core::mem::swap(&mut self.along_gradient, &mut self.products);
        self.fresh = true;
    }
}
