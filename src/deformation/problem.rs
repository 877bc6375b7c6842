//! A solid, made ready, and the solver that deforms it.

use super::{DeformationMethod, DeformationOptions, Material, Supports};
use crate::Error;
use crate::certificate::SolidCertificate;
use crate::energy::{Arap, Energy, NeoHookean, SymmetricDirichlet};
use crate::geometry::RestShape;
use crate::mesh::{MeshError, SolidMesh};
use crate::optim::{BuildError, Deformer, Field, Solver, Spring, StepReport, Stopwatch};
use crate::space::Solid;
use crate::wrapd::{External, Linear, Problem, Reweighting, RotationAware, Wrapd, WrapdOptions};
use glam::DVec3;

/// Where a vertex is wanted. A pinned vertex is moved there, a free one pulled by a spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// The vertex.
    pub vertex: u32,
    /// Where to, in the units of the mesh.
    pub position: DVec3,
}

/// A deformation in progress.
pub struct Deformation {
    rest: SolidMesh,
    notes: Vec<String>,
    setup_seconds: f64,
    supports: Supports,
    /// The springs' stiffness, a vertex.
    spring_stiffness: Vec<f64>,
    solver: Box<dyn Deformer>,
}

impl Deformation {
    /// Checks rest shape, start (one position a vertex, may be inverted) and pins (vertices held where
    /// they start), and builds the solver.
    ///
    /// # Errors
    /// [`MeshError`] for a rest shape that is none, [`BuildError`] for pins, starts or options that do
    /// not fit it.
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
        let mut notes = Vec::new();
        check_indices(rest)?;
        if start.len() != rest.positions.len() {
            return Err(BuildError::WrongLength {
                argument: "start",
                expected: rest.positions.len(),
                found: start.len(),
            }
            .into());
        }
        if let Some(vertex) = start.iter().position(|p| !p.is_finite()) {
            return Err(MeshError::NonFinitePosition { vertex }.into());
        }
        let (shape, turned) = RestShape::of_solid(rest)?;
        if turned {
            notes.push("the mesh was inside out: all tetrahedra were turned".into());
        }
        let supports = Supports::new(rest, pins, &mut notes)?;
        let material = AnyMaterial::new(options.material)?;
        let mut spring_stiffness = vec![0.0; start.len()];
        for e in 0..shape.len() {
            for (corner, &v) in shape.simplex(e).iter().enumerate() {
                spring_stiffness[v as usize] += options.target_stiffness
                    * material.rest_stiffness()
                    * shape.measure[e]
                    * shape.hat_product(e, corner, corner);
            }
        }
        let mut positions = start.to_vec();
        let (moved, springs) = split(targets, &supports, &spring_stiffness)?;
        for (vertex, point) in moved {
            positions[vertex as usize] = DVec3::from_array(point);
        }
        let positions: Vec<f64> = positions.iter().flat_map(|p| p.to_array()).collect();
        let external = External {
            springs,
            ..Default::default()
        };
        let problem = Problem {
            rest: &shape,
            start: &positions,
            pins: &supports.held(),
            external: Some(&external),
        };
        let solver = match material {
            AnyMaterial::NeoHookean(energy) => build(problem, energy, options),
            AnyMaterial::Arap(energy) => build(problem, energy, options),
            AnyMaterial::SymmetricDirichlet(energy) => build(problem, energy, options),
        }?;
        Ok(Self {
            rest: rest.clone(),
            notes,
            setup_seconds: clock.seconds(),
            supports,
            spring_stiffness,
            solver,
        })
    }

    /// Replaces all targets while the solver runs: pinned vertices named here are moved, springs pull at
    /// the free ones, and springs of before are gone. The iterate is kept.
    ///
    /// # Errors
    /// `InvalidOption` for a target that is not finite, out of range or given twice, and if a component
    /// were left without pin or target; nothing has changed then.
    pub fn set_targets(&mut self, targets: &[Target]) -> Result<(), Error> {
        let (moved, springs) = split(targets, &self.supports, &self.spring_stiffness)?;
        Ok(self.solver.retarget(&moved, &springs)?)
    }

    /// A field at the newest iterate, one value a tetrahedron.
    pub fn field(&self, field: Field) -> Vec<f32> {
        self.solver.field(field)
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
        let positions = self.solver.positions().as_chunks::<3>().0;
        positions.iter().map(|&p| DVec3::from_array(p)).collect()
    }
    /// What is known for certain of the newest iterate, as a map of the rest shape.
    pub fn certificate(&self) -> SolidCertificate {
        SolidCertificate::of_solid(&self.rest, &self.positions())
    }
    /// Seconds that [`Self::new`] took.
    pub fn setup_seconds(&self) -> f64 {
        self.setup_seconds
    }
}

