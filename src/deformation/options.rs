//! What a deformation is to be like.

use crate::lim::{LimEnergy, LimOptions};
use crate::optim::BuildError;

/// The elastic energy of a solid.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(tag = "energy", rename_all = "kebab-case")]
pub enum Material {
    /// Neo-Hookean elasticity.
    NeoHookean {
        /// Young's modulus, > 0, in any unit of pressure.
        young: f64,
        /// Poisson's ratio, below 0.5.
        poisson: f64,
    },
    /// Stable neo-Hookean elasticity (Smith, de Goes & Kim 2018).
    StableNeoHookean {
        /// As that of neo-Hookean.
        young: f64,
        /// As that of neo-Hookean.
        poisson: f64,
    },
    /// St. Venant–Kirchhoff elasticity: for large turns and small strains.
    StVenantKirchhoff {
        /// As that of neo-Hookean.
        young: f64,
        /// As that of neo-Hookean.
        poisson: f64,
    },
    /// As rigid as possible.
    Arap,
    /// Symmetric Dirichlet: a barrier against inversion.
    SymmetricDirichlet,
    /// Dirichlet: the harmonic map of the pins.
    Dirichlet,
}

impl Material {
    /// The names on the command line and in JavaScript; the first is the default.
    pub const NAMES: [&str; 6] = [
        "neo-hookean",
        "stable-neo-hookean",
        "st-venant-kirchhoff",
        "arap",
        "symmetric-dirichlet",
        "dirichlet",
    ];
    /// Young's modulus of the paper's quasi-static examples.
    pub const YOUNG: f64 = 1e7;
    /// Poisson's ratio of the paper's quasi-static examples.
    pub const POISSON: f64 = 0.45;

    /// The material of this name, with these moduli if it has any.
    pub fn named(name: &str, young: f64, poisson: f64) -> Option<Self> {
        Some(match name {
            "neo-hookean" => Self::NeoHookean { young, poisson },
            "stable-neo-hookean" => Self::StableNeoHookean { young, poisson },
            "st-venant-kirchhoff" => Self::StVenantKirchhoff { young, poisson },
            "dirichlet" => Self::Dirichlet,
            "arap" => Self::Arap,
            "symmetric-dirichlet" => Self::SymmetricDirichlet,
            _ => return None,
        })
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::NeoHookean {
            young: Self::YOUNG,
            poisson: Self::POISSON,
        }
    }
}

/// How the energy is minimised: the four curves of the paper's figure 4, and one beside them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
#[serde(rename_all = "kebab-case")]
pub enum DeformationMethod {
    /// Rotation-aware, with dynamic reweighting.
    Wrapd,
    /// Rotation-aware, with rest weights.
    RAdmm,
    /// With dynamic reweighting only.
    WAdmm,
    /// Neither (Overby et al. 2017).
    AdmmPd,
    /// L-BFGS that begins with the Laplacian (Liu, Bouaziz & Kavan 2017).
    #[serde(rename = "l-bfgs")]
    Lbfgs,
    /// Newton's method with the projected Hessian (Teran et al. 2005; Smith, de Goes & Kim 2019). Solids only.
    Newton,
    /// WRAPD to its first iterate without inverted elements, then Newton's method. Solids only.
    #[serde(rename = "wrapd+newton")]
    WrapdNewton,
    /// Locally injective mappings (Schüller et al. 2013). Solids only, ARAP and Dirichlet; with its own energies and
    /// options, and of triangles in the plane: [`super::Deformation::locally_injective`].
    Lim,
}

/// Options of [`super::Deformation`]. `Default` is the paper's choice for quasi-statics (§6.1, §7.1).
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct DeformationOptions {
    /// What the solid is made of.
    pub material: Material,
    /// The solver.
    pub method: DeformationMethod,
    /// How hard targets pull at free vertices, relative to how hard the body holds on to the vertex (the
    /// diagonal of its stiffness matrix at rest), > 0.
    pub target_stiffness: f64,
    /// Stop when |ΔE|/(|E| + floor), or the gradient against the body's stiffness and size, is below
    /// this. The floor is the energy of a strain of 1.1e-4 all over: units do not matter.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
}

impl Default for DeformationOptions {
    fn default() -> Self {
        Self {
            material: Material::default(),
            method: DeformationMethod::Wrapd,
            target_stiffness: 10.0,
            tolerance: 1e-11,
            max_iterations: 5000,
        }
    }
}

impl DeformationOptions {
    /// Checks the ranges; those of the material are checked when it is made.
    pub fn validate(&self) -> Result<(), BuildError> {
        if !(self.tolerance.is_finite() && self.tolerance >= 0.0) {
            return Err(BuildError::InvalidOption {
                option: "tolerance",
                what: "must be finite and not negative".into(),
            });
        }
        if !(self.target_stiffness.is_finite() && self.target_stiffness > 0.0) {
            return Err(BuildError::InvalidOption {
                option: "targetStiffness",
                what: "must be finite and positive".into(),
            });
        }
        Ok(())
    }

    /// The options of locally injective mappings.
    pub(super) fn locally_injective(&self) -> Result<LimOptions, BuildError> {
        let energy = match self.material {
            Material::Arap => LimEnergy::Arap,
            Material::Dirichlet => LimEnergy::Dirichlet,
            _ => {
                let names = LimEnergy::NAMES.join(", ");
                let what = format!("the energies of lim are {names}");
                return Err(BuildError::InvalidOption {
                    option: "energy",
                    what,
                });
            }
        };
        Ok(LimOptions {
            energy,
            target_stiffness: self.target_stiffness,
            tolerance: self.tolerance,
            max_iterations: self.max_iterations,
            ..Default::default()
        })
    }
}
