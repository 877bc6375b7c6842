//! What a locally injective map is to minimise, and how.

use crate::optim::BuildError;

/// The deformation energy, of a body scaled to a measure (area or volume) of 1: the sum over the elements with
/// their share A of it, unless said otherwise. J is the Jacobian of the map, u its displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum LimEnergy {
    /// ½ Σ A ‖J − R‖², R the rotation nearest to J (Sorkine & Alexa 2007).
    #[default]
    Arap,
    /// Σ A min ‖J − S‖² over the similarities S: in the plane that of least-squares conformal maps,
    /// ½ Σ A ((J₁₁ − J₂₂)² + (J₁₂ + J₂₁)²) (Lévy et al. 2002), and the same for tetrahedra.
    Lscm,
    /// ½ Σ A ‖∇u‖².
    Dirichlet,
    /// ½ uᵀ L M⁻¹ L u with the cotangent Laplacian L and the vertices' shares M of the measure.
    Laplacian,
    /// ½ Σ ‖uᵢ − mean of the neighbours' u‖² over the vertices.
    UniformLaplacian,
    /// Σ ‖JᵀJ − I‖² over the elements, large or small.
    GreenStrain,
}

impl LimEnergy {
    /// All, in the order of [`Self::NAMES`].
    pub const ALL: [Self; 6] = [
        Self::Arap,
        Self::Lscm,
        Self::Dirichlet,
        Self::Laplacian,
        Self::UniformLaplacian,
        Self::GreenStrain,
    ];
    /// The names on the command line and in JavaScript; the first is the default.
    pub const NAMES: [&str; 6] = [
        "arap",
        "lscm",
        "dirichlet",
        "laplacian",
        "uniform-laplacian",
        "green-strain",
    ];

    /// The energy of this name.
    pub fn named(name: &str) -> Option<Self> {
        let place = Self::NAMES.iter().position(|&known| known == name)?;
        Some(Self::ALL[place])
    }

    /// β of (2) where none is chosen: 0.01, and 100 for Green strain, whose values are so much larger.
    pub fn barrier_weight(self) -> f64 {
        match self {
            Self::GreenStrain => 100.0,
            _ => 0.01,
        }
    }
}

/// Where the second derivatives of a step come from, and how they are made positive definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum LimHessian {
    /// The paper's: of energies with rotations in them (ARAP, and LSCM of tetrahedra) as if these stayed as they are
    /// (appendix (13)), of all others and of the barrier exact; with μ and sub-steps where that is indefinite.
    Frozen,
    /// Those of energy and barrier with all, a half or nothing of what is negative in them, element by element
    /// (Smith, de Goes & Kim 2019): the first that is definite. The last always is, so that no μ is needed.
    #[default]
    Projected,
}

/// Options of [`super::Lim`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "camelCase", default)]
pub struct LimOptions {
    /// The deformation energy.
    pub energy: LimEnergy,
    /// Is there a barrier against inversion (2)? Without it elements may invert.
    pub barrier: bool,
    /// β of (2), > 0; none: that of the energy.
    #[cfg_attr(target_arch = "wasm32", tsify(optional))]
    pub barrier_weight: Option<f64>,
    /// Γ: the barrier acts on elements below this part of their rest measure, in (0, 1].
    pub barrier_reach: f64,
    /// Second derivatives.
    pub hessian: LimHessian,
    /// How hard targets pull at vertices that are not held, relative to how hard the body holds on to the vertex
    /// at rest, > 0.
    pub target_stiffness: f64,
    /// Stop when all handles have arrived and the decrease that a full step promises, relative to the energy,
    /// is below this.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
}

impl Default for LimOptions {
    fn default() -> Self {
        Self {
            energy: LimEnergy::default(),
            barrier: true,
            barrier_weight: None,
            barrier_reach: 1.0,
            hessian: LimHessian::default(),
            target_stiffness: 10.0,
            tolerance: 1e-8,
            max_iterations: 2000,
        }
    }
}

impl LimOptions {
    /// β, 0 without barrier.
    pub fn beta(&self) -> f64 {
        let weight = self.barrier_weight;
        match self.barrier {
            true => weight.unwrap_or(self.energy.barrier_weight()),
            false => 0.0,
        }
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn validate(&self) -> Result<(), BuildError> {
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let weight = self.barrier_weight.is_none_or(positive);
        let reach = self.barrier_reach > 0.0 && self.barrier_reach <= 1.0;
        let tolerance = self.tolerance >= 0.0 && self.tolerance.is_finite();
        let checks = [
            ("barrierWeight", weight, "must be finite and positive"),
            ("barrierReach", reach, "must be above 0 and at most 1"),
            (
                "targetStiffness",
                positive(self.target_stiffness),
                "must be finite and positive",
            ),
            ("tolerance", tolerance, "must be finite and not negative"),
        ];
        match checks.into_iter().find(|(_, fits, _)| !fits) {
            Some((option, _, what)) => Err(BuildError::InvalidOption {
                option,
                what: what.into(),
            }),
            None => Ok(()),
        }
    }
}
