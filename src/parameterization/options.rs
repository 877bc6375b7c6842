//! The options of a parameterization, as a person names them.

use crate::optim::BuildError;
use serde::{Deserialize, Serialize};

/// How the map is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Rotation-aware ADMM with dynamic reweighting (Brown & Narain 2021).
    #[default]
    Wrapd,
    /// Rotation-aware ADMM with the rest weights (the paper's R-ADMM).
    RAdmm,
    /// ADMM-PD with dynamic reweighting (the paper's W-ADMM).
    WAdmm,
    /// ADMM-PD (Overby et al. 2017).
    AdmmPd,
    /// Composite majorization (Shtengel et al. 2017); symmetric Dirichlet, injective starts.
    Cm,
    /// WRAPD to its first iterate without inverted triangles, then composite majorization.
    #[serde(rename = "wrapd+cm")]
    WrapdCm,
    /// SLIM (Rabinovich et al. 2017); injective starts for symmetric Dirichlet.
    Slim,
    /// GINI with overlap constraints (Overby, Kaufman & Narain 2021): any start, and an image whose boundary does not
    /// pass through itself.
    Gini,
    /// The same, then composite majorization, whose steps end before the boundary would meet itself.
    #[serde(rename = "gini+cm")]
    GiniCm,
    /// ARAP by local/global (Liu et al. 2008).
    Arap,
    /// Least squares conformal map (Lévy et al. 2002): direct.
    Lscm,
    /// Cotangent harmonic map to a circle: direct.
    Harmonic,
    /// Uniform-weight Tutte map to a circle: direct.
    Tutte,
}

/// The energy that is minimised, by the ADMM methods and SLIM.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum EnergyKind {
    /// ψ = σ₁² + σ₁⁻² + σ₂² + σ₂⁻²; reported as ¼ Σ A (ψ − 4) + 1, so an isometry has 1.
    #[default]
    SymmetricDirichlet,
    /// ψ = (σ₁ − 1)² + (σ₂ − 1)²; an isometry has 0.
    Arap,
}

/// Where an iterative method starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// Harmonic, and Tutte where harmonic has flips (the paper's).
    #[default]
    Automatic,
    /// Cotangent harmonic on a circle, flips and all.
    Harmonic,
    /// Tutte on a circle.
    Tutte,
    /// Least squares conformal.
    Lscm,
    /// Every vertex at a random place (from `seed`).
    Random,
    /// Every vertex at one point.
    Collapsed,
}

/// What to do with a surface that is not a disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum CutPolicy {
    /// Cut it to a disk along short seams.
    #[default]
    Cut,
    /// The same, but holes stay: only what has handles, or no boundary, is cut. Right where a hole is a hole, like
    /// the eyes of a mask; a tube that is not cut open has to stretch.
    KeepHoles,
    /// Refuse with `NotADisk`.
    Refuse,
}

/// All options of a parameterization; `Default` is the paper's choice.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase", default, deny_unknown_fields)]
pub struct ParameterizationOptions {
    /// The method.
    pub method: Method,
    /// The energy of the ADMM methods and SLIM.
    pub energy: EnergyKind,
    /// The start of the iterative methods.
    pub start: Start,
    /// What to do when the surface is not a disk.
    pub cut: CutPolicy,
    /// Stop when |ΔE|/E or |∇E| falls below this and nothing was inverted in the last two iterates.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
    /// Seed of the random start.
    pub seed: u32,
    /// How hard landmarks that are not held pull, relative to how hard the surface holds on to a vertex.
    pub landmark_stiffness: f64,
}

impl Default for ParameterizationOptions {
    fn default() -> Self {
        Self {
            method: Method::default(),
            energy: EnergyKind::default(),
            start: Start::default(),
            cut: CutPolicy::default(),
            tolerance: 1e-6,
            max_iterations: 5000,
            seed: 1,
            landmark_stiffness: 10.0,
        }
    }
}

impl ParameterizationOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// `InvalidOption` names the option.
    pub fn validate(&self) -> Result<(), BuildError> {
        if !(self.tolerance >= 0.0 && self.tolerance.is_finite()) {
            return Err(BuildError::InvalidOption {
                option: "tolerance",
                what: format!("{} is not a finite number of at least 0", self.tolerance),
            });
        }
        let stiff = self.landmark_stiffness > 0.0 && self.landmark_stiffness.is_finite();
        if !stiff {
            return Err(BuildError::InvalidOption {
                option: "landmarkStiffness",
                what: format!("{} is not a finite number above 0", self.landmark_stiffness),
            });
        }
        let majorizes = matches!(self.method, Method::Cm | Method::WrapdCm | Method::GiniCm);
        if majorizes && self.energy != EnergyKind::SymmetricDirichlet {
            return Err(BuildError::InvalidOption {
                option: "energy",
                what: "composite majorization is for symmetric-dirichlet".into(),
            });
        }
        Ok(())
    }
}
