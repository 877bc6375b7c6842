//! A strip along a Hilbert curve, rolled onto a cylinder.
//!
//! This is the shape of the hard case of Brown & Narain 2021 (after Smith & Schaefer 2015): a long
//! thin strip that fills a square, bent round a cylinder. Its quads have two sides along the axis, so
//! even the discrete surface is developable: an isometric map exists, with energy 1.

use super::{SurfaceMesh, push_quad, wish};
use glam::DVec3;
use std::f64::consts::TAU;

/// Strip of `width` quads across, in cells of `width + gap` quads; both chosen by [`layout`].
pub(super) fn hilbert_strip(triangles: usize) -> SurfaceMesh {
    let quads = wish(triangles) / 2.0;
    let (order, width, gap) = layout(quads);
    let period = width + gap;
    let cells = curve(order);
    let side = (1usize << order) * period - gap;

    // Which quads of the square belong to the strip: the cells, and the bridges between neighbours.
    let mut inside = vec![false; side * side];
    let mut fill = |x: std::ops::Range<usize>, y: std::ops::Range<usize>| {
        for j in y {
            inside[j * side..][x.clone()].fill(true);
        }
    };
    for (index, &(x, y)) in cells.iter().enumerate() {
        let (x, y) = (x * period, y * period);
        fill(x..x + width, y..y + width);
        if let Some(&(next_x, next_y)) = cells.get(index + 1) {
            let (next_x, next_y) = (next_x * period, next_y * period);
            let (low_x, low_y) = (x.min(next_x), y.min(next_y));
            let (high_x, high_y) = (x.max(next_x), y.max(next_y));
            fill(low_x..high_x + width, low_y..high_y + width);
        }
    }

    // Rolled so that the square's left and right sides almost meet.
    let radius = 2.0 / (0.97 * TAU);
    let place = |i: usize, j: usize| {
        let scale = 2.0 / side as f64;
        let (s, c) = ((i as f64 * scale - 1.0) / radius).sin_cos();
        DVec3::new(radius * s, j as f64 * scale - 1.0, radius * c)
    };
    let mut mesh = SurfaceMesh::default();
    let mut ids = vec![u32::MAX; (side + 1) * (side + 1)];
    for j in 0..side {
        for i in 0..side {
            if !inside[j * side + i] {
                continue;
            }
            let quad = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
                let id = &mut ids[j * (side + 1) + i];
                if *id == u32::MAX {
                    *id = mesh.positions.len() as u32;
                    mesh.positions.push(place(i, j));
                }
                *id
            });
            push_quad(&mut mesh, quad);
        }
    }
    mesh
}

/// The order of the curve, and the quads across the strip and between neighbouring runs of it, that
/// come closest to a number of quads with a gap of about 2/7 of the width.
fn layout(quads: f64) -> (u32, usize, usize) {
    // Order 4 (256 cells) as the paper's mesh, fewer where there are too few triangles for it.
    let order = (1..=4u32)
        .rev()
        .find(|order| quads >= 0.7 * strip_quads(*order, 2, 1))
        .unwrap_or(1);
    let cells = 4f64.powi(order as i32);
    let middle = (quads / cells / 1.28).sqrt() as usize;
    let mut best = (f64::INFINITY, 2, 1);
    for width in middle.saturating_sub(1).max(2)..=middle + 2 {
        for gap in width.div_ceil(6)..=width.div_ceil(2) {
            let miss = (strip_quads(order, width, gap) / quads.max(1.0)).ln().abs();
            let cost = miss + 0.3 * (gap as f64 / width as f64 - 2.0 / 7.0).abs();
            if cost < best.0 {
                best = (cost, width, gap);
            }
        }
    }
    (order, best.1, best.2)
}

/// Number of quads of a strip: 4^order cells and the bridges between them.
fn strip_quads(order: u32, width: usize, gap: usize) -> f64 {
    let cells = 4f64.powi(order as i32);
    (cells * width as f64 + (cells - 1.0) * gap as f64) * width as f64
}

/// The cells of the Hilbert curve of that order, from start to end.
fn curve(order: u32) -> Vec<(usize, usize)> {
    let side = 1usize << order;
    (0..side * side)
        .map(|index| {
            let (mut x, mut y, mut rest) = (0, 0, index);
            let mut scale = 1;
            while scale < side {
                let right = (rest / 2) & 1;
                let up = (rest ^ right) & 1;
                if up == 0 {
                    if right == 1 {
                        (x, y) = (scale - 1 - x, scale - 1 - y);
                    }
                    (x, y) = (y, x);
                }
                x += scale * right;
                y += scale * up;
                rest /= 4;
                scale *= 2;
            }
            (x, y)
        })
        .collect()
}
