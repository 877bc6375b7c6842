//! Floating-point numbers in order, as integers.

/// An integer that is in the order of `f64::total_cmp`: numbers and indices sort as pairs of integers, all by one
/// compiled routine.
pub(crate) fn ranked(value: f64) -> i64 {
    let bits = value.to_bits() as i64;
    bits ^ (((bits >> 63) as u64) >> 1) as i64
}

#[cfg(test)]
mod tests {
    use super::ranked;

    #[test]
    fn integers_are_in_the_order_of_their_numbers() {
        let in_order = [
            f64::NEG_INFINITY,
            -1e300,
            -2.0,
            -f64::MIN_POSITIVE,
            -5e-324,
            -0.0,
            0.0,
            5e-324,
            1.0,
            1.0f64.next_up(),
            f64::INFINITY,
            f64::NAN,
        ];
        assert!(in_order.is_sorted_by(|&a, &b| ranked(a) < ranked(b)));
    }
}
