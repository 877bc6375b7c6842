//! The compact form of limited-memory BFGS matrices (Byrd, Nocedal & Schnabel 1994): B = θI − W M Wᵀ with
//! W = [Y θS] and M⁻¹ = [−D Lᵀ; L θSᵀS].

use super::vectors::{dot, dots};

/// A limited-memory model of a Hessian.
pub(super) struct Compact {
    most: usize,
    /// Steps and changes of the gradient, oldest first.
    pairs: Vec<(Vec<f64>, Vec<f64>)>,
    /// s_i·s_j and s_i·y_j.
    ss: Vec<Vec<f64>>,
    sy: Vec<Vec<f64>>,
    /// θ.
    pub theta: f64,
    /// M, row by row.
    m: Vec<f64>,
    /// Wᵀ(Cauchy point − λ).
    pub along: Vec<f64>,
}

/// Of short vectors.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Compact {
    /// Of no pairs, θ = 1.
    pub fn new(most: usize) -> Self {
        Self {
            most,
            pairs: Vec::new(),
            ss: Vec::new(),
            sy: Vec::new(),
            theta: 1.0,
            m: Vec::new(),
            along: Vec::new(),
        }
    }

    /// Columns of W.
    pub fn size(&self) -> usize {
        2 * self.pairs.len()
    }

    /// Remembers a step and the change of the gradient, if they show curvature.
    pub fn push(&mut self, s: &[f64], y: &[f64]) {
        let (curvature, change) = (dot(s, y), dot(y, y));
        if !(curvature > f64::EPSILON * change.sqrt() * dot(s, s).sqrt()) {
            return;
        }
        if self.pairs.len() == self.most {
            self.pairs.remove(0);
            for products in [&mut self.ss, &mut self.sy] {
                products.remove(0);
                products.iter_mut().for_each(|row| {
                    row.remove(0);
                });
            }
        }
        self.pairs.push((s.to_vec(), y.to_vec()));
        let steps = self.pairs.iter().map(|(old, _)| &**old);
        let changes = self.pairs.iter().map(|(_, old)| &**old);
        let [mut row_ss, mut column_sy, mut row_sy] = [const { Vec::new() }; 3];
        dots(steps.clone(), s, &mut row_ss);
        dots(steps, y, &mut column_sy);
        dots(changes, s, &mut row_sy);
        let last = self.ss.len();
        for i in 0..last {
            self.ss[i].push(row_ss[i]);
            self.sy[i].push(column_sy[i]);
        }
        self.ss.push(row_ss);
        self.sy.push(row_sy);
        self.theta = change / curvature;
    }

    /// Computes M.
    pub fn prepare(&mut self) {
        let k = self.pairs.len();
        let mut inverse = vec![0.0; 4 * k * k];
        for i in 0..k {
            inverse[i * 2 * k + i] = -self.sy[i][i];
            for j in 0..k {
                inverse[(k + i) * 2 * k + k + j] = self.theta * self.ss[i][j];
                if i > j {
                    inverse[(k + i) * 2 * k + j] = self.sy[i][j];
                    inverse[j * 2 * k + k + i] = self.sy[i][j];
                }
            }
        }
        let mut identity = vec![0.0; 4 * k * k];
        (0..2 * k).for_each(|i| identity[i * 2 * k + i] = 1.0);
        // a model that is singular to rounding is forgotten
        if eliminate(&mut inverse, &mut identity, 2 * k) {
            self.m = identity;
        } else {
            self.pairs.clear();
            self.ss.clear();
            self.sy.clear();
            self.m.clear();
        }
    }

    /// Row i of W.
    pub fn row(&self, i: usize, out: &mut [f64]) {
        let k = self.pairs.len();
        for (j, (s, y)) in self.pairs.iter().enumerate() {
            (out[j], out[k + j]) = (y[i], self.theta * s[i]);
        }
    }

    /// Adds `factor` times row i of W.
    pub fn add_row(&self, i: usize, factor: f64, out: &mut [f64]) {
        let k = self.pairs.len();
        for (j, (s, y)) in self.pairs.iter().enumerate() {
            out[j] += factor * y[i];
            out[k + j] += factor * self.theta * s[i];
        }
    }

    /// Row i of W times `v`.
    pub fn row_dot(&self, i: usize, v: &[f64]) -> f64 {
        let k = self.pairs.len();
        let pairs = self.pairs.iter().enumerate();
        pairs.fold(0.0, |sum, (j, (s, y))| {
            sum + v[j] * y[i] + v[k + j] * self.theta * s[i]
        })
    }

    /// M v.
    pub fn times_m(&self, v: &[f64]) -> Vec<f64> {
        match self.size() {
            0 => Vec::new(),
            size => self.m.chunks_exact(size).map(|row| inner(row, v)).collect(),
        }
    }

    /// aᵀ M b.
    pub fn form(&self, a: &[f64], b: &[f64], product: &mut [f64]) -> f64 {
        if a.is_empty() {
            return 0.0;
        }
        for (out, row) in product.iter_mut().zip(self.m.chunks_exact(a.len())) {
            *out = inner(row, b);
        }
        inner(a, product)
    }

    /// (I − M WᵀW/θ)⁻¹ M Wᵀ r over the free variables: what the inverse of the reduced matrix needs beside 1/θ.
    pub fn free_correction(&self, reduced: &[f64], is_free: &impl Fn(usize) -> bool) -> Vec<f64> {
        let size = self.size();
        if size == 0 {
            return Vec::new();
        }
        let (mut gram, mut right) = (vec![0.0; size * size], vec![0.0; size]);
        let mut row = vec![0.0; size];
        for i in (0..reduced.len()).filter(|&i| is_free(i)) {
            self.row(i, &mut row);
            for a in 0..size {
                right[a] += row[a] * reduced[i];
                for b in 0..=a {
                    gram[a * size + b] += row[a] * row[b];
                }
            }
        }
        for a in 0..size {
            for b in 0..a {
                gram[b * size + a] = gram[a * size + b];
            }
        }
        let mut matrix = vec![0.0; size * size];
        for a in 0..size {
            for b in 0..size {
                let column = (0..size).map(|c| self.m[a * size + c] * gram[c * size + b]);
                matrix[a * size + b] = -column.sum::<f64>() / self.theta;
            }
            matrix[a * size + a] += 1.0;
        }
        let mut v = self.times_m(&right);
        if !eliminate(&mut matrix, &mut v, size) {
            v.fill(0.0);
        }
        v
    }
}

