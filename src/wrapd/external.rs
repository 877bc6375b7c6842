//! Terms beside the elements: bending, weight, springs.
//!
//! Quadratic in the positions, they join the system matrix (5a) as they are, so that the initial
//! inverse Hessian of the global step knows them exactly.

use crate::optim::{BuildError, Spring};
use crate::parallel;
use nalgebra_sparse::{CooMatrix, CsrMatrix};

/// ½ tr(XᵀBX) − tr(LᵀX) + Σ k/2 ‖x_v − t‖², added to the raw energy Σ A ψ. X is n×d, in the first two terms
/// relative to `origin`.
#[derive(Debug, Clone, Default)]
pub struct External {
    /// B, symmetric and positive semidefinite, as a sum of entries (vertex, vertex, value): a pair of
    /// different vertices stands for both entries (a, b) and (b, a).
    pub stiffness: Vec<(u32, u32, f64)>,
    /// L, n×d interleaved: a constant force on each vertex. Empty: none.
    pub load: Vec<f64>,
    /// Where the load's energy is zero; near the body, so that B, if it does not care for translations,
    /// meets small numbers. The first `dimension` coordinates count.
    pub origin: [f64; 3],
    /// The springs at the start; they can be replaced while the solver runs.
    pub springs: Vec<Spring>,
}

impl External {
    /// Checks that it fits a problem of n vertices.
    pub(super) fn validate(
        &self,
        n: usize,
        dimension: usize,
        pins: &[u32],
    ) -> Result<(), BuildError> {
        let wrong = |option, what| Err(BuildError::InvalidOption { option, what });
        if !self.load.is_empty() && self.load.len() != n * dimension {
            return Err(BuildError::WrongLength {
                argument: "external.load",
                expected: n * dimension,
                found: self.load.len(),
            });
        }
        if let Some(bad) = self.load.iter().position(|x| !x.is_finite()) {
            let what = format!("vertex {} has a force that is not finite", bad / dimension);
            return wrong("external.load", what);
        }
        if !self.origin.iter().all(|x| x.is_finite()) {
            return wrong("external.origin", "must be finite".into());
        }
        let outside = |&v: &u32| v as usize >= n;
        for &(a, b, value) in &self.stiffness {
            if outside(&a) || outside(&b) || !value.is_finite() {
                let what = format!("entry ({a}, {b}, {value}) of {n} vertices");
                return wrong("external.stiffness", what);
            }
        }
        let mut pinned = vec![false; n];
        for &pin in pins.iter().filter(|&&pin| (pin as usize) < n) {
            pinned[pin as usize] = true;
        }
        for spring in &self.springs {
            let v = spring.vertex;
            let finite = spring.target[..dimension].iter().all(|x| x.is_finite());
            let stiff = spring.stiffness > 0.0 && spring.stiffness.is_finite();
            if outside(&v) || pinned[v as usize] || !finite || !stiff {
                let what = format!("vertex {v}: free, a finite target and k > 0 are needed");
                return wrong("external.springs", what);
            }
        }
        Ok(())
    }
}

/// Slots whose gradient is one piece of work.
const SLOTS: usize = 1024;

/// The same by slot, with its value and gradient at the newest positions.
pub struct Terms {
    dimension: usize,
    /// B with all slots, pinned ones too.
    matrix: Option<CsrMatrix<f64>>,
    load: Vec<f64>,
    origin: [f64; 3],
    springs: Vec<Spring>,
    /// Sum of the springs' stiffnesses on each free slot.
    pub spring_stiffness: Vec<f64>,
    /// BX − L and the springs' pull, by slot.
    pub gradient: Vec<f64>,
    /// ½ tr(XᵀBX) − tr(LᵀX) + the springs' energy.
    pub energy: f64,
    /// The rounding error of the energy, about: that of tr(XᵀBX), from the positions at the start.
    pub rounding: f64,
    sums: Vec<f64>,
}

