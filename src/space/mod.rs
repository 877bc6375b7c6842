//! Dimension as a type: what a deformation gradient, its stretch and its singular values are.
//!
//! [`Plane`] maps triangles to the plane, [`Solid`] tetrahedra to space, [`Sheet`] triangles to space. No
//! solver knows more of dimension than the trait [`Space`].

mod lane;
pub(crate) mod plane;
mod registers;
mod sheet;
mod solid;
mod three;

pub use lane::{Lane, Pack, Scalar, dispatch};
pub use plane::Plane;
pub use registers::Registers;
pub use sheet::Sheet;
pub use solid::Solid;

/// A fixed number of components, one register each.
///
/// Closures handed to these inside a kernel are marked `#[inline(always)]`, see `from_fn`.
pub trait Components<T: Copy>: Copy {
    /// How many.
    const LEN: usize;
    /// Component `i` is `f(i)`.
    fn from_fn(f: impl FnMut(usize) -> T) -> Self;
    /// Component `i`.
    fn at(&self, i: usize) -> T;
    /// All of them.
    fn as_slice(&self) -> &[T];
    /// Component by component.
    #[inline(always)]
    fn zip(self, other: Self, mut f: impl FnMut(T, T) -> T) -> Self {
        Self::from_fn(
            #[inline(always)]
            |i| f(self.at(i), other.at(i)),
        )
    }
}

impl<T: Copy, const N: usize> Components<T> for [T; N] {
    const LEN: usize = N;
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> T) -> Self {
        // not core::array::from_fn: it is not always inlined, and code that is not inlined into a
        // `pulp` dispatch is compiled without its instruction set
        if N == 0 {
            return core::array::from_fn(f);
        }
        let mut out = [f(0); N];
        let mut i = 1;
        while i < N {
            out[i] = f(i);
            i += 1;
        }
        out
    }
    #[inline(always)]
    fn at(&self, i: usize) -> T {
        self[i]
    }
    #[inline(always)]
    fn as_slice(&self) -> &[T] {
        self
    }
}

/// Simplices of dimension k (`STRETCHES`) mapped into dimension d (`DIM`).
///
/// The deformation gradient F is d×k, stored column by column; its polar decomposition is F = R S
/// with R orthonormal and *proper* where d = k, so that S carries the reflection of an inverted
/// element in its last singular value. Where d > k all singular values are ≥ 0.
pub trait Space: Copy + Send + Sync + 'static {
    /// d, the dimension of the positions.
    const DIM: usize;
    /// k, the dimension of the simplices and the number of singular values.
    const STRETCHES: usize;
    /// κ of the adaptive termination (17) of WRAPD's global step (paper §6).
    const KAPPA: f64;

    /// F, d×k, column by column.
    type Gradient<T: Copy>: Components<T>;
    /// A symmetric k×k matrix, in the space's own basis.
    type Symmetric<T: Copy>: Components<T>;
    /// Singular values or eigenvalues, largest first.
    type Sigma<T: Copy>: Components<T>;
    /// The rotation R of the polar decomposition, with what (15) needs beside it.
    type Polar<T: Copy>: Copy;
    /// Eigenvectors of a symmetric matrix.
    type Eigenframe<T: Copy>: Copy;
    /// Left and right singular vectors.
    type Singularframe<T: Copy>: Copy;

    /// Where an iterative decomposition may begin: what is kept of that of a nearby F.
    type Guess<T: Copy>: Components<T>;
    /// What one begins with where nothing is known.
    fn no_guess() -> Self::Guess<f64>;
    /// What to keep of a decomposition.
    fn guess<L: Lane>(polar: Self::Polar<L>) -> Self::Guess<L>;
    /// [`Self::polar`] from a guess.
    fn polar_near<L: Lane>(
        f: Self::Gradient<L>,
        guess: Self::Guess<L>,
    ) -> (Self::Symmetric<L>, Self::Polar<L>);
    /// What is kept beside the guess where F will be decomposed once more.
    type Kept<T: Copy>: Components<T>;
    /// That of a decomposition.
    fn keep<L: Lane>(polar: Self::Polar<L>) -> Self::Kept<L>;
    /// [`Self::polar`] of the F whose guess and rest were kept.
    fn polar_again<L: Lane>(
        f: Self::Gradient<L>,
        guess: Self::Guess<L>,
        kept: Self::Kept<L>,
    ) -> (Self::Symmetric<L>, Self::Polar<L>);
    /// [`Self::eigen`] of a matrix near S, or with eigenvectors near those of S.
    fn eigen_near<L: Lane>(
        s: Self::Symmetric<L>,
        polar: Self::Polar<L>,
    ) -> (Self::Sigma<L>, Self::Eigenframe<L>);

    /// sym(F) = S of F = R S, and R.
    fn polar<L: Lane>(f: Self::Gradient<L>) -> (Self::Symmetric<L>, Self::Polar<L>);
    /// M = F − U H Vᵀ of (15), (16): the gradient of ½‖sym(F) − P‖² with respect to F. Where
    /// σᵢ + σⱼ vanishes the quotient is left out.
    fn stretch_residual<L: Lane>(
        f: Self::Gradient<L>,
        polar: Self::Polar<L>,
        p: Self::Symmetric<L>,
    ) -> Self::Gradient<L>;
    /// Eigenvalues, largest first, and eigenvectors.
    fn eigen<L: Lane>(s: Self::Symmetric<L>) -> (Self::Sigma<L>, Self::Eigenframe<L>);
    /// The symmetric matrix with these eigenvalues.
    fn from_eigen<L: Lane>(
        values: Self::Sigma<L>,
        frame: Self::Eigenframe<L>,
    ) -> Self::Symmetric<L>;
    /// Signed singular values (a reflection is put on the last) and singular vectors.
    fn svd<L: Lane>(f: Self::Gradient<L>) -> (Self::Sigma<L>, Self::Singularframe<L>);
    /// The same of an F whose polar decomposition is known.
    #[inline(always)]
    fn svd_of_polar<L: Lane>(
        f: Self::Gradient<L>,
        _polar: Self::Polar<L>,
    ) -> (Self::Sigma<L>, Self::Singularframe<L>) {
        Self::svd(f)
    }
    /// The matrix with these singular values.
    fn from_svd<L: Lane>(sigma: Self::Sigma<L>, frame: Self::Singularframe<L>)
    -> Self::Gradient<L>;
    /// ‖S‖²_F of a symmetric matrix.
    fn symmetric_norm_squared<L: Lane>(s: Self::Symmetric<L>) -> L;
}
