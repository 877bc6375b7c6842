//! A solid on the bench: what is held, dragged and cut, and how the iterate on show is drawn.

mod contacts;
mod cut;
mod handles;
mod parameters;
mod skin;

pub use cut::show as show_cut;
pub use parameters::show_with_cut as show_cut_and_parameters;
pub use skin::show as show_skin;

use eframe::egui::{Pos2, Rect};
use glam::{Mat3, Vec2, Vec3};

use super::bench::Bench;
use super::gpu::{self, SolidData, SolidLook};
use super::legend::Legend;
use crate::camera::Orbit;
use crate::colour;
use crate::solid::Solid;
use crate::solid::field::Field;
use crate::solid::pick::Lens;
use crate::solid::slice::{self, Corner, Plane, corner};
use crate::solid::stretch::{self, Stretches};

/// Half the depth the camera shows, in radii of the solid at rest: handles may be dragged far out.
const REACH: f32 = 3.4;

/// Where the solid is cut open.
#[derive(Clone, Copy, PartialEq)]
pub struct Cut {
    /// Normal of the plane: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Where it stands in the bounding box at rest, 0–1.
    pub at: f32,
}

/// What a drag with the pointer moves.
#[derive(Clone, Copy, PartialEq)]
pub enum Grab {
    /// The camera.
    Camera,
    /// Vertices: where their anchor was and where the pointer was, when it began.
    Vertices(Vec3, Vec2),
    /// A handle, turned: where the pointer was when it began.
    Turn(Vec2),
    /// A rubber band, from here.
    Box(Pos2),
}

/// The solid and all that belongs to it.
#[derive(Default)]
pub struct Body {
    /// The solid at rest.
    pub solid: Solid,
    /// What the colours mean.
    pub field: Field,
    /// Where it is cut open.
    pub cut: Option<Cut>,
    /// Whether a drag spans a box, without the shift key.
    pub box_tool: bool,
    /// Vertices held together, handle by handle.
    pub handles: Vec<Vec<u32>>,
    /// The handle keys act on.
    pub selected: Option<usize>,
    /// The vertex that keys would pin.
    pub cursor: Option<u32>,
    /// Where vertices are to go.
    pub targets: Vec<(u32, Vec3)>,
    /// Where the newest step led those that are not there yet.
    pub sub_targets: Vec<(u32, Vec3)>,
    /// Whether what comes with the positions are zones, not stresses.
    pub zones: bool,
    /// Whether what is held may be dragged while it is untangled.
    pub movable: bool,
    /// Whether a handle was ever grabbed since then.
    pub grabbed: bool,
    /// Contacts there were to draw last, of vertices and facets and of edges; and the glyphs that they got.
    pub drawn_contacts: [usize; 4],
    /// The drag under way.
    pub grab: Option<Grab>,
    /// Vertex under the pointer.
    pub over: Option<u32>,
    /// Inverted or collapsed tetrahedra of the iterate on show.
    pub inverted: Vec<u32>,
    /// Tetrahedra the plane meets.
    pub met: Vec<u32>,
    /// The view of the skin, as it was last drawn.
    pub view: Option<(Rect, Lens)>,
    /// Where on the ramp every tetrahedron is; below 0 inverted.
    values: Vec<f32>,
    plane: Option<Plane>,
    cut_stale: bool,
    scratch: Scratch,
}

#[derive(Default)]
struct Scratch {
    skin: Vec<Corner>,
    inverted: Vec<Corner>,
    cut: Vec<Corner>,
    creases: Vec<f32>,
}