fn check_indices(rest: &SolidMesh) -> Result<(), MeshError> {
    let vertices = rest.positions.len();
    if rest.simplices.is_empty() {
        return Err(MeshError::Empty);
    }
    if let Some(vertex) = rest.positions.iter().position(|p| !p.is_finite()) {
        return Err(MeshError::NonFinitePosition { vertex });
    }
    for (face, tetrahedron) in rest.simplices.iter().enumerate() {
        if let Some(&index) = tetrahedron.iter().find(|&&v| v as usize >= vertices) {
            let index = u64::from(index);
            return Err(MeshError::IndexOutOfRange {
                face,
                index,
                vertices,
            });
        }
    }
    Ok(())
}

/// Targets as moves of held vertices and springs on free ones.
#[allow(clippy::type_complexity)]
fn split(
    targets: &[Target],
    supports: &Supports,
    stiffness: &[f64],
) -> Result<(Vec<(u32, [f64; 3])>, Vec<Spring>), BuildError> {
    let n = supports.is_held.len();
    let wrong = |what| {
        Err(BuildError::InvalidOption {
            option: "targets",
            what,
        })
    };
    let (mut moved, mut springs) = (Vec::new(), Vec::new());
    let mut has_target = vec![false; n];
    for &Target { vertex, position } in targets {
        let v = vertex as usize;
        if v >= n {
            return wrong(format!("vertex {v} of {n} (the first is 0)"));
        }
        if !position.is_finite() {
            return wrong(format!("the target of vertex {v} is not finite"));
        }
        if has_target[v] {
            return wrong(format!("vertex {v} has two targets"));
        }
        has_target[v] = true;
        let target = position.to_array();
        match supports.is_held[v] {
            true => moved.push((vertex, target)),
            false => springs.push(Spring {
                vertex,
                stiffness: stiffness[v],
                target,
            }),
        }
    }
    supports.check(targets.iter().map(|t| t.vertex))?;
    Ok((moved, springs))
}

/// A checked material.
enum AnyMaterial {
    NeoHookean(NeoHookean),
    Arap(Arap),
    SymmetricDirichlet(SymmetricDirichlet),
}

impl AnyMaterial {
    fn new(material: Material) -> Result<Self, BuildError> {
        Ok(match material {
            Material::NeoHookean { young, poisson } => {
                Self::NeoHookean(NeoHookean::new(young, poisson)?)
            }
            Material::Arap => Self::Arap(Arap),
            Material::SymmetricDirichlet => Self::SymmetricDirichlet(SymmetricDirichlet),
        })
    }

    fn rest_stiffness(&self) -> f64 {
        match self {
            Self::NeoHookean(energy) => Energy::<Solid>::constants(energy),
            Self::Arap(energy) => Energy::<Solid>::constants(energy),
            Self::SymmetricDirichlet(energy) => Energy::<Solid>::constants(energy),
        }
        .rest_stiffness
    }
}

fn build<E: Energy<Solid>>(
    problem: Problem,
    energy: E,
    options: &DeformationOptions,
) -> Result<Box<dyn Deformer>, BuildError> {
    use DeformationMethod::{AdmmPd, RAdmm, WAdmm, Wrapd as Both};
    let reweighting = matches!(options.method, Both | WAdmm).then_some(Reweighting::QUASI_STATIC);
    let settings = WrapdOptions {
        reweighting,
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        restart_duals: true,
        ..Default::default()
    };
    Ok(Box::new(match options.method {
        Both | RAdmm => Wrapd::new::<Solid, RotationAware, E>(problem, energy, settings)?,
        WAdmm | AdmmPd => Wrapd::new::<Solid, Linear, E>(problem, energy, settings)?,
    }))
}
