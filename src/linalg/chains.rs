//! Sums of products of rows in fours, for backward solves: Σ l x of rows of even number, and of rows of odd number, by
//! right-hand side.
//!
//! The vectors of WebAssembly have to be written out: these two chains are one of them, and GINI's steps take a sixth
//! less. Compilers that see wider ones for themselves do better with plain numbers: written out in this way, the same
//! steps would take a fifth longer on a machine with AVX. Both give the same bits.

use super::panels::ROWS;
#[cfg(target_arch = "wasm32")]
use wide::f64x2;

/// Four rows of the right-hand sides, as [`Chains`] take them.
#[cfg(not(target_arch = "wasm32"))]
pub(super) type Gathered<const D: usize> = [[f64; D]; ROWS];
/// The same.
#[cfg(target_arch = "wasm32")]
pub(super) type Gathered<const D: usize> = [[f64x2; D]; 2];

/// The two sums of each side.
#[cfg(not(target_arch = "wasm32"))]
#[derive(Clone, Copy)]
pub(super) struct Chains<const D: usize>([[f64; D]; 2]);

#[cfg(not(target_arch = "wasm32"))]
impl<const D: usize> Chains<D> {
    pub(super) const ZERO: Self = Self([[0.0; D]; 2]);
    pub(super) const NOTHING: Gathered<D> = [[0.0; D]; ROWS];

    #[inline(always)]
    pub(super) fn gather(x: [[f64; D]; ROWS]) -> Gathered<D> {
        x
    }

    #[inline(always)]
    pub(super) fn add_products(&mut self, l: &[f64; ROWS], x: &Gathered<D>) {
        for k in 0..ROWS {
            for d in 0..D {
                self.0[k % 2][d] += l[k] * x[k][d];
            }
        }
    }

    #[inline(always)]
    pub(super) fn sums(self) -> [f64; D] {
        core::array::from_fn(|d| self.0[0][d] + self.0[1][d])
    }
}

/// The two sums of each side.
#[cfg(target_arch = "wasm32")]
#[derive(Clone, Copy)]
pub(super) struct Chains<const D: usize>([f64x2; D]);

#[cfg(target_arch = "wasm32")]
impl<const D: usize> Chains<D> {
    pub(super) const ZERO: Self = Self([f64x2::ZERO; D]);
    pub(super) const NOTHING: Gathered<D> = [[f64x2::ZERO; D]; 2];

    #[inline(always)]
    pub(super) fn gather(x: [[f64; D]; ROWS]) -> Gathered<D> {
        [0, 2].map(|k| core::array::from_fn(|d| f64x2::new([x[k][d], x[k + 1][d]])))
    }

    #[inline(always)]
    pub(super) fn add_products(&mut self, l: &[f64; ROWS], x: &Gathered<D>) {
        let l = [f64x2::new([l[0], l[1]]), f64x2::new([l[2], l[3]])];
        for (l, x) in l.iter().zip(x) {
            for d in 0..D {
                self.0[d] += *l * x[d];
            }
        }
    }

    #[inline(always)]
    pub(super) fn sums(self) -> [f64; D] {
        self.0.map(|chains| {
            let [even, odd] = chains.to_array();
            even + odd
        })
    }
}
