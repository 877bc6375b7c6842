//! The element loops of a space and a coupling behind one call a block, so that the solver itself is
//! compiled once.

use super::Coupling;
use super::block::{Block, BlockSums};
use super::densities::{Densities, Of};
use super::kernels::{Kernel, Pass};
use crate::energy::{Constants, Energy};
use crate::optim::Field;
use crate::space::{Components, Space, dispatch};
use core::marker::PhantomData;

/// What the solver knows of its types.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// d.
    pub dimension: usize,
    /// k.
    pub stretches: usize,
    /// Components of F.
    pub gradient: usize,
    /// Components of Z.
    pub local: usize,
    /// The first guess of a decomposition, of which so many components count.
    pub guess: ([f64; 9], usize),
    /// Components of what else is kept of one.
    pub kept: usize,
    /// κ of (17).
    pub kappa: f64,
    /// Is the global step a single linear solve?
    pub linear: bool,
    /// Is the energy infinite where an element is inverted?
    pub barrier: bool,
    /// Least and most σ that an iterate may have and have converged.
    pub limits: [f64; 2],
    /// Numbers of the energy.
    pub constants: Constants,
}

impl Shape {
    /// Of these types.
    pub fn of<S: Space, C: Coupling<S>, E: Energy<S>>(energy: &E) -> Self {
        let first = C::no_guess();
        let mut guess = [0.0; 9];
        guess[..first.as_slice().len()].copy_from_slice(first.as_slice());
        Self {
            guess: (guess, first.as_slice().len()),
            kept: C::Kept::<f64>::LEN,
            dimension: S::DIM,
            stretches: S::STRETCHES,
            gradient: S::Gradient::<f64>::LEN,
            local: C::Local::<f64>::LEN,
            kappa: S::KAPPA,
            linear: C::LINEAR,
            barrier: E::BARRIER,
            limits: energy.limits(),
            constants: energy.constants(),
        }
    }
}

/// Element loops.
pub trait Elements: Send + Sync {
    /// One pass over one block; arguments as those of [`Kernel`].
    fn pass(
        &self,
        pass: Pass,
        block: &mut Block,
        positions: &[f64],
        forces: &mut [f64],
    ) -> BlockSums;
    /// The value of a field at an element, after a pass that evaluates.
    fn field(&self, block: &Block, element: usize, field: Field) -> f32;
}

/// An energy on a splitting of F.
pub struct Model<S, C> {
    energy: Box<dyn Densities>,
    types: PhantomData<(S, C)>,
}

impl<S: Space, C: Coupling<S>> Model<S, C> {
    /// Of this energy.
    pub fn new<E: Energy<S>>(energy: E) -> Self {
        Self {
            energy: Box::new(Of::<S, E>::new(energy)),
            types: PhantomData,
        }
    }
}

impl<S: Space, C: Coupling<S>> Elements for Model<S, C> {
    fn pass(
        &self,
        pass: Pass,
        block: &mut Block,
        positions: &[f64],
        forces: &mut [f64],
    ) -> BlockSums {
        dispatch(Kernel::<S, C> {
            pass,
            block,
            positions,
            forces,
            energy: &*self.energy,
            types: PhantomData,
        })
    }
    fn field(&self, block: &Block, element: usize, field: Field) -> f32 {
        let sigma = |i: usize| block.stretch.get(i).map_or(0.0, |row| row[element]);
        self.energy.field([sigma(0), sigma(1), sigma(2)], field)
    }
}
