//! The disks: each from its seed alone.

use crate::patch::{Patch, Random};
use foldfree::mesh::{Shape, SurfaceMesh, generate};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A disk, or a sphere cut open.
pub struct Disk {
    pub mesh: SurfaceMesh,
    /// What is difficult about it,
    pub kind: &'static str,
    /// and how much, from 0 to 1.
    pub nastiness: f64,
}

type Maker = fn(&mut Random, f64, f64) -> Patch;

const KINDS: [(&str, Maker); 9] = [
    ("hills", hills),
    ("cuts", cuts),
    ("spikes", spikes),
    ("slivers", slivers),
    ("snake", snake),
    ("cap", cap),
    ("finger", finger),
    ("maze", maze),
    ("all at once", all_at_once),
];

/// The disk of a seed: 1 000 to 20 000 triangles.
pub fn disk(seed: u64) -> Disk {
    let mut random = Random::new(seed);
    let triangles = random.log_between(1e3, 2e4);
    let nastiness = random.unit();
    let (kind, make) = KINDS[(seed % KINDS.len() as u64) as usize];
    let mut mesh = make(&mut random, triangles, nastiness).mesh;
    let scale = random.log_between(1e-3, 1e3);
    mesh.positions.iter_mut().for_each(|p| *p *= scale);
    Disk {
        mesh,
        kind,
        nastiness,
    }
}

fn square(random: &mut Random, triangles: f64) -> Patch {
    let aspect = random.log_between(0.5, 2.0);
    let columns = (triangles / 2.0 * aspect).sqrt().round() as usize;
    let rows = (triangles / 2.0 / columns as f64).round() as usize;
    Patch::grid(random, columns, rows, 0.4)
}

/// Smooth heights over a patch of about unit size.
fn raise(patch: &mut Patch, random: &mut Random, nastiness: f64) {
    let bumps: Vec<(DVec3, f64, f64)> = (0..12)
        .map(|_| {
            let radius = random.log_between(0.05, 0.4);
            let centre = DVec3::new(random.unit(), random.unit(), 0.0);
            let height = radius * (0.3 + 4.0 * nastiness) * (2.0 * random.unit() - 1.0);
            (centre, radius, height)
        })
        .collect();
    for p in &mut patch.mesh.positions {
        let flat = DVec3::new(p.x, p.y, 0.0);
        p.z += bumps
            .iter()
            .map(|(centre, radius, height)| {
                height * (-flat.distance_squared(*centre) / (radius * radius)).exp()
            })
            .sum::<f64>();
    }
}

fn hills(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = square(random, triangles);
    raise(&mut patch, random, nastiness);
    patch
}

/// Hills or a sphere, cut along random trees.
fn cuts(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = match random.unit() < 0.5 {
        true => Patch::new(generate(Shape::Sphere, triangles as usize)),
        false => hills(random, triangles, 0.5 * nastiness),
    };
    patch.cut(
        random,
        1 + (40.0 * nastiness) as usize,
        2.0 * triangles.sqrt(),
    );
    patch
}

/// Single vertices pulled far out, up to a thousand edges.
fn spike(patch: &mut Patch, random: &mut Random, count: usize, most: f64) {
    for _ in 0..count {
        let v = random.below(patch.mesh.positions.len());
        let edge = patch.edge_at(v);
        let far = random.log_between(1.0, most);
        patch.mesh.positions[v] += far * edge * random.direction();
    }
}

fn spikes(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = hills(random, triangles, 0.3);
    let count = random.log_between(1.0, 1.0 + 0.05 * triangles) as usize;
    spike(&mut patch, random, count, 1.0 + 10f64.powf(3.0 * nastiness));
    patch
}

/// Aspect ratios up to 1e4: columns and rows of very different widths, or vertices very near to a neighbour.
fn sliver(patch: &mut Patch, random: &mut Random, nastiness: f64) {
    let least = 10f64.powf(-4.0 * nastiness);
    if random.unit() < 0.5 {
        patch.squeeze(random, least);
    }
    if random.unit() < 0.7 {
        let share = random.log_between(1e-3, 0.1);
        for v in 0..patch.mesh.positions.len() {
            if random.unit() < share {
                let left = random.log_between(least, 1.0);
                patch.approach(v, random, left);
            }
        }
    }
}

fn slivers(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = square(random, triangles);
    sliver(&mut patch, random, nastiness);
    raise(&mut patch, random, 0.3);
    patch
}

/// A long narrow ribbon that curls in its surface, bends and winds.
fn snake(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let columns = (triangles / 2.0 * (1.0 - nastiness))
        .sqrt()
        .clamp(1.0, 1.0 + 9.0 * random.unit());
    let rows = (triangles / 2.0 / columns.floor()) as usize;
    let mut patch = Patch::grid(random, columns as usize, rows, 0.2);
    let width = 1.0 / rows as f64 * columns.floor();
    patch.wind(random, rows, 0.7 / width);
    patch
}

/// A cap of a sphere that reaches far round it, with noise on it.
fn cap(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = Patch::round(random, triangles);
    let reach = PI * (0.3 + 0.65 * nastiness);
    let waves: Vec<(DVec3, f64, f64)> = (0..8)
        .map(|_| {
            let frequency = random.log_between(2.0, 30.0);
            let wave = frequency * random.direction();
            (wave, nastiness / frequency, TAU * random.unit())
        })
        .collect();
    for p in &mut patch.mesh.positions {
        let (polar, longitude) = (p.length() * reach, p.y.atan2(p.x));
        let direction = DVec3::new(
            polar.sin() * longitude.cos(),
            polar.sin() * longitude.sin(),
            polar.cos(),
        );
        let height: f64 = waves
            .iter()
            .map(|(k, a, phase)| a * (k.dot(direction) + phase).sin())
            .sum();
        *p = direction * (1.0 + 0.8 * height).max(0.1);
    }
    patch
}

/// A tube, closed at one end, up to three times as long as it is thick, that stands on a brim.
fn finger(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = Patch::round(random, triangles);
    let length = 0.5 + 5.5 * nastiness;
    let bend = random.unit();
    for p in &mut patch.mesh.positions {
        let (along, longitude) = (p.length(), p.y.atan2(p.x));
        // a hemisphere, the tube, the brim
        let (radius, height) = match along {
            a if a < 0.25 => ((a * TAU).sin(), length + (a * TAU).cos()),
            a if a < 0.85 => (1.0, length * (0.85 - a) / 0.6),
            a => (1.0 + 10.0 * (a - 0.85), 0.0),
        };
        let lean = bend * height * height / (1.0 + height);
        *p = DVec3::new(
            radius * longitude.cos() + lean,
            radius * longitude.sin(),
            height,
        );
    }
    patch
}

/// A region grown at random, with a boundary of no shape.
fn grown(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = square(random, 4.0 * triangles);
    patch.grow(random, triangles as usize, nastiness);
    patch
}

fn maze(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = grown(random, triangles, nastiness);
    raise(&mut patch, random, 0.5);
    patch
}

fn all_at_once(random: &mut Random, triangles: f64, nastiness: f64) -> Patch {
    let mut patch = match random.unit() < 0.5 {
        true => square(random, triangles),
        false => grown(random, triangles, 0.5 * nastiness),
    };
    sliver(&mut patch, random, 0.75 * nastiness);
    raise(&mut patch, random, nastiness);
    patch.cut(random, 1 + (20.0 * nastiness) as usize, triangles.sqrt());
    let count = (0.01 * triangles * nastiness) as usize;
    spike(&mut patch, random, count, 1.0 + 10f64.powf(2.0 * nastiness));
    patch
}
