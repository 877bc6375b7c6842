//! What may be changed while a solver runs: where pinned vertices are, and springs on free ones.

use super::{SolveError, Solver};

/// Pulls a vertex to a point: adds k/2 ‖x − target‖² to the raw energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// The vertex.
    pub vertex: u32,
    /// k > 0, energy per squared length.
    pub stiffness: f64,
    /// Where it pulls to; the first `dimension` coordinates count.
    pub target: [f64; 3],
}

/// A per-element field of a deformation. All are infinite where an element is inverted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Field {
    /// The symmetric Dirichlet density relative to that of an isometry (1: undeformed).
    #[default]
    Distortion,
    /// max(σ₁, 1/σ_k) (1: undeformed).
    Stretch,
    /// Von Mises' equivalent of the Cauchy stress, in the unit of the material's moduli (0:
    /// undeformed).
    Stress,
}

/// A solver whose handles can be moved between steps.
pub trait Deformer: Solver {
    /// Moves pinned vertices (`positions`: vertex and point) and replaces all springs. The iterate and
    /// what was learned of it are kept, the status goes back to running, and the most iterations are counted from here. The matrix is factored again
    /// only when springs come, go or change their stiffness.
    ///
    /// # Errors
    /// [`SolveError::NotPositiveDefinite`] if what is left holds nothing in place.
    ///
    /// # Panics
    /// If a vertex to be moved is not pinned, or a spring's vertex is: callers know their pins.
    fn retarget(
        &mut self,
        positions: &[(u32, [f64; 3])],
        springs: &[Spring],
    ) -> Result<(), SolveError>;
    /// A field at the newest iterate, one value an element, in the input's order.
    fn field(&self, field: Field) -> Vec<f32>;
    /// Where the last step led pinned vertices that are not yet where they are wanted, of methods that bring
    /// them there step by step: vertex and point.
    fn sub_targets(&self) -> Vec<(u32, [f64; 3])> {
        Vec::new()
    }
}
