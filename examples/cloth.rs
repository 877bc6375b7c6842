//! Figure 8 of the paper: a wrinkled square of cloth comes to rest under its weight, held at its corners.
//! Prints how far WRAPD and ADMM-PD are from where it ends, iteration by iteration.
//!
//! `cargo run --release --example cloth [quads along a side]`

use foldfree::deformation::{ClothOptions, Deformation, DeformationMethod};
use foldfree::mesh::SurfaceMesh;
use foldfree::optim::Status;
use glam::DVec3;
use std::error::Error;

/// Position and seconds after every iteration.
type History = Vec<(Vec<DVec3>, f64)>;

fn main() -> Result<(), Box<dyn Error>> {
    let n = std::env::args().nth(1).map_or(Ok(40), |n| n.parse())?;
    let cloth = square(n);
    let corners = [0, n, n * (n + 1), n * (n + 2)].map(|v| v as u32);
    let start: Vec<DVec3> = cloth
        .positions
        .iter()
        .map(|&p| wrinkled(p, corners.map(|c| cloth.positions[c as usize])))
        .collect();

    let run = |method, max_iterations| -> Result<History, Box<dyn Error>> {
        let options = ClothOptions {
            bending: 1e-3,
            tolerance: 1e-13,
            method,
            max_iterations,
            ..Default::default()
        };
        let mut solver = Deformation::of_cloth(&cloth, &start, &corners, &[], &options)?;
        let mut history = vec![(start.clone(), 0.0)];
        while solver.solver().status() == Status::Running {
            let step = solver.step()?;
            history.push((solver.positions(), step.seconds));
        }
        let last = solver.solver().report();
        println!(
            "{method:?}: {} after {} iterations, energy {:.9} J, stretch {:.4} to {:.4}",
            last.status.name(),
            last.iteration,
            last.energy,
            last.smallest_sigma,
            last.largest_sigma
        );
        Ok(history)
    };
    let wrapd = run(DeformationMethod::Wrapd, 5000)?;
    let admm_pd = run(DeformationMethod::AdmmPd, 5000)?;

    let (solution, _) = &wrapd[wrapd.len() - 1];
    let error = |x: &[DVec3]| distance(x, solution) / distance(&start, solution);
    println!("error after iterations |    WRAPD  seconds |  ADMM-PD  seconds");
    for k in [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000] {
        print!("{k:22} |");
        for history in [&wrapd, &admm_pd] {
            match history.get(k) {
                Some((x, seconds)) => print!(" {:8.1e} {seconds:8.3} |", error(x)),
                None => print!(" {:17} |", ""),
            }
        }
        println!();
    }
    Ok(())
}

/// The unit square of n × n quads, each divided in two.
fn square(n: usize) -> SurfaceMesh {
    let at = |i: usize, j: usize| (j * (n + 1) + i) as u32;
    let mut mesh = SurfaceMesh::default();
    for v in 0..(n + 1) * (n + 1) {
        let (i, j) = (v % (n + 1), v / (n + 1));
        let point = DVec3::new(i as f64, j as f64, 0.0) / n as f64;
        mesh.positions.push(point);
    }
    for (i, j) in (0..n * n).map(|quad| (quad % n, quad / n)) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        mesh.simplices.extend(match (i + j) % 2 {
            0 => [[a, b, d], [b, c, d]],
            _ => [[a, b, c], [a, c, d]],
        });
    }
    mesh
}

/// Corners drawn together by 5 %, wrinkles of up to 10 cm between them.
fn wrinkled(p: DVec3, corners: [DVec3; 4]) -> DVec3 {
    let fade: f64 = corners
        .iter()
        .map(|c| 1.0 - (-25.0 * c.distance_squared(p)).exp())
        .product();
    let (x, y) = (12.0 * p.x, 12.0 * p.y);
    let wrinkle = DVec3::new(
        (y + 1.0).sin() * (0.7 * x).cos(),
        x.sin() * (0.5 * y + 2.0).cos(),
        1.5 * (0.8 * x + 0.3).sin() * (0.6 * y + 0.5).sin(),
    );
    let middle = DVec3::new(0.5, 0.5, 0.0);
    middle + 0.95 * (p - middle) + 0.1 * fade * wrinkle
}

fn distance(x: &[DVec3], y: &[DVec3]) -> f64 {
    let squares = x.iter().zip(y).map(|(a, b)| a.distance_squared(*b));
    squares.sum::<f64>().sqrt()
}
