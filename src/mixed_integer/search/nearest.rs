//! Rounding that does not depend on the last bit: ties inside a small band go one way.

/// Half-width of the band: far above rounding errors, far below what an energy could notice.
const BAND: f64 = 1e-7;

/// The nearest integer; halves, and what is 1e-7 below them, upwards.
pub fn nearest(x: f64) -> f64 {
    (x + 0.5 + BAND).floor()
}

/// What greedy compares: the distance to the nearest integer in steps of 1e-7, so that distances that
/// differ by rounding errors are equal, and the number decides.
pub fn preference(x: f64) -> u32 {
    ((x - nearest(x)).abs() / BAND).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_go_up_whatever_their_last_bit() {
        for x in [0.5, 0.5 - 1e-12, 0.5 + 1e-12] {
            assert_eq!(nearest(x), 1.0);
            assert_eq!(nearest(x - 1.0), 0.0);
            assert_eq!(preference(x), 5_000_000);
        }
        assert_eq!(nearest(0.4999), 0.0);
        assert_eq!(nearest(-0.6), -1.0);
    }
}
