//! The arguments, as a person types them.

use crate::miqp::Miqp;
use crate::relaxation::Relaxation;
use crate::untangle::Untangle;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use foldfree::deformation::{ClothOptions, DeformationOptions, Material};
use foldfree::lim::{LimEnergy, LimHessian, LimOptions};
use foldfree::mesh::{Shape, SolidShape};
use foldfree::parameterization::{CutPolicy, EnergyKind, Method, ParameterizationOptions, Start};
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// Maps that do not fold: flatten a surface, check a map, make a sample.
#[derive(Debug, Parser)]
#[command(name = "foldfree", version, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Flatten a triangle mesh.
    Parameterize(Parameterize),
    /// Deform an elastic solid under pins.
    Deform(Deform),
    /// Untangle a map of a solid, or of triangles in the plane.
    Untangle(Untangle),
    /// Let a cloth come to rest under its weight.
    Cloth(Cloth),
    /// Solve a mixed-integer quadratic problem.
    Miqp(Miqp),
    /// Check a map exactly: folds, overlaps, distortion.
    Check(Check),
    /// Make a sample mesh.
    Generate(Generate),
}

/// Flatten a triangle mesh; exit code 2 when it did not converge.
#[derive(Debug, Args)]
pub struct Parameterize {
    /// Mesh to flatten: .obj, .off, .ply, .stl, .mesh, .msh or .vtk, also with .gz behind.
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// How.
    #[arg(long, default_value = "wrapd", value_parser = names::<Method>(METHODS))]
    pub method: Method,
    /// Energy of the ADMM methods and of slim.
    #[arg(long, default_value = "symmetric-dirichlet", value_parser = names::<EnergyKind>(ENERGIES))]
    pub energy: EnergyKind,
    /// Where the iterative methods start.
    #[arg(long, default_value = "automatic", value_parser = names::<Start>(STARTS))]
    pub start: Start,
    /// Refuse a piece of a surface that is not a disk instead of cutting it.
    #[arg(long)]
    pub no_cut: bool,
    /// Keep holes as they are, and cut only what has handles or no boundary.
    #[arg(long, conflicts_with = "no_cut")]
    pub keep_holes: bool,
    /// Stop after this many iterations; 0: the start is the result.
    #[arg(long, value_name = "N", default_value_t = ParameterizationOptions::default().max_iterations)]
    pub iterations: usize,
    /// Stop when the relative change of the energy, or its gradient, is below this.
    #[arg(long, value_name = "T", default_value_t = ParameterizationOptions::default().tolerance, value_parser = tolerance)]
    pub tolerance: f64,
    /// Threads; 0: as many as the machine has.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = threads)]
    pub threads: usize,
    /// Seed of the random start.
    #[arg(long, value_name = "S", default_value_t = ParameterizationOptions::default().seed)]
    pub seed: u32,
    /// Places that vertices are pulled to in the plane: a text file of lines `index u v`, the first vertex being 0,
    /// in the units of the mesh.
    #[arg(long, value_name = "L")]
    pub landmarks: Option<PathBuf>,
    /// Hold the vertices of --landmarks at their places instead of pulling at them.
    #[arg(long, requires = "landmarks")]
    pub hard: bool,
    /// How hard landmarks pull, relative to how hard the surface holds on to a vertex.
    #[arg(long, value_name = "K", default_value_t = ParameterizationOptions::default().landmark_stiffness, value_parser = positive)]
    pub landmark_stiffness: f64,
    /// WRAPD without rotation awareness (the paper's W-ADMM).
    #[arg(long)]
    pub no_rotation_aware: bool,
    /// WRAPD without dynamic reweighting (the paper's R-ADMM; with --no-rotation-aware: ADMM-PD).
    #[arg(long)]
    pub no_reweighting: bool,
    /// Write the mesh with its map as texture coordinates: .obj or .obj.gz.
    #[arg(long, value_name = "OUT.obj")]
    pub out: Option<PathBuf>,
    /// Write what happened, iteration by iteration, as JSON.
    #[arg(long, value_name = "REPORT.json")]
    pub report: Option<PathBuf>,
    /// Compare with a solution: an .obj of the same triangles with texture coordinates, or flat.
    #[arg(long, value_name = "SOLUTION.obj")]
    pub reference: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Deform an elastic solid to the minimum of its energy, or (--method lim) a solid or triangles in the plane
/// without inverting any element; exit code 2 when it did not converge.
#[derive(Debug, Args)]
pub struct Deform {
    /// Rest shape: .node and .ele (either name stands for both), .mesh, .msh or .vtk, also with .gz
    /// behind; of --method lim also triangles in a plane z = constant (.obj, .off, .ply, .stl and these). INIT if
    /// left out.
    #[arg(long, value_name = "R")]
    pub rest: Option<PathBuf>,
    /// Where it starts, in any of these formats. May be inverted, but not for --method lim.
    #[arg(long, value_name = "I")]
    pub init: PathBuf,
    /// Energy; left out: neo-hookean, and arap of --method lim. The last four and arap and dirichlet are those of
    /// lim.
    #[arg(long, value_parser = PossibleValuesParser::new(energies_of_solids()))]
    pub energy: Option<String>,
    /// Young's modulus (neo-hookean, stable-neo-hookean, st-venant-kirchhoff).
    #[arg(long, value_name = "E", default_value_t = Material::YOUNG)]
    pub young: f64,
    /// Poisson's ratio (the same).
    #[arg(long, value_name = "N", default_value_t = Material::POISSON)]
    pub poisson: f64,
    /// Without the barrier against inversion (--method lim): elements may invert.
    #[arg(long)]
    pub no_barrier: bool,
    /// How hard the barrier pushes, β (--method lim); left out: 0.01, and 100 of green-strain.
    #[arg(long, value_name = "B", value_parser = positive)]
    pub barrier_weight: Option<f64>,
    /// Second derivatives of energies with rotations (--method lim).
    #[arg(long, default_value = "projected", value_parser = names::<LimHessian>(&["projected", "frozen"]))]
    pub hessian: LimHessian,
    /// What it shares with cloth.
    #[command(flatten)]
    pub relaxation: Relaxation,
}

/// Names of materials, then of energies that only locally injective mappings have.
fn energies_of_solids() -> Vec<&'static str> {
    let mut names = Material::NAMES.to_vec();
    names.extend(
        LimEnergy::NAMES
            .iter()
            .filter(|n| !Material::NAMES.contains(n)),
    );
    names
}

