//! Untangling from a target surface that may meet itself (Overby, Kaufman & Narain 2021, §8.3).
//!
//! The boundary is parted by a flow, the inside placed harmonically in it, and the solver, which keeps the boundary from
//! passing through itself, pulls every vertex of the boundary back to where it was.

use super::body::check;
use super::injective::flat;
use super::{Material, Target, Untangling, UntanglingOptions};
use crate::Error;
use crate::collision::Boundary;
use crate::embedding::{Flowed, flow_apart, harmonic_inside};
use crate::geometry::RestShape;
use crate::gini::GiniOptions;
use crate::mesh::{SolidMesh, SurfaceMesh, counted};
use crate::optim::{BuildError, Stopwatch};
use glam::DVec3;

impl Untangling {
    /// Of tetrahedra whose `start` has the target surface as its boundary, which may meet itself.
    ///
    /// Where it does, it is parted by conformalized mean curvature flow, and the inside of `start` gives way to a
    /// harmonic one. Where it does not, the run begins at `start`, and a note says so. In both cases every vertex of the
    /// boundary that is not pinned and has no target of its own is pulled to where it is in `start`, softly
    /// ([`GiniOptions::target_stiffness`]), so that it comes as near as the body's energy and contacts allow.
    ///
    /// Pins stay hard: they begin where the flow and the harmonic inside leave them, and go back to their places in
    /// `start`, or to their targets, while the way is free; the run is not over before. Pins that meet each other there
    /// do not arrive.
    ///
    /// # Errors
    /// As [`Self::of_solid`] and [`flow_apart`]; `InvalidOption` without [`GiniOptions::overlap`].
    pub fn through_flow(
        rest: &SolidMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        material: Material,
        options: impl Into<UntanglingOptions>,
    ) -> Result<Self, Error> {
        let options = options.into();
        let clock = Stopwatch::start();
        needs_overlap(&options.gini)?;
        check(rest, start)?;
        let (shape, _) = RestShape::of_solid(rest)?;
        let all = |points: &[DVec3]| points.iter().map(DVec3::to_array).collect::<Vec<_>>();
        let route = Route::new(&shape, &all(&rest.positions), &all(start))?;
        let targets = route.targets(start, pins, targets);
        let begin: Vec<DVec3> = route.begin.iter().map(|&p| DVec3::from_array(p)).collect();
        let mut this = Self::of_solid(rest, &begin, pins, &targets, material, options)?;
        this.notes.push(route.note("triangles"));
        this.flowed = Some(route.flowed);
        this.setup_seconds = clock.seconds();
        Ok(this)
    }

    /// The same of triangles in a plane z = constant: outlines go to circles by their curvature.
    ///
    /// # Errors
    /// As [`Self::of_plane`] and [`flow_apart`]; `InvalidOption` without [`GiniOptions::overlap`].
    pub fn through_flow_in_plane(
        rest: &SurfaceMesh,
        start: &[DVec3],
        pins: &[u32],
        targets: &[Target],
        material: Material,
        options: impl Into<UntanglingOptions>,
    ) -> Result<Self, Error> {
        let options = options.into();
        let clock = Stopwatch::start();
        needs_overlap(&options.gini)?;
        check(rest, start)?;
        flat("rest", &rest.positions)?;
        flat("start", start)?;
        let (shape, _) = RestShape::of_plane(rest)?;
        let all = |points: &[DVec3]| points.iter().map(|p| [p.x, p.y]).collect::<Vec<_>>();
        let route = Route::new(&shape, &all(&rest.positions), &all(start))?;
        let targets = route.targets(start, pins, targets);
        let level = start[0].z;
        let points = route.begin.iter();
        let begin: Vec<DVec3> = points.map(|p| DVec3::new(p[0], p[1], level)).collect();
        let mut this = Self::of_plane(rest, &begin, pins, &targets, material, options)?;
        this.notes.push(route.note("edges"));
        this.flowed = Some(route.flowed);
        this.setup_seconds = clock.seconds();
        Ok(this)
    }
}

fn needs_overlap(options: &GiniOptions) -> Result<(), BuildError> {
    match options.overlap {
        true => Ok(()),
        false => Err(BuildError::InvalidOption {
            option: "flow",
            what: "needs the option overlap".into(),
        }),
    }
}

/// Where a run begins that is to lead to a start.
struct Route<const D: usize> {
    /// One position a vertex, the boundary of which does not meet itself.
    begin: Vec<[f64; D]>,
    /// The vertices of the boundary, in ascending order.
    boundary: Vec<u32>,
    flowed: Flowed,
}

impl<const D: usize> Route<D> {
    fn new(shape: &RestShape, rest: &[[f64; D]], start: &[[f64; D]]) -> Result<Self, BuildError> {
        let boundary = Boundary::<D>::new(&shape.vertices).map_err(|e| {
            let (vertices, elements) = (e.vertices, e.elements);
            BuildError::NonManifoldFacet { vertices, elements }
        })?;
        let mut begin = start.to_vec();
        let flowed = flow_apart(&boundary, rest, &mut begin)?;
        if flowed.steps > 0 {
            harmonic_inside(shape, &boundary.vertices, &mut begin)?;
        }
        Ok(Self {
            begin,
            boundary: boundary.vertices,
            flowed,
        })
    }

    /// The targets, and those that lead back to the start: of the boundary, and of pins where they have been moved.
    fn targets(&self, start: &[DVec3], pins: &[u32], targets: &[Target]) -> Vec<Target> {
        let mut wants = vec![false; start.len()];
        (self.boundary.iter()).for_each(|&v| wants[v as usize] = true);
        // those out of range are for the solver to refuse
        for &pin in pins {
            if let Some(wants) = wants.get_mut(pin as usize) {
                *wants = self.flowed.steps > 0;
            }
        }
        for target in targets {
            if let Some(wants) = wants.get_mut(target.vertex as usize) {
                *wants = false;
            }
        }
        let back = (0..).zip(start).zip(&wants).filter(|back| *back.1);
        let back = back.map(|((vertex, &position), _)| Target { vertex, position });
        targets.iter().copied().chain(back).collect()
    }

    fn note(&self, facets: &str) -> String {
        match self.flowed.steps {
            0 => "the boundary of the start does not meet itself: it begins there, without flow"
                .into(),
            steps => {
                let (pairs, steps) = (self.flowed.pairs[0], counted(steps, "step"));
                let pairs = counted(pairs, "pair");
                format!(
                    "the boundary of the start met itself in {pairs} of {facets}: {steps} of flow parted it"
                )
            }
        }
    }
}
