//! The sums over the elements: energy, barrier, their gradient and their second derivatives.
//!
//! Elements are taken in chunks of a fixed size, which are the unit of parallel work and of ordered summation.

use super::barrier::Barrier;
use super::curvature::{frozen, projected};
use super::density::{density, stress};
use super::inversion::{add_barrier, determinant};
use super::{LimEnergy, LimHessian};
use crate::energy::total::relative_distortion;
use crate::geometry::RestShape;
use crate::newton::bound::{area_coefficients, first_root, volume_coefficients};
use crate::newton::corners::corner_blocks;
use crate::newton::curvature::stride;
use crate::optim::Field;
use crate::parallel;
use crate::space::{Components, Space};
use core::marker::PhantomData;

/// Elements in a chunk.
const CHUNK: usize = 256;

/// What the elements add up to.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sums {
    /// Σ w ψ.
    pub energy: f64,
    /// β Σ φ, infinite where an element is at or behind the wall.
    pub barrier: f64,
    /// Least and largest singular values; only of [`Elements::gradient`].
    pub smallest: f64,
    /// See `smallest`.
    pub largest: f64,
    /// Elements with det F ≤ 0.
    pub inverted: usize,
}

impl Sums {
    const NONE: Self = Self {
        energy: 0.0,
        barrier: 0.0,
        smallest: f64::INFINITY,
        largest: 0.0,
        inverted: 0,
    };

    fn add(&mut self, other: &Self) {
        self.energy += other.energy;
        self.barrier += other.barrier;
        self.smallest = self.smallest.min(other.smallest);
        self.largest = self.largest.max(other.largest);
        self.inverted += other.inverted;
    }
}

/// What is the same for all elements.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    /// ψ.
    pub energy: LimEnergy,
    /// Its second derivatives.
    pub hessian: LimHessian,
    /// β, 0 without barrier.
    pub beta: f64,
}

/// The loops of one dimension. Positions are by slot, interleaved.
pub trait Elements: Send + Sync {
    /// Energy and barrier.
    fn value(&mut self, law: Law, x: &[f64]) -> Sums;
    /// The same, with singular values and the forces at the corners, (k+1) × d an element.
    fn gradient(&mut self, law: Law, x: &[f64], forces: &mut [f64]) -> Sums;
    /// The blocks of [`corner_blocks`], element by element, with the part `kept` of what is negative in them
    /// (all of it with frozen rotations).
    fn hessian(&self, law: Law, x: &[f64], kept: f64, blocks: &mut [f64]);
    /// The part of a step of `most` directions before the first element meets its wall, at most `most`.
    fn bound(&mut self, x: &[f64], direction: &[f64], most: f64) -> f64;
    /// The corners of each element, by slot.
    fn corners(&self) -> &[u32];
    /// A field, one value an element; the stress is that of w ψ per unit of w.
    fn field(&self, law: Law, x: &[f64], field: Field) -> Vec<f32>;
}

/// The elements in a space of d = k.
pub struct Mesh<S> {
    /// Slots, k+1 an element.
    corners: Vec<u32>,
    /// Inverse of the rest edges, k×k by columns.
    inverse: Vec<f64>,
    /// Weights of ψ.
    weight: Vec<f64>,
    barrier: Vec<Barrier>,
    sums: Vec<Sums>,
    bounds: Vec<f64>,
    space: PhantomData<S>,
}

impl<S: Space> Mesh<S> {
    /// Of rest shapes whose vertices have these slots, with a weight and a barrier for each.
    pub fn new(rest: &RestShape, slot: &[u32], weight: Vec<f64>, barrier: Vec<Barrier>) -> Self {
        const { assert!(S::DIM == S::STRETCHES) };
        let chunks = rest.len().div_ceil(CHUNK);
        Self {
            corners: rest.vertices.iter().map(|&v| slot[v as usize]).collect(),
            inverse: rest.inverse.clone(),
            weight,
            barrier,
            sums: vec![Sums::NONE; chunks],
            bounds: vec![0.0; chunks],
            space: PhantomData,
        }
    }

    fn len(&self) -> usize {
        self.weight.len()
    }

    /// Replaces the barriers.
    pub fn set_barriers(&mut self, barrier: Vec<Barrier>) {
        self.barrier = barrier;
    }

    /// det F of each element.
    pub fn determinants(&self, x: &[f64]) -> Vec<f64> {
        let determinant = |e| determinant::<S>(self.jacobian(e, x)).0;
        (0..self.len()).map(determinant).collect()
    }

    /// The elements of a chunk.
    fn chunk(&self, chunk: usize) -> core::ops::Range<usize> {
        chunk * CHUNK..self.len().min((chunk + 1) * CHUNK)
    }

