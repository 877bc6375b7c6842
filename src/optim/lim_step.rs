//! What a step of a locally injective map has beside that of other methods.

/// The parameters of a step, all of a body scaled to a measure (area or volume) of 1, so that units do not
/// matter. The report's energy is that of the deformation alone.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct LimStep {
    /// α, how hard handles are led to their targets.
    pub alpha: f64,
    /// μ, what the diagonal needed to be positive definite; 0: nothing.
    pub mu: f64,
    /// σ, the part of the step that was taken; 0: none.
    pub sigma: f64,
    /// The part 1/(1 + μ²) of the way to their targets that the handles were led.
    pub sub_step: f64,
    /// The barrier's energy, β Σ φ.
    pub barrier: f64,
    /// The largest distance of a handle from its target.
    pub positional_error: f64,
    /// Handles that are at their targets, and held there.
    pub arrived: usize,
    /// All handles.
    pub handles: usize,
}
