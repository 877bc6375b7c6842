//! How often elements go around a vertex.

use crate::geometry::seen_part;
use glam::DVec3;

/// Do the elements (D + 1 `corners` each, none inverted or flat) go around a vertex more than once? In floating point: at an
/// inner vertex they take up all directions once, or a multiple, and at one of the boundary no more.
pub(super) fn winds<const D: usize>(corners: &[u32], points: &[[f64; D]]) -> bool {
    let point = |v: u32| {
        let p = &points[v as usize];
        DVec3::new(p[0], p[1], if D == 2 { 0.0 } else { p[D - 1] })
    };
    let mut seen = vec![0.0; points.len()];
    for simplex in corners.chunks_exact(D + 1) {
        for k in 0..=D {
            let vertex = simplex[k];
            let opposite: [DVec3; D] =
                core::array::from_fn(|i| point(simplex[(k + 1 + i) % (D + 1)]) - point(vertex));
            seen[vertex as usize] += seen_part(&opposite).abs();
        }
    }
    seen.iter().any(|&part| part > 1.001)
}

#[cfg(test)]
mod tests {
    use super::winds;

    /// A fan of n triangles that goes around its middle `times`.
    fn fan(n: u32, times: f64) -> (Vec<u32>, Vec<[f64; 2]>) {
        let corners = (0..n).flat_map(|i| [0, 1 + i, 1 + (i + 1) % n]).collect();
        let rim = |i: u32| {
            let angle = times * core::f64::consts::TAU * f64::from(i) / f64::from(n);
            [1e3 + angle.cos(), angle.sin()]
        };
        let middle = [[1e3, 0.0]];
        (corners, middle.into_iter().chain((0..n).map(rim)).collect())
    }

    #[test]
    fn a_fan_winds_when_it_goes_around_twice() {
        let (corners, points) = fan(9, 1.0);
        assert!(!winds(&corners, &points));
        let (corners, points) = fan(9, 2.0);
        assert!(winds(&corners, &points));
    }

    #[test]
    fn tetrahedra_around_an_edge_do_when_their_fan_does() {
        for (times, expected) in [(1.0, false), (2.0, true)] {
            let (triangles, points) = fan(7, times);
            let n = points.len() as u32;
            // the fan in the plane z = 0, and two points above and below its middle
            let mut solid: Vec<[f64; 3]> = points.iter().map(|p| [p[0], p[1], 0.0]).collect();
            solid.extend([[1e3, 0.0, 1.0], [1e3, 0.0, -1.0]]);
            let tetrahedra: Vec<u32> = triangles
                .chunks_exact(3)
                .flat_map(|t| [[t[0], t[1], t[2], n], [t[0], t[2], t[1], n + 1]].concat())
                .collect();
            assert_eq!(winds(&tetrahedra, &solid), expected);
        }
    }
}
