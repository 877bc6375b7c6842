//! Numbers the kernels compute with: one `f64`, a dual number, or a SIMD register of elements.
//!
//! Every per-element formula of the crate is written once, generic over [`Scalar`] (arithmetic only:
//! also dual numbers, for the derivative tests) or [`Lane`] (with comparisons: `f64` or a register).
//! Registers come from `pulp`, which picks AVX-512, AVX2 or simd128 at run time; none of the
//! operations contracts to a fused multiply-add, so that a kernel gives the same bits at every width
//! (the dense kernels of faer's Cholesky do use it where the machine has it).

use super::Registers as Simd;
use core::ops::{Add, Div, Mul, Neg, Sub};
use pulp::WithSimd;

/// Field arithmetic, and constants by [`Scalar::lift`].
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `c`, of the same width as `self`.
    fn lift(self, c: f64) -> Self;
    /// 1/self.
    #[inline(always)]
    fn recip(self) -> Self {
        self.lift(1.0) / self
    }
}

/// A [`Scalar`] that can be compared: one element or several side by side.
pub trait Lane: Scalar {
    /// The result of a comparison.
    type Mask: Copy;
    /// √self.
    fn sqrt(self) -> Self;
    /// |self|.
    fn abs(self) -> Self;
    /// The smaller of the two.
    fn min(self, other: Self) -> Self;
    /// The larger of the two.
    fn max(self, other: Self) -> Self;
    /// self < other.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, else `no`.
    fn select(self, mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Does the mask hold anywhere?
    fn any(self, mask: Self::Mask) -> bool;
    /// self = m·2ᵉ with m in [√½, √2), for normal positive numbers; anything otherwise.
    fn mantissa_exponent(self) -> (Self, Self);

    /// The natural logarithm of a normal positive number, to 1 ulp: the same bits on every machine, at
    /// every width. Anything for other arguments.
    #[inline(always)]
    fn ln(self) -> Self {
        // with f = m − 1 and s = f/(2+f): ln m = 2 artanh s = f − f²/2 + s (f²/2 + R), where
        // R = 2s²/3 + 2s⁴/5 + …, to s²⁰ since s² < 0.0295; f is exact, and leads
        let (m, e) = self.mantissa_exponent();
        let f = m - self.lift(1.0);
        let s = f / (self.lift(2.0) + f);
        let square = s * s;
        let mut sum = self.lift(2.0 / 21.0);
        let mut power = 19.0;
        while power > 2.0 {
            sum = sum * square + self.lift(2.0 / power);
            power -= 2.0;
        }
        let half = self.lift(0.5) * f * f;
        // ln 2 in two parts: the first times an exponent is exact
        let high = e * self.lift(f64::from_bits(0x3FE6_2E42_FEE0_0000));
        let low = e * self.lift(1.908_214_929_270_587_7e-10);
        high - ((half - (s * (half + square * sum) + low)) - f)
    }
}

/// m and e of [`Lane::mantissa_exponent`].
#[inline(always)]
fn split(x: f64) -> (f64, f64) {
    let bits = x.to_bits();
    // adding what is between √½ and 1 to the mantissa carries into the exponent from √2 on
    let carried = bits.wrapping_add(0x3FF0_0000_0000_0000 - 0x3FE6_A09E_667F_3BCD);
    let e = (carried >> 52) as i64 - 0x3FF;
    let m = f64::from_bits(bits.wrapping_sub((e << 52) as u64));
    (m, e as f64)
}

impl Scalar for f64 {
    #[inline(always)]
    fn lift(self, c: f64) -> f64 {
        c
    }
}

impl Lane for f64 {
    type Mask = bool;
    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn lt(self, other: f64) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(self, mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn any(self, mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn mantissa_exponent(self) -> (f64, f64) {
        split(self)
    }
}

/// A SIMD register of `f64`, one lane an element.
#[derive(Clone, Copy)]
pub struct Pack<S: Simd> {
    simd: S,
    lanes: S::Lanes,
}

impl<S: Simd> Pack<S> {
    /// Lanes in the register.
    pub const WIDTH: usize = core::mem::size_of::<S::Lanes>() / core::mem::size_of::<f64>();

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, c: f64) -> Self {
        Self {
            simd,
            lanes: simd.splat(c),
        }
    }
    /// `WIDTH` numbers from the front of `source`.
    #[inline(always)]
    pub fn load(simd: S, source: &[f64]) -> Self {
        Self {
            simd,
            lanes: simd.load(source),
        }
    }
    /// Writes the lanes to the front of `target`.
    #[inline(always)]
    pub fn store(self, target: &mut [f64]) {
        self.simd.store(self.lanes, target);
    }
    /// All lanes folded into one number.
    #[inline(always)]
    pub fn fold(self, f: impl Fn(f64, f64) -> f64) -> f64 {
        let mut lanes = [0.0; 8];
        self.store(&mut lanes[..Self::WIDTH]);
        lanes[1..Self::WIDTH].iter().fold(lanes[0], |a, &b| f(a, b))
    }
    #[inline(always)]
    fn with(self, lanes: S::Lanes) -> Self {
        Self {
            simd: self.simd,
            lanes,
        }
    }
}

macro_rules! operator {
    ($trait:ident, $name:ident, $op:ident) => {
        impl<S: Simd> $trait for Pack<S> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                self.with(self.simd.$op(self.lanes, other.lanes))
            }
        }
    };
}
operator!(Add, add, plus);
operator!(Sub, sub, minus);
operator!(Mul, mul, times);
operator!(Div, div, over);

impl<S: Simd> Neg for Pack<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.with(self.simd.negated(self.lanes))
    }
}

impl<S: Simd> Scalar for Pack<S> {
    #[inline(always)]
    fn lift(self, c: f64) -> Self {
        Self::splat(self.simd, c)
    }
}

impl<S: Simd> Lane for Pack<S> {
    type Mask = S::Mask;
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.simd.root(self.lanes))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.with(self.simd.absolute(self.lanes))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        // by comparison, not by the hardware's minimum: those differ between targets on NaN and ±0
        self.select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.select(other.lt(self), self, other)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> S::Mask {
        self.simd.less(self.lanes, other.lanes)
    }
    #[inline(always)]
    fn select(self, mask: S::Mask, yes: Self, no: Self) -> Self {
        self.with(self.simd.choose(mask, yes.lanes, no.lanes))
    }
    #[inline(always)]
    fn any(self, mask: S::Mask) -> bool {
        self.simd.any(mask)
    }
    #[inline(always)]
    fn mantissa_exponent(self) -> (Self, Self) {
        let (mut m, mut e) = ([0.0; 8], [0.0; 8]);
        self.store(&mut m[..Self::WIDTH]);
        for lane in 0..Self::WIDTH {
            (m[lane], e[lane]) = split(m[lane]);
        }
        (Self::load(self.simd, &m), Self::load(self.simd, &e))
    }
}

/// Runs a kernel with the widest instruction set of this machine.
pub fn dispatch<K: WithSimd>(kernel: K) -> K::Output {
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    {
        // `pulp::Arch` would keep a scalar copy of every kernel beside the one that is used: here the
        // choice was made when the module was compiled, and an engine without simd128 refuses it whole
        match pulp::wasm::Simd128::try_new() {
            Some(simd) => kernel.with_simd(simd),
            None => unreachable!("the module was compiled for simd128"),
        }
    }
    #[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
    pulp::Arch::new().dispatch(kernel)
}
