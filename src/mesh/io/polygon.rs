//! Triangulating one polygon: a fan where that is right, else ear clipping in the Newell plane.

use glam::{DVec2, DVec3};

/// Polygons of more corners than this that are not fans are refused (ear clipping is quadratic).
const MAX_CLIPPED_CORNERS: usize = 4096;

/// How a polygon came apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    /// Into triangles of its own orientation that cover it.
    Clean,
    /// It crosses itself or has no area: triangles there are, but they may overlap or be degenerate.
    Doubtful,
    /// Not a fan, and more than [`MAX_CLIPPED_CORNERS`] corners.
    TooLarge,
}

/// Collects faces of any number of corners as triangles.
#[derive(Default)]
pub(super) struct Faces {
    /// The triangles.
    pub triangles: Vec<[u32; 3]>,
    polygons: usize,
    doubtful: usize,
    points: Vec<DVec3>,
    split: Vec<[u32; 3]>,
}

impl Faces {
    /// Adds a face of three corners or more, all of them within range; what is wrong if it cannot be
    /// triangulated.
    pub fn push(&mut self, corners: &[u32], positions: &[DVec3]) -> Result<(), String> {
        if let &[a, b, c] = corners {
            self.triangles.push([a, b, c]);
            return Ok(());
        }
        self.polygons += 1;
        self.points.clear();
        self.points
            .extend(corners.iter().map(|&v| positions[v as usize]));
        match triangulate(&self.points, &mut self.split) {
            Outcome::Clean => {}
            Outcome::Doubtful => self.doubtful += 1,
            Outcome::TooLarge => return Err(too_large(corners.len())),
        }
        let faces = self.split.iter().map(|t| t.map(|k| corners[k as usize]));
        self.triangles.extend(faces);
        Ok(())
    }

    /// Says what became of the polygons.
    pub fn note(&self, notes: &mut Vec<String>) {
        super::note_polygons(notes, self.polygons, self.doubtful);
    }
}

/// What is wrong with a polygon that is [`Outcome::TooLarge`].
pub(super) fn too_large(corners: usize) -> String {
    format!(
        "a polygon of {corners} corners that is not convex (at most {MAX_CLIPPED_CORNERS} are taken)"
    )
}

/// Replaces `out` by the `points.len() − 2` triangles of the polygon (indices into `points`).
pub(super) fn triangulate(points: &[DVec3], out: &mut Vec<[u32; 3]>) -> Outcome {
    out.clear();
    let n = points.len();
    if n < 3 {
        return Outcome::Doubtful;
    }
    let fan = |out: &mut Vec<[u32; 3]>| {
        out.clear();
        out.extend((1..n as u32 - 1).map(|i| [0, i, i + 1]));
    };
    let Some((flat, scale)) = flatten(points) else {
        fan(out);
        return Outcome::Doubtful;
    };
    let tiny = 1e-12 * scale;
    if (1..n - 1).all(|i| cross(flat[0], flat[i], flat[i + 1]) > tiny) {
        fan(out);
        return Outcome::Clean;
    }
    if n > MAX_CLIPPED_CORNERS {
        fan(out);
        return Outcome::TooLarge;
    }
    Clipper::new(&flat, tiny).run(out)
}

/// Coordinates in the Newell plane (the polygon counter-clockwise), and twice the polygon's area;
/// `None` if it has none.
fn flatten(points: &[DVec3]) -> Option<(Vec<DVec2>, f64)> {
    let origin = points[0];
    let extent = points
        .iter()
        .map(|p| (*p - origin).abs().max_element())
        .fold(0.0, f64::max);
    if !(extent > 0.0 && extent.is_finite()) {
        return None;
    }
    let local = |i: usize| (points[i % points.len()] - origin) / extent;
    let mut normal = DVec3::ZERO;
    for i in 0..points.len() {
        normal += local(i).cross(local(i + 1));
    }
    let area = normal.length();
    if area <= 1e-14 {
        return None;
    }
    let normal = normal / area;
    let u = normal.any_orthonormal_vector();
    let v = normal.cross(u);
    let flat = (0..points.len())
        .map(|i| DVec2::new(local(i).dot(u), local(i).dot(v)))
        .collect();
    Some((flat, area))
}