/// Solves A X = B in place of B (n rows) by Gaussian elimination with row pivots; false where A is singular.
fn eliminate(a: &mut [f64], b: &mut [f64], n: usize) -> bool {
    let width = b.len() / n.max(1);
    for column in 0..n {
        let size = |row: usize| a[row * n + column].abs();
        let pivot = (column + 1..n).fold(column, |best, row| match size(row) > size(best) {
            true => row,
            false => best,
        });
        if !(size(pivot) > 0.0 && size(pivot).is_finite()) {
            return false;
        }
        for c in 0..n {
            a.swap(pivot * n + c, column * n + c);
        }
        for c in 0..width {
            b.swap(pivot * width + c, column * width + c);
        }
        let inverse = a[column * n + column].recip();
        for row in (0..n).filter(|&row| row != column) {
            let factor = a[row * n + column] * inverse;
            if factor == 0.0 {
                continue;
            }
            for c in column..n {
                a[row * n + c] -= factor * a[column * n + c];
            }
            for c in 0..width {
                b[row * width + c] -= factor * b[column * width + c];
            }
        }
    }
    for row in 0..n {
        let inverse = a[row * n + row].recip();
        b[row * width..(row + 1) * width]
            .iter_mut()
            .for_each(|x| *x *= inverse);
    }
    true
}
