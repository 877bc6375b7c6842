//! Meshes and checks that several tests share.
#![allow(dead_code)]

use foldfree::mesh::SurfaceMesh;
use glam::DVec3;
use std::collections::BTreeMap;

/// A small generator of pseudo-random numbers (SplitMix64): tests must not change from run to run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In 0..1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.next() as usize % (i + 1));
        }
    }
}

/// The boundary surface of a set of unit cubes, each face divided n × n: '#' in the layers' rows.
pub fn voxels(layers: &[&[&str]], n: i64) -> SurfaceMesh {
    let filled = |[x, y, z]: [i64; 3]| {
        let row = usize::try_from(z).ok().and_then(|z| layers.get(z));
        let row = row.and_then(|l| usize::try_from(y).ok().and_then(|y| l.get(y)));
        let cell = row.and_then(|r| usize::try_from(x).ok().and_then(|x| r.as_bytes().get(x)));
        cell == Some(&b'#')
    };
    let mut mesh = SurfaceMesh::default();
    let mut ids: BTreeMap<[i64; 3], u32> = BTreeMap::new();
    for z in 0..layers.len() as i64 {
        for y in 0..layers[z as usize].len() as i64 {
            for x in 0..layers[z as usize][y as usize].len() as i64 {
                let cell = [x, y, z];
                if !filled(cell) {
                    continue;
                }
                for axis in 0..3 {
                    for side in [0, 1] {
                        let mut neighbour = cell;
                        neighbour[axis] += 2 * side - 1;
                        if filled(neighbour) {
                            continue;
                        }
                        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                        for i in 0..n {
                            for j in 0..n {
                                let mut corner = |a: i64, b: i64| {
                                    let mut p = cell.map(|c| c * n);
                                    p[axis] += side * n;
                                    p[u] += i + a;
                                    p[v] += j + b;
                                    *ids.entry(p).or_insert_with(|| {
                                        let scaled = p.map(|c| c as f64 / n as f64);
                                        mesh.positions.push(DVec3::from_array(scaled));
                                        (mesh.positions.len() - 1) as u32
                                    })
                                };
                                let mut quad =
                                    [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                                if side == 0 {
                                    quad.reverse();
                                }
                                let [a, b, c, d] = quad;
                                mesh.simplices.extend([[a, b, c], [a, c, d]]);
                            }
                        }
                    }
                }
            }
        }
    }
    mesh
}

/// A block with two holes through it: genus 2.
pub fn double_torus(n: i64) -> SurfaceMesh {
    voxels(&[&["#####", "#.#.#", "#####"]], n)
}

/// Moves every vertex a little, so that no two lengths are equal.
pub fn jitter(mesh: &mut SurfaceMesh, amount: f64) {
    let mut random = Random(7);
    for position in &mut mesh.positions {
        let mut offset = || (random.unit() - 0.5) * amount;
        *position += DVec3::new(offset(), offset(), offset());
    }
}

/// The same surface with its vertices and faces in another order, and faces beginning elsewhere.
pub fn shuffled(mesh: &SurfaceMesh, seed: u64) -> SurfaceMesh {
    let mut random = Random(seed);
    let mut order: Vec<usize> = (0..mesh.positions.len()).collect();
    random.shuffle(&mut order);
    let mut new = vec![0u32; order.len()];
    for (index, &old) in order.iter().enumerate() {
        new[old] = index as u32;
    }
    let mut simplices = mesh.simplices.clone();
    for simplex in &mut simplices {
        *simplex = simplex.map(|v| new[v as usize]);
        simplex.rotate_left(random.next() as usize % 3);
    }
    random.shuffle(&mut simplices);
    SurfaceMesh {
        positions: order.iter().map(|&v| mesh.positions[v]).collect(),
        simplices,
    }
}

/// The mesh without the faces for which `remove` holds, unused vertices dropped.
pub fn without(mesh: &SurfaceMesh, remove: impl Fn(usize, DVec3) -> bool) -> SurfaceMesh {
    let mut kept = mesh.clone();
    let mut index = 0;
    kept.simplices.retain(|simplex| {
        let centre = simplex
            .map(|v| mesh.positions[v as usize])
            .iter()
            .sum::<DVec3>()
            / 3.0;
        index += 1;
        !remove(index - 1, centre)
    });
    foldfree::mesh::prepare(&kept).unwrap().mesh
}

/// Two meshes side by side.
pub fn both(a: &SurfaceMesh, b: &SurfaceMesh) -> SurfaceMesh {
    let shift = a.positions.len() as u32;
    let far = DVec3::new(10.0, 0.0, 0.0);
    SurfaceMesh {
        positions: a
            .positions
            .iter()
            .copied()
            .chain(b.positions.iter().map(|&p| p + far))
            .collect(),
        simplices: a
            .simplices
            .iter()
            .copied()
            .chain(b.simplices.iter().map(|s| s.map(|v| v + shift)))
            .collect(),
    }
}
