//! Boundaries that meet themselves are parted, by flows that make them rounder step by step.
//!
//! Of a solid: conformalized mean curvature flow ([`surface`]; Kazhdan, Solomon & Ben-Chen 2012), the start of Overby,
//! Kaufman & Narain (2021, §8.3) and of Schüller et al. (2013). In the plane a flow of the curvature ([`outline`]).
//!
//! Every connected part of the boundary flows by itself, keeps its area (in the plane its length) and its centroid, and
//! moves only in steps before which it meets something: what is apart already stays where it is.

mod delaunay;
mod outline;
mod surface;

use crate::collision::{Boundary, BroadPhase, intersections};
use crate::disjoint_sets::DisjointSets;
use crate::geometry::seen_part;
use crate::optim::BuildError;
use glam::DVec3;
use outline::Outline;
use surface::Surface;

/// What [`flow_apart`] did.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[cfg_attr(target_arch = "wasm32", derive(tsify::Tsify))]
pub struct Flowed {
    /// Steps that were taken; 0 where nothing met.
    pub steps: usize,
    /// Pairs of facets that meet, before the first step and after each, counted up to 2²⁰; the last is 0.
    pub pairs: Vec<usize>,
}

/// Steps after which it gives up: long before, what comes apart at all is round.
const MOST_STEPS: usize = 100;

/// Pairs that are counted, at most; where there are more, all parts flow.
const MOST_PAIRS: usize = 1 << 20;

/// Moves the vertices of the boundary until no facets meet, by exact predicates. `rest` and `x` have one position a
/// vertex; the boundary is oriented as at `rest`. After an error x is where the flow has come to.
///
/// # Errors
/// `InvalidOption`: `start` for a boundary that is open, has no extent, or is not finite; `flow` for one that is, after
/// the flow, inside another or inside out, so that no map has it as its boundary, and for outlines in the plane that
/// branch. `NotFlowedApart` says how many pairs still meet after the last step. What the linear systems need:
/// `TooLarge`, `NotPositiveDefinite`.
pub fn flow_apart<const D: usize>(
    boundary: &Boundary<D>,
    rest: &[[f64; D]],
    x: &mut [[f64; D]],
) -> Result<Flowed, BuildError> {
    let mut parts = parts(boundary, rest, x)?;
    let mut part_of = vec![0; x.len()];
    for (number, part) in parts.iter().enumerate() {
        (part.vertices.iter()).for_each(|&v| part_of[v as usize] = number);
    }
    let mut broad = BroadPhase::default();
    let mut flowed = Flowed {
        steps: 0,
        pairs: Vec::new(),
    };
    loop {
        let meeting = intersections(boundary, x, &mut broad, MOST_PAIRS);
        flowed.pairs.push(meeting.len());
        let Some(first) = meeting.first() else { break };
        let mut meets = vec![meeting.len() == MOST_PAIRS; parts.len()];
        for &f in meeting.as_flattened() {
            meets[part_of[boundary.facets[f as usize][0] as usize]] = true;
        }
        let mut moved = false;
        if flowed.steps < MOST_STEPS {
            for part in parts.iter_mut().zip(&meets).filter(|m| *m.1).map(|m| m.0) {
                moved |= part.step(x)?;
            }
        }
        if !moved {
            let facet = |f: u32| {
                let facet = boundary.facets[f as usize];
                std::array::from_fn(|i| facet[i.min(D - 1)])
            };
            return Err(BuildError::NotFlowedApart {
                steps: flowed.steps,
                pairs: meeting.len(),
                first: first.map(facet),
            });
        }
        flowed.steps += 1;
    }
    check_sides(&parts, x, flowed.steps)?;
    Ok(flowed)
}

/// A connected part of a boundary.
struct Part<const D: usize> {
    /// Its vertices, in ascending order.
    vertices: Vec<u32>,
    /// Its facets, by places in `vertices`.
    facets: Vec<[u32; D]>,
    /// Is the body on its inside? False for the wall of a cavity.
    is_outer: bool,
    /// Its centre and half the size of its box, in which units it flows.
    frame: (DVec3, f64),
    /// Made when it is to move.
    flow: Option<Flow>,
}