impl Deform {
    /// The library's options, of any method but lim.
    pub fn options(&self) -> Result<DeformationOptions, String> {
        let name = self.energy.as_deref().unwrap_or(Material::NAMES[0]);
        let Some(material) = Material::named(name, self.young, self.poisson) else {
            return Err(format!("--energy {name} goes with --method lim"));
        };
        if self.no_barrier || self.barrier_weight.is_some() {
            return Err("--no-barrier and --barrier-weight go with --method lim".into());
        }
        Ok(DeformationOptions {
            material,
            method: self.relaxation.method,
            target_stiffness: self.relaxation.target_stiffness,
            tolerance: self.relaxation.tolerance,
            max_iterations: self.relaxation.iterations,
        })
    }

    /// The library's options of locally injective mappings.
    pub fn lim_options(&self) -> Result<LimOptions, String> {
        let name = self.energy.as_deref().unwrap_or(LimEnergy::NAMES[0]);
        let Some(energy) = LimEnergy::named(name) else {
            let known = LimEnergy::NAMES.join(", ");
            return Err(format!(
                "--method lim has no energy {name} (it has {known})"
            ));
        };
        Ok(LimOptions {
            energy,
            barrier: !self.no_barrier,
            barrier_weight: self.barrier_weight,
            hessian: self.hessian,
            target_stiffness: self.relaxation.target_stiffness,
            tolerance: self.relaxation.tolerance,
            max_iterations: self.relaxation.iterations,
            ..Default::default()
        })
    }
}

/// Let a cloth come to rest under its weight; exit code 2 when it did not converge. Units are SI.
#[derive(Debug, Args)]
pub struct Cloth {
    /// Rest shape, triangles: .obj, .off, .ply, .stl, .mesh, .msh or .vtk, also with .gz behind; INIT if left
    /// out.
    #[arg(long, value_name = "R")]
    pub rest: Option<PathBuf>,
    /// Where it starts: a mesh of the same vertices, in any of these formats.
    #[arg(long, value_name = "I")]
    pub init: PathBuf,
    /// Young's modulus times thickness, in N/m.
    #[arg(long, value_name = "K", default_value_t = ClothOptions::default().stretch, value_parser = positive)]
    pub stretch: f64,
    /// Bending stiffness, in N m.
    #[arg(long, value_name = "D", default_value_t = ClothOptions::default().bending, value_parser = tolerance)]
    pub bending: f64,
    /// Mass, in kg/m².
    #[arg(long, value_name = "M", default_value_t = ClothOptions::default().density, value_parser = tolerance)]
    pub density: f64,
    /// Gravity, in m/s²: three numbers with commas between.
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,-9.81", allow_hyphen_values = true, value_parser = numbers::<3>)]
    pub gravity: [f64; 3],
    /// Least and most stretch of any part, a number up to 1 and one from 1 on with a comma between (`inf`:
    /// without limit).
    #[arg(long, value_name = "LEAST,MOST", default_value = "0.95,1.05", value_parser = numbers::<2>)]
    pub limits: [f64; 2],
    /// What it shares with solids.
    #[command(flatten)]
    pub relaxation: Relaxation,
}

impl Cloth {
    /// The library's options.
    pub fn options(&self) -> ClothOptions {
        ClothOptions {
            stretch: self.stretch,
            bending: self.bending,
            density: self.density,
            gravity: self.gravity,
            limits: (self.limits != [0.0, f64::INFINITY]).then_some(self.limits),
            method: self.relaxation.method,
            target_stiffness: self.relaxation.target_stiffness,
            tolerance: self.relaxation.tolerance,
            max_iterations: self.relaxation.iterations,
        }
    }
}

