//! Fixed-boundary problems that have an injective solution: the boundary of a shape is taken along by a map of space
//! that is known to invert none of its elements, and the inside starts anywhere.
#![allow(dead_code)]

mod wheel;

#[allow(unused_imports)]
pub use wheel::spiked_wheel;

use foldfree::certificate::{orientation, orientation_of_tetrahedron};
use foldfree::geometry::RestShape;
use foldfree::mesh::{SimplicialMesh, SolidMesh, SolidShape, SurfaceMesh, generate_solid};
use glam::{DVec2, DVec3};

/// How the boundary is deformed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bend {
    Twisted,
    Bent,
    Sheared,
    Squashed,
    Waved,
}

impl Bend {
    pub const ALL: [Bend; 5] = [
        Bend::Twisted,
        Bend::Bent,
        Bend::Sheared,
        Bend::Squashed,
        Bend::Waved,
    ];

    /// The image of a point of a body that fills about −1..1 along its longest axis x.
    fn of(self, p: DVec3, amount: f64) -> DVec3 {
        match self {
            Bend::Twisted => {
                let (s, c) = (amount * std::f64::consts::PI * p.x).sin_cos();
                DVec3::new(p.x, c * p.y - s * p.z, s * p.y + c * p.z)
            }
            Bend::Bent => {
                // x along a circle in the plane of x and y
                let angle = 1.2 * amount * p.x;
                let radius = 1.0 / (1.2 * amount) - p.y;
                DVec3::new(
                    radius * angle.sin(),
                    1.0 / (1.2 * amount) - radius * angle.cos(),
                    p.z,
                )
            }
            Bend::Sheared => DVec3::new(p.x + 2.0 * amount * p.y, p.y + amount * p.z, p.z),
            Bend::Squashed => {
                let squash = 1.0 - 0.85 * amount * (-4.0 * p.x * p.x).exp();
                DVec3::new(p.x, p.y * squash, p.z)
            }
            Bend::Waved => {
                let wave = 0.4 * amount * (5.0 * p.x).sin();
                DVec3::new(p.x, p.y + wave, p.z + 0.4 * amount * (4.0 * p.x).cos())
            }
        }
    }
}

/// Where the inside starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Inside {
    Harmonic,
    Random,
    OnePoint,
}

impl Inside {
    pub const ALL: [Inside; 3] = [Inside::Harmonic, Inside::Random, Inside::OnePoint];
}

/// A problem: rest shape, start, pins.
pub struct Tangle<const K: usize> {
    pub rest: SimplicialMesh<K>,
    pub start: Vec<DVec3>,
    pub pins: Vec<u32>,
}

/// The body in a box of largest extent −1..1, longest axis along x; deformed so that no element inverts, by as much
/// of `amount` as allows that.
fn images<const K: usize>(
    rest: &mut SimplicialMesh<K>,
    bend: Bend,
    is_positive: impl Fn([DVec3; K]) -> bool,
) -> Vec<DVec3> {
    let low = rest
        .positions
        .iter()
        .fold(DVec3::INFINITY, |a, &p| a.min(p));
    let high = rest
        .positions
        .iter()
        .fold(-DVec3::INFINITY, |a, &p| a.max(p));
    let extent = high - low;
    let turn = |p: DVec3| match () {
        _ if extent.x >= extent.y && extent.x >= extent.z => p,
        _ if extent.y >= extent.z => DVec3::new(p.y, -p.x, p.z),
        () => DVec3::new(p.z, p.y, -p.x),
    };
    let scale = 2.0 / extent.max_element();
    let middle = 0.5 * (low + high);
    rest.positions
        .iter_mut()
        .for_each(|p| *p = turn((*p - middle) * scale));
    let mut amount = 1.0;
    loop {
        let images: Vec<DVec3> = rest.positions.iter().map(|&p| bend.of(p, amount)).collect();
        let fine = |simplex: &[u32; K]| is_positive(simplex.map(|v| images[v as usize]));
        if rest.simplices.iter().all(fine) {
            return images;
        }
        amount *= 0.8;
        assert!(amount > 0.01, "the shape itself is degenerate");
    }
}

/// Vertices that are not pinned are put where the start wants them.
fn place<const K: usize>(
    rest: SimplicialMesh<K>,
    shape: &RestShape,
    images: Vec<DVec3>,
    is_pinned: Vec<bool>,
    inside: Inside,
    seed: u64,
) -> Tangle<K> {
    let mut start = images;
    let free: Vec<usize> = (0..start.len()).filter(|&v| !is_pinned[v]).collect();
    let pinned = || (0..is_pinned.len()).filter(|&v| is_pinned[v]);
    let low = pinned().fold(DVec3::INFINITY, |a, v| a.min(start[v]));
    let high = pinned().fold(-DVec3::INFINITY, |a, v| a.max(start[v]));
    match inside {
        Inside::OnePoint => free.iter().for_each(|&v| start[v] = 0.5 * (low + high)),
        Inside::Random => {
            let mut state = seed;
            let mut next = || {
                state = state
                    .wrapping_mul(6_364_136_223_846_793_005)
                    .wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            };
            for &v in &free {
                let t = DVec3::new(next(), next(), next());
                start[v] = low + (high - low) * t;
            }
        }
        Inside::Harmonic => harmonic(shape, &is_pinned, &mut start),
    }
    let pins = pinned().map(|v| v as u32).collect();
    Tangle { rest, start, pins }
}

