//! Sample shapes at any resolution.
//!
//! Every shape is deterministic. Coordinates are rounded to 1e-7, so that the last bit of a
//! platform's `sin` does not show and a file written from them stays small.

mod closed;
mod hilbert;
mod open;
mod solid;

use super::SurfaceMesh;
use glam::DVec3;
pub use solid::{SolidShape, StuffingError, generate_solid, stuff};

/// A sample shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// A dome with bumps: a disk that has to stretch.
    BumpyCap,
    /// A landscape: a gentle height field.
    Terrain,
    /// A ramp that winds round more than once: the overlap trap.
    SpiralRamp,
    /// A long strip along a Hilbert curve, rolled up: the paper's hard case.
    HilbertStrip,
    /// A torus: genus 1, has to be cut.
    Torus,
    /// A sphere: genus 0 without boundary, has to be cut.
    Sphere,
    /// A cube with rounded edges: closed, nearly developable faces.
    RoundedCube,
    /// A flat square.
    Sheet,
    /// A flat disk.
    RoundSheet,
    /// A unit square whose cells are all split along the same diagonal.
    Grid,
}

impl Shape {
    /// All shapes, in the order a picker shows them.
    pub const ALL: [Shape; 10] = [
        Shape::BumpyCap,
        Shape::Terrain,
        Shape::SpiralRamp,
        Shape::HilbertStrip,
        Shape::Torus,
        Shape::Sphere,
        Shape::RoundedCube,
        Shape::Sheet,
        Shape::RoundSheet,
        Shape::Grid,
    ];

    /// The stable name, as used on the command line and in JavaScript (`"bumpy-cap"`).
    pub fn name(self) -> &'static str {
        match self {
            Shape::BumpyCap => "bumpy-cap",
            Shape::Terrain => "terrain",
            Shape::SpiralRamp => "spiral-ramp",
            Shape::HilbertStrip => "hilbert-strip",
            Shape::Torus => "torus",
            Shape::Sphere => "sphere",
            Shape::RoundedCube => "rounded-cube",
            Shape::Sheet => "sheet",
            Shape::RoundSheet => "round-sheet",
            Shape::Grid => "grid",
        }
    }

    /// The shape of that [`name`](Shape::name).
    pub fn from_name(name: &str) -> Option<Shape> {
        Shape::ALL.into_iter().find(|shape| shape.name() == name)
    }

    /// The title a picker shows.
    pub fn title(self) -> &'static str {
        match self {
            Shape::BumpyCap => "Bumpy cap",
            Shape::Terrain => "Terrain",
            Shape::SpiralRamp => "Spiral ramp",
            Shape::HilbertStrip => "Hilbert strip",
            Shape::Torus => "Torus",
            Shape::Sphere => "Sphere",
            Shape::RoundedCube => "Rounded cube",
            Shape::Sheet => "Sheet",
            Shape::RoundSheet => "Round sheet",
            Shape::Grid => "Grid",
        }
    }

    /// One sentence that says what the shape shows.
    pub fn describe(self) -> &'static str {
        match self {
            Shape::BumpyCap => {
                "A dome covered with bumps: curved everywhere, so every flat map has to stretch some of it."
            }
            Shape::Terrain => {
                "A landscape of hills: nearly flat already, and the best map is close to the view from above."
            }
            Shape::SpiralRamp => {
                "A ramp that winds round one and a half times: flattened without stretch it would lie on top of itself."
            }
            Shape::HilbertStrip => {
                "A long strip along a Hilbert curve, rolled up: it unrolls without any stretch, but its start on a circle is crushed thousands of times over."
            }
            Shape::Torus => {
                "A ring without boundary: it has to be cut along two loops before it can lie flat."
            }
            Shape::Sphere => {
                "A ball without boundary: it is slit from one end to the other, and no map of it is free of stretch."
            }
            Shape::RoundedCube => {
                "A cube with rounded edges: flat on its sides, with all its curvature in the eight corners."
            }
            Shape::Sheet => "A flat square, as cloth lies before it is lifted.",
            Shape::RoundSheet => "A flat disk, as a round cloth lies before it is lifted.",
            Shape::Grid => "A flat unit square of equal triangles, to be deformed in its plane.",
        }
    }
}

/// Makes a shape of approximately that many triangles (never fewer than a handful, so that it stays
/// recognisable). The result is clean: manifold, oriented, no vertex unused.
pub fn generate(shape: Shape, triangles: usize) -> SurfaceMesh {
    let mut mesh = match shape {
        Shape::BumpyCap => open::bumpy_cap(triangles),
        Shape::Terrain => open::terrain(triangles),
        Shape::SpiralRamp => open::spiral_ramp(triangles),
        Shape::HilbertStrip => hilbert::hilbert_strip(triangles),
        Shape::Torus => closed::torus(triangles),
        Shape::Sphere => closed::sphere(triangles),
        Shape::RoundedCube => closed::rounded_cube(triangles),
        Shape::Sheet => open::sheet(triangles),
        Shape::RoundSheet => open::round_sheet(triangles),
        Shape::Grid => open::unit_grid(triangles),
    };
    round_positions(&mut mesh.positions);
    mesh
}

/// Rounds coordinates to 1e-7.
fn round_positions(positions: &mut [DVec3]) {
    for position in positions {
        *position = (*position * 1e7).round() / 1e7;
    }
}

/// Splits a quad (counter-clockwise `a b c d`) along its shorter diagonal.
fn push_quad(mesh: &mut SurfaceMesh, [a, b, c, d]: [u32; 4]) {
    let at = |i: u32| mesh.positions[i as usize];
    let ac = at(a).distance_squared(at(c));
    let bd = at(b).distance_squared(at(d));
    // On a tie, alternate: no direction is favoured. The margin keeps rounding out of the choice.
    let first = if (ac - bd).abs() <= 1e-9 * (ac + bd) {
        a % 2 == 0
    } else {
        ac < bd
    };
    mesh.simplices.extend(if first {
        [[a, b, c], [a, c, d]]
    } else {
        [[a, b, d], [b, c, d]]
    });
}

/// The nearest whole number to the root of `count`, at least `least`.
fn root(count: f64, least: usize) -> usize {
    (count.max(0.0).sqrt().round() as usize).max(least)
}

/// An absurd wish is capped at ten million triangles.
fn wish(triangles: usize) -> f64 {
    (triangles as f64).min(1e7)
}

/// A unit vector at polar angle `polar` from +z and longitude `longitude`.
fn spherical(polar: f64, longitude: f64) -> DVec3 {
    let (s, c) = polar.sin_cos();
    DVec3::new(s * longitude.cos(), s * longitude.sin(), c)
}
