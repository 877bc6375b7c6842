//! Reduction of a lattice basis: LLL (Lenstra, Lenstra & Lovász 1982) with deep insertions (Schnorr &
//! Euchner 1994), on the triangular factor of the basis, which Givens rotations keep triangular.
//!
//! The basis changes by integer operations alone, which are exact; rounding errors can only make it less
//! reduced than it seems.

use crate::mixed_integer::search::{IntegerForm, nearest};

/// How much shorter a vector has to be to be inserted further in front.
const DELTA: f64 = 0.999;
/// A vector is tried at the first places, and at this many before its own.
const WINDOW: usize = 24;
/// Integers below this are exact, sums of two included.
const EXACT: f64 = (1u64 << 52) as f64;

/// min ‖R (z − c)‖ over integers z = shift + U w becomes min ‖R' w − y‖ over integers w.
#[derive(Debug, Clone)]
pub struct Reduction {
    k: usize,
    /// R', upper triangular, column by column.
    basis: Vec<f64>,
    /// y.
    target: Vec<f64>,
    /// U, column by column.
    transform: Vec<f64>,
    /// The rotation Q with R' = Q R U, column by column.
    rotation: Vec<f64>,
    /// The integers nearest to c.
    shift: Vec<f64>,
    /// The first column that is not known to be in its place.
    next: usize,
    exchanges: u64,
}

impl Reduction {
    /// The basis as it is: U = 1.
    pub fn new(form: &IntegerForm) -> Self {
        let k = form.k;
        let mut transform = vec![0.0; k * k];
        for i in 0..k {
            transform[i * k + i] = 1.0;
        }
        let mut this = Self {
            k,
            // R = Lᵀ: the rows of L are the columns of R
            basis: form.factor.clone(),
            target: Vec::new(),
            rotation: transform.clone(),
            transform,
            shift: Vec::new(),
            next: 1,
            exchanges: 0,
        };
        this.set_center(form);
        this
    }

    /// The same basis for another c.
    pub fn set_center(&mut self, form: &IntegerForm) {
        self.shift = form.center.iter().map(|&c| nearest(c)).collect();
        let rest: Vec<f64> = form.offset(&self.shift).iter().map(|d| -d).collect();
        self.target = vec![0.0; self.k];
        let columns = self.rotation.chunks_exact(self.k.max(1));
        for (r, column) in form.root(&rest).iter().zip(columns) {
            for (t, q) in self.target.iter_mut().zip(column) {
                *t += q * r;
            }
        }
    }

    /// Number of integers.
    pub fn dimension(&self) -> usize {
        self.k
    }
    /// R', upper triangular, column by column.
    pub fn basis(&self) -> &[f64] {
        &self.basis
    }
    /// y.
    pub fn target(&self) -> &[f64] {
        &self.target
    }
    /// U, column by column; its entries are integers.
    pub fn transform(&self) -> &[f64] {
        &self.transform
    }
    /// Exchanges of neighbouring vectors so far.
    pub fn exchanges(&self) -> u64 {
        self.exchanges
    }

    /// z = shift + U w.
    pub fn integers(&self, w: &[f64]) -> Vec<f64> {
        let mut z = self.shift.clone();
        for (w, column) in w.iter().zip(self.transform.chunks_exact(self.k.max(1))) {
            for (z, u) in z.iter_mut().zip(column) {
                *z += u * w;
            }
        }
        z
    }

    /// Works until about `exchanges` more have been made; is the basis reduced?
    pub fn run(&mut self, exchanges: u64) -> bool {
        let end = self.exchanges + exchanges;
        while self.next < self.k {
            if self.exchanges >= end {
                return false;
            }
            self.reduce_size(self.next);
            match self.insertion(self.next) {
                Some(place) => {
                    for i in (place..self.next).rev() {
                        self.exchange(i);
                    }
                    self.next = place.max(1);
                }
                None => self.next += 1,
            }
        }
        true
    }

    /// Subtracts earlier vectors from vector `j` until its coefficients are at most ½ of theirs.
    fn reduce_size(&mut self, j: usize) {
        let k = self.k;
        for _ in 0..8 {
            let mut again = false;
            for i in (0..j).rev() {
                let quotient = (self.basis[j * k + i] / self.basis[i * k + i]).round();
                if quotient == 0.0 || !self.subtract(j, i, quotient) {
                    continue;
                }
                // after a large multiple little of the numbers is exact
                again |= quotient.abs() > 1e6;
            }
            if !again {
                break;
            }
        }
    }

