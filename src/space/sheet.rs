//! Triangles in space: cloth.
//!
//! A frame of the triangle's plane, two orthonormal vectors E, takes F to a 2×2 matrix: F = E G. What
//! [`Plane`] finds of G holds for F, with E before every left factor: S is the same, R = E R_G and
//! U = E U_G. So is the gradient (16): dS/dF sees only the part of dF in the plane (the normal part of
//! dF changes FᵀF in second order), therefore M = E M_G.
//!
//! E comes from Gram–Schmidt on the columns of F, so that G is upper triangular with a diagonal ≥ 0: its
//! determinant is not negative. A sheet has no inside: no triangle is ever inverted, and only one
//! that has collapsed to a segment or a point (σ₂ = 0) is counted with the inverted. There the plane is
//! not defined; some frame through the segment is taken, so that nothing is NaN and forces have a
//! direction to open the triangle in.

use super::plane::{PlanePolar, PlaneSvd, TINY};
use super::{Lane, Plane, Space};

/// Triangles (k = 2) in space (d = 3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Sheet;

/// A vector in space.
type Vector<T> = [T; 3];

/// Two orthonormal vectors: the plane of a triangle.
type Frame<T> = [Vector<T>; 2];

/// The polar decomposition of a 3×2 matrix: that of its 2×2 part, and the plane.
#[derive(Debug, Clone, Copy)]
pub struct SheetPolar<T> {
    frame: Frame<T>,
    inner: [T; 4],
    polar: PlanePolar<T>,
}

/// A part of a column below this part of it is rounding error.
const ROUNDING: f64 = 1e-15;

