//! The step of Levenberg and Marquardt's method (13a) on a zone: −Jᵀ(JJᵀ + γU)⁻¹ e.

use crate::optim::vectors::dot;
use crate::parallel;

/// Up to so many violated constraints JJᵀ + U is factored, beyond conjugate gradients are used.
const DENSE: usize = 40;

/// Most iterations of conjugate gradients, and when they end: the residual relative to the right-hand side, in the norm
/// of the preconditioner.
const MOST_CG: usize = 60;
const CG_TOLERANCE: f64 = 1e-2;

/// Fewer rows, or vertices, are not worth a thread: every iteration hands them over twice, and in a browser that takes
/// longer.
const ROWS: usize = 2048;
const VERTICES: usize = 512;

/// A thread's share of so many, none less than `least`.
fn share(count: usize, least: usize) -> usize {
    let threads = parallel::threads().min(count / least).max(1);
    count.div_ceil(threads).max(1)
}

/// A violated constraint of a zone: e < 0 and its gradient on the zone's vertices.
pub(super) struct Row<const D: usize> {
    /// Places of its vertices in the zone; of one that is held any, with no gradient.
    pub vertices: [u32; 4],
    pub gradient: [[f64; D]; 4],
    pub error: f64,
}

impl<const D: usize> Row<D> {
    /// The square of the gradient: an entry of JJᵀ's diagonal.
    pub fn square(&self) -> f64 {
        self.gradient.iter().flatten().map(|g| g * g).sum()
    }
}

/// The step of each of the zone's `vertices`. `shift`: the diagonal γU, which is positive.
pub(super) fn direction<const D: usize>(
    rows: &[Row<D>],
    shift: f64,
    vertices: usize,
) -> Vec<[f64; D]> {
    let columns = Columns::new(rows, vertices);
    let y = match rows.len() <= DENSE {
        true => solve_dense(rows, shift),
        false => solve_iteratively(rows, &columns, shift),
    };
    let mut direction = vec![[0.0; D]; vertices];
    columns.spread(rows, &y, &mut direction);
    direction.iter_mut().flatten().for_each(|d| *d = -*d);
    direction
}

/// J by columns: of each vertex the rows it is in, and as which corner.
struct Columns {
    begin: Vec<u32>,
    entries: Vec<(u32, u32)>,
}

impl Columns {
    fn new<const D: usize>(rows: &[Row<D>], vertices: usize) -> Self {
        let all = || {
            let corners = |(r, row): (u32, &'_ Row<D>)| {
                let moves = row.gradient.map(|g| g != [0.0; D]);
                let corners = (0..4u32).filter(move |&c| moves[c as usize]);
                let vertices = row.vertices;
                corners.map(move |c| (vertices[c as usize] as usize, (r, c)))
            };
            (0..rows.len() as u32).zip(rows).flat_map(corners)
        };
        let mut begin = vec![0u32; vertices + 1];
        all().for_each(|(v, _)| begin[v + 1] += 1);
        for v in 0..vertices {
            begin[v + 1] += begin[v];
        }
        let mut next = begin.clone();
        let mut entries = vec![(0, 0); begin[vertices] as usize];
        for (v, entry) in all() {
            entries[next[v] as usize] = entry;
            next[v] += 1;
        }
        Self { begin, entries }
    }

    /// Jᵀy.
    fn spread<const D: usize>(&self, rows: &[Row<D>], y: &[f64], out: &mut [[f64; D]]) {
        let each = share(out.len(), VERTICES);
        parallel::for_each_chunk(out, each, |chunk, out| {
            for (k, out) in out.iter_mut().enumerate() {
                let v = chunk * each + k;
                let range = self.begin[v] as usize..self.begin[v + 1] as usize;
                *out = [0.0; D];
                for &(row, corner) in &self.entries[range] {
                    let gradient = &rows[row as usize].gradient[corner as usize];
                    for i in 0..D {
                        out[i] += y[row as usize] * gradient[i];
                    }
                }
            }
        });
    }
}