    /// The edges from the first corner of an element, as columns.
    #[inline(always)]
    fn edges(&self, e: usize, x: &[f64]) -> S::Gradient<f64> {
        let (d, k) = (S::DIM, S::STRETCHES);
        let corners = &self.corners[e * (k + 1)..(e + 1) * (k + 1)];
        let first = &x[corners[0] as usize * d..][..d];
        S::Gradient::from_fn(
            #[inline(always)]
            |c| x[corners[c / d + 1] as usize * d + c % d] - first[c % d],
        )
    }

    /// F = edges · inverse.
    #[inline(always)]
    fn jacobian(&self, e: usize, x: &[f64]) -> S::Gradient<f64> {
        let k = S::STRETCHES;
        let edges = self.edges(e, x);
        let inverse = &self.inverse[e * k * k..(e + 1) * k * k];
        S::Gradient::from_fn(
            #[inline(always)]
            |c| {
                let (column, row) = (c / k, c % k);
                let mut sum = edges.at(row) * inverse[column * k];
                for r in 1..k {
                    sum += edges.at(r * k + row) * inverse[column * k + r];
                }
                sum
            },
        )
    }

    /// Gradients of the hat functions of an element's corners.
    #[inline(always)]
    fn hats(&self, e: usize) -> [[f64; 3]; 4] {
        let k = S::STRETCHES;
        let inverse = &self.inverse[e * k * k..(e + 1) * k * k];
        let mut hats = [[0.0; 3]; 4];
        for v in 1..=k {
            for column in 0..k {
                hats[v][column] = inverse[column * k + v - 1];
                hats[0][column] -= hats[v][column];
            }
        }
        hats
    }

    fn total(&self) -> Sums {
        let mut total = Sums::NONE;
        self.sums.iter().for_each(|sums| total.add(sums));
        total
    }

    /// Determinants along the edges `from` to `to` as Bernstein coefficients over J, less the wall; where the
    /// first of them vanishes.
    fn first_wall(&self, e: usize, from: S::Gradient<f64>, to: S::Gradient<f64>) -> f64 {
        let k = S::STRETCHES;
        let inverse = &self.inverse[e * k * k..(e + 1) * k * k];
        let rest = S::Gradient::from_fn(|c| inverse[c]);
        let (scale, _) = determinant::<S>(rest);
        let wall = self.barrier[e].wall;
        if k == 2 {
            let columns = |g: S::Gradient<f64>| [[g.at(0), g.at(1)], [g.at(2), g.at(3)]];
            let coefficients = area_coefficients(columns(from), columns(to));
            let coefficients = coefficients.map(|c| scale * c - wall);
            return match coefficients.iter().all(|&c| c > 0.0) {
                true => f64::INFINITY,
                false => first_root(coefficients),
            };
        }
        let columns = |g: S::Gradient<f64>| {
            [
                [g.at(0), g.at(1), g.at(2)],
                [g.at(3), g.at(4), g.at(5)],
                [g.at(6), g.at(7), g.at(8)],
            ]
        };
        let coefficients = volume_coefficients(columns(from), columns(to));
        let coefficients = coefficients.map(|c| scale * c - wall);
        match coefficients.iter().all(|&c| c > 0.0) {
            true => f64::INFINITY,
            false => first_root(coefficients),
        }
    }
}

impl<S: Space> Elements for Mesh<S> {
    fn value(&mut self, law: Law, x: &[f64]) -> Sums {
        let mut out = core::mem::take(&mut self.sums);
        let mesh = &*self;
        parallel::for_each_chunk(&mut out, 1, |chunk, out| {
            let mut sums = Sums::NONE;
            for e in mesh.chunk(chunk) {
                let f = mesh.jacobian(e, x);
                let (j, _) = determinant::<S>(f);
                sums.inverted += usize::from(!(j > 0.0));
                if law.beta > 0.0 {
                    sums.barrier += law.beta * mesh.barrier[e].at(j).value;
                }
                sums.energy += mesh.weight[e] * density::<S>(law.energy, f);
            }
            out[0] = sums;
        });
        self.sums = out;
        self.total()
    }

