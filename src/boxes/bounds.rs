//! Boxes along the axes.

/// All points between two corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds<const D: usize> {
    pub low: [f64; D],
    pub high: [f64; D],
}

impl<const D: usize> Bounds<D> {
    /// No point at all.
    pub const EMPTY: Self = Self {
        low: [f64::INFINITY; D],
        high: [f64::NEG_INFINITY; D],
    };

    /// With a point more.
    #[inline(always)]
    pub fn with(mut self, point: [f64; D]) -> Self {
        for i in 0..D {
            self.low[i] = self.low[i].min(point[i]);
            self.high[i] = self.high[i].max(point[i]);
        }
        self
    }

    /// Around both.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        self.with(other.low).with(other.high)
    }

    /// Larger by this on all sides, rounding included.
    #[inline(always)]
    pub fn inflated(mut self, by: f64) -> Self {
        if by > 0.0 {
            for i in 0..D {
                self.low[i] = (self.low[i] - by).next_down();
                self.high[i] = (self.high[i] + by).next_up();
            }
        }
        self
    }

    /// Have they a point in common?
    #[inline(always)]
    pub fn meets(&self, other: &Self) -> bool {
        let mut apart = false;
        for i in 0..D {
            apart |= self.low[i] > other.high[i] || other.low[i] > self.high[i];
        }
        !apart
    }
}