    /// Vector j −= quotient · vector i, unless the integers would grow too large.
    fn subtract(&mut self, j: usize, i: usize, quotient: f64) -> bool {
        let k = self.k;
        let (before, from) = self.transform.split_at_mut(j * k);
        let (own, other) = (&mut from[..k], &before[i * k..(i + 1) * k]);
        let fits = |(a, b): (&f64, &f64)| (quotient * b).abs() + a.abs() < EXACT;
        if !own.iter().zip(other).all(fits) {
            return false;
        }
        own.iter_mut()
            .zip(other)
            .for_each(|(a, b)| *a -= quotient * b);
        let (before, from) = self.basis.split_at_mut(j * k);
        let other = &before[i * k..i * k + i + 1];
        from.iter_mut()
            .zip(other)
            .for_each(|(a, b)| *a -= quotient * b);
        true
    }

    /// The first place where vector `j`, without its part along the vectors before that place, is clearly
    /// shorter than what is there.
    fn insertion(&self, j: usize) -> Option<usize> {
        let k = self.k;
        let column = &self.basis[j * k..j * k + j + 1];
        let mut rest: f64 = column.iter().map(|r| r * r).sum();
        for (i, r) in column[..j].iter().enumerate() {
            let diagonal = self.basis[i * k + i];
            if (i < 5 || i + WINDOW >= j) && rest < DELTA * diagonal * diagonal {
                return Some(i);
            }
            rest -= r * r;
        }
        None
    }

    /// Exchanges vectors i and i + 1, and rotates rows i and i + 1 so that R' is triangular again.
    fn exchange(&mut self, i: usize) {
        let k = self.k;
        self.exchanges += 1;
        for matrix in [&mut self.basis, &mut self.transform] {
            let (left, right) = matrix.split_at_mut((i + 1) * k);
            left[i * k..].swap_with_slice(&mut right[..k]);
        }
        let (a, b) = (self.basis[i * k + i], self.basis[i * k + i + 1]);
        let length = a.hypot(b);
        let (cosine, sine) = (a / length, b / length);
        let rotate = |x: &mut [f64]| {
            let (p, q) = (x[i], x[i + 1]);
            x[i] = cosine * p + sine * q;
            x[i + 1] = cosine * q - sine * p;
        };
        for column in self.basis[i * k..].chunks_exact_mut(k) {
            rotate(column);
        }
        self.rotation.chunks_exact_mut(k).for_each(rotate);
        rotate(&mut self.target);
        self.basis[i * k + i + 1] = 0.0;
        // diagonals stay positive
        if self.basis[(i + 1) * k + i + 1] < 0.0 {
            for column in self.basis[(i + 1) * k..].chunks_exact_mut(k) {
                column[i + 1] = -column[i + 1];
            }
            for column in self.rotation.chunks_exact_mut(k) {
                column[i + 1] = -column[i + 1];
            }
            self.target[i + 1] = -self.target[i + 1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// S = [[5, 4.9], [4.9, 5]] · 20: a long thin cell.
    fn skew() -> IntegerForm {
        let l = [10.0, 0.0, 9.8, 1.99];
        IntegerForm {
            k: 2,
            factor: l.to_vec(),
            center: vec![0.3, 0.4],
        }
    }

    #[test]
    fn reduced_basis_spans_the_same_lattice_and_keeps_distances() {
        let form = skew();
        let mut reduction = Reduction::new(&form);
        assert!(reduction.run(1000));
        let u = reduction.transform();
        assert_eq!((u[0] * u[3] - u[1] * u[2]).abs(), 1.0);
        for w in [[0.0, 0.0], [1.0, -2.0], [3.0, 1.0]] {
            let (r, y) = (reduction.basis(), reduction.target());
            let first = r[0] * w[0] + r[2] * w[1] - y[0];
            let second = r[3] * w[1] - y[1];
            let energy = 0.5 * (first * first + second * second);
            assert!((energy - form.energy(&reduction.integers(&w))).abs() < 1e-9);
        }
        let r = reduction.basis();
        assert!(r[2].abs() <= 0.5 * r[0].abs() + 1e-12, "{r:?}");
    }
}
