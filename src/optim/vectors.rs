//! Long vectors: products and combinations, block by block, summed in an order that depends on
//! nothing but the length.

use crate::parallel;
use crate::space::{Pack, dispatch};
use pulp::{Simd, WithSimd};

/// Entries of a block: it stays in the first-level cache while several vectors pass over it.
const BLOCK: usize = 1024;

/// Blocks a unit of parallel work has.
const BLOCKS: usize = 8;

/// a·b.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = Vec::with_capacity(1);
    dots(core::iter::once(a), b, &mut sum);
    sum[0]
}

/// Fewer of these units [`dots`] takes by itself: others would have to be told.
const SHARED: usize = 4;

/// Most vectors that [`dots`] takes at once without another round.
const ROUND: usize = 8;

/// The product of each vector with b: eight running sums a block, blocks in order.
pub fn dots<'a>(
    vectors: impl Iterator<Item = &'a [f64]> + Clone + Sync + Send,
    b: &[f64],
    products: &mut Vec<f64>,
) {
    products.clear();
    let total = vectors.clone().count();
    let chunks = b.len().div_ceil(BLOCK * BLOCKS).max(1);
    for round in (0..total).step_by(ROUND) {
        let vectors = vectors.clone().skip(round).take(ROUND);
        let one_chunk = |chunk: usize, sums: &mut [f64; ROUND]| {
            let range = chunk * BLOCK * BLOCKS..((chunk + 1) * BLOCK * BLOCKS).min(b.len());
            *sums = [0.0; ROUND];
            let b = &b[range.clone()];
            for (k, b) in b.chunks(BLOCK).enumerate() {
                let start = range.start + k * BLOCK;
                for (sum, a) in sums.iter_mut().zip(vectors.clone()) {
                    let a = &a[start..start + b.len()];
                    *sum += dispatch(Dot { a, b });
                }
            }
        };
        let mut total_sums = [0.0; ROUND];
        let mut add = |sums: &[f64; ROUND]| {
            for (t, s) in total_sums.iter_mut().zip(sums) {
                *t += s;
            }
        };
        if parallel::threads() > 1 && chunks >= SHARED {
            let mut partial = vec![[0.0; ROUND]; chunks];
            parallel::for_each_chunk(&mut partial, 1, |chunk, sums| {
                one_chunk(chunk, &mut sums[0]);
            });
            partial.iter().for_each(add);
        } else {
            for chunk in 0..chunks {
                let mut sums = [0.0; ROUND];
                one_chunk(chunk, &mut sums);
                add(&sums);
            }
        }
        products.extend_from_slice(&total_sums[..(total - round).min(ROUND)]);
    }
}

struct Dot<'a> {
    a: &'a [f64],
    b: &'a [f64],
}

impl WithSimd for Dot<'_> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        // eight sums in as many registers as they take
        let width = Pack::<S>::WIDTH;
        let mut packs = [Pack::splat(simd, 0.0); 8];
        let (a, a_rest) = self.a.as_chunks::<8>();
        let (b, b_rest) = self.b.as_chunks::<8>();
        for (a, b) in a.iter().zip(b) {
            for (k, sum) in packs.iter_mut().enumerate().take(8 / width) {
                let at = k * width;
                *sum = *sum + Pack::load(simd, &a[at..]) * Pack::load(simd, &b[at..]);
            }
        }
        let mut sums = [0.0; 8];
        for (sums, pack) in sums.chunks_exact_mut(width).zip(packs) {
            pack.store(sums);
        }
        for (lane, (a, b)) in a_rest.iter().zip(b_rest).enumerate() {
            sums[lane] += a * b;
        }
        let [s0, s1, s2, s3, s4, s5, s6, s7] = sums;
        ((s0 + s4) + (s2 + s6)) + ((s1 + s5) + (s3 + s7))
    }
}

/// y += c x.
struct Axpy<'a> {
    c: f64,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Axpy<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let c = Pack::splat(simd, self.c);
        let width = Pack::<S>::WIDTH;
        let whole = self.y.len() / width * width;
        let (y, y_rest) = self.y.split_at_mut(whole);
        let (x, x_rest) = self.x.split_at(whole);
        for (y, x) in y.chunks_exact_mut(width).zip(x.chunks_exact(width)) {
            (Pack::load(simd, y) + c * Pack::load(simd, x)).store(y);
        }
        for (y, x) in y_rest.iter_mut().zip(x_rest) {
            *y += self.c * x;
        }
    }
}

/// y = c x.
struct Scaled<'a> {
    c: f64,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl WithSimd for Scaled<'_> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let c = Pack::splat(simd, self.c);
        let width = Pack::<S>::WIDTH;
        let whole = self.y.len() / width * width;
        let (y, y_rest) = self.y.split_at_mut(whole);
        let (x, x_rest) = self.x.split_at(whole);
        for (y, x) in y.chunks_exact_mut(width).zip(x.chunks_exact(width)) {
            (c * Pack::load(simd, x)).store(y);
        }
        for (y, x) in y_rest.iter_mut().zip(x_rest) {
            *y = self.c * x;
        }
    }
}

/// y += Σ cᵢ xᵢ, in the order of the terms.
pub fn add_combination<'a>(
    terms: impl Iterator<Item = (f64, &'a [f64])> + Clone + Sync + Send,
    y: &mut [f64],
) {
    parallel::for_each_chunk(y, BLOCK * BLOCKS, |chunk, y| {
        for (block, y) in y.chunks_mut(BLOCK).enumerate() {
            let start = (chunk * BLOCKS + block) * BLOCK;
            for (c, x) in terms.clone() {
                let x = &x[start..start + y.len()];
                dispatch(Axpy { c, x, y });
            }
        }
    });
}

/// y = c x + Σ cᵢ xᵢ, in this order.
pub fn set_combination<'a>(
    (c, x): (f64, &[f64]),
    terms: impl Iterator<Item = (f64, &'a [f64])> + Clone + Sync + Send,
    y: &mut [f64],
) {
    parallel::for_each_chunk(y, BLOCK * BLOCKS, |chunk, y| {
        for (block, y) in y.chunks_mut(BLOCK).enumerate() {
            let start = (chunk * BLOCKS + block) * BLOCK;
            let x = &x[start..start + y.len()];
            dispatch(Scaled { c, x, y });
            for (c, x) in terms.clone() {
                let x = &x[start..start + y.len()];
                dispatch(Axpy { c, x, y });
            }
        }
    });
}
