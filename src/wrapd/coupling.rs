//! What the local variable Z of an element is coupled to: its stretch sym(F) (8) or F itself (2).

use crate::space::{Components, Lane, Space};

/// The coupling constraint C(X, Z) = local(F) − Z of the ADMM splitting.
pub trait Coupling<S: Space>: Copy + Send + Sync + 'static {
    /// Z, U and P live here.
    type Local<T: Copy>: Components<T>;
    /// What `local` finds on the way and `residual` needs.
    type Aux<L: Copy>: Copy;
    /// Singular vectors of a local variable.
    type Frame<L: Copy>: Copy;
    /// Is the global step a single linear solve?
    const LINEAR: bool;

    /// Where the decomposition of the next F begins.
    type Guess<T: Copy>: Components<T>;
    /// The first of them.
    fn no_guess() -> Self::Guess<f64>;
    /// What to keep.
    fn guess<L: Lane>(aux: Self::Aux<L>) -> Self::Guess<L>;

    /// The local coordinates of a deformation gradient.
    fn local<L: Lane>(f: S::Gradient<L>, guess: Self::Guess<L>) -> (Self::Local<L>, Self::Aux<L>);
    /// What is kept beside the guess where `local` will be asked for once more.
    type Kept<T: Copy>: Components<T>;
    /// That of a decomposition.
    fn keep<L: Lane>(aux: Self::Aux<L>) -> Self::Kept<L>;
    /// The same once more for an F whose guess and rest were kept.
    fn local_again<L: Lane>(
        f: S::Gradient<L>,
        guess: Self::Guess<L>,
        kept: Self::Kept<L>,
    ) -> (Self::Local<L>, Self::Aux<L>);
    /// Singular values (or eigenvalues) and vectors of a local variable near that of `aux`.
    fn spectrum<L: Lane>(z: Self::Local<L>, aux: Self::Aux<L>) -> (S::Sigma<L>, Self::Frame<L>);
    /// The local variable with these values.
    fn compose<L: Lane>(values: S::Sigma<L>, frame: Self::Frame<L>) -> Self::Local<L>;
    /// ‖Z‖²_F.
    fn norm_squared<L: Lane>(z: Self::Local<L>) -> L;
    /// Singular values and vectors of F itself.
    fn svd<L: Lane>(f: S::Gradient<L>, aux: Self::Aux<L>) -> (S::Sigma<L>, S::Singularframe<L>);
    /// The gradient of ½‖local(F) − P‖² with respect to F (16).
    fn residual<L: Lane>(f: S::Gradient<L>, aux: Self::Aux<L>, p: Self::Local<L>)
    -> S::Gradient<L>;
}

/// Z = sym(F) (8): rotations are left to the global step.
#[derive(Debug, Clone, Copy, Default)]
pub struct RotationAware;

impl<S: Space> Coupling<S> for RotationAware {
    type Local<T: Copy> = S::Symmetric<T>;
    type Aux<L: Copy> = S::Polar<L>;
    type Frame<L: Copy> = S::Eigenframe<L>;
    const LINEAR: bool = false;

    type Guess<T: Copy> = S::Guess<T>;

    fn no_guess() -> S::Guess<f64> {
        S::no_guess()
    }
    #[inline(always)]
    fn guess<L: Lane>(polar: S::Polar<L>) -> S::Guess<L> {
        S::guess(polar)
    }
    #[inline(always)]
    fn local<L: Lane>(f: S::Gradient<L>, guess: S::Guess<L>) -> (S::Symmetric<L>, S::Polar<L>) {
        S::polar_near(f, guess)
    }

    type Kept<T: Copy> = S::Kept<T>;

    #[inline(always)]
    fn keep<L: Lane>(polar: S::Polar<L>) -> S::Kept<L> {
        S::keep(polar)
    }
    #[inline(always)]
    fn local_again<L: Lane>(
        f: S::Gradient<L>,
        guess: S::Guess<L>,
        kept: S::Kept<L>,
    ) -> (S::Symmetric<L>, S::Polar<L>) {
        S::polar_again(f, guess, kept)
    }
    #[inline(always)]
    fn spectrum<L: Lane>(
        z: S::Symmetric<L>,
        polar: S::Polar<L>,
    ) -> (S::Sigma<L>, S::Eigenframe<L>) {
        S::eigen_near(z, polar)
    }
    #[inline(always)]
    fn compose<L: Lane>(values: S::Sigma<L>, frame: S::Eigenframe<L>) -> S::Symmetric<L> {
        S::from_eigen(values, frame)
    }
    #[inline(always)]
    fn norm_squared<L: Lane>(z: S::Symmetric<L>) -> L {
        S::symmetric_norm_squared(z)
    }
    #[inline(always)]
    fn svd<L: Lane>(f: S::Gradient<L>, polar: S::Polar<L>) -> (S::Sigma<L>, S::Singularframe<L>) {
        S::svd_of_polar(f, polar)
    }
    #[inline(always)]
    fn residual<L: Lane>(
        f: S::Gradient<L>,
        polar: S::Polar<L>,
        p: S::Symmetric<L>,
    ) -> S::Gradient<L> {
        S::stretch_residual(f, polar, p)
    }
}

/// Z = F (2): ADMM-PD.
#[derive(Debug, Clone, Copy, Default)]
pub struct Linear;

impl<S: Space> Coupling<S> for Linear {
    type Local<T: Copy> = S::Gradient<T>;
    type Aux<L: Copy> = ();
    type Frame<L: Copy> = S::Singularframe<L>;
    const LINEAR: bool = true;

    type Guess<T: Copy> = [T; 0];

    fn no_guess() -> [f64; 0] {
        []
    }
    #[inline(always)]
    fn guess<L: Lane>(_: ()) -> [L; 0] {
        []
    }
    #[inline(always)]
    fn local<L: Lane>(f: S::Gradient<L>, _: [L; 0]) -> (S::Gradient<L>, ()) {
        (f, ())
    }

    type Kept<T: Copy> = [T; 0];

    #[inline(always)]
    fn keep<L: Lane>(_: ()) -> [L; 0] {
        []
    }
    #[inline(always)]
    fn local_again<L: Lane>(f: S::Gradient<L>, _: [L; 0], _: [L; 0]) -> (S::Gradient<L>, ()) {
        (f, ())
    }
    #[inline(always)]
    fn spectrum<L: Lane>(z: S::Gradient<L>, _: ()) -> (S::Sigma<L>, S::Singularframe<L>) {
        S::svd(z)
    }
    #[inline(always)]
    fn compose<L: Lane>(values: S::Sigma<L>, frame: S::Singularframe<L>) -> S::Gradient<L> {
        S::from_svd(values, frame)
    }
    #[inline(always)]
    fn norm_squared<L: Lane>(z: S::Gradient<L>) -> L {
        let mut sum = z.at(0) * z.at(0);
        for i in 1..S::Gradient::<L>::LEN {
            sum = sum + z.at(i) * z.at(i);
        }
        sum
    }
    #[inline(always)]
    fn svd<L: Lane>(f: S::Gradient<L>, _: ()) -> (S::Sigma<L>, S::Singularframe<L>) {
        S::svd(f)
    }
    #[inline(always)]
    fn residual<L: Lane>(f: S::Gradient<L>, _: (), p: S::Gradient<L>) -> S::Gradient<L> {
        f.zip(
            p,
            #[inline(always)]
            |f, p| f - p,
        )
    }
}
