//! Sample solids at any resolution: regular ones of boxes and prisms, and implicit ones filled by
//! isosurface stuffing.

mod figures;
mod fill;
mod grid;
mod implicit;
mod lattice;
mod stencil;
mod stuffing;

use super::open::hexagonal_disk;
use super::round_positions;
use crate::mesh::SolidMesh;
use fill::stuffed;
use glam::DVec3;
pub use stuffing::{StuffingError, stuff};

/// A sample solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SolidShape {
    /// A bar, four times as long as wide.
    Bar,
    /// A slender beam, twelve times as long as wide.
    Beam,
    /// A cube.
    Box,
    /// A flat round plate.
    Disk,
    /// An open hand with a bit of forearm.
    Hand,
    /// An octopus-like creature.
    Creature,
    /// The letters ff.
    Letters,
}

impl SolidShape {
    /// All solids, in the order a picker shows them.
    pub const ALL: [SolidShape; 7] = [
        SolidShape::Bar,
        SolidShape::Beam,
        SolidShape::Box,
        SolidShape::Disk,
        SolidShape::Hand,
        SolidShape::Creature,
        SolidShape::Letters,
    ];

    /// The stable name, as used on the command line and in JavaScript (`"bar"`).
    pub fn name(self) -> &'static str {
        match self {
            SolidShape::Bar => "bar",
            SolidShape::Beam => "beam",
            SolidShape::Box => "box",
            SolidShape::Disk => "disk",
            SolidShape::Hand => "hand",
            SolidShape::Creature => "creature",
            SolidShape::Letters => "letters",
        }
    }

    /// The solid of that [`name`](SolidShape::name).
    pub fn from_name(name: &str) -> Option<SolidShape> {
        SolidShape::ALL
            .into_iter()
            .find(|shape| shape.name() == name)
    }

    /// The title a picker shows.
    pub fn title(self) -> &'static str {
        match self {
            SolidShape::Bar => "Bar",
            SolidShape::Beam => "Beam",
            SolidShape::Box => "Box",
            SolidShape::Disk => "Disk",
            SolidShape::Hand => "Hand",
            SolidShape::Creature => "Creature",
            SolidShape::Letters => "Letters",
        }
    }

    /// One sentence that says what the solid shows.
    pub fn describe(self) -> &'static str {
        match self {
            SolidShape::Bar => {
                "A square bar: held at one end and twisted or bent at the other, it is the classic test."
            }
            SolidShape::Beam => {
                "A slender beam: a small force bends it far, and a twist winds it up before it gives way."
            }
            SolidShape::Box => {
                "A cube: squashed, sheared or turned inside out, it shows how stiff a material is in each direction."
            }
            SolidShape::Disk => {
                "A flat round plate: it bends easily and hardly stretches, which makes its equations stiff."
            }
            SolidShape::Hand => {
                "An open hand: five fingers that move almost freely on a palm that does not."
            }
            SolidShape::Creature => {
                "A creature with eight tapering arms: drag one, and the others follow one after another."
            }
            SolidShape::Letters => {
                "Two letters f joined by their crossbar: thin strokes that bend, and corners that gather the stress."
            }
        }
    }
}

/// Makes a solid of approximately that many tetrahedra, in one piece, its box centred at the origin and
/// about two units wide.
///
/// From 500 tetrahedra upwards the number is met within 15 % (the disk: 20 %). Every dihedral angle of
/// an implicit solid (hand, creature, letters) is between 10.7° and 164.8°; of the others between 25°
/// and 130°. A mesh too coarse for the thin parts of an implicit solid has them thicker; what still
/// does not hang together is left out, but for the largest piece.
pub fn generate_solid(shape: SolidShape, tetrahedra: usize) -> SolidMesh {
    let mut mesh = match shape {
        SolidShape::Bar => grid::bar(4.0, tetrahedra),
        SolidShape::Beam => grid::bar(12.0, tetrahedra),
        SolidShape::Box => grid::bar(1.0, tetrahedra),
        SolidShape::Disk => grid::disk(tetrahedra),
        SolidShape::Hand => stuffed(figures::hand, 0.33, tetrahedra),
        SolidShape::Creature => stuffed(figures::creature, 0.56, tetrahedra),
        SolidShape::Letters => stuffed(figures::letters, 0.37, tetrahedra),
    };
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for &position in &mesh.positions {
        bounds = [bounds[0].min(position), bounds[1].max(position)];
    }
    let middle = (bounds[0] + bounds[1]) * 0.5;
    for position in &mut mesh.positions {
        *position -= middle;
    }
    round_positions(&mut mesh.positions);
    mesh
}

/// An absurd wish is capped at two million tetrahedra.
fn wish(tetrahedra: usize) -> f64 {
    (tetrahedra as f64).min(2e6)
}