impl Body {
    /// The positions in what is kept of an iterate.
    pub fn positions<'a>(&self, frame: &'a [f32]) -> &'a [f32] {
        &frame[..3 * self.solid.vertices]
    }

    /// Whether an iterate has as many numbers as this solid's has: positions, and a stress for
    /// every tetrahedron or none.
    pub fn fits(&self, frame: &[f32]) -> bool {
        let (n, m) = (3 * self.solid.vertices, self.solid.tetrahedra.len());
        frame.len() == n || frame.len() == n + m
    }

    /// The stretches of a tetrahedron in an iterate.
    pub fn stretches(&self, t: usize, frame: &[f32]) -> Stretches {
        let corners = stretch::corners(self.solid.tetrahedra[t], frame);
        self.solid.rest.stretches(t, corners)
    }

    /// The stress of a tetrahedron in an iterate, if it came with one.
    pub fn stress(&self, t: usize, frame: &[f32]) -> Option<f32> {
        let stress = frame.get(3 * self.solid.vertices + t).copied();
        stress.filter(|_| !self.zones)
    }

    /// The zone of violated constraints that an element is in, if it is in one.
    pub fn zone(&self, t: usize, frame: &[f32]) -> Option<usize> {
        let zone = frame.get(3 * self.solid.vertices + t).copied();
        zone.filter(|zone| self.zones && *zone > 0.0)
            .map(|zone| zone as usize)
    }

    /// Writes what the graphics card needs of an iterate.
    pub fn refresh(&mut self, frame: &[f32]) {
        let solid = &self.solid;
        let beside = &frame[3 * solid.vertices..];
        let zone = |t: usize| {
            let zone = beside.get(t).filter(|_| self.zones);
            Field::Zone.position(f64::from(zone.copied().unwrap_or_default()))
        };
        self.values.clear();
        self.inverted.clear();
        for (t, tetrahedron) in solid.tetrahedra.iter().enumerate() {
            let s = solid
                .rest
                .stretches(t, stretch::corners(*tetrahedron, frame));
            let value = match (s.worst(), self.field) {
                (None, field) => {
                    self.inverted.push(t as u32);
                    if field == Field::Zone && zone(t) > Field::Zone.position(0.0) {
                        -2.0 - zone(t)
                    } else {
                        -1.0
                    }
                }
                (Some(_), Field::Zone) => zone(t),
                (Some(worst), Field::Stretch) => Field::Stretch.position(worst),
                (Some(_), Field::Volume) => Field::Volume.position(s.volume()),
                (Some(_), Field::Stress) => {
                    let stress = beside.get(t).copied().unwrap_or(0.0);
                    Field::Stress.position(f64::from(stress))
                }
            };
            self.values.push(value);
        }
        let point = |v: u32| Vec3::from_slice(&frame[3 * v as usize..]);
        let scratch = &mut self.scratch;
        scratch.skin.clear();
        for (triangle, owner) in solid.skin.iter().zip(&solid.owners) {
            let value = self.values[*owner as usize];
            scratch
                .skin
                .extend(triangle.map(|v| corner(point(v), value, 0.0)));
        }
        scratch.inverted.clear();
        for &t in &self.inverted {
            let [a, b, c, d] = solid.tetrahedra[t as usize];
            let value = self.values[t as usize];
            if solid.planar {
                let corners = [a, b, c].map(|v| corner(point(v), value, 0.0));
                scratch.inverted.extend(corners);
                continue;
            }
            for face in [[b, c, d], [a, d, c], [a, b, d], [a, c, b]] {
                scratch
                    .inverted
                    .extend(face.map(|v| corner(point(v), value, 0.0)));
            }
        }
        scratch.creases.clear();
        for &v in solid.creases.as_flattened() {
            scratch
                .creases
                .extend_from_slice(&frame[3 * v as usize..][..3]);
        }
        gpu::with(|gpu| {
            gpu.set_solid(&SolidData {
                skin: &scratch.skin,
                inverted: &scratch.inverted,
                creases: &scratch.creases,
            });
        });
        self.cut_stale = true;
    }

    /// The plane of the cut, with the side towards the viewer taken away.
    pub fn plane(&self, towards: Vec3) -> Option<Plane> {
        let Cut { axis, at } = self.cut?;
        let unit = [Vec3::X, Vec3::Y, Vec3::Z][axis.min(2)];
        // A plane seen nearly edge on keeps its side, so that it does not flicker.
        let facing = unit.dot(towards);
        let before = self.plane.map_or(0.0, |p| p.normal.dot(unit));
        let side = if before != 0.0 && facing.abs() < 0.12 {
            before
        } else {
            facing
        };
        let normal = if side < 0.0 { -unit } else { unit };
        let reach = self.solid.high - self.solid.low;
        // Never exactly through a layer of vertices: the sections there would be empty.
        let offset = (self.solid.low + reach * (at * 0.9994 + 0.000_31)).dot(normal);
        Some(Plane { normal, offset })
    }

    /// Brings the faces of the cut up to date.
    pub fn refresh_cut(&mut self, frame: &[f32], plane: Option<Plane>) {
        if !std::mem::take(&mut self.cut_stale) && self.plane == plane {
            return;
        }
        self.plane = plane;
        let out = &mut self.scratch.cut;
        let upright = match plane {
            Some(plane) => slice::cut_faces(
                &self.solid.tetrahedra,
                frame,
                &self.values,
                plane,
                &mut self.met,
                out,
            ),
            None => {
                out.clear();
                self.met.clear();
                0
            }
        };
        gpu::with(|gpu| gpu.set_cut(out, upright));
    }

    /// The legend of the colours.
    pub fn legend(&self) -> Legend {
        let (ramp, short): (fn(f64) -> colour::Rgb, _) = match self.field {
            Field::Stretch => (colour::cividis, "stretch or squeeze"),
            Field::Volume if self.solid.planar => (colour::diverging, "area"),
            Field::Volume => (colour::diverging, "volume"),
            Field::Stress => (colour::cividis, "stress"),
            Field::Zone => (colour::zones, "zones"),
        };
        Legend {
            caption: match self.solid.planar {
                true => self.field.planar_caption(),
                false => self.field.caption(),
            },
            short,
            ramp,
            position: match self.field {
                Field::Stretch => |v| Field::Stretch.position(v),
                Field::Volume => |v| Field::Volume.position(v),
                Field::Stress => |v| Field::Stress.position(v),
                Field::Zone => |v| Field::Zone.position(v),
            },
            ticks: self.field.ticks(),
            clamped_above: self.field != Field::Zone,
            clamped_below: self.field == Field::Volume,
        }
    }

    /// How the solid is drawn from a camera.
    pub fn look(&self, orbit: &Orbit, aspect: f32, tint: f32, plane: Option<Plane>) -> SolidLook {
        SolidLook {
            matrix: orbit.matrix(aspect),
            turn: Mat3::from_quat(orbit.rotation),
            radius: orbit.radius,
            row: self.field.row(),
            tint,
            plane,
        }
    }
}