impl Terms {
    /// Of a problem with this start, whose vertices have these slots, `free` of them free.
    pub fn new(external: &External, start: &[f64], slot: &[u32], free: usize) -> Self {
        let n = slot.len();
        let dimension = start.len() / n;
        let size = |v: u32| {
            let position = &start[v as usize * dimension..][..dimension];
            let relative = position.iter().zip(&external.origin).map(|(x, o)| x - o);
            relative.map(|x| x * x).sum::<f64>().sqrt()
        };
        let entries = external.stiffness.iter();
        let products = entries.map(|&(a, b, value)| value.abs() * size(a) * size(b));
        let rounding = f64::EPSILON * products.sum::<f64>();
        let matrix = (!external.stiffness.is_empty()).then(|| {
            let mut entries = CooMatrix::new(n, n);
            for &(a, b, value) in &external.stiffness {
                let (a, b) = (slot[a as usize] as usize, slot[b as usize] as usize);
                entries.push(a, b, value);
                if a != b {
                    entries.push(b, a, value);
                }
            }
            CsrMatrix::from(&entries)
        });
        let mut load = vec![0.0; n * dimension];
        for (v, force) in external.load.chunks_exact(dimension).enumerate() {
            let s = slot[v] as usize * dimension;
            load[s..s + dimension].copy_from_slice(force);
        }
        let mut this = Self {
            dimension,
            matrix,
            load,
            origin: external.origin,
            springs: Vec::new(),
            spring_stiffness: vec![0.0; free],
            gradient: vec![0.0; n * dimension],
            energy: 0.0,
            rounding,
            sums: vec![0.0; n.div_ceil(SLOTS)],
        };
        this.set_springs(&external.springs, slot);
        this
    }

    /// Replaces the springs. Did the stiffness of any slot change?
    pub fn set_springs(&mut self, springs: &[Spring], slot: &[u32]) -> bool {
        let before = core::mem::take(&mut self.spring_stiffness);
        self.spring_stiffness = vec![0.0; before.len()];
        self.springs.clear();
        for spring in springs {
            let vertex = slot[spring.vertex as usize];
            assert!(
                (vertex as usize) < before.len(),
                "springs hold free vertices"
            );
            self.spring_stiffness[vertex as usize] += spring.stiffness;
            self.springs.push(Spring { vertex, ..*spring });
        }
        before != self.spring_stiffness
    }

    /// Evaluates at these positions, by slot.
    pub fn evaluate(&mut self, x: &[f64]) {
        let d = self.dimension;
        let (matrix, load, origin) = (&self.matrix, &self.load, &self.origin);
        parallel::for_each_block(
            &mut self.sums,
            &mut self.gradient,
            SLOTS * d,
            |chunk, sum, gradient| {
                *sum = 0.0;
                for (local, g) in gradient.chunks_exact_mut(d).enumerate() {
                    let row = chunk * SLOTS + local;
                    g.fill(0.0);
                    if let Some(matrix) = matrix {
                        let row = matrix.row(row);
                        for (&column, value) in row.col_indices().iter().zip(row.values()) {
                            let x = x[column * d..].iter().zip(origin);
                            for (g, (x, o)) in g.iter_mut().zip(x) {
                                *g += value * (x - o);
                            }
                        }
                    }
                    let at = row * d..(row + 1) * d;
                    let x = x[at.clone()].iter().zip(origin);
                    for ((g, (x, o)), l) in g.iter_mut().zip(x).zip(&load[at]) {
                        *sum += (0.5 * *g - l) * (x - o);
                        *g -= l;
                    }
                }
            },
        );
        self.energy = self.sums.iter().sum();
        for spring in &self.springs {
            let at = spring.vertex as usize * d;
            for i in 0..d {
                let away = x[at + i] - spring.target[i];
                self.energy += 0.5 * spring.stiffness * away * away;
                self.gradient[at + i] += spring.stiffness * away;
            }
        }
    }
}
