//! Edge weights of Laplacians on a surface.

use super::RestShape;

/// For each element, the weights of its three edges (opposite to corner 0, 1, 2) of the cotangent
/// Laplacian: ½ cot of the opposite angle = −A g_i·g_j (Pinkall & Polthier 1993).
pub fn cotangent_weights(rest: &RestShape) -> Vec<[f64; 3]> {
    (0..rest.len())
        .map(|e| {
            let g = rest.hat_gradients(e);
            let area = rest.measure[e];
            let edge = |i: usize, j: usize| -area * (g[i][0] * g[j][0] + g[i][1] * g[j][1]);
            [edge(1, 2), edge(2, 0), edge(0, 1)]
        })
        .collect()
}

/// Weights that add up to 1 on an interior edge (½ from either side) and on a boundary edge to ½:
/// the uniform Laplacian of Tutte's embedding, whose scale does not matter in the interior.
pub fn uniform_weights(rest: &RestShape) -> Vec<[f64; 3]> {
    vec![[0.5; 3]; rest.len()]
}
