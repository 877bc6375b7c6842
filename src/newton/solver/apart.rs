//! Steps that keep the boundary from passing through itself.

use super::Newton;
use crate::collision::{Boundary, BroadPhase};
use crate::geometry::RestShape;
use crate::optim::BuildError;

/// What keeps the boundary from passing through itself.
pub(super) struct Apart {
    detection: Box<dyn Detection>,
    /// Parts nearer to each other than this, a length, count as in contact.
    gap: f64,
    /// The most that a vertex may go in a step.
    reach: f64,
}

/// Continuous detection, in the plane or in space.
trait Detection: Send {
    /// Of the step `longest` along `direction` from `x` (both by slot, interleaved; below `free` slots move) the part
    /// up to the first contact, if there is one.
    fn first_contact(
        &mut self,
        x: &[f64],
        direction: &[f64],
        free: usize,
        longest: f64,
        gap: f64,
    ) -> Option<f64>;
}

struct Facets<const D: usize> {
    boundary: Boundary<D>,
    broad: BroadPhase<D>,
    to: Vec<[f64; D]>,
}

impl<const D: usize> Detection for Facets<D> {
    fn first_contact(
        &mut self,
        x: &[f64],
        direction: &[f64],
        free: usize,
        longest: f64,
        gap: f64,
    ) -> Option<f64> {
        let (from, along) = (x.as_chunks::<D>().0, direction.as_chunks::<D>().0);
        self.to.clear();
        let ends = from.iter().zip(along);
        self.to
            .extend(ends.map(|(x, d)| std::array::from_fn(|i| x[i] + longest * d[i])));
        self.broad.forget();
        let boundary = &self.boundary;
        let hits = self
            .broad
            .collisions(boundary, from, &self.to, gap, |pair| {
                let vertices = pair.vertices(boundary);
                vertices.iter().any(|&v| (v as usize) < free)
            });
        hits.iter().map(|hit| hit.1.time).min_by(f64::total_cmp)
    }
}

impl Newton {
    /// From here on no step has the boundary of the body pass through itself or another body, nor come nearer to it
    /// than `gap`, a length: steps end before that (conservative detection), and are straight. Nothing pushes bodies
    /// apart; where they press on each other, it stalls.
    ///
    /// # Errors
    /// `NonManifoldFacet` where more than two elements share a facet.
    pub fn keep_apart(&mut self, rest: &RestShape, gap: f64) -> Result<(), BuildError> {
        let dimension = self.evaluation.shape.dimension;
        self.apart = Some(Apart {
            detection: match dimension {
                2 => Box::new(self.facets::<2>(rest)?),
                _ => Box::new(self.facets::<3>(rest)?),
            },
            gap,
            reach: rest
                .measure
                .iter()
                .sum::<f64>()
                .powf(1.0 / dimension as f64),
        });
        // curves and vertices one by one are not looked after
        self.turns = None;
        self.relaxation = None;
        Ok(())
    }

    /// Another gap of [`Self::keep_apart`].
    pub(crate) fn set_gap(&mut self, gap: f64) {
        if let Some(apart) = &mut self.apart {
            apart.gap = gap;
        }
    }

    /// From here on no step inverts an element, whatever the energy.
    pub(crate) fn keep_positive(&mut self) {
        self.keeps_positive = true;
    }

    /// The longest step of at most `longest` on which the boundary does not pass through itself, if it must not; whether
    /// a contact bounds it.
    pub(super) fn longest_apart(&mut self, longest: f64) -> (f64, bool) {
        let Some(apart) = &mut self.apart else {
            return (longest, false);
        };
        let dimension = self.evaluation.shape.dimension;
        let squares = self.direction[..self.unknowns]
            .chunks_exact(dimension)
            .map(|d| d.iter().map(|d| d * d).sum::<f64>());
        let way = squares.fold(0.0, f64::max).sqrt();
        // what is swept far meets everything, and most of it for nothing
        let longest = longest.min(1.0).min(apart.reach / way);
        let free = self.unknowns / dimension;
        let detection = &mut apart.detection;
        match detection.first_contact(&self.x, &self.direction, free, longest, apart.gap) {
            Some(time) => (self.options.fraction * time * longest, true),
            None => (longest, false),
        }
    }

    fn facets<const D: usize>(&self, rest: &RestShape) -> Result<Facets<D>, BuildError> {
        let slots = rest.vertices.iter().map(|&v| self.slot[v as usize]);
        let elements: Vec<u32> = slots.collect();
        let boundary = Boundary::new(&elements).map_err(|e| {
            let vertex = |s: u32| self.slot.iter().position(|&slot| slot == s).unwrap_or(0);
            BuildError::NonManifoldFacet {
                vertices: e.vertices.map(|s| vertex(s) as u32),
                elements: e.elements,
            }
        })?;
        Ok(Facets {
            boundary,
            broad: BroadPhase::default(),
            to: Vec::new(),
        })
    }
}
