//! Composite majorization of the symmetric Dirichlet energy (Shtengel, Poranne, Sorkine-Hornung, Kovalsky &
//! Lipman 2017, "Geometric Optimization via Composite Majorization").
//!
//! With the similarity part α and the anti-similarity part β of F (both linear in F, see
//! [`Plane`](crate::space::Plane)), Σ = |α| + |β| and σ = |α| − |β|, ψ = Σ² + Σ⁻² + σ² + σ⁻² is a convex function of the
//! two, and these are sums and differences of convex functions. What is convex in
//!
//! ψ_ΣΣ ∇Σ∇Σᵀ + ψ_σσ ∇σ∇σᵀ + (ψ_Σ + ψ_σ) ∇²|α| + (ψ_Σ − ψ_σ) ∇²|β|
//!
//! is kept: all but the third term where its factor is negative. The fourth never is, and neither divides by
//! |β|, which vanishes in conformal triangles:
//! (ψ_Σ − ψ_σ)/|β| = 4 + 4 (Σ² + Σσ + σ²)/(Σσ)³.
//!
//! The eigenvectors of ∇²|α| and of the rest being perpendicular, for this energy the result is its projected
//! Hessian, at a fraction of the cost.
//!
//! Along curves on which triangles turn (see [`turns`](super::turns)) a bent strip is stiffer in this than it is: what
//! is stretched across it resists a turn, what is pressed together is left out, though the two cancel. There α and β
//! turn at the rates ω = a/|α| and b/|β|, where a and b are how fast they go perpendicularly to themselves; the third
//! and the fourth term are τ a² + φ b². A triangle that turns freely, and what is done to it with it, has neither a
//! resistance τ nor one of β to a turn with α: of the two is left φ (b − |β| a/|α|)², which is positive
//! semidefinite, and the second derivative of the energy of F̂(t). The matrix is a mean of the two.

use super::curvature::{Curvature, Share, stride};
use crate::space::{Components, Lane, Pack, dispatch};
use crate::wrapd::block::{BLOCK, Block, Row, load};
use pulp::{Simd, WithSimd};

/// Entries of a triangle's matrix.
const ENTRIES: usize = 24;

/// Below this modulus a direction is not defined (nor needed).
const TINY: f64 = 1e-150;

/// Composite majorization.
pub struct CompositeMajorization;

impl Curvature for CompositeMajorization {
    fn has_negative(&self) -> bool {
        true
    }

    fn can_relax(&self) -> bool {
        true
    }

    fn fill(&self, block: &Block, count: usize, kept: f64, out: &mut [f64]) {
        let share = Share {
            resistance: 1.0,
            negative: kept,
        };
        self.fill_turning(block, &[0.0; BLOCK], count, share, out);
    }

    fn fill_turning(
        &self,
        block: &Block,
        unbalanced: &Row,
        count: usize,
        share: Share,
        out: &mut [f64],
    ) {
        debug_assert_eq!(stride(2), ENTRIES);
        dispatch(Kernel {
            block,
            unbalanced,
            count,
            share,
            out,
        });
    }
}

struct Kernel<'a> {
    block: &'a Block,
    /// ∇λ : F, see [`super::turns`].
    unbalanced: &'a Row,
    count: usize,
    share: Share,
    out: &'a mut [f64],
}

/// |z|, its inverse and the direction of z; where z vanishes 0 and any direction.
#[inline(always)]
fn polar_form<L: Lane>(z: [L; 2]) -> (L, L, [L; 2]) {
    let (zero, one) = (z[0].lift(0.0), z[0].lift(1.0));
    let modulus = (z[0] * z[0] + z[1] * z[1]).sqrt();
    let vanishes = modulus.lt(modulus.lift(TINY));
    let inverse = zero.select(vanishes, zero, modulus.recip());
    let direction = [one.select(vanishes, one, z[0] * inverse), z[1] * inverse];
    (modulus, inverse, direction)
}

