mod flattening;

use flattening::{Run, endless, from};
use foldfree::mesh::{Shape, generate};
use foldfree::parameterization::{Method, Start};

#[test]
fn measure() {
    for shape in Shape::ALL {
        let mesh = generate(shape, 2_000);
        let t = std::time::Duration::ZERO;
        let run = Run::new(&mesh, &endless(Method::Wrapd)).steps(600);
        let best = run.last().energy;
        println!(
            "{shape:?} {} {:?} {t:?} E0 {} E* {best:.12} prev {:.12} counts {:?} {:?} inv {:?} rew {} lb {}",
            mesh.simplices.len(),
            run.parameterization.start_kind(),
            run.reports[0].energy,
            run.reports[400].energy,
            run.reaches(1.01 * best),
            run.reaches((1.0 + 1e-6) * best),
            run.reports
                .iter()
                .take(5)
                .map(|r| r.inverted)
                .collect::<Vec<_>>(),
            run.reports.iter().filter(|r| r.reweighted).count(),
            run.reports
                .iter()
                .map(|r| r.lbfgs_iterations)
                .sum::<usize>()
        );
        for method in [Method::Wrapd, Method::RAdmm, Method::WAdmm, Method::AdmmPd] {
            let run = Run::new(&mesh, &endless(method)).while_true(|r| {
                r.iteration < 400 && !(r.inverted == 0 && r.energy < best * (1.0 + 1e-4))
            });
            println!(
                "   {method:?}: 10% {:?} 1% {:?} 1e-3 {:?} 1e-4 {:?} last {}",
                run.reaches(1.1 * best),
                run.reaches(1.01 * best),
                run.reaches(1.001 * best),
                run.reaches(1.0001 * best),
                run.last().energy
            );
        }
        for start in [Start::Random, Start::Collapsed] {
            let run = Run::new(&mesh, &from(start, Method::Wrapd)).while_true(|r| {
                r.iteration < 300 && !(r.iteration > 0 && r.inverted == 0 && r.energy < 1.01 * best)
            });
            println!(
                "   {start:?}: 0 inverted at {:?}, last inverted {} energy {}",
                run.reports
                    .iter()
                    .position(|r| r.inverted == 0 && r.iteration > 0),
                run.last().inverted,
                run.last().energy
            );
        }
    }
}
