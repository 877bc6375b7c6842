//! Edge weights of Laplacians on a surface.

use super::RestShape;

/// For each triangle, the weights of its edges opposite to corner 0, 1, 2 in the cotangent
/// Laplacian: ½ cot of the angle there = −A g_i·g_j (Pinkall & Polthier 1993).
pub fn cotangent_weights(rest: &RestShape) -> Vec<[f64; 3]> {
    (0..rest.len())
        .map(|e| {
            [(1, 2), (2, 0), (0, 1)].map(|(i, j)| -rest.measure[e] * rest.hat_product(e, i, j))
        })
        .collect()
}

/// The uniform Laplacian of Tutte's embedding: ½ from either side of an edge (in the interior only
/// ratios matter, and there every edge has both).
pub fn uniform_weights(rest: &RestShape) -> Vec<[f64; 3]> {
    vec![[0.5; 3]; rest.len()]
}
