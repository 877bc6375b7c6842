//! Two-opt: change one integer, or two, by one as long as that lowers the energy; the best change first.

use super::IntegerForm;

/// One change: indices and by how much.
pub type Move = Vec<(usize, f64)>;

/// The state on k integers; O(k²) a move.
#[derive(Debug, Clone)]
pub struct TwoOpt {
    k: usize,
    schur: Vec<f64>,
    /// S (z − c).
    gradient: Vec<f64>,
    z: Vec<f64>,
    /// Gains below this are rounding errors.
    least: f64,
}

impl TwoOpt {
    /// Begins at z (length k).
    pub fn new(form: &IntegerForm, z: &[f64]) -> Self {
        let schur = form.schur();
        let largest = (0..form.k).map(|i| schur[i * form.k + i]);
        Self {
            k: form.k,
            gradient: form.times(&form.offset(z)),
            z: z.to_vec(),
            least: 1e-11 * largest.fold(form.energy(z), f64::max),
            schur,
        }
    }

    /// The integers.
    pub fn integers(&self) -> &[f64] {
        &self.z
    }

    /// Makes the best change; `None`: there is none.
    pub fn step(&mut self) -> Option<Move> {
        let k = self.k;
        // the better direction of one alone, and its change of the energy
        let alone: Vec<f64> = (0..k)
            .map(|i| 0.5 * self.schur[i * k + i] - self.gradient[i].abs())
            .collect();
        let mut best = (-self.least, None);
        for i in 0..k {
            if alone[i] < best.0 {
                best = (alone[i], Some((i, i, 0.0)));
            }
            let (s, g) = (&self.schur[i * k..i * k + i], &self.gradient);
            let own = 0.5 * self.schur[i * k + i];
            for j in 0..i {
                // both signs: equal ones cost +S_ij, opposite ones −S_ij
                let squares = own + 0.5 * self.schur[j * k + j];
                let equal = squares + s[j] - (g[i] + g[j]).abs();
                let opposite = squares - s[j] - (g[i] - g[j]).abs();
                if equal.min(opposite) < best.0 {
                    best = match equal <= opposite {
                        true => (equal, Some((i, j, 1.0))),
                        false => (opposite, Some((i, j, -1.0))),
                    };
                }
            }
        }
        let (i, j, sign) = best.1?;
        let slope = self.gradient[i] + if i == j { 0.0 } else { sign * self.gradient[j] };
        let first = if slope > 0.0 { -1.0 } else { 1.0 };
        let change = match i == j {
            true => vec![(i, first)],
            false => vec![(i, first), (j, sign * first)],
        };
        for &(i, by) in &change {
            self.z[i] += by;
            let row = &self.schur[i * k..(i + 1) * k];
            for (g, s) in self.gradient.iter_mut().zip(row) {
                *g += by * s;
            }
        }
        Some(change)
    }
}