/// Twice the signed area of a triangle.
fn cross(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Ear clipping on a doubly linked ring. The state of a corner changes only when a neighbour is cut
/// off, and only reflex corners can lie in an ear: n·reflex steps in all.
struct Clipper<'a> {
    points: &'a [DVec2],
    tiny: f64,
    previous: Vec<u32>,
    next: Vec<u32>,
    /// Corners that are not strictly convex, as long as they are in the ring.
    reflex: Vec<u32>,
    is_reflex: Vec<bool>,
    is_ear: Vec<bool>,
}

impl<'a> Clipper<'a> {
    fn new(points: &'a [DVec2], tiny: f64) -> Self {
        let n = points.len() as u32;
        let mut clipper = Clipper {
            points,
            tiny,
            previous: (0..n).map(|i| (i + n - 1) % n).collect(),
            next: (0..n).map(|i| (i + 1) % n).collect(),
            reflex: Vec::new(),
            is_reflex: vec![false; n as usize],
            is_ear: vec![false; n as usize],
        };
        for i in 0..n {
            if clipper.turn(i) <= tiny {
                clipper.is_reflex[i as usize] = true;
                clipper.reflex.push(i);
            }
        }
        for i in 0..n {
            clipper.is_ear[i as usize] = clipper.ear(i);
        }
        clipper
    }

    fn turn(&self, i: u32) -> f64 {
        let [a, b, c] = self.corners(i).map(|i| self.points[i as usize]);
        cross(a, b, c)
    }

    fn corners(&self, i: u32) -> [u32; 3] {
        [self.previous[i as usize], i, self.next[i as usize]]
    }

    /// Strictly convex, with no other corner in the closed triangle.
    fn ear(&self, i: u32) -> bool {
        if self.is_reflex[i as usize] {
            return false;
        }
        let corners = self.corners(i);
        let [a, b, c] = corners.map(|i| self.points[i as usize]);
        !self.reflex.iter().any(|&other| {
            let p = self.points[other as usize];
            // A corner in the place of one of the ear's (a bridge to a hole) does not block it.
            self.is_reflex[other as usize]
                && !corners.contains(&other)
                && p != a
                && p != b
                && p != c
                && cross(a, b, p) >= 0.0
                && cross(b, c, p) >= 0.0
                && cross(c, a, p) >= 0.0
        })
    }

    fn refresh(&mut self, i: u32) {
        if self.is_reflex[i as usize] && self.turn(i) > self.tiny {
            self.is_reflex[i as usize] = false;
        }
        if !self.is_reflex[i as usize] && self.turn(i) <= self.tiny {
            self.is_reflex[i as usize] = true;
            self.reflex.push(i);
        }
        self.is_ear[i as usize] = self.ear(i);
    }

    fn run(mut self, out: &mut Vec<[u32; 3]>) -> Outcome {
        let mut left = self.points.len();
        let mut at = 0;
        let mut passed = 0;
        while left > 3 {
            if passed > left {
                // No ear left: the polygon crosses itself or what is left is flat.
                return self.give_up(at, left, out);
            }
            if !self.is_ear[at as usize] {
                at = self.next[at as usize];
                passed += 1;
                continue;
            }
            out.push(self.corners(at));
            let [before, _, after] = self.corners(at);
            self.next[before as usize] = after;
            self.previous[after as usize] = before;
            self.is_reflex[at as usize] = false;
            if self.reflex.len() > 2 * left {
                let is_reflex = &self.is_reflex;
                self.reflex.retain(|&i| is_reflex[i as usize]);
            }
            self.refresh(before);
            self.refresh(after);
            left -= 1;
            passed = 0;
            // Going on behind the neighbour spreads the ears round the ring.
            at = self.next[after as usize];
        }
        let clean = self.turn(at) > self.tiny;
        out.push(self.corners(at));
        if clean {
            Outcome::Clean
        } else {
            Outcome::Doubtful
        }
    }

    /// The rest as a fan.
    fn give_up(&self, apex: u32, left: usize, out: &mut Vec<[u32; 3]>) -> Outcome {
        let mut at = self.next[apex as usize];
        for _ in 0..left - 2 {
            let next = self.next[at as usize];
            out.push([apex, at, next]);
            at = next;
        }
        Outcome::Doubtful
    }
}
