//! Vertices one by one, where a step of all of them is stopped by a few triangles.
//!
//! A map far from its minimum, with single triangles that are worth a thousand others, has such triangles at every
//! step: what the neighbours want inverts one, so that all go a hundredth of the way, and the next stops the next
//! step. Moving each vertex alone to where Newton's method wants it (Gauss & Seidel) mends these; what is left is
//! smooth, which is what a step of all vertices is good at.
//!
//! With N = |F|² and D = det F, the symmetric Dirichlet energy is ψ = N (1 + D⁻²). A vertex that moves by y changes F
//! by y gᵀ, g the gradient of its hat function: N is a quadratic and D a linear function of y.

use crate::wrapd::block::{BLOCK, Block};

/// Most halvings of a vertex's step.
const MOST_HALVINGS: u32 = 30;

/// c of Armijo's rule.
const DECREASE: f64 = 1e-4;

/// The least eigenvalue of a Hessian, relative to the largest.
const FLAT: f64 = 1e-8;

/// A change of the energy below this part of it is not worth a step.
const ROUNDING: f64 = 1e-14;

/// A triangle at one of its vertices.
struct Corner {
    /// The slots of its other vertices.
    others: [u32; 2],
    /// The gradients of the hat functions of this vertex and of the others.
    hats: [[f64; 2]; 3],
    measure: f64,
}

/// Moves the vertices of a planar map one by one, to less symmetric Dirichlet energy.
pub struct Relaxation {
    begin: Vec<u32>,
    corners: Vec<Corner>,
}

/// A triangle at a vertex: its energy as a function of how far that has moved.
#[derive(Clone, Copy)]
pub(super) struct Local {
    /// F by columns,
    pub f: [f64; 4],
    /// and how it changes with the vertex.
    pub hat: [f64; 2],
    /// Rest measure.
    pub measure: f64,
}

impl Local {
    /// |F|² and det F.
    fn at(&self, y: [f64; 2]) -> (f64, f64) {
        let [a, c, b, d] = self.f;
        let [p, q] = self.hat;
        let (a, c, b, d) = (a + y[0] * p, c + y[1] * p, b + y[0] * q, d + y[1] * q);
        (a * a + b * b + c * c + d * d, a * d - b * c)
    }

    pub fn energy(&self, y: [f64; 2]) -> f64 {
        let (n, det) = self.at(y);
        match det > 0.0 {
            true => self.measure * n * (1.0 + 1.0 / (det * det)),
            false => f64::INFINITY,
        }
    }
}

impl Relaxation {
    /// Of the first `elements` elements of these blocks; free vertices come first.
    pub fn new(blocks: &[Block], elements: usize, free: usize) -> Self {
        let mut begin = vec![0u32; free + 1];
        let each = |place: usize| {
            let block = &blocks[place / BLOCK];
            let e = place % BLOCK;
            (block, e, [0, 1, 2].map(|v| block.vertices[v][e]))
        };
        for place in 0..elements {
            for slot in each(place).2 {
                if (slot as usize) < free {
                    begin[slot as usize + 1] += 1;
                }
            }
        }
        for v in 0..free {
            begin[v + 1] += begin[v];
        }
        let mut next = begin.clone();
        let mut order = vec![(0u32, 0u8); begin[free] as usize];
        for place in 0..elements {
            for (corner, slot) in each(place).2.into_iter().enumerate() {
                if (slot as usize) < free {
                    order[next[slot as usize] as usize] = (place as u32, corner as u8);
                    next[slot as usize] += 1;
                }
            }
        }
        let corners = order
            .into_iter()
            .map(|(place, corner)| {
                let (block, e, slots) = each(place as usize);
                let inverse = |c: usize| block.inverse[c][e];
                let (g1, g2) = ([inverse(0), inverse(2)], [inverse(1), inverse(3)]);
                let g0 = [-(g1[0] + g2[0]), -(g1[1] + g2[1])];
                let hats = [g0, g1, g2];
                let at = |k: usize| (corner as usize + k) % 3;
                Corner {
                    others: [slots[at(1)], slots[at(2)]],
                    hats: [hats[at(0)], hats[at(1)], hats[at(2)]],
                    measure: block.measure[0][e],
                }
            })
            .collect();
        Self { begin, corners }
    }

