//! The least energy for given integers: E(z) = E_relaxed + ½ (z − c)ᵀ S (z − c), S the Schur complement of
//! the reals, c the relaxed integers.

/// S by its Cholesky factor, and c.
#[derive(Debug, Clone)]
pub struct IntegerForm {
    /// Number of integers, k.
    pub k: usize,
    /// L with S = L Lᵀ, k×k row by row, zeros above the diagonal.
    pub factor: Vec<f64>,
    /// c, length k.
    pub center: Vec<f64>,
}

impl IntegerForm {
    /// S, k×k.
    pub fn schur(&self) -> Vec<f64> {
        let (k, l) = (self.k, &self.factor);
        let mut s = vec![0.0; k * k];
        for i in 0..k {
            for j in 0..=i {
                let (a, b) = (&l[i * k..i * k + j + 1], &l[j * k..j * k + j + 1]);
                let value = a.iter().zip(b).map(|(a, b)| a * b).sum();
                s[i * k + j] = value;
                s[j * k + i] = value;
            }
        }
        s
    }

    /// S⁻¹, k×k.
    pub fn inverse(&self) -> Vec<f64> {
        let (k, l) = (self.k, &self.factor);
        // rows of L⁻ᵀ: row j holds column j of L⁻¹
        let mut columns = vec![0.0; k * k];
        for j in 0..k {
            let column = &mut columns[j * k..(j + 1) * k];
            column[j] = 1.0 / l[j * k + j];
            for i in j + 1..k {
                let row = &l[i * k + j..i * k + i];
                let sum: f64 = row.iter().zip(&column[j..i]).map(|(a, b)| a * b).sum();
                column[i] = -sum / l[i * k + i];
            }
        }
        let mut inverse = vec![0.0; k * k];
        for i in 0..k {
            for j in 0..=i {
                let (a, b) = (
                    &columns[i * k + i..(i + 1) * k],
                    &columns[j * k + i..(j + 1) * k],
                );
                let value = a.iter().zip(b).map(|(a, b)| a * b).sum();
                inverse[i * k + j] = value;
                inverse[j * k + i] = value;
            }
        }
        inverse
    }

    /// w = Lᵀ d, of which ½‖w‖² is the energy above the relaxed one.
    pub fn root(&self, d: &[f64]) -> Vec<f64> {
        let k = self.k;
        let mut w = vec![0.0; k];
        for (i, d) in d.iter().enumerate() {
            let row = &self.factor[i * k..i * k + i + 1];
            for (w, l) in w.iter_mut().zip(row) {
                *w += l * d;
            }
        }
        w
    }

    /// S d.
    pub fn times(&self, d: &[f64]) -> Vec<f64> {
        let (k, w) = (self.k, self.root(d));
        let of_row = |i: usize| {
            let row = &self.factor[i * k..i * k + i + 1];
            row.iter().zip(&w).map(|(l, w)| l * w).sum()
        };
        (0..k).map(of_row).collect()
    }

    /// z − c.
    pub fn offset(&self, z: &[f64]) -> Vec<f64> {
        z.iter().zip(&self.center).map(|(z, c)| z - c).collect()
    }

    /// ½ (z − c)ᵀ S (z − c).
    pub fn energy(&self, z: &[f64]) -> f64 {
        let w = self.root(&self.offset(z));
        0.5 * w.iter().map(|w| w * w).sum::<f64>()
    }
}
