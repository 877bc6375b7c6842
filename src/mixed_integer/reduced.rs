//! The problem without constraints: minimise ½ yᵀÃ y − b̃ᵀy + constant over what elimination leaves
//! (paper, equation 9), in elimination order.

use super::elimination::{AffineMap, Elimination};
use super::problem::multiply;
use super::{MixedIntegerError as Error, Problem};
use crate::linalg::{Order, SymmetricAssembly};
use nalgebra_sparse::CscMatrix;

/// The reduced problem on m unknowns.
#[derive(Debug, Clone)]
pub struct Reduced {
    map: AffineMap,
    /// Which of the unknowns that are left is eliminated k-th.
    order: Order,
    /// Ã, its lower triangle by columns, in elimination order.
    matrix: CscMatrix<f64>,
    /// b̃, in elimination order.
    linear: Vec<f64>,
    /// The energy of y = 0.
    constant: f64,
    /// Where the integers are in elimination order, by number of their unknown.
    integers: Vec<u32>,
    /// n.
    unknowns: usize,
}

impl Reduced {
    /// T'AT and T'(b − At). With `integers_last` the order ends with the integers, by number of their
    /// unknown.
    ///
    /// # Errors
    /// Those of [`AffineMap::new`].
    pub fn new(
        problem: &Problem,
        elimination: &Elimination,
        integers_last: bool,
    ) -> Result<Self, Error> {
        let map = AffineMap::new(problem, elimination)?;
        let m = map.kept.len();
        let is_integer = |k: u32| {
            problem
                .integers()
                .binary_search(&map.kept[k as usize])
                .is_ok()
        };
        let integers: Vec<u32> = (0..m as u32).filter(|&k| is_integer(k)).collect();
        let (places, values) = contributions(problem, &map);
        let order = match integers_last {
            true => with_integers_last(m, &places, &integers),
            false => Order::minimum_degree(m, places.iter().copied(), 0),
        };
        let mut place = vec![0u32; m];
        for (position, &k) in order.unknowns.iter().enumerate() {
            place[k as usize] = position as u32;
        }
        let placed = places
            .iter()
            .map(|&(i, j)| (place[i as usize], place[j as usize]));
        let mut assembly = SymmetricAssembly::new(m, placed);
        assembly.fill(|t| values[t]);
        let mut this = Self {
            integers: integers.iter().map(|&k| place[k as usize]).collect(),
            order,
            matrix: assembly.matrix().clone(),
            linear: vec![0.0; m],
            constant: 0.0,
            unknowns: problem.unknowns(),
            map,
        };
        this.set_linear(problem);
        Ok(this)
    }

    /// Other b or other constants of the constraint rows: Ã stays.
    ///
    /// # Errors
    /// `Contradictory`, `Infeasible`; nothing has changed then.
    pub fn update(&mut self, problem: &Problem, elimination: &Elimination) -> Result<(), Error> {
        self.map.set_constants(elimination, problem.constants())?;
        self.set_linear(problem);
        Ok(())
    }

    fn set_linear(&mut self, problem: &Problem) {
        let offset = &self.map.offset;
        let mut gradient = vec![0.0; self.unknowns];
        multiply(problem.matrix(), offset, &mut gradient);
        let mut constant = 0.0;
        for ((g, b), t) in gradient.iter_mut().zip(problem.linear()).zip(offset) {
            constant += t * (0.5 * *g - b);
            *g = b - *g;
        }
        self.constant = constant;
        let mut linear = vec![0.0; self.linear.len()];
        self.map.add_transposed(&gradient, &mut linear);
        for (target, &k) in self.linear.iter_mut().zip(&self.order.unknowns) {
            *target = linear[k as usize];
        }
    }

    /// m.
    pub fn dimension(&self) -> usize {
        self.linear.len()
    }
    /// Ã: its lower triangle by columns.
    pub fn matrix(&self) -> &CscMatrix<f64> {
        &self.matrix
    }
    /// b̃.
    pub fn linear(&self) -> &[f64] {
        &self.linear
    }
    /// The order of elimination.
    pub fn order(&self) -> &Order {
        &self.order
    }
    /// Positions of the integers, by number of their unknown.
    pub fn integers(&self) -> &[u32] {
        &self.integers
    }
    /// The unknown of the problem that a position stands for.
    pub fn unknown(&self, position: u32) -> u32 {
        self.map.kept[self.order.unknowns[position as usize] as usize]
    }

    /// ½ yᵀÃ y − b̃ᵀy + constant.
    pub fn energy(&self, y: &[f64]) -> f64 {
        let mut product = vec![0.0; y.len()];
        multiply(&self.matrix, y, &mut product);
        let each = y.iter().zip(&product).zip(&self.linear);
        self.constant + each.map(|((y, ay), b)| y * (0.5 * ay - b)).sum::<f64>()
    }

    /// The unknowns x of the problem (length n) for y in elimination order.
    pub fn expand(&self, y: &[f64], x: &mut [f64]) {
        let mut kept = vec![0.0; y.len()];
        for (&value, &k) in y.iter().zip(&self.order.unknowns) {
            kept[k as usize] = value;
        }
        self.map.apply(&kept, x);
    }
}

/// Entries of T'AT, each of the lower triangle or its mirror image, of which several may be at the same
/// place.
fn contributions(problem: &Problem, map: &AffineMap) -> (Vec<(u32, u32)>, Vec<f64>) {
    let entries = problem.matrix().nnz();
    let (mut places, mut values) = (Vec::with_capacity(entries), Vec::with_capacity(entries));
    for (i, j, &a) in problem.matrix().triplet_iter() {
        if a == 0.0 && i != j {
            continue;
        }
        for (s, &(p, ti)) in map.row(i).iter().enumerate() {
            if i == j {
                // A_ii tᵢtᵢᵀ is symmetric: its lower triangle alone
                for &(q, tj) in &map.row(i)[..=s] {
                    places.push((p, q));
                    values.push(a * ti * tj);
                }
                continue;
            }
            for &(q, tj) in map.row(j) {
                places.push((p, q));
                values.push(if p == q {
                    2.0 * a * ti * tj
                } else {
                    a * ti * tj
                });
            }
        }
    }
    (places, values)
}

/// The reals by minimum degree, then the integers: the last block of the factor is then that of their
/// Schur complement.
fn with_integers_last(m: usize, places: &[(u32, u32)], integers: &[u32]) -> Order {
    let mut number = vec![u32::MAX; m];
    let reals = (m - integers.len()) as u32;
    for (&k, new) in integers.iter().zip(reals..) {
        number[k as usize] = new;
    }
    let mut unknowns: Vec<u32> = Vec::with_capacity(m);
    for k in 0..m as u32 {
        if number[k as usize] == u32::MAX {
            number[k as usize] = unknowns.len() as u32;
            unknowns.push(k);
        }
    }
    unknowns.extend_from_slice(integers);
    let edges = places
        .iter()
        .map(|&(i, j)| (number[i as usize], number[j as usize]));
    let mut order = Order::minimum_degree(m, edges, integers.len());
    for k in &mut order.unknowns {
        *k = unknowns[*k as usize];
    }
    order
}
