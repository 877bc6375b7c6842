//! A deformation in progress, of a solid or of a cloth, and how one of a solid is made.

use super::body::{Body, check};
use super::{DeformationMethod, DeformationOptions, Material, Supports, Target};
use crate::Error;
use crate::certificate::{Certificate, SolidCertificate};
use crate::energy::{
    Arap, Dirichlet, NeoHookean, StVenantKirchhoff, StableNeoHookean, SymmetricDirichlet,
};
use crate::geometry::RestShape;
use crate::mesh::{SolidMesh, SurfaceMesh};
use crate::optim::{Deformer, Field, Solver, StepReport, Stopwatch};
use crate::wrapd::External;
use glam::{DVec2, DVec3};

/// A deformation in progress.
pub struct Deformation {
    /// The solid at rest; none for triangles.
    pub(super) rest: Option<SolidMesh>,
    /// The triangles at rest, turned as the solver has them, where they are deformed in their plane.
    pub(super) flat: Option<SurfaceMesh>,
    /// z, where the solver knows the plane only.
    pub(super) level: f64,
    pub(super) notes: Vec<String>,
    pub(super) setup_seconds: f64,
    pub(super) supports: Supports,
    /// The springs' stiffness, a vertex.
    pub(super) spring_stiffness: Vec<f64>,
    pub(super) solver: Box<dyn Deformer>,
}

impl Deformation {
    /// Checks rest shape, start (one position a vertex, may be inverted) and pins (vertices held where
    /// they start), and builds the solver.
    ///
    /// # Errors
    /// [`MeshError`](crate::mesh::MeshError) for a rest shape that is none,
    /// [`BuildError`](crate::optim::BuildError) for pins, starts or options that do
    /// not fit it; `NotInjectiveStart` for one with inverted elements where the energy is a barrier and the
    /// method (L-BFGS) keeps to it.
    pub fn new(
        rest: &SolidMesh,
        start: &[DVec3],
        pins: &[u32],
        options: &DeformationOptions,
    ) -> Result<Self, Error> {
        Self::with_targets(rest, start, pins, &[], options)
    }

    /// The same with targets from the beginning: a component with a target needs no pin.
    ///
    /// # Errors
    /// As [`Self::new`] and [`Self::set_targets`].
    pub fn with_targets(
        rest: &SolidMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        options: &DeformationOptions,
    ) -> Result<Self, Error> {
        let clock = Stopwatch::start();
        options.validate()?;
        if options.method == DeformationMethod::Lim {
            let options = options.locally_injective()?;
            return Self::locally_injective(rest, start, pins, targets, &options);
        }
        let mut notes = Vec::new();
        check(rest, start)?;
        let (shape, turned) = RestShape::of_solid(rest)?;
        if turned {
            notes.push("the mesh was inside out: all tetrahedra were turned".into());
        }
        let supports = Supports::new(rest, pins, &mut notes)?;
        let body = Body {
            shape: &shape,
            start,
            supports,
            targets,
            target_stiffness: options.target_stiffness,
            external: External::default(),
            method: options.method,
            tolerance: options.tolerance,
            max_iterations: options.max_iterations,
            notes,
            clock,
        };
        let mut made = match options.material {
            Material::NeoHookean { young, poisson } => {
                body.solver_of_solid(NeoHookean::new(young, poisson)?)
            }
            Material::StableNeoHookean { young, poisson } => {
                body.solver_of_solid(StableNeoHookean::new(young, poisson)?)
            }
            Material::StVenantKirchhoff { young, poisson } => {
                body.solver_of_solid(StVenantKirchhoff::new(young, poisson)?)
            }
            Material::Dirichlet => body.solver_of_solid(Dirichlet),
            Material::Arap => body.solver_of_solid(Arap),
            Material::SymmetricDirichlet => body.solver_of_solid(SymmetricDirichlet),
        }?;
        made.rest = Some(rest.clone());
        Ok(made)
    }

    /// Replaces all targets while the solver runs: pinned vertices named here are moved, springs pull at
    /// the free ones, and springs of before are gone. The iterate is kept.
    ///
    /// # Errors
    /// `InvalidOption` for a target that is not finite, out of range or given twice, and if a component
    /// were left without pin or target; nothing has changed then.
    pub fn set_targets(&mut self, targets: &[Target]) -> Result<(), Error> {
        let (moved, springs) = self.supports.split(targets, &self.spring_stiffness)?;
        Ok(self.solver.retarget(&moved, &springs)?)
    }

    /// A field at the newest iterate, one value an element.
    pub fn field(&self, field: Field) -> Vec<f32> {
        self.solver.field(field)
    }

    /// Where the last step led handles that have not arrived yet, of a method that leads them step by step.
    pub fn sub_targets(&self) -> Vec<Target> {
        let targets = self.solver.sub_targets().into_iter();
        let in_plane = self.solver.dimension() == 2;
        targets
            .map(|(vertex, mut point)| {
                if in_plane {
                    point[2] = self.level;
                }
                let position = DVec3::from_array(point);
                Target { vertex, position }
            })
            .collect()
    }

    /// What was mended or chosen, in words.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
    /// The solver.
    pub fn solver(&self) -> &dyn Solver {
        &*self.solver
    }
    /// The solver, to be stepped.
    pub fn solver_mut(&mut self) -> &mut dyn Solver {
        &mut *self.solver
    }
    /// Takes one step.
    ///
    /// # Errors
    /// As [`Solver::step`].
    pub fn step(&mut self) -> Result<StepReport, Error> {
        Ok(self.solver.step()?)
    }
    /// Positions, one a vertex, in the input's units.
    pub fn positions(&self) -> Vec<DVec3> {
        let positions = self.solver.positions();
        match self.solver.dimension() {
            2 => {
                let points = positions.as_chunks::<2>().0.iter();
                points.map(|p| DVec3::new(p[0], p[1], self.level)).collect()
            }
            _ => {
                let points = positions.as_chunks::<3>().0.iter();
                points.map(|&p| DVec3::from_array(p)).collect()
            }
        }
    }
    /// What is known for certain of the newest iterate of a solid, as a map of its rest shape; `None` for
    /// triangles: a cloth has no inside.
    pub fn certificate(&self) -> Option<SolidCertificate> {
        let rest = self.rest.as_ref()?;
        Some(SolidCertificate::of_solid(rest, &self.positions()))
    }
    /// The same of triangles that are deformed in their plane; `None` for solids and cloth.
    pub fn certificate_in_plane(&self) -> Option<Certificate> {
        let rest = self.flat.as_ref()?;
        let points = self.positions();
        let points: Vec<DVec2> = points.iter().map(|p| p.truncate()).collect();
        Some(Certificate::of_map(rest, &points))
    }
    /// Seconds that [`Self::new`] took.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }
}