#[inline(always)]
fn dot<L: Lane>(x: Vector<L>, y: Vector<L>) -> L {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

#[inline(always)]
fn scaled<L: Lane>([x, y, z]: Vector<L>, by: L) -> Vector<L> {
    [x * by, y * by, z * by]
}

/// x − (x·e) e.
#[inline(always)]
fn without<L: Lane>(x: Vector<L>, e: Vector<L>) -> Vector<L> {
    let along = dot(x, e);
    [
        x[0] - along * e[0],
        x[1] - along * e[1],
        x[2] - along * e[2],
    ]
}

#[inline(always)]
fn choose<L: Lane>(mask: L::Mask, yes: Vector<L>, no: Vector<L>) -> Vector<L> {
    let pick = yes[0];
    [
        pick.select(mask, yes[0], no[0]),
        pick.select(mask, yes[1], no[1]),
        pick.select(mask, yes[2], no[2]),
    ]
}

/// A unit vector at right angles to a unit vector (Duff et al. 2017).
#[inline(always)]
fn perpendicular<L: Lane>([x, y, z]: Vector<L>) -> Vector<L> {
    let (zero, one) = (z.lift(0.0), z.lift(1.0));
    let sign = z.select(z.lt(zero), -one, one);
    let a = -(sign + z).recip();
    [one + sign * x * x * a, sign * x * y * a, -(sign * x)]
}

/// F = E G with G upper triangular, its diagonal ≥ 0.
#[inline(always)]
fn reduce<L: Lane>(f: [L; 6]) -> (Frame<L>, [L; 4]) {
    let (a, b) = ([f[0], f[1], f[2]], [f[3], f[4], f[5]]);
    let (zero, one, tiny) = (f[0].lift(0.0), f[0].lift(1.0), f[0].lift(TINY));

    let length = dot(a, a).sqrt();
    let vanishes = length.lt(tiny);
    let first = choose(vanishes, [one, zero, zero], scaled(a, length.recip()));

    let rest = without(b, first);
    let width = dot(rest, rest).sqrt();
    let noise = (f[0].lift(ROUNDING) * dot(b, b).sqrt()).max(tiny);
    let parallel = width.lt(noise);
    // a second time, for what rounding has left of `first` in a direction that is nearly parallel
    let second = without(scaled(rest, width.recip()), first);
    let second = scaled(second, dot(second, second).sqrt().recip());
    let second = choose(parallel, perpendicular(first), second);

    let inner = [
        zero.select(vanishes, zero, length),
        zero,
        dot(first, b),
        zero.select(parallel, zero, dot(second, b)),
    ];
    ([first, second], inner)
}

/// E G.
#[inline(always)]
fn lift<L: Lane>([first, second]: Frame<L>, inner: [L; 4]) -> [L; 6] {
    let mut f = [inner[0]; 6];
    for column in 0..2 {
        for i in 0..3 {
            f[3 * column + i] = first[i] * inner[2 * column] + second[i] * inner[2 * column + 1];
        }
    }
    f
}

/// Singular values of a matrix whose determinant is not negative, and vectors.
#[inline(always)]
fn svd<L: Lane>(inner: [L; 4]) -> ([L; 2], PlaneSvd<L>) {
    let ([high, low], vectors) = Plane::svd(inner);
    // rounding may leave less than nothing
    ([high, low.max(low.lift(0.0))], vectors)
}

impl Space for Sheet {
    const DIM: usize = 3;
    const STRETCHES: usize = 2;
    const KAPPA: f64 = 1.0;

    type Gradient<T: Copy> = [T; 6];
    type Symmetric<T: Copy> = [T; 3];
    type Sigma<T: Copy> = [T; 2];
    type Polar<T: Copy> = SheetPolar<T>;
    type Eigenframe<T: Copy> = [T; 2];
    type Singularframe<T: Copy> = (Frame<T>, PlaneSvd<T>);

    type Guess<T: Copy> = [T; 0];

    fn no_guess() -> [f64; 0] {
        []
    }
    #[inline(always)]
    fn guess<L: Lane>(_: Self::Polar<L>) -> [L; 0] {
        []
    }
    #[inline(always)]
    fn polar_near<L: Lane>(
        f: Self::Gradient<L>,
        _: [L; 0],
    ) -> (Self::Symmetric<L>, Self::Polar<L>) {
        Self::polar(f)
    }
    type Kept<T: Copy> = [T; 0];

    #[inline(always)]
    fn keep<L: Lane>(_: Self::Polar<L>) -> [L; 0] {
        []
    }
    #[inline(always)]
    fn polar_again<L: Lane>(
        f: Self::Gradient<L>,
        _: [L; 0],
        _: [L; 0],
    ) -> (Self::Symmetric<L>, Self::Polar<L>) {
        Self::polar(f)
    }
    #[inline(always)]
    fn eigen_near<L: Lane>(
        s: Self::Symmetric<L>,
        _: Self::Polar<L>,
    ) -> (Self::Sigma<L>, Self::Eigenframe<L>) {
        Self::eigen(s)
    }

    #[inline(always)]
    fn polar<L: Lane>(f: [L; 6]) -> ([L; 3], SheetPolar<L>) {
        let (frame, inner) = reduce(f);
        let (s, polar) = Plane::polar(inner);
        (
            s,
            SheetPolar {
                frame,
                inner,
                polar,
            },
        )
    }

    #[inline(always)]
    fn stretch_residual<L: Lane>(_: [L; 6], polar: SheetPolar<L>, p: [L; 3]) -> [L; 6] {
        let m = Plane::stretch_residual(polar.inner, polar.polar, p);
        lift(polar.frame, m)
    }

    #[inline(always)]
    fn eigen<L: Lane>(s: [L; 3]) -> ([L; 2], [L; 2]) {
        Plane::eigen(s)
    }

    #[inline(always)]
    fn from_eigen<L: Lane>(values: [L; 2], direction: [L; 2]) -> [L; 3] {
        Plane::from_eigen(values, direction)
    }

    #[inline(always)]
    fn svd<L: Lane>(f: [L; 6]) -> ([L; 2], (Frame<L>, PlaneSvd<L>)) {
        let (frame, inner) = reduce(f);
        let (sigma, vectors) = svd(inner);
        (sigma, (frame, vectors))
    }

    #[inline(always)]
    fn svd_of_polar<L: Lane>(_: [L; 6], polar: SheetPolar<L>) -> ([L; 2], (Frame<L>, PlaneSvd<L>)) {
        let (sigma, vectors) = svd(polar.inner);
        (sigma, (polar.frame, vectors))
    }

    #[inline(always)]
    fn from_svd<L: Lane>(sigma: [L; 2], (frame, vectors): (Frame<L>, PlaneSvd<L>)) -> [L; 6] {
        lift(frame, Plane::from_svd(sigma, vectors))
    }

    #[inline(always)]
    fn symmetric_norm_squared<L: Lane>(s: [L; 3]) -> L {
        Plane::symmetric_norm_squared(s)
    }
}
