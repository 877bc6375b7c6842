//! Rows of integer unknowns: whole coefficients without a common divisor, and Euclid's algorithm.

/// Largest denominator of the ratios of a row's coefficients.
const LARGEST_DENOMINATOR: f64 = 4096.0;
/// How near, relatively, a coefficient has to be to a fraction to be taken for it.
const NEAR: f64 = 1e-11;
/// Integers below this are exact in double precision, sums of two included.
pub(super) const EXACT: f64 = (1u64 << 52) as f64;

/// The factor that makes these coefficients (not empty, none 0) whole numbers without a common divisor,
/// and these numbers. `None`: their ratios are not rational, as far as can be seen.
pub(super) fn primitive(coefficients: &[f64]) -> Option<(f64, Vec<f64>)> {
    let whole = |factor: f64| -> Option<Vec<f64>> {
        let each = coefficients.iter().map(|a| {
            let (scaled, rounded) = (a * factor, (a * factor).round());
            let near = (scaled - rounded).abs() <= NEAR * scaled.abs() && scaled.abs() < EXACT;
            (near && rounded != 0.0).then_some(rounded)
        });
        each.collect()
    };
    let (mut factor, mut numbers) = match whole(1.0) {
        Some(numbers) => (1.0, numbers),
        None => {
            let smallest = coefficients.iter().map(|a| a.abs()).reduce(f64::min)?;
            let mut common = 1.0;
            for a in coefficients {
                let denominator = denominator((a / smallest).abs())?;
                common = common / gcd(common, denominator) * denominator;
                if common > LARGEST_DENOMINATOR * LARGEST_DENOMINATOR {
                    return None;
                }
            }
            (common / smallest, whole(common / smallest)?)
        }
    };
    let divisor = numbers.iter().copied().reduce(gcd)?.abs();
    numbers.iter_mut().for_each(|a| *a /= divisor);
    factor /= divisor;
    Some((factor, numbers))
}

/// The denominator of the first convergent of x's continued fraction that is x.
fn denominator(x: f64) -> Option<f64> {
    let (mut before, mut current) = (0.0, 1.0);
    let mut rest = x;
    loop {
        let nearest = (x * current).round() / current;
        if (x - nearest).abs() <= NEAR * x {
            return Some(current);
        }
        let fraction = rest - rest.floor();
        if fraction < NEAR {
            return None;
        }
        rest = fraction.recip();
        (before, current) = (current, rest.floor() * current + before);
        if current > LARGEST_DENOMINATOR {
            return None;
        }
    }
}

/// Of whole numbers, exactly.
fn gcd(a: f64, b: f64) -> f64 {
    let (mut a, mut b) = (a.abs(), b.abs());
    while b != 0.0 {
        (a, b) = (b, a % b);
    }
    a
}

/// One step of Euclid's algorithm on a row of whole coefficients, none of them ±1 (so that there are at
/// least two): the unknown j with the smallest, and for each other the rounded quotient of its
/// coefficient, where that is not 0. With z_j = z_j' − Σ q z the others keep remainders of at most half
/// the smallest.
pub(super) fn euclid(terms: &[(u32, f64)]) -> (u32, Vec<(u32, f64)>) {
    let mut smallest = terms[0];
    for &term in terms {
        if term.1.abs() < smallest.1.abs() {
            smallest = term;
        }
    }
    let (variable, a) = smallest;
    let others = terms.iter().filter(|t| t.0 != variable);
    let quotients = others.map(|&(i, c)| (i, (c / a).round()));
    (variable, quotients.filter(|t| t.1 != 0.0).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_become_whole_numbers_without_a_common_divisor() {
        let (factor, numbers) = primitive(&[0.5, -0.75]).expect("rational");
        assert_eq!((factor, numbers), (4.0, vec![2.0, -3.0]));
        let (_, numbers) = primitive(&[1.0 / 3.0, 2.0 / 7.0]).expect("rational");
        assert_eq!(numbers, [7.0, 6.0]);
        let (factor, numbers) = primitive(&[6.0, 10.0, -16.0]).expect("whole");
        assert_eq!((factor, numbers), (0.5, vec![3.0, 5.0, -8.0]));
        assert_eq!(primitive(&[1.0, 2f64.sqrt()]), None);
    }

    #[test]
    fn euclid_leaves_remainders_of_at_most_half_the_smallest() {
        let (variable, quotients) = euclid(&[(0, 6.0), (1, 10.0), (2, 15.0)]);
        assert_eq!((variable, quotients), (0, vec![(1, 2.0), (2, 3.0)]));
    }
}
