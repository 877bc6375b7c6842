//! Ã y = b̃ with fixed unknowns: the iterate, its residual and its energy, kept up to date by every change.

use crate::mixed_integer::problem::multiply;
use crate::mixed_integer::reduced::Reduced;
use nalgebra_sparse::CscMatrix;

/// The system and an iterate. Rows and columns of fixed unknowns stay where they are, and are passed over.
#[derive(Debug, Clone)]
pub(super) struct System {
    /// The whole matrix by rows, without the diagonal.
    begin: Vec<usize>,
    neighbours: Vec<(u32, f64)>,
    pub diagonal: Vec<f64>,
    pub y: Vec<f64>,
    /// b̃ − Ã y, of fixed unknowns too.
    pub residual: Vec<f64>,
    pub fixed: Vec<bool>,
    pub energy: f64,
}

impl System {
    pub fn new(lower: &CscMatrix<f64>) -> Self {
        let m = lower.ncols();
        let mut begin = vec![0usize; m + 1];
        let mut diagonal = vec![0.0; m];
        let off_diagonal = || {
            lower
                .triplet_iter()
                .filter(|&(i, j, &a)| i != j && a != 0.0)
        };
        for (i, j, _) in off_diagonal() {
            begin[i + 1] += 1;
            begin[j + 1] += 1;
        }
        for i in 0..m {
            begin[i + 1] += begin[i];
        }
        let mut next = begin.clone();
        let mut neighbours = vec![(0, 0.0); begin[m]];
        for (i, j, &a) in off_diagonal() {
            for (from, to) in [(i, j), (j, i)] {
                neighbours[next[from]] = (to as u32, a);
                next[from] += 1;
            }
        }
        for (i, j, &a) in lower.triplet_iter() {
            if i == j {
                diagonal[i] = a;
            }
        }
        Self {
            begin,
            neighbours,
            diagonal,
            y: vec![0.0; m],
            residual: vec![0.0; m],
            fixed: vec![false; m],
            energy: 0.0,
        }
    }

    /// Begins at y with nothing fixed.
    pub fn start(&mut self, reduced: &Reduced, y: &[f64]) {
        self.y.copy_from_slice(y);
        self.fixed.fill(false);
        self.energy = reduced.energy(y);
        self.refresh(reduced);
    }

    /// The residual anew, without what rounding has done to it.
    pub fn refresh(&mut self, reduced: &Reduced) {
        multiply(reduced.matrix(), &self.y, &mut self.residual);
        for (r, b) in self.residual.iter_mut().zip(reduced.linear()) {
            *r = b - *r;
        }
    }

    pub fn neighbours(&self, i: usize) -> &[(u32, f64)] {
        &self.neighbours[self.begin[i]..self.begin[i + 1]]
    }

    /// Changes one unknown.
    pub fn change(&mut self, i: usize, by: f64) {
        self.energy += by * (0.5 * self.diagonal[i] * by - self.residual[i]);
        self.y[i] += by;
        self.residual[i] -= self.diagonal[i] * by;
        for &(j, a) in &self.neighbours[self.begin[i]..self.begin[i + 1]] {
            self.residual[j as usize] -= a * by;
        }
    }

    /// Fixes an unknown at a value.
    pub fn fix(&mut self, i: usize, value: f64) {
        self.change(i, value - self.y[i]);
        self.y[i] = value;
        self.fixed[i] = true;
    }

    /// Changes all by `delta`, after which the residual is to be `residual`.
    pub fn change_all(&mut self, delta: &[f64], residual: &[f64]) {
        for (i, d) in delta.iter().enumerate() {
            // the energy is quadratic: its change is that of the mean slope
            self.energy -= 0.5 * d * (self.residual[i] + residual[i]);
            self.y[i] += d;
        }
        self.residual.copy_from_slice(residual);
    }

    /// Is the residual of a free unknown above the tolerance, relative to the diagonal?
    pub fn is_open(&self, i: usize, tolerance: f64) -> bool {
        !self.fixed[i] && self.residual[i].abs() > tolerance * self.diagonal[i]
    }

    /// Are all free unknowns within the tolerance?
    pub fn is_settled(&self, tolerance: f64) -> bool {
        (0..self.y.len()).all(|i| !self.is_open(i, tolerance))
    }

    /// product = Ã x on the whole.
    pub fn multiply(&self, x: &[f64], product: &mut [f64]) {
        for (i, product) in product.iter_mut().enumerate() {
            let row = self.neighbours(i).iter();
            *product = self.diagonal[i] * x[i] + row.map(|&(j, a)| a * x[j as usize]).sum::<f64>();
        }
    }
}
