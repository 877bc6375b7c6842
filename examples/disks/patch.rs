//! A piece of surface, and what can be done to it without it ceasing to be a disk.

use foldfree::mesh::SurfaceMesh;
use glam::DVec3;
use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::FRAC_PI_4;

/// Less is no area: the size of a disk is about 1.
const LEAST_AREA: f64 = 1e-12;

/// SplitMix64 (Steele et al. 2014).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
    /// A number whose logarithm is uniform.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let p = 2.0 * DVec3::new(self.unit(), self.unit(), self.unit()) - DVec3::ONE;
            if (0.01..1.0).contains(&p.length_squared()) {
                return p.normalize();
            }
        }
    }
}

pub struct Patch {
    pub mesh: SurfaceMesh,
    /// Neighbours of each vertex.
    around: Vec<Vec<u32>>,
}

fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

impl Patch {
    pub fn new(mesh: SurfaceMesh) -> Self {
        let mut around = vec![Vec::new(); mesh.positions.len()];
        for t in &mesh.simplices {
            for k in 0..3 {
                for other in [t[(k + 1) % 3], t[(k + 2) % 3]] {
                    if !around[t[k] as usize].contains(&other) {
                        around[t[k] as usize].push(other);
                    }
                }
            }
        }
        Self { mesh, around }
    }

    /// A flat grid whose longer side is 1: its vertices moved by up to this part of a cell, its diagonals at random.
    pub fn grid(random: &mut Random, columns: usize, rows: usize, jitter: f64) -> Self {
        let (columns, rows) = (columns.max(1), rows.max(1));
        let cell = 1.0 / columns.max(rows) as f64;
        let mut mesh = SurfaceMesh::default();
        for j in 0..=rows {
            for i in 0..=columns {
                let mut off = || jitter * (random.unit() - 0.5);
                let at = DVec3::new(i as f64 + off(), j as f64 + off(), 0.0);
                mesh.positions.push(cell * at);
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = (j * (columns + 1) + i) as u32;
                let (b, c) = (a + 1, a + columns as u32 + 1);
                mesh.simplices.extend(match random.unit() < 0.5 {
                    true => [[a, b, c + 1], [a, c + 1, c]],
                    false => [[a, b, c], [b, c + 1, c]],
                });
            }
        }
        Self::new(mesh)
    }

    /// A flat unit disk: a square, its rings made round.
    pub fn round(random: &mut Random, triangles: f64) -> Self {
        let half = (triangles / 8.0).sqrt().round().max(1.0);
        let mut patch = Self::grid(random, 2 * half as usize, 2 * half as usize, 0.3);
        for p in &mut patch.mesh.positions {
            let (x, y) = (2.0 * p.x - 1.0, 2.0 * p.y - 1.0);
            let (radius, angle) = match x.abs() > y.abs() {
                true => (x, FRAC_PI_4 * y / x),
                false => (
                    y,
                    2.0 * FRAC_PI_4 - FRAC_PI_4 * x / if y == 0.0 { 1.0 } else { y },
                ),
            };
            *p = DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
        }
        patch
    }

    /// The mean length of the edges of a vertex.
    pub fn edge_at(&self, v: usize) -> f64 {
        let here = self.mesh.positions[v];
        let length = |&u: &u32| self.mesh.positions[u as usize].distance(here);
        self.around[v].iter().map(length).sum::<f64>() / self.around[v].len().max(1) as f64
    }

