//! Sums of products of doubles in integers wide enough for all of them: nothing is rounded.

use std::cmp::Ordering;

/// A sum of products of `N` doubles each, the positive and the negative ones apart, in units of
/// 2^(−1074 N): integers of `WORDS` words of 64 bits, the lowest first. A product has at most
/// N · (1074 + 1024) bits; the words have to hold the sum of all that are added.
pub struct WideSum<const WORDS: usize> {
    sides: [[u64; WORDS]; 2],
}

impl<const WORDS: usize> WideSum<WORDS> {
    /// The empty sum.
    pub const ZERO: Self = Self {
        sides: [[0; WORDS]; 2],
    };

    /// Adds the product of the factors, or subtracts it. Every product of one sum has as many factors,
    /// all of them finite.
    pub fn add<const N: usize>(&mut self, factors: [f64; N], subtract: bool) {
        let negative = factors
            .iter()
            .fold(subtract, |sign, x| sign != x.is_sign_negative());
        add_product(&mut self.sides[usize::from(negative)], factors);
    }

    /// The sum compared with zero.
    pub fn sign(&self) -> Ordering {
        let [positive, negative] = &self.sides;
        positive.iter().rev().cmp(negative.iter().rev())
    }
}

/// |x| = mantissa · 2^(exponent − 1074).
fn decompose(x: f64) -> (u64, usize) {
    let bits = x.to_bits() & !(1 << 63);
    let exponent = (bits >> 52) as usize;
    let fraction = bits & ((1 << 52) - 1);
    match exponent {
        0 => (fraction, 0),
        e => (fraction | 1 << 52, e - 1),
    }
}

/// Adds |Π factors| in units of 2^(−1074 N).
fn add_product<const N: usize>(sum: &mut [u64], factors: [f64; N]) {
    // The product of the mantissas, 53 bits each, fits into N words.
    let mut product = [0u64; N];
    let mut exponent = 0;
    for (i, &x) in factors.iter().enumerate() {
        let (mantissa, e) = decompose(x);
        exponent += e;
        if i == 0 {
            product[0] = mantissa;
            continue;
        }
        let mut carry = 0u64;
        for word in &mut product[..=i] {
            let total = u128::from(*word) * u128::from(mantissa) + u128::from(carry);
            *word = total as u64;
            carry = (total >> 64) as u64;
        }
    }
    let (first, shift) = (exponent / 64, exponent % 64);
    // Shifted it has a word more: the bits that the highest word loses.
    let mut lost = 0u64;
    let mut carry = false;
    for (i, slot) in sum[first..].iter_mut().enumerate() {
        let word = product.get(i).copied().unwrap_or(0);
        if i > N && !carry {
            break;
        }
        let (total, first_carry) = slot.overflowing_add(word << shift | lost);
        let (total, second_carry) = total.overflowing_add(u64::from(carry));
        *slot = total;
        carry = first_carry || second_carry;
        lost = match shift {
            0 => 0,
            _ => word >> (64 - shift),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    fn any_finite() -> impl Strategy<Value = f64> {
        any::<u64>()
            .prop_map(f64::from_bits)
            .prop_filter("finite", |x| x.is_finite())
    }

    fn sign<const N: usize, const WORDS: usize>(terms: &[([f64; N], bool)]) -> Ordering {
        let mut sum = WideSum::<WORDS>::ZERO;
        terms.iter().for_each(|&(t, minus)| sum.add(t, minus));
        sum.sign()
    }

    fn exact<const N: usize>(terms: &[([f64; N], bool)]) -> Ordering {
        let product = |t: &[f64; N]| {
            let factors = t.iter().map(|&x| RBig::try_from(x).expect("finite"));
            factors.fold(RBig::ONE, |a, b| a * b)
        };
        let sum = terms
            .iter()
            .fold(RBig::ZERO, |sum, (t, minus)| match minus {
                true => sum - product(t),
                false => sum + product(t),
            });
        sum.cmp(&RBig::ZERO)
    }

    #[test]
    fn carries_run_through_all_words() {
        let (tiny, huge) = (f64::from_bits(1), f64::MAX);
        // 2·huge³ − 2·huge³ ± tiny³
        let full = [([huge; 3], false), ([-huge; 3], false)];
        let both = [full[0], full[0], full[1], full[1]];
        assert_eq!(sign::<3, 99>(&both), Ordering::Equal);
        for (minus, expected) in [(false, Ordering::Greater), (true, Ordering::Less)] {
            let terms = [both[0], both[1], both[2], both[3], ([tiny; 3], minus)];
            assert_eq!(sign::<3, 99>(&terms), expected);
        }
        // 12 · huge³ still fits.
        let twelve: Vec<_> = (0..24).map(|i| ([huge; 3], i % 2 == 1)).collect();
        assert_eq!(sign::<3, 99>(&twelve), Ordering::Equal);
    }

    proptest! {
        #[test]
        fn agrees_with_rationals(
            v in prop::array::uniform12(any_finite()), signs in prop::array::uniform4(any::<bool>()),
        ) {
            let three: Vec<_> = (0..4).map(|i| ([v[3 * i], v[3 * i + 1], v[3 * i + 2]], signs[i])).collect();
            prop_assert_eq!(sign::<3, 99>(&three), exact(&three));
            let two: Vec<_> = (0..4).map(|i| ([v[2 * i], v[2 * i + 1]], signs[i])).collect();
            prop_assert_eq!(sign::<2, 70>(&two), exact(&two));
            let four: Vec<_> = (0..3).map(|i| ([v[4 * i], v[4 * i + 1], v[4 * i + 2], v[4 * i + 3]], signs[i])).collect();
            prop_assert_eq!(sign::<4, 132>(&four), exact(&four));
            // Terms that cancel but for the last bits.
            let near = [
                ([v[0], v[1], v[2]], false),
                ([v[1], v[2], v[0]], true),
                ([v[3], v[4], v[5]], signs[0]),
                ([v[5], v[3], v[4]], !signs[0]),
                ([v[6] * 1e-300, v[7] * 1e-300, 1.0], signs[1]),
            ];
            prop_assert_eq!(sign::<3, 99>(&near), exact(&near));
        }
    }
}