    fn gradient(&mut self, law: Law, x: &[f64], forces: &mut [f64]) -> Sums {
        let k = S::STRETCHES;
        let each = (k + 1) * k;
        let mut out = core::mem::take(&mut self.sums);
        let mesh = &*self;
        parallel::for_each_block(&mut out, forces, CHUNK * each, |chunk, out, forces| {
            let mut sums = Sums::NONE;
            let elements = mesh.chunk(chunk);
            for (e, forces) in elements.zip(forces.chunks_exact_mut(each)) {
                let f = mesh.jacobian(e, x);
                let svd = S::svd(f);
                sums.largest = sums.largest.max(svd.0.at(0));
                sums.smallest = sums.smallest.min(svd.0.at(k - 1));
                let (j, cofactors) = determinant::<S>(f);
                sums.inverted += usize::from(!(j > 0.0));
                let mut slope = 0.0;
                if law.beta > 0.0 {
                    let barrier = mesh.barrier[e].at(j);
                    sums.barrier += law.beta * barrier.value;
                    slope = law.beta * barrier.slope;
                }
                let (value, stress) = stress::<S>(law.energy, f, svd);
                let weight = mesh.weight[e];
                sums.energy += weight * value;
                let hats = mesh.hats(e);
                for v in 0..=k {
                    for i in 0..k {
                        forces[v * k + i] = (0..k)
                            .map(|c| {
                                let at = c * k + i;
                                let p = weight * stress.at(at) + slope * cofactors.at(at);
                                p * hats[v][c]
                            })
                            .sum();
                    }
                }
            }
            *out = sums;
        });
        self.sums = out;
        self.total()
    }

    fn hessian(&self, law: Law, x: &[f64], kept: f64, blocks: &mut [f64]) {
        let k = S::STRETCHES;
        let each = stride(k);
        parallel::for_each_chunk(blocks, CHUNK * each, |chunk, blocks| {
            let elements = self.chunk(chunk);
            for (e, blocks) in elements.zip(blocks.chunks_exact_mut(each)) {
                let f = self.jacobian(e, x);
                let barrier = &self.barrier[e];
                let h = match law.hessian {
                    LimHessian::Projected => projected::<S>(law, self.weight[e], barrier, f, kept),
                    LimHessian::Frozen => {
                        let mut h = frozen::<S>(law.energy, f);
                        for row in &mut h[..k * k] {
                            row[..k * k].iter_mut().for_each(|h| *h *= self.weight[e]);
                        }
                        if law.beta > 0.0 {
                            add_barrier::<S>(barrier, law.beta, f, &mut h);
                        }
                        h
                    }
                };
                corner_blocks((k, k), &h, &self.hats(e), 1.0, blocks);
            }
        });
    }

    fn bound(&mut self, x: &[f64], direction: &[f64], most: f64) -> f64 {
        let mut bounds = core::mem::take(&mut self.bounds);
        let mesh = &*self;
        parallel::for_each_chunk(&mut bounds, 1, |chunk, bound| {
            bound[0] = mesh.chunk(chunk).fold(1.0, |least: f64, e| {
                let (from, way) = (mesh.edges(e, x), mesh.edges(e, direction));
                let to = S::Gradient::from_fn(|c| from.at(c) + most * way.at(c));
                least.min(mesh.first_wall(e, from, to))
            });
        });
        let least = bounds.iter().copied().fold(1.0, f64::min);
        self.bounds = bounds;
        most * least
    }

    fn corners(&self) -> &[u32] {
        &self.corners
    }

    fn field(&self, law: Law, x: &[f64], field: Field) -> Vec<f32> {
        let one = |e: usize| {
            let f = self.jacobian(e, x);
            let svd = S::svd(f);
            let sigma = svd.0.as_slice();
            let last = sigma[S::STRETCHES - 1];
            match field {
                _ if !(last > 0.0) => f32::INFINITY,
                Field::Distortion => relative_distortion(sigma),
                Field::Stretch => sigma[0].max(last.recip()) as f32,
                Field::Stress => equivalent_stress::<S>(f, stress::<S>(law.energy, f, svd).1),
            }
        };
        (0..self.len()).map(one).collect()
    }
}

/// Von Mises' equivalent of the Cauchy stress P Fᵀ/det F, of its symmetric part.
fn equivalent_stress<S: Space>(f: S::Gradient<f64>, p: S::Gradient<f64>) -> f32 {
    let k = S::STRETCHES;
    let (j, _) = determinant::<S>(f);
    let mut t = [[0.0; 3]; 3];
    for a in 0..k {
        for b in 0..k {
            let product = |a: usize, b: usize| -> f64 {
                (0..k).map(|c| p.at(c * k + a) * f.at(c * k + b)).sum()
            };
            t[a][b] = 0.5 * (product(a, b) + product(b, a)) / j;
        }
    }
    let difference = |a: usize, b: usize| (t[a][a] - t[b][b]) * (t[a][a] - t[b][b]);
    let normal = difference(0, 1) + difference(1, 2) + difference(2, 0);
    let shear = t[0][1] * t[0][1] + t[1][2] * t[1][2] + t[2][0] * t[2][0];
    (0.5 * normal + 3.0 * shear).sqrt() as f32
}
