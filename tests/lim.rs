//! Regression.
mod lim_grid;
use foldfree::lim::{LimEnergy, LimHessian, LimOptions};
use foldfree::optim::Solver;
use lim_grid::*;

#[test]
fn explore() {
    for barrier in [true, false] {
        for (energy, hessian) in [(LimEnergy::Dirichlet, LimHessian::Projected), (LimEnergy::Arap, LimHessian::Frozen), (LimEnergy::Arap, LimHessian::Projected), (LimEnergy::GreenStrain, LimHessian::Projected),
            (LimEnergy::Lscm, LimHessian::Projected), (LimEnergy::Laplacian, LimHessian::Projected), (LimEnergy::UniformLaplacian, LimHessian::Projected)] {
            let mut lim = corner_drag(41, LimOptions { energy, hessian, barrier, max_iterations: 400, ..Default::default() });
            let verbose = std::env::var("VERBOSE").is_ok();
            while lim.status() == foldfree::optim::Status::Running {
                let r = lim.step().unwrap();
                if verbose { println!("{} E {:.8e} |g| {:.2e} smin {:.2e} inv {} {:?} {:?}", r.iteration, r.energy, r.gradient_norm, r.smallest_sigma, r.inverted, r.lim.unwrap(), r.phases.iter().map(|p| (p.count, (p.milliseconds*100.0).round()/100.0)).collect::<Vec<_>>()); }
            }
            let r = lim.report();
            println!("{barrier} {energy:?} {hessian:?} {:?} it {} E {:.8} inv {} s {:.3} err {:e}", r.status, r.iteration, r.energy, r.inverted, r.seconds, r.lim.unwrap().positional_error);
        }
    }
}
