//! Level 2: conjugate gradients on the free unknowns, from where Gauss–Seidel ended, preconditioned by the
//! diagonal.

use super::system::System;

/// Workspace of the method.
#[derive(Debug, Clone, Default)]
pub(super) struct ConjugateGradients {
    direction: Vec<f64>,
    product: Vec<f64>,
    residual: Vec<f64>,
    delta: Vec<f64>,
}

impl ConjugateGradients {
    pub fn new(unknowns: usize) -> Self {
        let zeros = vec![0.0; unknowns];
        Self {
            direction: zeros.clone(),
            product: zeros.clone(),
            residual: zeros.clone(),
            delta: zeros,
        }
    }

    /// Up to `most` iterations: how many it were, and whether every free residual is within the tolerance,
    /// relative to the diagonal.
    pub fn run(&mut self, system: &mut System, most: u32, tolerance: f64) -> (u32, bool) {
        let m = system.y.len();
        self.residual.copy_from_slice(&system.residual);
        self.delta.fill(0.0);
        self.direction.fill(0.0);
        let settled = |residual: &[f64], system: &System| {
            (0..m).all(|i| system.fixed[i] || residual[i].abs() <= tolerance * system.diagonal[i])
        };
        let mut before = 0.0;
        let mut iterations = 0;
        let mut done = settled(&self.residual, system);
        while !done && iterations < most {
            iterations += 1;
            let mut product = 0.0;
            for i in 0..m {
                if !system.fixed[i] {
                    product += self.residual[i] * self.residual[i] / system.diagonal[i];
                }
            }
            let factor = if before > 0.0 { product / before } else { 0.0 };
            before = product;
            for i in 0..m {
                if !system.fixed[i] {
                    let steepest = self.residual[i] / system.diagonal[i];
                    self.direction[i] = steepest + factor * self.direction[i];
                }
            }
            system.multiply(&self.direction, &mut self.product);
            let curvature: f64 = (0..m).map(|i| self.direction[i] * self.product[i]).sum();
            if !(curvature > 0.0) {
                break;
            }
            let length = product / curvature;
            for i in 0..m {
                self.delta[i] += length * self.direction[i];
                self.residual[i] -= length * self.product[i];
            }
            done = settled(&self.residual, system);
        }
        if iterations > 0 {
            system.change_all(&self.delta, &self.residual);
        }
        (iterations, done)
    }
}
