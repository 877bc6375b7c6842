//! What a step of a globally injective map has beside that of other methods.

/// One iteration of the polisher.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct PolishStep {
    /// Elements that are inverted or flat before it, in floating point.
    pub inverted: usize,
    /// Constraints below their η before it.
    pub violated: usize,
    /// Zones of constraints that it worked on.
    pub zones: usize,
    /// Pairs of the boundary that collide between x and x̂ before it, where overlap counts.
    #[serde(default)]
    pub collisions: usize,
}

/// What a step did. Measures are relative to those at rest.
#[derive(Debug, Clone, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct GiniStep {
    /// Constraints of the quadratic problem, and how many of them are active in its solution.
    pub constraints: usize,
    /// See `constraints`.
    pub active: usize,
    /// Iterations of L-BFGS-B.
    pub qp_iterations: usize,
    /// Inverted or flat elements of x̄ after the global step, in floating point.
    pub inverted_iterate: usize,
    /// The polisher's iterations.
    pub polish: Vec<PolishStep>,
    /// How long they took, in milliseconds; they are part of the step's phase `evaluate`.
    pub polish_milliseconds: f64,
    /// Did x move, to x̂ or a part of the way there?
    pub accepted: bool,
    /// Did x move to x̂?
    #[serde(default)]
    pub reached: bool,
    /// The smallest signed measure of an element of x, relative to its rest measure.
    pub smallest_measure: f64,
    /// The least η of an element, and the η that elements begin with, relative to the rest measure.
    pub least_offset: f64,
    /// See `least_offset`.
    pub first_offset: f64,
    /// Elements whose η is smaller than that.
    pub reduced_offsets: usize,
    /// Contacts among the constraints when the polisher ended, where overlap counts.
    #[serde(default)]
    pub contacts: usize,
    /// How long finding collisions took, in milliseconds; part of `polish_milliseconds`.
    #[serde(default)]
    pub collision_milliseconds: f64,
}
