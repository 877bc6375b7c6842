//! Cloth: a sheet that resists stretch, within limits, and bending, and has weight (paper §7.1.2,
//! figure 8).

use super::body::{Body, check};
use super::{Deformation, DeformationMethod, Supports, Target};
use crate::Error;
use crate::energy::LimitedArap;
use crate::geometry::{RestShape, quadratic_bending, vertex_measures};
use crate::mesh::SurfaceMesh;
use crate::optim::{BuildError, Stopwatch};
use crate::space::Sheet;
use crate::wrapd::External;
use glam::DVec3;

/// What a cloth is, and how it is to be solved. Any consistent units will do; the defaults are SI, for a
/// stiff cotton with z upwards.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "camelCase", default)]
pub struct ClothOptions {
    /// Young's modulus times thickness, N/m, > 0.
    pub stretch: f64,
    /// Bending stiffness, N m, ≥ 0; see [`quadratic_bending`].
    pub bending: f64,
    /// Mass an area, kg/m², ≥ 0.
    pub density: f64,
    /// Gravity, m/s².
    pub gravity: [f64; 3],
    /// Least (0 to 1) and most (from 1) stretch of any part in any direction, kept exactly; none: any
    /// stretch. Pins that are further apart than the limits allow are not noticed: the solver then
    /// does not converge, or to a cloth that breaks them.
    pub limits: Option<[f64; 2]>,
    /// The solver. The stretch energy is equally stiff everywhere, so that reweighting never has reason
    /// to begin: `w-admm` is `admm-pd` here, `wrapd` is `r-admm`.
    pub method: DeformationMethod,
    /// How hard targets pull at free vertices, relative to how hard the cloth holds on to the vertex,
    /// > 0.
    pub target_stiffness: f64,
    /// Stop when |ΔE|/(|E| + floor), or the gradient against the body's stiffness and size, is below
    /// this. The floor is the energy of a strain of 1.1e-4 all over: units do not matter.
    pub tolerance: f64,
    /// Stop after this many iterations.
    pub max_iterations: usize,
}

impl Default for ClothOptions {
    fn default() -> Self {
        Self {
            stretch: 1000.0,
            bending: 1e-4,
            density: 0.25,
            gravity: [0.0, 0.0, -9.81],
            limits: Some([0.95, 1.05]),
            method: DeformationMethod::Wrapd,
            target_stiffness: 10.0,
            tolerance: 1e-11,
            max_iterations: 5000,
        }
    }
}

impl ClothOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// `InvalidOption` names the one out of its range.
    pub fn validate(&self) -> Result<(), BuildError> {
        let not_negative = |x: f64| x >= 0.0 && x.is_finite();
        let checks = [
            ("bending", not_negative(self.bending)),
            ("density", not_negative(self.density)),
            ("tolerance", not_negative(self.tolerance)),
        ];
        let wrong = |option, what: &str| {
            let what = what.into();
            Err(BuildError::InvalidOption { option, what })
        };
        for (option, fits) in checks {
            if !fits {
                return wrong(option, "must be finite and not negative");
            }
        }
        if !self.gravity.iter().all(|g| g.is_finite()) {
            return wrong("gravity", "must be finite");
        }
        if !(self.target_stiffness > 0.0 && self.target_stiffness.is_finite()) {
            return wrong("targetStiffness", "must be finite and positive");
        }
        if self.method == DeformationMethod::Lbfgs && self.limits.is_some() {
            return wrong(
                "method",
                "l-bfgs knows no hard limits: it needs limits to be none",
            );
        }
        if matches!(
            self.method,
            DeformationMethod::Newton | DeformationMethod::WrapdNewton
        ) {
            return wrong("method", "second-order methods are for solids");
        }
        if self.method == DeformationMethod::Lim {
            return wrong("method", "lim is for solids, and triangles in the plane");
        }
        self.energy().map(|_| ())
    }

    fn energy(&self) -> Result<LimitedArap, BuildError> {
        LimitedArap::new(self.stretch, self.limits.unwrap_or([0.0, f64::INFINITY]))
    }
}

impl Deformation {
    /// A cloth: checks rest shape (flat or not, any orientation, in any units), start (one position a
    /// vertex), pins (vertices held where they start) and targets, and builds the solver.
    ///
    /// The energy is that of stretch (J), of bending, and of height above the mean of pins and targets. The
    /// limits of stretch are kept by the local variables always, by the positions once converged: what
    /// is missing shows in the report's smallest and largest σ. Where a limit is reached the gradient
    /// of this energy does not vanish; something else holds against it.
    ///
    /// # Errors
    /// [`MeshError`](crate::mesh::MeshError) for a rest shape that is none, or where bending meets an
    /// edge of more than two triangles; [`BuildError`] for pins, targets, starts or options that do
    /// not fit it, and for a triangle without area.
    pub fn of_cloth(
        rest: &SurfaceMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        options: &ClothOptions,
    ) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        options.validate()?;
        check(rest, start)?;
        let shape = RestShape::of_sheet(rest)?;
        let mut notes = Vec::new();
        let supports = Supports::new(rest, pins, &mut notes)?;

        let n = start.len();
        let weight = DVec3::from_array(options.gravity) * options.density;
        let shares = vertex_measures(&shape, n);
        let points = pins.iter().map(|&v| start[v as usize]);
        let points = points.chain(targets.iter().map(|t| t.position));
        let count = (pins.len() + targets.len()).max(1);
        let level = points.sum::<DVec3>() / count as f64;
        let stiffness = match options.bending > 0.0 {
            true => quadratic_bending(&shape, n, options.bending)?,
            false => Vec::new(),
        };
        let body = Body {
            shape: &shape,
            start,
            supports,
            targets,
            target_stiffness: options.target_stiffness,
            external: External {
                stiffness,
                load: shares
                    .iter()
                    .flat_map(|&share| (weight * share).to_array())
                    .collect(),
                origin: level.to_array(),
                springs: Vec::new(),
            },
            method: options.method,
            tolerance: options.tolerance,
            max_iterations: options.max_iterations,
            notes,
            clock,
        };
        body.solver::<Sheet, _>(options.energy()?)
    }
}
