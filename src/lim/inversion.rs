//! The determinant of the Jacobian F (column by column), and the barrier on it with its derivatives.

use super::barrier::Barrier;
use crate::energy::hessian::Square;
use crate::space::{Components, Space};

/// Adds β times the Hessian of φ(det F) (paper, appendix (2)): φ″ c cᵀ + φ′ ∂²det, c the cofactors.
pub fn add_barrier<S: Space>(barrier: &Barrier, beta: f64, f: S::Gradient<f64>, h: &mut Square) {
    let k = S::STRETCHES;
    let (j, c) = determinant::<S>(f);
    let value = barrier.at(j);
    if !(value.curvature > 0.0) {
        return;
    }
    let (slope, curvature) = (beta * value.slope, beta * value.curvature);
    for a in 0..k * k {
        for b in 0..k * k {
            h[a][b] += curvature * c.at(a) * c.at(b);
        }
    }
    if k == 2 {
        for (a, b, sign) in [(0, 3, 1.0), (1, 2, -1.0)] {
            h[a][b] += sign * slope;
            h[b][a] += sign * slope;
        }
        return;
    }
    // the cofactors of column p are fq × fr: with respect to column q that is −[fr]×
    for p in 0..3 {
        let (q, r) = ((p + 1) % 3, (p + 2) % 3);
        for i in 0..3 {
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            for (to, component, sign) in [(next, last, 1.0), (last, next, -1.0)] {
                let entry = sign * slope * f.at(3 * r + component);
                h[3 * p + i][3 * q + to] += entry;
                h[3 * q + to][3 * p + i] += entry;
            }
        }
    }
}

/// det F and its derivative, the cofactors.
#[inline(always)]
pub fn determinant<S: Space>(f: S::Gradient<f64>) -> (f64, S::Gradient<f64>) {
    if S::STRETCHES == 2 {
        let signs = [1.0, -1.0, -1.0, 1.0];
        let cofactors = S::Gradient::from_fn(
            #[inline(always)]
            |c| signs[c] * f.at(3 - c),
        );
        return (f.at(0) * f.at(3) - f.at(1) * f.at(2), cofactors);
    }
    let cofactors = S::Gradient::from_fn(
        #[inline(always)]
        |c| {
            let (p, i) = (c / 3, c % 3);
            let (q, r) = (3 * ((p + 1) % 3), 3 * ((p + 2) % 3));
            let (next, last) = ((i + 1) % 3, (i + 2) % 3);
            f.at(q + next) * f.at(r + last) - f.at(q + last) * f.at(r + next)
        },
    );
    let j = f.at(0) * cofactors.at(0) + f.at(1) * cofactors.at(1) + f.at(2) * cofactors.at(2);
    (j, cofactors)
}