enum Flow {
    Surface(Box<Surface>),
    Outline(Outline),
}

fn wrong<T>(option: &'static str, what: String) -> Result<T, BuildError> {
    Err(BuildError::InvalidOption { option, what })
}

fn point<const D: usize>(p: &[f64; D]) -> DVec3 {
    let at = |i: usize| if i < D { p[i] } else { 0.0 };
    DVec3::new(at(0), at(1), at(2))
}

fn parts<const D: usize>(
    boundary: &Boundary<D>,
    rest: &[[f64; D]],
    x: &[[f64; D]],
) -> Result<Vec<Part<D>>, BuildError> {
    check_closed(boundary)?;
    let place = |v: u32| boundary.vertices.partition_point(|&w| w < v);
    let mut sets = DisjointSets::new(boundary.vertices.len());
    for facet in &boundary.facets {
        for &v in &facet[1..] {
            sets.join(place(facet[0]) as u32, place(v) as u32);
        }
    }
    let mut parts: Vec<Part<D>> = Vec::new();
    // of every vertex of the boundary: its part, and its place there
    let mut homes = vec![(0, 0); boundary.vertices.len()];
    for (k, &v) in boundary.vertices.iter().enumerate() {
        let root = sets.find(k as u32) as usize;
        if root == k {
            homes[k].0 = parts.len();
            parts.push(Part {
                vertices: Vec::new(),
                facets: Vec::new(),
                is_outer: true,
                frame: (DVec3::ZERO, 1.0),
                flow: None,
            });
        }
        let part = homes[root].0;
        homes[k] = (part, parts[part].vertices.len() as u32);
        parts[part].vertices.push(v);
    }
    for facet in &boundary.facets {
        let part = &mut parts[homes[place(facet[0])].0];
        part.facets.push(facet.map(|v| homes[place(v)].1));
    }
    for part in &mut parts {
        part.is_outer = part.signed_measure(rest) > 0.0;
        part.frame = part.find_frame(x)?;
    }
    Ok(parts)
}

/// Does every edge of the faces (end of the edges) have as many before it as behind it?
fn check_closed<const D: usize>(boundary: &Boundary<D>) -> Result<(), BuildError> {
    let mut rims: Vec<([u32; 2], i32)> = Vec::with_capacity(D * boundary.facets.len());
    for f in &boundary.facets {
        match D {
            2 => rims.extend([([f[0]; 2], 1), ([f[1]; 2], -1)]),
            _ => rims.extend((0..D).map(|i| {
                let (a, b) = (f[i], f[(i + 1) % D]);
                ([a.min(b), a.max(b)], if a < b { 1 } else { -1 })
            })),
        }
    }
    rims.sort_unstable();
    let sum = |same: &[([u32; 2], i32)]| same.iter().map(|rim| rim.1).sum::<i32>();
    match rims.chunk_by(|a, b| a.0 == b.0).find(|same| sum(same) != 0) {
        Some(open) => {
            let [a, b] = open[0].0;
            wrong("start", format!("the boundary is open at {a}–{b}"))
        }
        None => Ok(()),
    }
}

impl<const D: usize> Part<D> {
    /// Volume or area that it encloses, negative for the wall of a cavity.
    fn signed_measure(&self, x: &[[f64; D]]) -> f64 {
        let origin = point(&x[self.vertices[0] as usize]);
        let corners = |f: &[u32; D]| self.corners(f, x).map(|p| point(&p) - origin);
        let each = self.facets.iter().map(|f| {
            let c = corners(f);
            match D {
                2 => c[0].cross(c[1]).z / 2.0,
                _ => c[0].cross(c[1]).dot(c[D - 1]) / 6.0,
            }
        });
        each.sum()
    }

    fn corners(&self, facet: &[u32; D], x: &[[f64; D]]) -> [[f64; D]; D] {
        facet.map(|v| x[self.vertices[v as usize] as usize])
    }

