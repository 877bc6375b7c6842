//! Flattens a sample surface and prints what every iteration did.
//!
//! `cargo run --release --example flatten [shape] [triangles]`

use foldfree::mesh::{Shape, generate};
use foldfree::optim::Status;
use foldfree::parameterization::{Parameterization, ParameterizationOptions};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "bumpy-cap".into());
    let shape = Shape::from_name(&name).ok_or("no such shape")?;
    let triangles = arguments.next().map_or(Ok(5000), |n| n.parse())?;
    let surface = generate(shape, triangles);
    println!("{}", shape.describe());

    // The paper's method and its values; the surface is cut where it has to be.
    let options = ParameterizationOptions::default();
    let mut map = Parameterization::new(&surface, &options)?;
    let start = map.solver().report();
    println!(
        "start: energy {:.6}, {} inverted",
        start.energy, start.inverted
    );
    while map.solver().status() == Status::Running {
        let step = map.step()?;
        println!(
            "iteration {}: energy {:.9}, {} inverted, {} L-BFGS iterations{}",
            step.iteration,
            step.energy,
            step.inverted,
            step.lbfgs_iterations,
            if step.reweighted { ", reweighted" } else { "" },
        );
    }
    println!("{}", map.solver().status().name());

    // What is left is exact: does it fold, does it overlap?
    println!("{}", map.certificate().summary());
    Ok(())
}