/// Check a map exactly; exit code 2 when it folds (a triangle or tetrahedron is inverted or degenerate).
#[derive(Debug, Args)]
pub struct Check {
    /// The map: an .obj with texture coordinates, or (with --rest) a flat mesh (.obj, .off, .ply, .stl, .mesh,
    /// .msh, .vtk) or a deformed solid (.node, .mesh, .msh, .vtk); also with .gz behind.
    #[arg(value_name = "MAP")]
    pub map: PathBuf,
    /// The surface that is mapped, where it is not in MAP: the same triangles in the same order. The solid
    /// that is deformed: .node and .ele, .mesh, .msh or .vtk.
    #[arg(long, value_name = "R")]
    pub rest: Option<PathBuf>,
    /// Exit code 2 also when the map overlaps itself (is not injective as a whole).
    #[arg(long)]
    pub global: bool,
    /// Write the certificate as JSON.
    #[arg(long, value_name = "REPORT.json")]
    pub report: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

/// Make a sample mesh: a surface of triangles or a solid of tetrahedra.
#[derive(Debug, Args)]
pub struct Generate {
    /// Which.
    #[arg(value_parser = PossibleValuesParser::new(Sample::names()).try_map(|n| Sample::named(&n)))]
    pub shape: Sample,
    /// Approximate number of triangles, or of tetrahedra (at most 2 000 000 of these).
    #[arg(long, visible_alias = "tetrahedra", value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(1..=20_000_000))]
    pub triangles: u32,
    /// Where to: .obj, .off, .ply, .stl, .mesh, .msh or .vtk; a solid: .node (with .ele beside it), .mesh,
    /// .msh or .vtk; also with .gz behind.
    #[arg(long, value_name = "OUT")]
    pub out: PathBuf,
}

/// A sample of either kind.
#[derive(Debug, Clone, Copy)]
pub enum Sample {
    /// Of triangles.
    Surface(Shape),
    /// Of tetrahedra.
    Solid(SolidShape),
}

impl Sample {
    fn names() -> impl Iterator<Item = &'static str> {
        let solids = SolidShape::ALL.into_iter().map(SolidShape::name);
        Shape::ALL.into_iter().map(Shape::name).chain(solids)
    }

    fn named(name: &str) -> Result<Sample, String> {
        let surface = Shape::from_name(name).map(Sample::Surface);
        surface
            .or_else(|| SolidShape::from_name(name).map(Sample::Solid))
            .ok_or_else(|| format!("there is no shape {name}"))
    }
}

const METHODS: &[&str] = &[
    "wrapd", "r-admm", "w-admm", "admm-pd", "cm", "wrapd+cm", "slim", "gini", "gini+cm", "arap",
    "lscm", "harmonic", "tutte",
];
const ENERGIES: &[&str] = &["symmetric-dirichlet", "arap"];
const STARTS: &[&str] = &[
    "automatic",
    "harmonic",
    "tutte",
    "lscm",
    "random",
    "collapsed",
];

/// A parser for the kebab-case names of an option of the library.
pub fn names<T: DeserializeOwned + Clone + Send + Sync + 'static>(
    known: &'static [&'static str],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(known)
        .try_map(|name| serde_json::from_value::<T>(serde_json::Value::String(name)))
}

fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let parse = |part: &str| part.trim().parse::<f64>().ok().filter(|x| !x.is_nan());
    let parsed: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let wrong = || format!("{N} numbers with commas between are needed");
    parsed
        .and_then(|list| list.try_into().ok())
        .ok_or_else(wrong)
}

pub fn tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(t) if t.is_finite() && t >= 0.0 => Ok(t),
        Ok(_) => Err("it must be finite and not negative".into()),
        Err(error) => Err(error.to_string()),
    }
}

pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() && x > 0.0 => Ok(x),
        Ok(_) => Err("it must be finite and positive".into()),
        Err(error) => Err(error.to_string()),
    }
}

pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if n <= 1024 => Ok(n),
        Ok(_) => Err("at most 1024".into()),
        Err(error) => Err(error.to_string()),
    }
}

impl Parameterize {
    /// The library's options.
    pub fn options(&self) -> Result<ParameterizationOptions, String> {
        let method = match (self.method, self.no_rotation_aware, self.no_reweighting) {
            (method, false, false) => method,
            (Method::Wrapd, true, false) => Method::WAdmm,
            (Method::Wrapd, false, true) => Method::RAdmm,
            (Method::Wrapd, true, true) => Method::AdmmPd,
            _ => {
                return Err(
                    "--no-rotation-aware and --no-reweighting go with --method wrapd".into(),
                );
            }
        };
        Ok(ParameterizationOptions {
            landmark_stiffness: self.landmark_stiffness,
            method,
            energy: self.energy,
            start: self.start,
            cut: match (self.no_cut, self.keep_holes) {
                (true, _) => CutPolicy::Refuse,
                (false, true) => CutPolicy::KeepHoles,
                (false, false) => CutPolicy::Cut,
            },
            tolerance: self.tolerance,
            max_iterations: self.iterations,
            seed: self.seed,
        })
    }
}
