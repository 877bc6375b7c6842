//! Vectors of two or three numbers.

/// a − b.
#[inline(always)]
pub fn sub<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// a + t b.
#[inline(always)]
pub fn add_scaled<const D: usize>(a: [f64; D], t: f64, b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|i| a[i] + t * b[i])
}

/// aᵀb.
#[inline(always)]
pub fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let mut sum = 0.0;
    for i in 0..D {
        sum += a[i] * b[i];
    }
    sum
}

/// a × b; in the plane a turned by a quarter, clockwise, whatever b is.
#[inline(always)]
pub fn normal<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    let mut n = [0.0; D];
    if D == 2 {
        (n[0], n[1]) = (a[1], -a[0]);
    } else {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            n[i] = a[j] * b[k] - a[k] * b[j];
        }
    }
    n
}

/// a of length 1, if it has a length.
#[inline(always)]
pub fn unit<const D: usize>(a: [f64; D]) -> Option<[f64; D]> {
    let length = dot(a, a).sqrt();
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}