/// Replaces what is not pinned by the harmonic interpolation of what is: conjugate gradients.
fn harmonic(rest: &RestShape, is_pinned: &[bool], x: &mut [DVec3]) {
    let corners = rest.stretches + 1;
    let apply = |x: &[DVec3], out: &mut Vec<DVec3>| {
        out.clear();
        out.resize(x.len(), DVec3::ZERO);
        for e in 0..rest.len() {
            let s = rest.simplex(e);
            for a in 0..corners {
                for b in 0..corners {
                    let weight = rest.measure[e] * rest.hat_product(e, a, b);
                    out[s[a] as usize] += weight * x[s[b] as usize];
                }
            }
        }
        for (out, &pinned) in out.iter_mut().zip(is_pinned) {
            if pinned {
                *out = DVec3::ZERO;
            }
        }
    };
    for (x, &pinned) in x.iter_mut().zip(is_pinned) {
        if !pinned {
            *x = DVec3::ZERO;
        }
    }
    let dot = |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum::<f64>();
    let mut image = Vec::new();
    apply(x, &mut image);
    let mut residual: Vec<DVec3> = image.iter().map(|r| -*r).collect();
    let mut direction = residual.clone();
    let mut square = dot(&residual, &residual);
    let goal = 1e-20 * square;
    for _ in 0..2000 {
        if square <= goal {
            break;
        }
        apply(&direction, &mut image);
        let step = square / dot(&direction, &image);
        for v in 0..x.len() {
            x[v] += step * direction[v];
            residual[v] -= step * image[v];
        }
        let next = dot(&residual, &residual);
        for (d, r) in direction.iter_mut().zip(&residual) {
            *d = *r + next / square * *d;
        }
        square = next;
    }
}

/// A generated solid of about so many tetrahedra, its boundary bent and pinned.
pub fn solid(shape: SolidShape, count: usize, bend: Bend, inside: Inside) -> Tangle<4> {
    let mut rest: SolidMesh = generate_solid(shape, count);
    let images = images(&mut rest, bend, |[a, b, c, d]| {
        orientation_of_tetrahedron(a, b, c, d).is_gt()
    });
    let (shape, turned) = RestShape::of_solid(&rest).expect("a solid");
    assert!(!turned);
    let mut is_pinned = vec![false; rest.positions.len()];
    let boundary = rest.boundary().expect("a solid has a boundary");
    boundary
        .vertices
        .iter()
        .for_each(|&v| is_pinned[v as usize] = true);
    place(rest, &shape, images, is_pinned, inside, 7)
}

/// A grid of 2 n² triangles with its boundary bent and pinned.
pub fn sheet(n: usize, bend: Bend, inside: Inside) -> Tangle<3> {
    let mut rest = SurfaceMesh::default();
    for row in 0..=n {
        for column in 0..=n {
            rest.positions
                .push(DVec3::new(column as f64, row as f64, 0.0) / n as f64);
        }
    }
    for row in 0..n {
        for column in 0..n {
            let v = (row * (n + 1) + column) as u32;
            let above = v + n as u32 + 1;
            rest.simplices
                .extend([[v, v + 1, above + 1], [v, above + 1, above]]);
        }
    }
    let flatten = |p: DVec3| DVec2::new(p.x, p.y);
    // a turn about the middle instead of a twist about x, which would leave the plane
    let mut images = images(
        &mut rest,
        if bend == Bend::Twisted {
            Bend::Bent
        } else {
            bend
        },
        |[a, b, c]| orientation(flatten(a), flatten(b), flatten(c)).is_gt(),
    );
    for p in &mut images {
        if bend == Bend::Twisted {
            let angle = 1.5 * p.length();
            *p = DVec3::new(
                angle.cos() * p.x - angle.sin() * p.y,
                angle.sin() * p.x + angle.cos() * p.y,
                0.0,
            );
        }
        p.z = 0.0;
    }
    let (shape, _) = RestShape::of_plane(&rest).expect("a flat sheet");
    let is_edge = |v: usize| {
        let (row, column) = (v / (n + 1), v % (n + 1));
        row == 0 || column == 0 || row == n || column == n
    };
    let is_pinned = (0..rest.positions.len()).map(is_edge).collect();
    place(rest, &shape, images, is_pinned, inside, 3)
}