    fn bounds(&self, x: &[[f64; D]]) -> (DVec3, DVec3) {
        let points = self.vertices.iter().map(|&v| point(&x[v as usize]));
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        points.fold(empty, |(low, high), p| (low.min(p), high.max(p)))
    }

    fn find_frame(&self, x: &[[f64; D]]) -> Result<(DVec3, f64), BuildError> {
        let vertex = self.vertices[0];
        let (low, high) = self.bounds(x);
        let (centre, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
        let size = half.max_element();
        match size > 0.0 && centre.is_finite() && size.is_finite() {
            true => Ok((centre, size)),
            false => wrong(
                "start",
                format!("the boundary around vertex {vertex} has no extent"),
            ),
        }
    }

    /// One step of its flow; false if it has come to its end.
    fn step(&mut self, x: &mut [[f64; D]]) -> Result<bool, BuildError> {
        let (centre, size) = self.frame;
        let here = |&v: &u32| (point(&x[v as usize]) - centre) / size;
        let mut local: Vec<DVec3> = self.vertices.iter().map(here).collect();
        let flow = match &mut self.flow {
            Some(flow) => flow,
            None => {
                let new = match D {
                    2 => {
                        let edges = self.facets.iter().map(|f| [f[0], f[1]]);
                        Outline::new(&edges.collect::<Vec<_>>(), &local, self.is_outer)
                            .map(Flow::Outline)
                    }
                    _ => {
                        let triangles = self.facets.iter().map(|f| [f[0], f[1], f[D - 1]]);
                        Surface::new(triangles.collect(), &local)?
                            .map(|surface| Flow::Surface(Box::new(surface)))
                    }
                };
                let Some(new) = new else {
                    let vertex = self.vertices[0];
                    return match D {
                        2 => wrong(
                            "flow",
                            format!("the outline around vertex {vertex} branches"),
                        ),
                        _ => wrong(
                            "start",
                            format!("the boundary around vertex {vertex} has no area"),
                        ),
                    };
                };
                self.flow.insert(new)
            }
        };
        let moved = match flow {
            Flow::Surface(surface) => surface.step(&mut local)?,
            Flow::Outline(outline) => outline.step(&mut local),
        };
        for (&v, p) in self.vertices.iter().zip(&local) {
            let p = centre + size * *p;
            x[v as usize] = std::array::from_fn(|i| p[i]);
        }
        Ok(moved)
    }

    /// How often it winds around a point that is not on it.
    fn winding(&self, p: DVec3, x: &[[f64; D]]) -> f64 {
        let (low, high) = self.bounds(x);
        if p.cmplt(low).any() || p.cmpgt(high).any() {
            return 0.0;
        }
        let part = |f: &[u32; D]| seen_part(&self.corners(f, x).map(|q| point(&q) - p));
        self.facets.iter().map(part).sum()
    }
}

/// Boundaries that do not meet are those of a map if each is turned as at rest, and has the body on its right side only:
/// outside of all others, or, as the wall of a cavity, once inside.
fn check_sides<const D: usize>(
    parts: &[Part<D>],
    x: &[[f64; D]],
    steps: usize,
) -> Result<(), BuildError> {
    let after = match steps {
        0 => String::new(),
        _ => format!("after {steps} steps "),
    };
    for (k, part) in parts.iter().enumerate() {
        let vertex = part.vertices[0];
        if (part.signed_measure(x) > 0.0) != part.is_outer {
            let what = format!("{after}the boundary around vertex {vertex} is inside out");
            return wrong("flow", what);
        }
        let p = point(&x[vertex as usize]);
        let others = parts.iter().enumerate().filter(|other| other.0 != k);
        let winding = others.map(|other| other.1.winding(p, x)).sum::<f64>();
        let expected = if part.is_outer { 0.0 } else { 1.0 };
        if (winding - expected).abs() > 0.5 {
            let what = match part.is_outer {
                true => format!("{after}the body of vertex {vertex} is inside another"),
                false => format!("{after}the cavity of vertex {vertex} is not inside a body"),
            };
            return wrong("flow", what);
        }
    }
    Ok(())
}
