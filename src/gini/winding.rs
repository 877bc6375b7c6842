//! How often elements go around a vertex.

use core::f64::consts::PI;

/// Do the elements (D + 1 `corners` each, none inverted or flat) go around a vertex more than once? In floating point: their
/// angles at an inner vertex sum to 2π (solid angles to 4π) or a multiple, and at one of the boundary to no more.
pub(super) fn winds<const D: usize>(corners: &[u32], points: &[[f64; D]]) -> bool {
    let mut sums = vec![0.0; points.len()];
    for simplex in corners.chunks_exact(D + 1) {
        for k in 0..=D {
            let from = points[simplex[k] as usize];
            let edges: [[f64; D]; D] = core::array::from_fn(|i| {
                let to = points[simplex[(k + 1 + i) % (D + 1)] as usize];
                core::array::from_fn(|d| to[d] - from[d])
            });
            sums[simplex[k] as usize] += angle(&edges);
        }
    }
    let full = if D == 2 { 2.0 * PI } else { 4.0 * PI };
    sums.iter().any(|&sum| sum > 1.001 * full)
}

/// The angle between two edges, or the solid angle between three (Van Oosterom & Strackee 1983).
fn angle<const D: usize>(edges: &[[f64; D]; D]) -> f64 {
    let dot = |i: usize, j: usize| -> f64 { (0..D).map(|d| edges[i][d] * edges[j][d]).sum() };
    if D == 2 {
        let cross = edges[0][0] * edges[1][1] - edges[0][1] * edges[1][0];
        return cross.abs().atan2(dot(0, 1));
    }
    let minor = |i: usize, j: usize| edges[1][i] * edges[2][j] - edges[1][j] * edges[2][i];
    let volume = edges[0][0] * minor(1, 2) - edges[0][1] * minor(0, 2) + edges[0][2] * minor(0, 1);
    let [a, b, c] = [0, 1, 2].map(|i| dot(i, i).sqrt());
    let denominator = a * b * c + dot(0, 1) * c + dot(1, 2) * a + dot(2, 0) * b;
    2.0 * volume.abs().atan2(denominator)
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