/// A row of J times x.
fn gather<const D: usize>(row: &Row<D>, x: &[[f64; D]]) -> f64 {
    let mut sum = 0.0;
    for corner in 0..4 {
        let x = &x[row.vertices[corner] as usize];
        for i in 0..D {
            sum += x[i] * row.gradient[corner][i];
        }
    }
    sum
}

/// (JJᵀ + shift) y = e by Cholesky's factorisation. The shift keeps the pivots positive.
fn solve_dense<const D: usize>(rows: &[Row<D>], shift: f64) -> Vec<f64> {
    let m = rows.len();
    let mut matrix = vec![0.0; m * m];
    for (i, a) in rows.iter().enumerate() {
        for (j, b) in rows[..=i].iter().enumerate() {
            let mut sum = 0.0;
            for (va, ga) in a.vertices.iter().zip(&a.gradient) {
                for (vb, gb) in b.vertices.iter().zip(&b.gradient) {
                    if va == vb {
                        sum += ga.iter().zip(gb).map(|(a, b)| a * b).sum::<f64>();
                    }
                }
            }
            matrix[i * m + j] = sum;
        }
        matrix[i * m + i] += shift;
    }
    let mut y: Vec<f64> = rows.iter().map(|row| row.error).collect();
    for j in 0..m {
        let (done, rest) = matrix.split_at_mut((j + 1) * m);
        let row = &mut done[j * m..];
        let square: f64 = row[..j].iter().map(|l| l * l).sum();
        let pivot = (row[j] - square).max(0.5 * shift).sqrt();
        row[j] = pivot;
        let row = &done[j * m..];
        for below in rest.chunks_exact_mut(m) {
            let product: f64 = below[..j].iter().zip(row).map(|(a, b)| a * b).sum();
            below[j] = (below[j] - product) / pivot;
        }
    }
    for i in 0..m {
        let sum: f64 = (0..i).map(|j| matrix[i * m + j] * y[j]).sum();
        y[i] = (y[i] - sum) / matrix[i * m + i];
    }
    for i in (0..m).rev() {
        let sum: f64 = (i + 1..m).map(|j| matrix[j * m + i] * y[j]).sum();
        y[i] = (y[i] - sum) / matrix[i * m + i];
    }
    y
}

/// The same by conjugate gradients, of which a step needs no more than a direction: the matrix is applied as
/// J(Jᵀy), never formed. Its diagonal preconditions: gradients grow with the elements.
fn solve_iteratively<const D: usize>(rows: &[Row<D>], columns: &Columns, shift: f64) -> Vec<f64> {
    let m = rows.len();
    let inverse: Vec<f64> = rows
        .iter()
        .map(|row| 1.0 / (row.square() + shift))
        .collect();
    let mut y = vec![0.0; m];
    let mut residual: Vec<f64> = rows.iter().map(|row| row.error).collect();
    let mut scaled: Vec<f64> = residual.iter().zip(&inverse).map(|(r, i)| r * i).collect();
    let mut direction = scaled.clone();
    let mut image = vec![0.0; m];
    let mut moved = vec![[0.0; D]; columns.begin.len() - 1];
    let mut square = dot(&residual, &scaled);
    let goal = CG_TOLERANCE * CG_TOLERANCE * square;
    for _ in 0..MOST_CG {
        if !(square > goal) {
            break;
        }
        columns.spread(rows, &direction, &mut moved);
        let each = share(m, ROWS);
        parallel::for_each_chunk(&mut image, each, |chunk, image| {
            let first = chunk * each;
            let rows = rows[first..].iter().zip(&direction[first..]);
            for (image, (row, d)) in image.iter_mut().zip(rows) {
                *image = gather(row, &moved) + shift * d;
            }
        });
        let step = square / dot(&image, &direction);
        for i in 0..m {
            y[i] += step * direction[i];
            residual[i] -= step * image[i];
            scaled[i] = residual[i] * inverse[i];
        }
        let next = dot(&residual, &scaled);
        let factor = next / square;
        square = next;
        for (d, r) in direction.iter_mut().zip(&scaled) {
            *d = r + factor * *d;
        }
    }
    y
}