impl Bench {
    /// Puts a solid on the bench and forgets the runs on the last one: rest positions (n×3),
    /// tetrahedra (m×4), skin triangles (k×3), indices in range.
    pub fn set_solid(&mut self, positions: &[f64], tetrahedra: &[u32], skin: &[u32]) {
        self.set_body(positions, Solid::new(positions, tetrahedra, skin));
    }

    /// The same with triangles (m×3) of a plane z = constant.
    pub fn set_planar(&mut self, positions: &[f64], triangles: &[u32]) {
        self.set_body(positions, Solid::planar(positions, triangles));
    }

    /// Looks at where these positions are instead of at those at rest, and cuts there.
    pub fn look_at(&mut self, positions: &[f64]) {
        let Some(body) = &mut self.body else { return };
        self.orbit = match body.solid.planar {
            true => Orbit::above(positions),
            false => Orbit::around(positions).reaching(REACH),
        };
        let points = positions.as_chunks::<3>().0.iter();
        let points = points.map(|p| Vec3::from_array(p.map(|x| x as f32)));
        let ends = points
            .map(|p| (p, p))
            .reduce(|(l, h), (p, q)| (l.min(p), h.max(q)));
        (body.solid.low, body.solid.high) = ends.unwrap_or((body.solid.low, body.solid.high));
    }

    fn set_body(&mut self, positions: &[f64], solid: Solid) {
        let before = self.body.take();
        if before.is_none() {
            // What is inside shows through a plain skin best.
            self.tinted = false;
        }
        let same = before.as_ref().is_some_and(|b| {
            b.solid.tetrahedra == solid.tetrahedra && b.solid.vertices == solid.vertices
        });
        if !same {
            self.orbit = match solid.planar {
                true => Orbit::above(positions),
                false => Orbit::around(positions).reaching(REACH),
            };
        }
        let body = before.map_or_else(Body::default, |b| Body {
            field: b.field,
            cut: b.cut,
            box_tool: b.box_tool,
            ..Default::default()
        });
        self.body = Some(Body { solid, ..body });
        self.forget_runs();
    }
}
