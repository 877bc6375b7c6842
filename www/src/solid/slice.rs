//! Where a plane cuts tetrahedra.

use glam::Vec3;

/// A plane; the side its normal points to is taken away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Unit normal.
    pub normal: Vec3,
    /// Points on the plane have this product with the normal.
    pub offset: f32,
}

impl Plane {
    /// How far a point lies on the side that is taken away; negative on the side that stays.
    pub fn height(&self, p: Vec3) -> f32 {
        self.normal.dot(p) - self.offset
    }
}

/// One corner of a triangle on its way to the graphics card: x y z, where on the ramp (below 0
/// inverted, above 1 clamped), and which edges not to draw (bit k: the one opposite to corner k).
pub type Corner = [f32; 5];

/// A corner at `p`.
pub fn corner(p: Vec3, value: f32, hidden: f32) -> Corner {
    [p.x, p.y, p.z, value, hidden]
}

/// Where a corner is.
pub fn place(corner: &Corner) -> Vec3 {
    Vec3::from_slice(corner)
}

/// The polygon in which a plane cuts a tetrahedron: three or four points, in order; none if it does
/// not. `heights` are those of the corners.
pub fn section(corners: [Vec3; 4], heights: [f32; 4]) -> ([Vec3; 4], usize) {
    let mut polygon = [Vec3::ZERO; 4];
    let above = heights.map(|h| h > 0.0);
    let mut split = [0usize; 4];
    let mut count = 0;
    for side in [true, false] {
        for i in 0..4 {
            if above[i] == side {
                split[count] = i;
                count += 1;
            }
        }
    }
    let cut = |i: usize, j: usize| {
        let t = heights[i] / (heights[i] - heights[j]);
        corners[i].lerp(corners[j], t.clamp(0.0, 1.0))
    };
    let [a, b, c, d] = split;
    let edges: &[(usize, usize)] = match above.iter().filter(|x| **x).count() {
        1 => &[(a, b), (a, c), (a, d)],
        2 => &[(a, c), (a, d), (b, d), (b, c)],
        3 => &[(a, d), (b, d), (c, d)],
        _ => &[],
    };
    for (point, &(i, j)) in polygon.iter_mut().zip(edges) {
        *point = cut(i, j);
    }
    (polygon, edges.len())
}

/// Writes the cut faces of all tetrahedra that `plane` meets into `out`, upright ones first; returns how
/// many corners those have. `values` are one a tetrahedron, below 0 where inverted; `met` takes the
/// tetrahedra that are cut.
pub fn cut_faces(
    tetrahedra: &[[u32; 4]],
    positions: &[f32],
    values: &[f32],
    plane: Plane,
    met: &mut Vec<u32>,
    out: &mut Vec<Corner>,
) -> usize {
    met.clear();
    out.clear();
    let point = |v: u32| Vec3::from_slice(&positions[3 * v as usize..]);
    met.extend(
        (0u32..)
            .zip(tetrahedra)
            .filter(|(_, t)| {
                let above = t.iter().filter(|v| plane.height(point(**v)) > 0.0).count();
                (1..4).contains(&above)
            })
            .map(|(i, _)| i),
    );
    let mut upright = 0;
    for inverted in [false, true] {
        for &t in met.iter() {
            let value = values[t as usize];
            if (value < 0.0) != inverted {
                continue;
            }
            let corners = tetrahedra[t as usize].map(point);
            let (p, count) = section(corners, corners.map(|c| plane.height(c)));
            match count {
                3 => out.extend([0, 1, 2].map(|k| corner(p[k], value, 0.0))),
                // The diagonal is no edge of the mesh: opposite to corner 1, then to corner 2.
                4 => {
                    out.extend([0, 1, 2].map(|k| corner(p[k], value, 2.0)));
                    out.extend([0, 2, 3].map(|k| corner(p[k], value, 4.0)));
                }
                _ => {}
            }
        }
        if !inverted {
            upright = out.len();
        }
    }
    upright
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::tests::cube;

    fn area(corners: &[Corner]) -> f32 {
        corners
            .as_chunks::<3>()
            .0
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|c| place(&c));
                0.5 * (b - a).cross(c - a).length()
            })
            .sum()
    }

    #[test]
    fn the_section_of_a_cube_has_the_area_of_its_face() {
        let (positions, tetrahedra, _) = cube();
        let single: Vec<f32> = positions.iter().map(|p| *p as f32).collect();
        let (mut met, mut out) = (Vec::new(), Vec::new());
        for normal in [Vec3::X, Vec3::Y, Vec3::NEG_Z] {
            for at in [0.25, 0.5, 0.8] {
                let plane = Plane {
                    normal,
                    offset: at * normal.dot(Vec3::ONE),
                };
                cut_faces(
                    tetrahedra.as_chunks::<4>().0,
                    &single,
                    &[0.0; 5],
                    plane,
                    &mut met,
                    &mut out,
                );
                assert!(
                    (area(&out) - 1.0).abs() < 1e-5,
                    "{normal} {at}: {}",
                    area(&out)
                );
                let on = |c: &Corner| plane.height(place(c)).abs() < 1e-6;
                assert!(out.iter().all(on));
            }
        }
    }

    #[test]
    fn a_plane_beside_the_solid_cuts_nothing() {
        let (positions, tetrahedra, _) = cube();
        let single: Vec<f32> = positions.iter().map(|p| *p as f32).collect();
        let (mut met, mut out) = (Vec::new(), Vec::new());
        let plane = Plane {
            normal: Vec3::X,
            offset: 1.5,
        };
        let tetrahedra = tetrahedra.as_chunks::<4>().0;
        let upright = cut_faces(tetrahedra, &single, &[0.0; 5], plane, &mut met, &mut out);
        assert!(upright == 0 && met.is_empty() && out.is_empty());
    }

    #[test]
    fn inverted_sections_come_last() {
        let (positions, tetrahedra, _) = cube();
        let single: Vec<f32> = positions.iter().map(|p| *p as f32).collect();
        let (mut met, mut out) = (Vec::new(), Vec::new());
        let plane = Plane {
            normal: Vec3::X,
            offset: 0.5,
        };
        let tetrahedra = tetrahedra.as_chunks::<4>().0;
        let values = [0.1, -1.0, 0.2, 0.3, -1.0];
        let upright = cut_faces(tetrahedra, &single, &values, plane, &mut met, &mut out);
        assert!(out[..upright].iter().all(|c| c[3] >= 0.0));
        assert!(!out[upright..].is_empty() && out[upright..].iter().all(|c| c[3] < 0.0));
    }
}