    /// Moves each free vertex of `x` (by slot) twice: those whose triangles are worst first, and then back. That order,
    /// unlike that of the vertices, is one of the map.
    pub fn relax(&self, x: &mut [f64]) {
        let mut local = Vec::new();
        let mut worst: Vec<(f64, usize)> = (0..self.begin.len() - 1)
            .map(|v| {
                self.around(v, x, &mut local);
                let energy = local.iter().map(|l| l.energy([0.0; 2])).sum();
                (energy, v)
            })
            .collect();
        worst.sort_by(|(a, _), (b, _)| b.total_cmp(a));
        for &(_, v) in worst.iter().chain(worst.iter().rev()) {
            self.around(v, x, &mut local);
            if let Some([dx, dy]) = step(&local) {
                x[2 * v] += dx;
                x[2 * v + 1] += dy;
            }
        }
    }

    /// The triangles at a vertex.
    fn around(&self, v: usize, x: &[f64], local: &mut Vec<Local>) {
        let corners = &self.corners[self.begin[v] as usize..self.begin[v + 1] as usize];
        let here = [x[2 * v], x[2 * v + 1]];
        local.clear();
        local.extend(corners.iter().map(|corner| {
            let [i, j] = corner.others.map(|o| 2 * o as usize);
            let [h, g, k] = corner.hats;
            let entry = |row: usize, column: usize| {
                here[row] * h[column] + x[i + row] * g[column] + x[j + row] * k[column]
            };
            Local {
                f: [entry(0, 0), entry(1, 0), entry(0, 1), entry(1, 1)],
                hat: h,
                measure: corner.measure,
            }
        }));
    }
}

/// The energy of the triangles at a vertex, its gradient and its Hessian (xx, xy, yy).
pub(super) fn derivatives(local: &[Local]) -> (f64, [f64; 2], [f64; 3]) {
    let (mut energy, mut gradient, mut hessian) = (0.0, [0.0; 2], [0.0; 3]);
    for l in local {
        let (n, det) = l.at([0.0; 2]);
        let [a, c, b, d] = l.f;
        let [p, q] = l.hat;
        let i2 = 1.0 / (det * det);
        // ψ = N (1 + D⁻²): its derivatives by N, by D, by both, and by D twice
        let (of_n, mixed) = (1.0 + i2, -2.0 * i2 / det);
        let (of_det, of_det_twice) = (mixed * n, 6.0 * n * i2 * i2);
        let dn = [2.0 * (a * p + b * q), 2.0 * (c * p + d * q)];
        let dd = [p * d - q * c, q * a - p * b];
        let bend = |r: usize, s: usize| {
            mixed * (dn[r] * dd[s] + dd[r] * dn[s]) + of_det_twice * dd[r] * dd[s]
        };
        let same = 2.0 * (p * p + q * q) * of_n;
        energy += l.measure * n * of_n;
        for r in 0..2 {
            gradient[r] += l.measure * (of_n * dn[r] + of_det * dd[r]);
        }
        hessian[0] += l.measure * (same + bend(0, 0));
        hessian[1] += l.measure * bend(0, 1);
        hessian[2] += l.measure * (same + bend(1, 1));
    }
    (energy, gradient, hessian)
}

/// A step of Newton's method with the moduli of the Hessian's eigenvalues, cut short until the energy is less by
/// enough; none where that would be rounding error.
fn step(local: &[Local]) -> Option<[f64; 2]> {
    let (energy, [gx, gy], [xx, xy, yy]) = derivatives(local);
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = (half * half + xy * xy).sqrt();
    // their inverses, in the frame of the double angle
    let large = (mean + radius).abs();
    let (large, small) = (
        large.recip(),
        (mean - radius).abs().max(FLAT * large).recip(),
    );
    let (same, apart) = (0.5 * (large + small), 0.5 * (large - small));
    let [cos, sin] = match radius > 0.0 {
        true => [half / radius, xy / radius],
        false => [1.0, 0.0],
    };
    let direction = [
        -((same + apart * cos) * gx + apart * sin * gy),
        -(apart * sin * gx + (same - apart * cos) * gy),
    ];
    let slope = gx * direction[0] + gy * direction[1];
    if !(slope < -ROUNDING * energy) {
        return None;
    }
    let mut t = 1.0;
    for _ in 0..MOST_HALVINGS {
        let y = direction.map(|d| t * d);
        let value: f64 = local.iter().map(|l| l.energy(y)).sum();
        if value <= energy + DECREASE * t * slope {
            return Some(y);
        }
        t *= 0.5;
    }
    None
}
