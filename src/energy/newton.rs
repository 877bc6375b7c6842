//! Newton's method for the prox of an energy that couples the three σ.

use crate::space::{Lane, Solid, Space};

/// ψ, its gradient and its Hessian (xx, yy, zz, xy, xz, yz) at some σ.
pub(super) type Expansion<L> = (L, [L; 3], [L; 6]);

/// Most Newton steps of a prox: for safety only.
const MOST_STEPS: u32 = 50;

/// Which σ of the minimum are to be positive.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Signs {
    /// All of them, whatever p; for p ≥ 0.
    Positive,
    /// The first two: ψ depends on the sign of J alone, and J is positive again where two are negative.
    /// p is sorted, largest first.
    Signed,
}

/// argmin_z ψ(z) + k/2 ‖z − p‖² over the z with these signs, and the number of steps: Newton's method,
/// the eigenvalues' signs dropped where the Hessian is not definite, and Armijo's rule.
///
/// It begins at the better of `warm` and |p|, and ends in a minimum downhill from there.
#[inline(always)]
pub(super) fn prox<L: Lane>(
    p: [L; 3],
    k: L,
    warm: [L; 3],
    signs: Signs,
    energy: impl Fn([L; 3]) -> Expansion<L>,
) -> ([L; 3], u32) {
    let (zero, half) = (k.lift(0.0), k.lift(0.5));
    // else p is itself as signed singular values are, and so is the nearest to it of all that are
    // equivalent to some z
    let askew = p[1].lt(p[2].abs());
    // the better of the two: the target without its reflection, and where it was
    let tiny = k.lift(1e-6);
    let target = [
        p[0].abs().max(tiny),
        p[1].abs().max(tiny),
        p[2].abs().max(tiny),
    ];
    let (there, ..) = augmented(&energy, target, p, k);
    let (here, ..) = augmented(&energy, warm, p, k);
    let mut s = keep(zero.lt(there - here), warm, target);
    let (mut value, mut gradient, mut hessian) = augmented(&energy, s, p, k);
    let mut count = 0;
    loop {
        count += 1;
        let d = direction(hessian, gradient, k.lift(1e-3) * k);
        let size = s[0].abs().max(s[1].abs()).max(s[2].abs());
        let step = d[0].abs().max(d[1].abs()).max(d[2].abs());
        // quadratic convergence: what is left after this step is of the order of its square
        let moving = (k.lift(1e-8) * (size + k.lift(1e-8))).lt(step);
        let going = s[0].any(moving) && count < MOST_STEPS;
        let slope = gradient[0] * d[0] + gradient[1] * d[1] + gradient[2] * d[2];
        // a step ends before a σ that must stay positive vanishes
        let mut t = k.lift(1.0);
        for i in 0..3 {
            let back = -d[i];
            let reach = k.lift(0.9) * s[i] / back;
            let reach = t.min(zero.select(zero.lt(back), reach, t));
            t = match (signs, i) {
                (Signs::Positive, _) => reach,
                (Signs::Signed, 2) => t,
                (Signs::Signed, _) => zero.select(askew, reach, t),
            };
        }
        let mut next;
        let mut halvings = 0;
        loop {
            next = [s[0] + t * d[0], s[1] + t * d[1], s[2] + t * d[2]];
            if signs == Signs::Signed {
                next = keep(askew, next, sorted(next));
            }
            let (trial, g, h) = augmented(&energy, next, p, k);
            let rounding = k.lift(1e-15) * (value.abs() + k * size * size);
            let bound = value + k.lift(1e-4) * t * slope + rounding;
            // only who still moves has to descend: at the minimum rounding decides
            let fails = zero.lt(zero.select(moving, trial - bound, zero));
            halvings += 1;
            if !zero.any(fails) || halvings == 30 {
                (value, gradient, hessian) = match going {
                    true => (
                        zero.select(moving, trial, value),
                        keep(moving, g, gradient),
                        keep(moving, h, hessian),
                    ),
                    false => (value, gradient, hessian),
                };
                break;
            }
            t = zero.select(fails, half * t, t);
        }
        if !going {
            return (next, count);
        }
        // who has arrived waits with the last step undone, and takes it at the end
        s = keep(moving, next, s);
    }
}

/// ψ(s) + k/2 ‖s − p‖² and its derivatives.
#[inline(always)]
fn augmented<L: Lane>(
    energy: &impl Fn([L; 3]) -> Expansion<L>,
    s: [L; 3],
    p: [L; 3],
    k: L,
) -> Expansion<L> {
    let (value, mut gradient, mut hessian) = energy(s);
    let away = [s[0] - p[0], s[1] - p[1], s[2] - p[2]];
    let distance = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
    for i in 0..3 {
        gradient[i] = gradient[i] + k * away[i];
        hessian[i] = hessian[i] + k;
    }
    (value + k.lift(0.5) * k * distance, gradient, hessian)
}

/// The solution of H d = −g, where the symmetric H (xx, yy, zz, xy, xz, yz) is made definite by taking
/// its eigenvalues without their signs, and at least `least`.
#[inline(always)]
fn direction<L: Lane>(h: [L; 6], g: [L; 3], least: L) -> [L; 3] {
    // L D Lᵀ; its pivots say whether H is definite
    let d0 = h[0];
    let (l1, l2) = (h[3] / d0, h[4] / d0);
    let d1 = h[1] - l1 * h[3];
    let cross = h[5] - l1 * h[4];
    let l3 = cross / d1;
    let d2 = h[2] - l2 * h[4] - l3 * cross;
    let y1 = g[1] - l1 * g[0];
    let y2 = g[2] - l2 * g[0] - l3 * y1;
    let z2 = -y2 / d2;
    let z1 = -y1 / d1 - l3 * z2;
    let z0 = -g[0] / d0 - l1 * z1 - l2 * z2;
    let lowest = d0.min(d1).min(d2);
    let definite = least.lt(lowest);
    let zero = least.lift(0.0);
    if !least.any(zero.lt(least.select(definite, zero, least))) {
        return [z0, z1, z2];
    }
    let (values, v) = Solid::eigen(h);
    let mut d = [zero; 3];
    for k in 0..3 {
        let along = v[k][0] * g[0] + v[k][1] * g[1] + v[k][2] * g[2];
        let step = along / values[k].abs().max(least);
        for i in 0..3 {
            d[i] = d[i] - step * v[k][i];
        }
    }
    [
        zero.select(definite, z0, d[0]),
        zero.select(definite, z1, d[1]),
        zero.select(definite, z2, d[2]),
    ]
}

/// A symmetric matrix (xx, yy, zz, xy, xz, yz) in full.
pub(super) fn square([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [[f64; 3]; 3] {
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
}

/// The signed singular values of diag(z): |z| sorted, with the sign of z₁z₂z₃ on the last.
#[inline(always)]
fn sorted<L: Lane>(z: [L; 3]) -> [L; 3] {
    let zero = z[0].lift(0.0);
    let [a, b, c] = [z[0].abs(), z[1].abs(), z[2].abs()];
    let (a, b) = (a.max(b), a.min(b));
    let (b, c) = (b.max(c), b.min(c));
    let (a, b) = (a.max(b), a.min(b));
    let mut last = c;
    for z in z {
        last = zero.select(z.lt(zero), -last, last);
    }
    [a, b, last]
}

#[inline(always)]
fn keep<L: Lane, const N: usize>(mask: L::Mask, yes: [L; N], no: [L; N]) -> [L; N] {
    let mut out = no;
    for i in 0..N {
        out[i] = yes[i].select(mask, yes[i], no[i]);
    }
    out
}