    /// Moves a vertex to one of its neighbours, up to a part of the way that is left, unless a triangle would be
    /// left without an area.
    pub fn approach(&mut self, v: usize, random: &mut Random, left: f64) {
        if let Some(&u) = self.around[v].get(random.below(self.around[v].len())) {
            let before = self.mesh.positions[v];
            self.mesh.positions[v] = self.mesh.positions[u as usize].lerp(before, left);
            let at = |v: u32| self.mesh.positions[v as usize];
            let area = |t: &[u32; 3]| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).length();
            let mut triangles = self.mesh.simplices.iter();
            if triangles.any(|t| t.contains(&(v as u32)) && area(t) < LEAST_AREA) {
                self.mesh.positions[v] = before;
            }
        }
    }

    /// Makes columns and rows of widths that differ by up to 1 / `least`.
    pub fn squeeze(&mut self, random: &mut Random, least: f64) {
        const BANDS: usize = 64;
        for axis in 0..2 {
            let mut ends = vec![0.0];
            for _ in 0..BANDS {
                ends.push(ends[ends.len() - 1] + random.log_between(least, 1.0));
            }
            let all = ends[BANDS];
            for p in &mut self.mesh.positions {
                let at = p[axis].clamp(-0.5, 1.5) * BANDS as f64;
                let band = (at.max(0.0) as usize).min(BANDS - 1);
                let part = at - band as f64;
                p[axis] = (ends[band] + part * (ends[band + 1] - ends[band])) / all;
            }
        }
    }

    /// Lays a strip, whose rows follow y, along a curve that turns in the surface, bends out of it and winds; in
    /// the surface by no more than `most` radians a unit of length.
    pub fn wind(&mut self, random: &mut Random, rows: usize, most: f64) {
        let columns = self.mesh.positions.len() / (rows + 1);
        let step = 1.0 / rows as f64;
        let (mut at, mut ahead, mut side) = (DVec3::ZERO, DVec3::Y, DVec3::X);
        let mut rates = [0.0; 3];
        for row in 0..=rows {
            if row == 0 || random.unit() < 0.02 {
                rates = [most, most, most].map(|most| most * (2.0 * random.unit() - 1.0));
            }
            for p in &mut self.mesh.positions[row * columns..][..columns] {
                let across = p.x - 0.5 * (columns - 1) as f64 * step;
                *p = at + across * side + (p.y - row as f64 * step) * ahead;
            }
            at += step * ahead;
            let up = side.cross(ahead);
            let [turn, bend, wind] = rates.map(|rate| rate * step);
            ahead = (ahead + turn * side + bend * up).normalize();
            side = (side + wind * up - side.dot(ahead) * ahead).normalize();
            side = (side - side.dot(ahead) * ahead).normalize();
        }
    }

    /// Faces beside each edge.
    fn faces(&self) -> BTreeMap<(u32, u32), Vec<usize>> {
        let mut faces: BTreeMap<_, Vec<usize>> = BTreeMap::new();
        for (f, t) in self.mesh.simplices.iter().enumerate() {
            for k in 0..3 {
                faces.entry(edge(t[k], t[(k + 1) % 3])).or_default().push(f);
            }
        }
        faces
    }

    /// Cuts along random walks, each of which begins at the boundary or at an earlier cut and meets none again:
    /// a disk, or a sphere, becomes a disk.
    pub fn cut(&mut self, random: &mut Random, walks: usize, longest: f64) {
        let faces = self.faces();
        let mut seen = vec![false; self.mesh.positions.len()];
        for (edge, _) in faces.iter().filter(|(_, beside)| beside.len() == 1) {
            seen[edge.0 as usize] = true;
            seen[edge.1 as usize] = true;
        }
        if !seen.contains(&true) {
            let v = random.below(seen.len());
            seen[v] = true;
        }
        let mut cuts = BTreeMap::new();
        for _ in 0..walks {
            let begins: Vec<usize> = (0..seen.len()).filter(|&v| seen[v]).collect();
            let mut here = begins[random.below(begins.len())];
            for _ in 0..2 + random.below(longest as usize) {
                let free: Vec<u32> = self.around[here]
                    .iter()
                    .copied()
                    .filter(|&u| !seen[u as usize])
                    .collect();
                if free.is_empty() {
                    break;
                }
                let next = free[random.below(free.len())];
                cuts.insert(edge(here as u32, next), ());
                seen[next as usize] = true;
                here = next as usize;
            }
        }
        // corners that are joined across an edge that is not cut are one vertex
        let mut root: Vec<usize> = (0..3 * self.mesh.simplices.len()).collect();
        fn find(root: &mut [usize], mut c: usize) -> usize {
            while root[c] != c {
                root[c] = root[root[c]];
                c = root[c];
            }
            c
        }
        for (ends, beside) in &faces {
            if beside.len() == 2 && !cuts.contains_key(ends) {
                for v in [ends.0, ends.1] {
                    let corner = |f: usize| {
                        3 * f
                            + self.mesh.simplices[f]
                                .iter()
                                .position(|&u| u == v)
                                .expect("an end")
                    };
                    let (a, b) = (corner(beside[0]), corner(beside[1]));
                    let (a, b) = (find(&mut root, a), find(&mut root, b));
                    root[a.max(b)] = a.min(b);
                }
            }
        }
        let mut mesh = SurfaceMesh::default();
        let mut number = BTreeMap::new();
        for (f, t) in self.mesh.simplices.iter().enumerate() {
            mesh.simplices.push(core::array::from_fn(|k| {
                *number.entry(find(&mut root, 3 * f + k)).or_insert_with(|| {
                    mesh.positions.push(self.mesh.positions[t[k] as usize]);
                    mesh.positions.len() as u32 - 1
                })
            }));
        }
        *self = Self::new(mesh);
    }

    /// Keeps a connected part of that many triangles without holes, grown from one: the nastier, the more it is a
    /// tree of narrow corridors.
    pub fn grow(&mut self, random: &mut Random, triangles: usize, nastiness: f64) {
        let faces = self.faces();
        let mut inside = vec![false; self.mesh.simplices.len()];
        let mut touched = vec![false; self.mesh.positions.len()];
        let mut kept = Vec::new();
        let mut front = VecDeque::from([random.below(inside.len())]);
        while let Some(f) = front.pop_back() {
            let t = self.mesh.simplices[f];
            let shared = |inside: &[bool]| {
                let is_shared = |k: &usize| {
                    faces[&edge(t[*k], t[(k + 1) % 3])]
                        .iter()
                        .any(|&g| inside[g])
                };
                (0..3).filter(is_shared).count()
            };
            let known = t.iter().filter(|&&v| touched[v as usize]).count();
            // glued along one edge, the third vertex being new, or along two: in both cases along an interval
            let may = !inside[f] && matches!((shared(&inside), known), (0, 0) | (1, 2) | (2, 3));
            if !may || (kept.len() > 1 && shared(&inside) == 0) {
                continue;
            }
            inside[f] = true;
            t.iter().for_each(|&v| touched[v as usize] = true);
            kept.push(f);
            if kept.len() == triangles {
                break;
            }
            for k in 0..3 {
                let beside = &faces[&edge(t[k], t[(k + 1) % 3])];
                front.extend(beside.iter().copied().filter(|&g| !inside[g]));
            }
            // the last in is the first out, or any other
            if random.unit() > 0.9 * nastiness {
                let (last, other) = (front.len().saturating_sub(1), random.below(front.len()));
                if last > 0 {
                    front.swap(last, other);
                }
            }
        }
        let mut mesh = SurfaceMesh::default();
        let mut number = BTreeMap::new();
        for f in kept {
            mesh.simplices.push(self.mesh.simplices[f].map(|v| {
                *number.entry(v).or_insert_with(|| {
                    mesh.positions.push(self.mesh.positions[v as usize]);
                    mesh.positions.len() as u32 - 1
                })
            }));
        }
        *self = Self::new(mesh);
    }
}
