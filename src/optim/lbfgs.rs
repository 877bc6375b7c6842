//! L-BFGS directions with a solve as the initial inverse Hessian.
//!
//! The two-loop recursion (Nocedal & Wright, algorithm 7.4) with H₀ = A⁻¹ and no y·s/y·y scaling. The
//! recursion itself runs on scalars: with the products s_i·y_j at hand, the first loop needs only
//! s_i·g and the second only y_i·r, so that a direction reads each stored vector twice and writes
//! none of them.

use crate::linalg::Cholesky;

/// A history of steps s and gradient changes y.
#[derive(Debug, Clone)]
pub struct Lbfgs {
    window: usize,
    /// Newest last; at most `window`.
    pairs: Vec<Pair>,
    /// Vectors of dropped pairs, kept to be used again.
    spare: Vec<Pair>,
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

/// Entries a block of the vector operations has: small enough for the first-level cache, and the unit
/// of ordered summation.
const BLOCK: usize = 1024;

/// a·b, summed in a fixed order: eight running sums a block, blocks in order.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    pulp::Arch::new().dispatch(Dot { a, b })
}

struct Dot<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl pulp::WithSimd for Dot<'_> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> f64 {
        let mut total = 0.0;
        for (a, b) in self.a.chunks(BLOCK).zip(self.b.chunks(BLOCK)) {
            let mut sums = [0.0; 8];
            let (a, a_rest) = a.as_chunks::<8>();
            let (b, b_rest) = b.as_chunks::<8>();
            for (a, b) in a.iter().zip(b) {
                for lane in 0..8 {
                    sums[lane] += a[lane] * b[lane];
                }
            }
            for (lane, (a, b)) in a_rest.iter().zip(b_rest).enumerate() {
                sums[lane] += a * b;
            }
            let [s0, s1, s2, s3, s4, s5, s6, s7] = sums;
            total += ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7));
        }
        total
    }
}

/// y += c x.
struct Axpy<'a> {
    c: f64,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl pulp::WithSimd for Axpy<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (y, x) in self.y.iter_mut().zip(self.x) {
            *y += self.c * x;
        }
    }
}

fn axpy(c: f64, x: &[f64], y: &mut [f64]) {
    pulp::Arch::new().dispatch(Axpy { c, x, y });
}

/// y += Σ cᵢ xᵢ, block by block.
fn add_combination<'a>(terms: impl Iterator<Item = (f64, &'a [f64])> + Clone, y: &mut [f64]) {
    for (block, y) in y.chunks_mut(BLOCK).enumerate() {
        let range = block * BLOCK..block * BLOCK + y.len();
        for (c, x) in terms.clone() {
            axpy(c, &x[range.clone()], y);
        }
    }
}

impl Lbfgs {
    /// An empty history of at most `window` pairs.
    pub fn new(window: usize) -> Self {
        Self {
            window,
            pairs: Vec::with_capacity(window),
            spare: Vec::new(),
        }
    }

    /// Forgets everything (H₀ has changed).
    pub fn clear(&mut self) {
        self.spare.append(&mut self.pairs);
    }

    /// Number of stored pairs.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Is the history empty?
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// direction = −H g, with H₀ = `factor`⁻¹ applied to each of the `columns` interleaved unknowns
    /// per row. Returns g·direction.
    pub fn direction(
        &mut self,
        factor: &mut Cholesky,
        columns: usize,
        gradient: &[f64],
        direction: &mut [f64],
    ) -> f64 {
        let m = self.pairs.len();
        let mut alpha = vec![0.0; m];
        for i in (0..m).rev() {
            let pair = &self.pairs[i];
            let newer: f64 = (i + 1..m).map(|j| alpha[j] * pair.against[j]).sum();
            alpha[i] = pair.rho * (dot(&pair.s, gradient) - newer);
        }
        direction.copy_from_slice(gradient);
        add_combination(
            self.pairs.iter().zip(&alpha).map(|(p, a)| (-a, &p.y[..])),
            direction,
        );
        factor.solve_in_place(direction, columns);
        let along: Vec<f64> = self.pairs.iter().map(|p| dot(&p.y, direction)).collect();
        let mut coefficient = vec![0.0; m];
        for i in 0..m {
            let older: f64 = (0..i)
                .map(|j| coefficient[j] * self.pairs[j].against[i])
                .sum();
            let beta = self.pairs[i].rho * (along[i] + older);
            coefficient[i] = alpha[i] - beta;
        }
        add_combination(
            self.pairs
                .iter()
                .zip(&coefficient)
                .map(|(p, c)| (*c, &p.s[..])),
            direction,
        );
        direction.iter_mut().for_each(|d| *d = -*d);
        dot(gradient, direction)
    }

    /// Remembers a step along the last direction and the gradients before and after it. A pair
    /// without positive curvature (s·y ≤ 0, up to rounding) is not kept.
    pub fn push(&mut self, step: &[f64], gradient_before: &[f64], gradient_after: &[f64]) {
        let mut pair = match self.pairs.len() == self.window {
            true => {
                for p in &mut self.pairs[1..] {
                    p.against.remove(0);
                }
                self.pairs.remove(0)
            }
            false => self.spare.pop().unwrap_or_default(),
        };
        pair.s.clear();
        pair.s.extend_from_slice(step);
        pair.y.clear();
        pair.y.extend(
            gradient_after
                .iter()
                .zip(gradient_before)
                .map(|(a, b)| a - b),
        );
        let curvature = dot(&pair.s, &pair.y);
        let scale = dot(&pair.y, &pair.y).sqrt() * dot(&pair.s, &pair.s).sqrt();
        if curvature.is_nan() || curvature <= 1e-16 * scale || curvature == 0.0 {
            self.spare.push(pair);
            return;
        }
        for older in &mut self.pairs {
            older.against.push(dot(&older.s, &pair.y));
        }
        pair.against.clear();
        pair.against
            .extend(self.pairs.iter().map(|older| dot(&pair.s, &older.y)));
        pair.against.push(curvature);
        pair.rho = curvature.recip();
        self.pairs.push(pair);
    }
}
