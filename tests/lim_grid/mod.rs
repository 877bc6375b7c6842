//! The square grid whose corner is dragged, and how it is solved.
#![allow(dead_code)]

use foldfree::geometry::RestShape;
use foldfree::lim::{Lim, LimOptions, LimProblem};
use foldfree::mesh::SurfaceMesh;
use foldfree::optim::{Deformer, Solver, Status};
use foldfree::space::Plane;
use glam::DVec3;

/// n×n vertices of the unit square, each cell split along its (0,0)–(1,1) diagonal.
pub fn grid(n: usize) -> SurfaceMesh {
    let mut mesh = SurfaceMesh::default();
    let step = ((n - 1) as f64).recip();
    for row in 0..n {
        for column in 0..n {
            let at = DVec3::new(column as f64 * step, row as f64 * step, 0.0);
            mesh.positions.push(at);
        }
    }
    for row in 0..n - 1 {
        for column in 0..n - 1 {
            let v = (row * n + column) as u32;
            let above = v + n as u32;
            mesh.simplices
                .extend([[v, v + 1, above + 1], [v, above + 1, above]]);
        }
    }
    mesh
}

/// Positions in the plane, interleaved.
pub fn flat(mesh: &SurfaceMesh) -> Vec<f64> {
    mesh.positions.iter().flat_map(|p| [p.x, p.y]).collect()
}

/// The solver of a mesh with these handles where they are.
pub fn planar(mesh: &SurfaceMesh, handles: &[u32], options: LimOptions) -> Lim {
    let (rest, _) = RestShape::of_plane(mesh).expect("a planar mesh");
    let positions = flat(mesh);
    let problem = LimProblem {
        rest: &rest,
        rest_positions: &positions,
        start: &positions,
        handles,
    };
    Lim::new::<Plane>(problem, options).expect("a problem without faults")
}

/// The vertices of the left and the bottom edge, and the corner (1, 1), the last.
pub fn handles(n: usize) -> Vec<u32> {
    let bottom = 0..n as u32;
    let left = (1..n as u32).map(|row| row * n as u32);
    bottom.chain(left).chain([(n * n - 1) as u32]).collect()
}

/// The corner drag of the notes: (1, 1) to (0.2, 0.2).
pub fn corner_drag(n: usize, options: LimOptions) -> Lim {
    let mut lim = planar(&grid(n), &handles(n), options);
    lim.retarget(&[((n * n - 1) as u32, [0.2, 0.2, 0.0])], &[])
        .expect("a finite target");
    lim
}

/// To the end.
pub fn run(lim: &mut Lim) -> Status {
    while lim.status() == Status::Running {
        lim.step().expect("a step");
    }
    lim.status()
}
