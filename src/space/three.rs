//! Decompositions of 3×3 matrices by Jacobi rotations, on one element or on several side by side.
//!
//! A rotation that would change nothing is left out element by element, so that an element takes the
//! same rotations in any company. Nothing is divided by a difference of singular values or
//! eigenvalues.

use super::Lane;

/// A vector.
pub type Three<T> = [T; 3];

/// Columns of a matrix.
pub type Columns<T> = [Three<T>; 3];

#[inline(always)]
fn dot<L: Lane>(a: Three<L>, b: Three<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross<L: Lane>(a: Three<L>, b: Three<L>) -> Three<L> {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
fn scaled<L: Lane>(a: Three<L>, s: L) -> Three<L> {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
fn choose<L: Lane>(mask: L::Mask, yes: Three<L>, no: Three<L>) -> Three<L> {
    [
        yes[0].select(mask, yes[0], no[0]),
        yes[0].select(mask, yes[1], no[1]),
        yes[0].select(mask, yes[2], no[2]),
    ]
}

/// Cosine, sine and tangent of the rotation by at most 45° for which tan 2θ = 2 γ/δ; where the mask does
/// not hold, of none.
#[inline(always)]
fn rotation<L: Lane>(gamma: L, delta: L, turns: L::Mask) -> (L, L, L) {
    let (zero, one) = (gamma.lift(0.0), gamma.lift(1.0));
    let twice = gamma + gamma;
    let denominator = delta.abs() + (delta * delta + twice * twice).sqrt();
    let t = twice / denominator;
    let t = t.select(delta.lt(zero), -t, t);
    let t = t.select(turns, t, zero);
    let c = one / (one + t * t).sqrt();
    (c, c * t, t)
}

#[inline(always)]
fn rotate<L: Lane>(columns: &mut Columns<L>, p: usize, q: usize, c: L, s: L) {
    for i in 0..3 {
        let (x, y) = (columns[p][i], columns[q][i]);
        columns[p][i] = c * x - s * y;
        columns[q][i] = s * x + c * y;
    }
}

/// The identity, as wide as `like`.
#[inline(always)]
pub fn identity<L: Lane>(like: L) -> Columns<L> {
    let (zero, one) = (like.lift(0.0), like.lift(1.0));
    [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
}

const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Sweeps converge quadratically: the bound is for safety only.
const MOST_SWEEPS: usize = 12;

/// Exchanges columns p and q of both where `mask` holds, with a change of sign, so that the
/// determinants stay.
#[inline(always)]
fn exchange<L: Lane>(mask: L::Mask, p: usize, q: usize, columns: &mut Columns<L>) {
    let (a, b) = (columns[p], columns[q]);
    columns[p] = choose(mask, b, a);
    columns[q] = choose(mask, [-a[0], -a[1], -a[2]], b);
}

/// A unit vector perpendicular to the unit vector n (Duff et al. 2017).
#[inline(always)]
fn perpendicular<L: Lane>(n: Three<L>) -> Three<L> {
    let (zero, one) = (n[0].lift(0.0), n[0].lift(1.0));
    let sign = one.select(n[2].lt(zero), -one, one);
    let a = -one / (sign + n[2]);
    let b = n[0] * n[1] * a;
    [one + sign * n[0] * n[0] * a, sign * b, -(sign * n[0])]
}

/// V with its columns orthonormal again, if they nearly are: one step of V ← V (3I − VᵀV)/2.
#[inline(always)]
fn orthonormalised<L: Lane>(v: Columns<L>) -> Columns<L> {
    let half = v[0][0].lift(0.5);
    let whole = v[0][0].lift(1.5);
    let [x, y, z] = [dot(v[0], v[1]), dot(v[0], v[2]), dot(v[1], v[2])].map(
        #[inline(always)]
        |g| -(half * g),
    );
    let own = [dot(v[0], v[0]), dot(v[1], v[1]), dot(v[2], v[2])];
    let own = own.map(
        #[inline(always)]
        |g| whole - half * g,
    );
    let mut out = v;
    for i in 0..3 {
        let (a, b, c) = (v[0][i], v[1][i], v[2][i]);
        out[0][i] = a * own[0] + b * x + c * y;
        out[1][i] = a * x + b * own[1] + c * z;
        out[2][i] = a * y + b * z + c * own[2];
    }
    out
}

/// F = U diag(σ) Vᵀ with proper rotations U and V, |σ| descending, only the last negative (for an
/// inverted F): one-sided Jacobi (Hestenes 1958).
#[inline(always)]
pub fn svd<L: Lane>(f: Columns<L>) -> (Three<L>, Columns<L>, Columns<L>) {
    svd_near(f, identity(f[0][0]))
}

/// The same from a proper rotation V that is orthonormal to rounding: the nearer it is to that of F, the
/// less is to be done.
// in WebAssembly the instruction set is the module's: one copy serves all kernels
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
pub fn svd_near<L: Lane>(f: Columns<L>, v: Columns<L>) -> (Three<L>, Columns<L>, Columns<L>) {
    let zero = f[0][0].lift(0.0);
    let one = f[0][0].lift(1.0);
    // products of entries must neither vanish nor overflow
    let mut size = zero;
    for column in f {
        size = size.max(column[0].abs().max(column[1].abs()).max(column[2].abs()));
    }
    let vanishes = size.lt(zero.lift(1e-300));
    let size = one.select(vanishes, one, size);
    let inverse = one / size;
    let f = [
        scaled(f[0], inverse),
        scaled(f[1], inverse),
        scaled(f[2], inverse),
    ];
    let mut v = orthonormalised(v);
    let mut a = f;
    for j in 0..3 {
        for i in 0..3 {
            a[j][i] = f[0][i] * v[j][0] + f[1][i] * v[j][1] + f[2][i] * v[j][2];
        }
    }
    let negligible = zero.lift(1e-30);
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for (p, q) in PAIRS {
            let (alpha, beta, gamma) = (dot(a[p], a[p]), dot(a[q], a[q]), dot(a[p], a[q]));
            let turns = (negligible * alpha * beta).lt(gamma * gamma);
            if zero.any(turns) {
                turned = true;
                let (c, s, _) = rotation(gamma, beta - alpha, turns);
                rotate(&mut a, p, q, c, s);
                rotate(&mut v, p, q, c, s);
            }
        }
        if !turned {
            break;
        }
    }
    let mut squares = [dot(a[0], a[0]), dot(a[1], a[1]), dot(a[2], a[2])];
    for (p, q) in [(0, 1), (1, 2), (0, 1)] {
        let wrong = squares[p].lt(squares[q]);
        if zero.any(wrong) {
            exchange(wrong, p, q, &mut a);
            exchange(wrong, p, q, &mut v);
            let (x, y) = (squares[p], squares[q]);
            squares[p] = x.select(wrong, y, x);
            squares[q] = x.select(wrong, x, y);
        }
    }
    let (first, second) = (squares[0].sqrt(), squares[1].sqrt());
    // the direction of a column that vanishes, or does so beside the first, is free
    let tiny = zero.lift(1e-150);
    let no_first = first.lt(tiny);
    let axis = [one, zero, zero];
    let u0 = choose(no_first, axis, scaled(a[0], one / first));
    let no_second = second.lt(tiny.max(zero.lift(1e-16) * first));
    let u1 = scaled(a[1], one / second);
    // orthogonal to rounding also where the second is small
    let slip = dot(u0, u1);
    let u1 = [
        u1[0] - slip * u0[0],
        u1[1] - slip * u0[1],
        u1[2] - slip * u0[2],
    ];
    let u1 = choose(no_second, perpendicular(u0), u1);
    let u2 = cross(u0, u1);
    let last = dot(u2, a[2]);
    (scaled([first, second, last], size), [u0, u1, u2], v)
}

/// Eigenvalues, descending, and a proper rotation of eigenvectors of the symmetric matrix
/// (xx, yy, zz, xy, xz, yz): Jacobi (1846).
#[inline(always)]
pub fn eigen<L: Lane>(s: [L; 6]) -> (Three<L>, Columns<L>) {
    eigen_near(s, identity(s[0]))
}

/// The same from a proper rotation whose columns are near the eigenvectors.
// in WebAssembly the instruction set is the module's: one copy serves all kernels
#[cfg_attr(target_arch = "wasm32", inline(never))]
#[cfg_attr(not(target_arch = "wasm32"), inline(always))]
pub fn eigen_near<L: Lane>(s: [L; 6], v: Columns<L>) -> (Three<L>, Columns<L>) {
    let zero = s[0].lift(0.0);
    let mut v = v;
    let mut d = [
        bilinear(s, v[0], v[0]),
        bilinear(s, v[1], v[1]),
        bilinear(s, v[2], v[2]),
    ];
    // off-diagonal entry of each of PAIRS
    let mut o = [
        bilinear(s, v[0], v[1]),
        bilinear(s, v[0], v[2]),
        bilinear(s, v[1], v[2]),
    ];
    let negligible = zero.lift(1e-16);
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for (k, (p, q)) in PAIRS.into_iter().enumerate() {
            let size = d[0].abs().max(d[1].abs()).max(d[2].abs());
            let turns = (negligible * size).lt(o[k].abs());
            if !zero.any(turns) {
                continue;
            }
            turned = true;
            let (c, sn, t) = rotation(o[k], d[q] - d[p], turns);
            let by = t * o[k];
            d[p] = d[p] - by;
            d[q] = d[q] + by;
            o[k] = o[k].select(turns, zero, o[k]);
            // the entries that couple p and q to the third axis
            let (kp, kq) = match k {
                0 => (1, 2),
                1 => (0, 2),
                _ => (0, 1),
            };
            let (x, y) = (o[kp], o[kq]);
            o[kp] = c * x - sn * y;
            o[kq] = sn * x + c * y;
            rotate(&mut v, p, q, c, sn);
        }
        if !turned {
            break;
        }
    }
    for (p, q) in [(0, 1), (1, 2), (0, 1)] {
        let wrong = d[p].lt(d[q]);
        if zero.any(wrong) {
            exchange(wrong, p, q, &mut v);
            let (x, y) = (d[p], d[q]);
            d[p] = x.select(wrong, y, x);
            d[q] = x.select(wrong, x, y);
        }
    }
    (d, v)
}

/// Σ_k w_k x_k y_kᵀ by columns.
#[inline(always)]
pub fn sum_of_products<L: Lane>(w: Three<L>, x: Columns<L>, y: Columns<L>) -> Columns<L> {
    let x = [scaled(x[0], w[0]), scaled(x[1], w[1]), scaled(x[2], w[2])];
    let zero = w[0].lift(0.0);
    let mut out = [[zero; 3]; 3];
    for j in 0..3 {
        for i in 0..3 {
            out[j][i] = x[0][i] * y[0][j] + x[1][i] * y[1][j] + x[2][i] * y[2][j];
        }
    }
    out
}

/// xᵀ S y for the symmetric matrix (xx, yy, zz, xy, xz, yz).
#[inline(always)]
pub fn bilinear<L: Lane>(s: [L; 6], x: Three<L>, y: Three<L>) -> L {
    let sy = [
        s[0] * y[0] + s[3] * y[1] + s[4] * y[2],
        s[3] * y[0] + s[1] * y[1] + s[5] * y[2],
        s[4] * y[0] + s[5] * y[1] + s[2] * y[2],
    ];
    dot(x, sy)
}
