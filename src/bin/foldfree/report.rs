//! REPORT.json. Its keys are snake_case throughout.

use crate::failure::Failure;
use foldfree::certificate::{Certificate, SolidCertificate};
use foldfree::deformation::Deformation;
use foldfree::optim::{GiniStep, LimStep, Phase, PhaseKind, Status, StepReport};
use serde::{Serialize, Serializer};
use serde_json::Value;

/// Name and version of the program.
pub const PROGRAM: &str = concat!("foldfree ", env!("CARGO_PKG_VERSION"));

/// The report of `parameterize`.
#[derive(Debug, Serialize)]
pub struct ParameterizeReport {
    pub program: &'static str,
    pub input: String,
    /// `converged`, `max-iterations`, `stalled`.
    pub status: &'static str,
    /// What made it converge.
    pub criterion: Option<String>,
    #[serde(serialize_with = "snake_keys")]
    pub options: foldfree::parameterization::ParameterizationOptions,
    pub threads: usize,
    /// What an automatic start became.
    pub start: String,
    pub vertices: usize,
    pub triangles: usize,
    pub seam_edges: usize,
    pub notes: Vec<String>,
    /// Reading, checking, cutting, start, factorisation.
    pub read_seconds: f64,
    pub setup_seconds: f64,
    /// Seconds of all iterations.
    pub seconds: f64,
    pub iterations: Vec<Iteration>,
    #[serde(serialize_with = "snake_keys")]
    pub certificate: Certificate,
    pub certificate_seconds: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<crate::reference::Comparison>,
}

/// One iteration; 0 is the start.
#[derive(Debug, Serialize)]
pub struct Iteration {
    pub iteration: usize,
    /// Since the first iteration began.
    pub seconds: f64,
    pub energy: f64,
    pub inverted: usize,
    pub gradient_norm: f64,
    pub smallest_sigma: f64,
    pub largest_sigma: f64,
    pub lbfgs_iterations: usize,
    pub reweighted: bool,
    /// Of a method in two stages: the iteration with which the first ended, once it has.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub switched_at: Option<usize>,
    /// Of locally injective maps: α, μ, σ, and where the handles are.
    #[serde(serialize_with = "snake_keys", skip_serializing_if = "Option::is_none")]
    pub lim: Option<LimStep>,
    /// Of untangling: the quadratic problem, the polisher, and η.
    #[serde(serialize_with = "snake_keys", skip_serializing_if = "Option::is_none")]
    pub gini: Option<GiniStep>,
    /// ‖x − x*‖/‖x₀ − x*‖ against the reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position_error: Option<f64>,
    pub phases: Vec<IterationPhase>,
}

/// One phase of an iteration.
#[derive(Debug, Serialize)]
pub struct IterationPhase {
    pub kind: PhaseKind,
    pub count: u32,
    pub milliseconds: f64,
}

impl From<&StepReport> for Iteration {
    fn from(step: &StepReport) -> Self {
        let phase = |p: &Phase| IterationPhase {
            kind: p.kind,
            count: p.count,
            milliseconds: p.milliseconds,
        };
        Self {
            iteration: step.iteration,
            seconds: step.seconds,
            energy: step.energy,
            inverted: step.inverted,
            gradient_norm: step.gradient_norm,
            smallest_sigma: step.smallest_sigma,
            largest_sigma: step.largest_sigma,
            lbfgs_iterations: step.lbfgs_iterations,
            reweighted: step.reweighted,
            switched_at: step.switched_at,
            lim: step.lim,
            gini: step.gini.clone(),
            position_error: None,
            phases: step.phases.iter().map(phase).collect(),
        }
    }
}

/// What is known for certain of a deformed body.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub enum BodyCertificate {
    /// Tetrahedra.
    Solid(SolidCertificate),
    /// Triangles in their plane.
    Plane(Certificate),
}

impl BodyCertificate {
    /// Of what has an inside: none of cloth.
    pub fn of(body: &Deformation) -> Option<Self> {
        let plane = || body.certificate_in_plane().map(Self::Plane);
        body.certificate().map(Self::Solid).or_else(plane)
    }

    /// In words.
    pub fn summary(&self) -> String {
        match self {
            Self::Solid(certificate) => certificate.summary(),
            Self::Plane(certificate) => certificate.summary(),
        }
    }
}

/// The report of `deform` and of `cloth`, with their options.
#[derive(Debug, Serialize)]
pub struct DeformReport<O: Serialize> {
    pub program: &'static str,
    pub rest: String,
    pub init: String,
    /// `converged`, `max-iterations`, `stalled`.
    pub status: &'static str,
    /// What made it converge.
    pub criterion: Option<String>,
    #[serde(serialize_with = "snake_keys")]
    pub options: O,
    pub threads: usize,
    pub vertices: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tetrahedra: Option<usize>,
    pub pins: usize,
    pub targets: usize,
    pub notes: Vec<String>,
    pub setup_seconds: f64,
    /// Seconds of all iterations.
    pub seconds: f64,
    pub iterations: Vec<Iteration>,
    /// Of a solid.
    #[serde(serialize_with = "snake_keys", skip_serializing_if = "Option::is_none")]
    pub certificate: Option<BodyCertificate>,
    pub certificate_seconds: f64,
}

/// The report of `check`, on a map of a surface ([`Certificate`]) or of a solid ([`SolidCertificate`]).
#[derive(Debug, Serialize)]
pub struct CheckReport<C: Serialize> {
    pub program: &'static str,
    pub map: String,
    pub notes: Vec<String>,
    #[serde(serialize_with = "snake_keys")]
    pub certificate: C,
    pub certificate_seconds: f64,
}

/// The criterion of a converged status.
pub fn criterion(status: Status) -> Option<String> {
    match status {
        Status::Converged(criterion) => Some(name(&criterion)),
        _ => None,
    }
}

/// The kebab-case name of an enum of the library.
pub fn name(value: &impl Serialize) -> String {
    match serde_json::to_value(value) {
        Ok(Value::String(name)) => name,
        _ => String::new(),
    }
}

/// The bytes of a report. Numbers that JSON does not have (NaN, infinity) become null.
pub fn to_json(report: &impl Serialize) -> Result<Vec<u8>, Failure> {
    let mut bytes = serde_json::to_vec_pretty(report).map_err(Failure::new)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Serializes a type of the library, whose keys are camelCase, with snake_case keys.
pub fn snake_keys<T: Serialize, S: Serializer>(
    value: &T,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let value = serde_json::to_value(value).map_err(serde::ser::Error::custom)?;
    snake(value).serialize(serializer)
}

fn snake(value: Value) -> Value {
    match value {
        Value::Array(items) => items.into_iter().map(snake).collect(),
        Value::Object(fields) => fields
            .into_iter()
            .map(|(key, value)| (snake_case(&key), snake(value)))
            .collect(),
        other => other,
    }
}

fn snake_case(key: &str) -> String {
    let mut out = String::with_capacity(key.len() + 4);
    for c in key.chars() {
        if c.is_ascii_uppercase() {
            out.push('_');
        }
        out.push(c.to_ascii_lowercase());
    }
    out
}