/// The factors of the eigenmatrices at F (by columns): of ∇|α| and ∇|β| with themselves, of the one with the
/// other, of ∇²|α| and of ∇²|β|, of the turn of α with that of β, and the directions of α and β.
#[inline(always)]
fn factors<L: Lane>(
    [a, c, b, d]: [L; 4],
    unbalanced: L,
    [resistance, negative]: [L; 2],
) -> ([L; 5], [[L; 2]; 2]) {
    let half = a.lift(0.5);
    let alpha = [half * (a + d), half * (c - b)];
    let beta = [half * (a - d), half * (c + b)];
    let (p, inverse_p, alpha) = polar_form(alpha);
    // in a conformal triangle the two ψ'' are equal and the rest is isotropic: any direction will do
    let (r, _, beta) = polar_form(beta);
    let (large, small) = (p + r, p - r);
    let (two, four, six) = (a.lift(2.0), a.lift(4.0), a.lift(6.0));
    let (il, is) = (large.recip(), small.recip());
    let (il2, is2) = (il * il, is * is);
    // ψ'' of the two
    let (stiff_large, stiff_small) = (two + six * il2 * il2, two + six * is2 * is2);
    let push = four * p - two * (il * il2 + is * is2) - unbalanced * inverse_p;
    let flip = four + four * (large * large + large * small + small * small) * il * il2 * is * is2;
    // ∇²|β| as seen from where α has turned to
    let ratio = r * inverse_p;
    let free = (resistance - a.lift(1.0)) * flip * ratio;
    let twist = resistance * push.max(negative * push) * inverse_p - free * ratio;
    (
        [
            stiff_large + stiff_small,
            stiff_large - stiff_small,
            twist,
            flip,
            free,
        ],
        [alpha, beta],
    )
}

impl WithSimd for Kernel<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<V: Simd>(self, simd: V) {
        let Self {
            block,
            unbalanced,
            count,
            share,
            out,
        } = self;
        let share = [share.resistance, share.negative].map(|s| Pack::splat(simd, s));
        let width = Pack::<V>::WIDTH;
        let zero = Pack::splat(simd, 0.0);
        let half = Pack::splat(simd, 0.5);
        let mut lanes = [[0.0; 8]; ENTRIES];
        for at in (0..BLOCK).step_by(width) {
            if at >= count {
                break;
            }
            let f: [Pack<V>; 4] = load(simd, &block.gradient, at);
            let [area]: [Pack<V>; 1] = load(simd, &block.measure, at);
            let inverse: [Pack<V>; 4] = load(simd, &block.inverse, at);
            let (factors, [alpha, beta]) =
                factors(f, Pack::load(simd, &unbalanced[at..at + width]), share);
            let [same, cross, twist, flip, free] = factors.map(|f| area * f);
            // a vertex that moves by y changes α by y ḡ/2 and β by y g/2, as complex numbers: what y is
            // multiplied with along the directions of α and β
            let (g1, g2) = ([inverse[0], inverse[2]], [inverse[1], inverse[3]]);
            let g0 = [zero - (g1[0] + g2[0]), zero - (g1[1] + g2[1])];
            let mut along = [[[zero; 2]; 2]; 3];
            let hats = [g0, g1, g2];
            for v in 0..3 {
                let g = [half * hats[v][0], half * hats[v][1]];
                along[v][0] = [
                    g[0] * alpha[0] - g[1] * alpha[1],
                    g[0] * alpha[1] + g[1] * alpha[0],
                ];
                along[v][1] = [
                    g[0] * beta[0] + g[1] * beta[1],
                    g[0] * beta[1] - g[1] * beta[0],
                ];
            }
            let mut entry = 0;
            for u in 0..3 {
                let [a, b] = along[u];
                for &[c, d] in &along[..=u] {
                    let p = [same * c[0] + cross * d[0], same * c[1] + cross * d[1]];
                    let q = [same * d[0] + cross * c[0], same * d[1] + cross * c[1]];
                    let t = [twist * c[0] + free * d[0], twist * c[1] + free * d[1]];
                    let w = [flip * d[0] + free * c[0], flip * d[1] + free * c[1]];
                    // the perpendicular (−y, x) of each for twist and flip
                    let k = [
                        a[0] * p[0] + b[0] * q[0] + a[1] * t[1] + b[1] * w[1],
                        a[0] * p[1] + b[0] * q[1] - a[1] * t[0] - b[1] * w[0],
                        a[1] * p[0] + b[1] * q[0] - a[0] * t[1] - b[0] * w[1],
                        a[1] * p[1] + b[1] * q[1] + a[0] * t[0] + b[0] * w[0],
                    ];
                    for c in 0..4 {
                        k.at(c).store(&mut lanes[entry + c][..width]);
                    }
                    entry += 4;
                }
            }
            let target = out[at * ENTRIES..].as_chunks_mut::<ENTRIES>().0;
            for (lane, target) in target.iter_mut().take(width.min(count - at)).enumerate() {
                for (target, lanes) in target.iter_mut().zip(&lanes) {
                    *target = lanes[lane];
                }
            }
        }
    }
}
