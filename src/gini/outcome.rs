//! How a run of the solver ended, or stands.

use super::problem::not_positive;
use super::solver::Gini;
use crate::optim::Solver;

/// Pairs of facets that meet are counted, or listed, up to here.
pub(crate) const MOST_PAIRS: usize = 1000;

/// How a run ended, or stands.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase")]
pub struct Outcome {
    /// Elements of the positions that are inverted or degenerate, by exact predicates.
    pub not_positive: Vec<u32>,
    /// Those of them all of whose vertices are pinned: no map of these pins is injective.
    pub hopeless: Vec<u32>,
    /// Signed measure of the whole image, where pins determine it and it is not positive: no map of these pins is
    /// injective.
    pub hopeless_measure: Option<f64>,
    /// The smallest signed measure of an element relative to its rest measure.
    pub smallest_measure: f64,
    /// Where overlap counts: are the positions injective as a whole? Proven by exact predicates: no element is
    /// inverted or degenerate, the boundary does not meet itself, and no part of it is inside another body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub globally_injective: Option<bool>,
    /// Where overlap counts: pairs of boundary facets that meet, up to 1000. There are none, unless the solver is wrong.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intersections: Option<usize>,
}

impl Outcome {
    /// Why no map of these pins can be injective, and which elements are not positive, in plain sentences.
    pub fn obstacles(&self) -> Vec<String> {
        let listed = |list: &[u32]| {
            let first: Vec<String> = list.iter().take(10).map(u32::to_string).collect();
            let more = if list.len() > 10 { ", …" } else { "" };
            format!("{}{more}", first.join(", "))
        };
        let mut words = Vec::new();
        if !self.hopeless.is_empty() {
            words.push(format!(
                "All vertices of these inverted elements are pinned, so that no map is injective: {}.",
                listed(&self.hopeless)
            ));
        }
        if let Some(measure) = self.hopeless_measure {
            words.push(format!(
                "The pinned boundary encloses a signed measure of {measure:.3e}, so that no map is injective."
            ));
        }
        if !self.not_positive.is_empty() {
            words.push(format!(
                "Inverted or degenerate elements: {}.",
                listed(&self.not_positive)
            ));
        }
        words
    }
}

impl<const D: usize> Gini<D> {
    /// What is known of the positions.
    pub fn outcome(&self) -> Outcome {
        self.outcome_of(self.positions())
    }

    /// The same of any positions of the vertices, vertices × dimension: where a run has gone on elsewhere.
    ///
    /// # Panics
    /// If there are fewer positions than vertices.
    pub fn outcome_of(&self, positions: &[f64]) -> Outcome {
        let x = self.by_slot(positions);
        let mut values = vec![0.0; self.elements.len()];
        self.elements.values(&x, &mut values);
        let not_positive = not_positive(D, &self.corners, positions);
        let contacts = self.contacts.as_ref();
        let intersections = contacts.map(|contacts| contacts.meeting(&x, MOST_PAIRS).len());
        let is_disjoint = || contacts.is_none_or(|contacts| contacts.overlaps(&x).is_empty());
        Outcome {
            globally_injective: intersections
                .map(|meeting| meeting == 0 && not_positive.is_empty() && is_disjoint()),
            intersections,
            not_positive,
            hopeless: self.hopeless.clone(),
            hopeless_measure: self.hopeless_measure,
            smallest_measure: self.smallest(&values),
        }
    }
}
