//! From a matrix on the entries of F to the blocks of an element's corners.

use crate::energy::hessian::{MOST, Square};

/// ∂F/∂x_v maps y to y ⊗ g_v: writes the d×d blocks, row by row, of the pairs of corners (0,0), (1,0), (1,1),
/// (2,0), … of `scale` times H, which is on F (d×k, column by column). `hats` are the gradients of the hat
/// functions of the k+1 corners.
#[inline(always)]
pub fn corner_blocks(
    (d, k): (usize, usize),
    h: &Square,
    hats: &[[f64; 3]; 4],
    scale: f64,
    out: &mut [f64],
) {
    // for each corner H times it
    let mut products = [[[0.0; 3]; MOST]; 4];
    for (product, g) in products.iter_mut().zip(&hats[..=k]) {
        for (row, product) in h[..d * k].iter().zip(product) {
            for (j, product) in product[..d].iter_mut().enumerate() {
                *product = (0..k).map(|c| row[c * d + j] * g[c]).sum();
            }
        }
    }
    let mut next = out.chunks_exact_mut(d * d);
    for u in 0..=k {
        for v in 0..=u {
            let Some(target) = next.next() else { continue };
            for i in 0..d {
                for j in 0..d {
                    let sum: f64 = (0..k).map(|c| hats[u][c] * products[v][c * d + i][j]).sum();
                    target[i * d + j] = scale * sum;
                }
            }
        }
    }
}
