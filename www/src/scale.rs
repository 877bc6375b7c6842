//! Axes and numbers as a person reads them.

/// A logarithmic axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogAxis {
    low: f64,
    high: f64,
}

impl LogAxis {
    /// The axis over the positive finite values, widened to whole parts of a decade.
    pub fn over(values: impl IntoIterator<Item = f64>) -> Self {
        let (mut low, mut high) = (f64::INFINITY, 0.0f64);
        for v in values.into_iter().filter(|v| v.is_finite() && *v > 0.0) {
            (low, high) = (low.min(v), high.max(v));
        }
        if low > high {
            (low, high) = (1.0, 10.0);
        }
        let (low, mut high) = (low.log10().floor(), high.log10().ceil());
        if high - low < 1.0 {
            high = low + 1.0;
        }
        Self { low, high }
    }

    /// Where a value lies, 0 at the bottom and 1 at the top, clamped; `None` unless positive.
    pub fn position(&self, value: f64) -> Option<f32> {
        (value > 0.0)
            .then(|| (((value.log10() - self.low) / (self.high - self.low)) as f32).clamp(0.0, 1.0))
    }

    /// Powers of ten to label, at most `most` of them.
    pub fn ticks(&self, most: usize) -> Vec<f64> {
        let decades = (self.high - self.low).round() as usize;
        let stride = decades.div_ceil(most.max(1)).max(1);
        (0..=decades)
            .step_by(stride)
            .map(|k| 10f64.powi(self.low as i32 + k as i32))
            .collect()
    }
}

/// Round steps for a linear axis from 0 to `end`, at most `most` of them.
pub fn linear_ticks(end: f64, most: usize) -> Vec<f64> {
    if !(end.is_finite() && end > 0.0) {
        return vec![0.0];
    }
    let rough = end / most.max(1) as f64;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * power)
        .into_iter()
        .find(|s| *s >= rough)
        .unwrap_or(rough);
    (0..=(end / step + 1e-9) as usize)
        .map(|k| k as f64 * step)
        .collect()
}

/// A number with about `digits` significant digits, in plain notation where that is short.
pub fn number(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return if value.is_nan() {
            "–".into()
        } else {
            "∞".into()
        };
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-3..=5).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        return format!("{value:.decimals$}").replace('-', "−");
    }
    let mantissa = value / 10f64.powi(exponent);
    format!(
        "{mantissa:.*} × 10{}",
        digits.saturating_sub(1).min(2),
        superscript(exponent)
    )
    .replace('-', "−")
}

/// So many seconds with three significant digits, in milliseconds below one.
pub fn duration(seconds: f64) -> String {
    if seconds < 1.0 {
        format!("{} ms", number(1e3 * seconds, 3))
    } else {
        format!("{} s", number(seconds, 3))
    }
}

/// A tick of an axis of seconds that ends at `end`: a round number of milliseconds or of seconds.
pub fn time_tick(seconds: f64, end: f64) -> String {
    let round = |value: f64| (1e6 * value).round() / 1e6;
    match seconds {
        0.0 => "0".into(),
        _ if end < 1.0 => format!("{} ms", round(1e3 * seconds)),
        _ => format!("{} s", round(seconds)),
    }
}

/// A power of ten as a tick label.
pub fn power_of_ten(value: f64) -> String {
    let exponent = value.log10().round() as i32;
    match exponent {
        0 => "1".into(),
        1 => "10".into(),
        2 => "100".into(),
        _ => format!("10{}", superscript(exponent)),
    }
}

/// An integer in superscript digits.
pub fn superscript(n: i32) -> String {
    n.to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            digit => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
        })
        .collect()
}

/// A whole number with thin groups of three.
pub fn whole(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && digits.len() > 4 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{a0}');
        }
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_axes_hold_their_values() {
        let axis = LogAxis::over([3.0, 4500.0, f64::INFINITY, 0.0, -1.0]);
        assert_eq!(axis.ticks(8), [1.0, 10.0, 100.0, 1000.0, 10000.0]);
        assert_eq!(axis.ticks(3), [1.0, 100.0, 10000.0]);
        assert_eq!(axis.position(100.0), Some(0.5));
        assert_eq!(axis.position(0.0), None);
        assert_eq!(LogAxis::over([]).ticks(4), [1.0, 10.0]);
        assert_eq!(LogAxis::over([1.0]).position(1.0), Some(0.0));
    }

    #[test]
    fn linear_ticks_are_round() {
        assert_eq!(linear_ticks(40.0, 5), [0.0, 10.0, 20.0, 30.0, 40.0]);
        assert_eq!(linear_ticks(7.0, 4), [0.0, 2.0, 4.0, 6.0]);
        assert_eq!(linear_ticks(0.0, 4), [0.0]);
    }

    #[test]
    fn numbers_read_well() {
        let cases = [
            (1.04312, "1.043"),
            (0.0, "0"),
            (133.97, "134.0"),
            (94046.0, "94046"),
            (2.5e-7, "2.50 × 10⁻⁷"),
            (-0.5, "−0.5000"),
            (f64::INFINITY, "∞"),
        ];
        for (value, text) in cases {
            assert_eq!(number(value, 4), text);
        }
        assert_eq!(power_of_ten(1e-12), "10⁻¹²");
        assert_eq!([duration(0.0392), duration(1.5)], ["39.2 ms", "1.50 s"]);
        let ticks = |end| {
            linear_ticks(end, 4)
                .into_iter()
                .map(move |t| time_tick(t, end))
        };
        assert_eq!(ticks(0.047).collect::<Vec<_>>(), ["0", "20 ms", "40 ms"]);
        assert_eq!(ticks(0.7).next_back().as_deref(), Some("600 ms"));
        assert_eq!(ticks(3.0).collect::<Vec<_>>(), ["0", "1 s", "2 s", "3 s"]);
        assert_eq!(whole(1234), "1234");
        assert_eq!(whole(1_234_567), "1\u{a0}234\u{a0}567");
    }
}
