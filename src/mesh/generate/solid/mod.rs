//! Sample solids at any resolution: regular ones of boxes and prisms, and implicit ones filled by
//! isosurface stuffing.

mod figures;
mod grid;
mod implicit;
mod lattice;
mod stencil;
mod stuffing;

use super::open::hexagonal_disk;
use super::round_positions;
use crate::mesh::SolidMesh;
use glam::DVec3;
use implicit::Implicit;
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

/// Looks for the spacing that gives the wanted number. `figure` makes the function of a solid whose
/// parts are nowhere thinner than a radius; `volume` is about that of the solid.
fn stuffed(figure: fn(f64) -> Implicit, volume: f64, tetrahedra: usize) -> SolidMesh {
    // A lattice finds every part of a round stroke whose radius is more than √5/4 of the spacing, the
    // distance from its vertices that a point can have; a little more keeps the parts joined.
    const THICKNESS: [f64; 3] = [0.75, 0.7, 0.8];
    // Thicker than this, the parts would run into each other.
    const THICKEST: f64 = 0.17;
    const CLOSE: f64 = 0.04;
    let wanted = wish(tetrahedra).max(100.0);
    let fill = |spacing: f64, thickness: f64, shift: f64| -> SolidMesh {
        let solid = figure((thickness * spacing).min(THICKEST));
        let shift = DVec3::new(0.13, 0.29, 0.41) * (shift.fract() * spacing);
        let bounds = solid.bounds().map(|corner| corner + shift);
        let mesh = stuff(|p| solid.value(p), bounds, spacing).unwrap_or_default();
        largest_piece(mesh)
    };
    // The number grows with the inverse cube of the spacing, roughly. Where it jumps, because a part
    // appears or breaks off, ever farther neighbours of the best spacing are tried, with other
    // thicknesses and the lattice moved.
    let mut spacing = (12.0 * volume / wanted).cbrt();
    let mut best = (f64::INFINITY, spacing, SolidMesh::default());
    for attempt in 0..30 {
        let other = if attempt < 6 { 0 } else { attempt };
        let mesh = fill(spacing, THICKNESS[other % 3], 0.1 * other as f64);
        let ratio = mesh.simplices.len().max(1) as f64 / wanted;
        let miss = ratio.ln().abs();
        if miss < best.0 {
            best = (miss, spacing, mesh);
        }
        if best.0 < CLOSE {
            break;
        }
        spacing = match attempt {
            0..6 => spacing * ratio.cbrt().clamp(0.5, 2.0),
            _ if attempt % 2 == 0 => best.1 * (1.0 + 0.01 * (attempt - 4) as f64),
            _ => best.1 * (1.0 - 0.01 * (attempt - 4) as f64),
        };
    }
    best.2
}

/// The piece with the most tetrahedra; of equal ones the first.
fn largest_piece(mesh: SolidMesh) -> SolidMesh {
    let mut parents: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    let find = |parents: &mut Vec<u32>, mut v: u32| {
        while parents[v as usize] != v {
            parents[v as usize] = parents[parents[v as usize] as usize];
            v = parents[v as usize];
        }
        v
    };
    for tetrahedron in &mesh.simplices {
        let root = find(&mut parents, tetrahedron[0]);
        for &v in &tetrahedron[1..] {
            let other = find(&mut parents, v);
            parents[other as usize] = root;
        }
    }
    let mut sizes = vec![0usize; mesh.positions.len()];
    for tetrahedron in &mesh.simplices {
        sizes[find(&mut parents, tetrahedron[0]) as usize] += 1;
    }
    let most = sizes.iter().copied().max().unwrap_or(0);
    let Some(chosen) = sizes.iter().position(|&size| size == most) else {
        return mesh;
    };
    let mut numbers = vec![u32::MAX; mesh.positions.len()];
    let mut piece = SolidMesh::default();
    for v in 0..mesh.positions.len() {
        if find(&mut parents, v as u32) as usize == chosen {
            numbers[v] = piece.positions.len() as u32;
            piece.positions.push(mesh.positions[v]);
        }
    }
    for tetrahedron in &mesh.simplices {
        if numbers[tetrahedron[0] as usize] != u32::MAX {
            piece
                .simplices
                .push(tetrahedron.map(|v| numbers[v as usize]));
        }
    }
    piece
}
