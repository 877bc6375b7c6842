//! Dual numbers as the crate's kernels compute with them.
#![allow(dead_code)]

use foldfree::space::{Lane, Scalar};
use num_dual::{DualNum, HyperDual64};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number with two first derivatives and their mixed second derivative, as the crate's kernels
/// compute with it.
#[derive(Clone, Copy)]
pub struct Dual(pub HyperDual64);

macro_rules! operator {
    ($trait:ident, $name:ident) => {
        impl $trait for Dual {
            type Output = Dual;
            fn $name(self, other: Dual) -> Dual {
                Dual($trait::$name(self.0, other.0))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        Dual(-self.0)
    }
}

impl Scalar for Dual {
    fn lift(self, c: f64) -> Dual {
        Dual(HyperDual64::from_re(c))
    }
}

impl Lane for Dual {
    type Mask = bool;
    fn sqrt(self) -> Dual {
        Dual(DualNum::sqrt(&self.0))
    }
    fn abs(self) -> Dual {
        if self.0.re < 0.0 { -self } else { self }
    }
    fn min(self, other: Dual) -> Dual {
        if self.lt(other) { self } else { other }
    }
    fn max(self, other: Dual) -> Dual {
        if other.lt(self) { self } else { other }
    }
    fn lt(self, other: Dual) -> bool {
        self.0.re < other.0.re
    }
    fn select(self, mask: bool, yes: Dual, no: Dual) -> Dual {
        if mask { yes } else { no }
    }
    fn any(self, mask: bool) -> bool {
        mask
    }
    fn mantissa_exponent(self) -> (Dual, Dual) {
        unreachable!("only the logarithm asks for it")
    }
    fn ln(self) -> Dual {
        Dual(DualNum::ln(&self.0))
    }
}

/// `values` as duals, of which entry i carries the first direction and entry j the second.
pub fn dual<const N: usize>(values: [f64; N], i: usize, j: usize) -> [Dual; N] {
    std::array::from_fn(|k| {
        let one = |yes| f64::from(u8::from(yes));
        Dual(HyperDual64::new(values[k], one(k == i), one(k == j), 0.0))
    })
}
