//! What [`Pack`](super::Pack) needs of an instruction set.
//!
//! `pulp` has all of it, with registers that are structures of numbers. In WebAssembly the compiler takes
//! such structures apart, and keeps half of them as single numbers: there the register is the engine's
//! own type.

use pulp::Simd;

/// An instruction set: registers of `f64`, and what can be done with them.
pub trait Registers: Simd {
    /// A register.
    type Lanes: Copy;
    /// The result of a comparison.
    type Mask: Copy;
    /// The same number in every lane.
    fn splat(self, c: f64) -> Self::Lanes;
    /// The numbers at the front of `source`.
    fn load(self, source: &[f64]) -> Self::Lanes;
    /// Writes them to the front of `target`.
    fn store(self, a: Self::Lanes, target: &mut [f64]);
    /// a + b.
    fn plus(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    /// a − b.
    fn minus(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    /// a b.
    fn times(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    /// a/b.
    fn over(self, a: Self::Lanes, b: Self::Lanes) -> Self::Lanes;
    /// −a.
    fn negated(self, a: Self::Lanes) -> Self::Lanes;
    /// √a.
    fn root(self, a: Self::Lanes) -> Self::Lanes;
    /// |a|.
    fn absolute(self, a: Self::Lanes) -> Self::Lanes;
    /// a < b.
    fn less(self, a: Self::Lanes, b: Self::Lanes) -> Self::Mask;
    /// `yes` where the mask holds, else `no`.
    fn choose(self, mask: Self::Mask, yes: Self::Lanes, no: Self::Lanes) -> Self::Lanes;
    /// Does the mask hold anywhere?
    fn any(self, mask: Self::Mask) -> bool;
}

#[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
impl<S: Simd> Registers for S {
    type Lanes = S::f64s;
    type Mask = S::m64s;
    #[inline(always)]
    fn splat(self, c: f64) -> S::f64s {
        self.splat_f64s(c)
    }
    #[inline(always)]
    fn load(self, source: &[f64]) -> S::f64s {
        S::as_simd_f64s(source).0[0]
    }
    #[inline(always)]
    fn store(self, a: S::f64s, target: &mut [f64]) {
        S::as_mut_simd_f64s(target).0[0] = a;
    }
    #[inline(always)]
    fn plus(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.add_f64s(a, b)
    }
    #[inline(always)]
    fn minus(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.sub_f64s(a, b)
    }
    #[inline(always)]
    fn times(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.mul_f64s(a, b)
    }
    #[inline(always)]
    fn over(self, a: S::f64s, b: S::f64s) -> S::f64s {
        self.div_f64s(a, b)
    }
    #[inline(always)]
    fn negated(self, a: S::f64s) -> S::f64s {
        self.neg_f64s(a)
    }
    #[inline(always)]
    fn root(self, a: S::f64s) -> S::f64s {
        self.sqrt_f64s(a)
    }
    #[inline(always)]
    fn absolute(self, a: S::f64s) -> S::f64s {
        self.abs_f64s(a)
    }
    #[inline(always)]
    fn less(self, a: S::f64s, b: S::f64s) -> S::m64s {
        self.less_than_f64s(a, b)
    }
    #[inline(always)]
    fn choose(self, mask: S::m64s, yes: S::f64s, no: S::f64s) -> S::f64s {
        self.select_f64s(mask, yes, no)
    }
    #[inline(always)]
    fn any(self, mask: S::m64s) -> bool {
        self.first_true_m64s(mask) < core::mem::size_of::<S::f64s>() / core::mem::size_of::<f64>()
    }
}

#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128 {
    use super::{Registers, Simd};
    use core::arch::wasm32::{
        f64x2_abs, f64x2_add, f64x2_div, f64x2_lt, f64x2_mul, f64x2_neg, f64x2_splat, f64x2_sqrt,
        f64x2_sub, v128, v128_any_true, v128_bitselect, v128_or,
    };

    /// Two: what is done with one does not wait for the other.
    type Two = [v128; 2];

    // not functions: an intrinsic is none that could be handed to one
    macro_rules! each {
        ($f:ident, $a:expr) => {
            [$f($a[0]), $f($a[1])]
        };
        ($f:ident, $a:expr, $b:expr) => {
            [$f($a[0], $b[0]), $f($a[1], $b[1])]
        };
    }

    impl<S: Simd> Registers for S {
        type Lanes = Two;
        type Mask = Two;
        #[inline(always)]
        fn splat(self, c: f64) -> Two {
            [f64x2_splat(c); 2]
        }
        #[inline(always)]
        fn load(self, source: &[f64]) -> Two {
            bytemuck::pod_read_unaligned(bytemuck::bytes_of(&source.as_chunks::<4>().0[0]))
        }
        #[inline(always)]
        fn store(self, a: Two, target: &mut [f64]) {
            target.as_chunks_mut::<4>().0[0] = bytemuck::cast(a);
        }
        #[inline(always)]
        fn plus(self, a: Two, b: Two) -> Two {
            each!(f64x2_add, a, b)
        }
        #[inline(always)]
        fn minus(self, a: Two, b: Two) -> Two {
            each!(f64x2_sub, a, b)
        }
        #[inline(always)]
        fn times(self, a: Two, b: Two) -> Two {
            each!(f64x2_mul, a, b)
        }
        #[inline(always)]
        fn over(self, a: Two, b: Two) -> Two {
            each!(f64x2_div, a, b)
        }
        #[inline(always)]
        fn negated(self, a: Two) -> Two {
            each!(f64x2_neg, a)
        }
        #[inline(always)]
        fn root(self, a: Two) -> Two {
            each!(f64x2_sqrt, a)
        }
        #[inline(always)]
        fn absolute(self, a: Two) -> Two {
            each!(f64x2_abs, a)
        }
        #[inline(always)]
        fn less(self, a: Two, b: Two) -> Two {
            each!(f64x2_lt, a, b)
        }
        #[inline(always)]
        fn choose(self, mask: Two, yes: Two, no: Two) -> Two {
            [
                v128_bitselect(yes[0], no[0], mask[0]),
                v128_bitselect(yes[1], no[1], mask[1]),
            ]
        }
        #[inline(always)]
        fn any(self, mask: Two) -> bool {
            v128_any_true(v128_or(mask[0], mask[1]))
        }
    }
}
