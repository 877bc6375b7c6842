//! The matrices of the elements, whose sum is what a step solves with.

use super::corners::corner_blocks;
use crate::energy::Energy;
use crate::energy::hessian::{Eigensystem, Square};
use crate::space::{Components, Space};
use crate::wrapd::block::{Block, Row};
use core::marker::PhantomData;

/// How much of the elements' Hessians is in their matrices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Share {
    /// Along curves on which elements turn, of what resists their turn: from 0, where they turn freely with all
    /// that is done to them, to 1. Where curves are straight it is 1.
    pub resistance: f64,
    /// Of what is negative: from 0 to 1.
    pub negative: f64,
}

impl Share {
    /// Positive semidefinite.
    pub fn semidefinite(resistance: f64) -> Self {
        Self {
            resistance,
            negative: 0.0,
        }
    }

    /// Can the matrices be indefinite?
    pub fn is_indefinite(self) -> bool {
        self.resistance * self.negative > 0.0
    }
}

/// Matrices of the elements: their Hessians, with all or a part or nothing of what is negative in them.
pub trait Curvature: Send + Sync {
    /// Of the first `count` elements of a block at the F of its last evaluation, times the measure: element
    /// after element the d×d blocks, row by row, of the pairs of corners (0,0), (1,0), (1,1), (2,0), …. Of the
    /// negative part of a Hessian `kept` is left, from 0 (positive semidefinite) to 1 (the Hessian).
    fn fill(&self, block: &Block, count: usize, kept: f64, out: &mut [f64]);
    /// The same along curves on which elements turn, with what [`super::turns`] has to say of each of them:
    /// that of straight lines where the method knows no others.
    fn fill_turning(&self, block: &Block, _: &Row, count: usize, share: Share, out: &mut [f64]) {
        self.fill(block, count, share.negative, out);
    }
    /// Does `kept` make a difference?
    fn has_negative(&self) -> bool;
    /// Is this for the energy that [`super::relaxation`] knows?
    fn can_relax(&self) -> bool {
        false
    }
}

/// Numbers an element has in [`Curvature::fill`].
pub fn stride(dimension: usize) -> usize {
    (dimension + 1) * (dimension + 2) / 2 * dimension * dimension
}

/// A matrix on the entries of F for each element: what most methods differ in.
pub trait OfGradient<S: Space>: Send + Sync {
    /// At F.
    fn at(&self, f: S::Gradient<f64>, kept: f64) -> Square;
    /// Does `kept` make a difference?
    const NEGATIVE: bool;
}

/// Takes a matrix on F to the corners, element by element.
pub struct OnCorners<S, M>(pub M, pub PhantomData<S>);

impl<S: Space, M: OfGradient<S>> Curvature for OnCorners<S, M> {
    fn has_negative(&self) -> bool {
        M::NEGATIVE
    }

    fn fill(&self, block: &Block, count: usize, kept: f64, out: &mut [f64]) {
        let (d, k) = (S::DIM, S::STRETCHES);
        for (e, out) in out.chunks_exact_mut(stride(d)).take(count).enumerate() {
            let h = self
                .0
                .at(S::Gradient::from_fn(|c| block.gradient[c][e]), kept);
            let hats = hat_gradients(block, e, k);
            to_corners::<S>(&h, &hats, block.measure[0][e], out);
        }
    }
}

/// [`corner_blocks`], compiled once a dimension, not once an energy.
#[inline(never)]
fn to_corners<S: Space>(h: &Square, hats: &[[f64; 3]; 4], measure: f64, out: &mut [f64]) {
    corner_blocks((S::DIM, S::STRETCHES), h, hats, measure, out);
}

/// The gradients of the hat functions of an element's corners.
fn hat_gradients(block: &Block, e: usize, k: usize) -> [[f64; 3]; 4] {
    let mut hats = [[0.0; 3]; 4];
    for v in 1..=k {
        for column in 0..k {
            hats[v][column] = block.inverse[column * k + v - 1][e];
            hats[0][column] -= hats[v][column];
        }
    }
    hats
}

/// The Hessian, with its negative eigenvalues set to 0 where nothing of them is kept (Teran et al. 2005, by the eigensystems of Smith,
/// de Goes & Kim 2019).
pub struct Projected<E>(pub E);

impl<S: Space, E: Energy<S>> OfGradient<S> for Projected<E> {
    const NEGATIVE: bool = true;

    fn at(&self, f: S::Gradient<f64>, kept: f64) -> Square {
        Eigensystem::<S>::new(self.0, f).map(|value| value.max(kept * value))
    }
}
