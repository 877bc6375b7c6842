//! Steps that keep the boundary from passing through itself.

use super::Newton;
use crate::collision::{Boundary, BroadPhase};
use crate::geometry::RestShape;
use crate::optim::BuildError;

/// How far a step may go before the boundary would meet itself.
pub(super) trait Apart: Send {
    /// A step along `direction` from `x` (both by slot, interleaved) that is free, at most `longest`; otherwise
    /// `fraction` of the way to the first contact.
    fn bound(&mut self, x: &[f64], direction: &[f64], fraction: f64, longest: f64) -> f64;
}

struct Detection<const D: usize> {
    boundary: Boundary<D>,
    broad: BroadPhase<D>,
    to: Vec<[f64; D]>,
}

impl<const D: usize> Apart for Detection<D> {
    fn bound(&mut self, x: &[f64], direction: &[f64], fraction: f64, longest: f64) -> f64 {
        let (from, along) = (x.as_chunks::<D>().0, direction.as_chunks::<D>().0);
        self.to.clear();
        let ends = from.iter().zip(along);
        self.to
            .extend(ends.map(|(x, d)| std::array::from_fn(|i| x[i] + longest * d[i])));
        self.broad.forget();
        let hits = self
            .broad
            .collisions(&self.boundary, from, &self.to, 0.0, |_| true);
        let first = hits.iter().map(|hit| hit.1.time);
        match first.min_by(f64::total_cmp) {
            Some(time) => fraction * time * longest,
            None => longest,
        }
    }
}

impl Newton {
    /// From here on no step has the boundary of the body pass through itself or another body: it ends before
    /// (conservative detection). Nothing pushes bodies apart; where they press on each other, it stalls.
    ///
    /// # Errors
    /// `NonManifoldFacet` where more than two elements share a facet.
    pub fn keep_apart(&mut self, rest: &RestShape) -> Result<(), BuildError> {
        self.apart = Some(match self.evaluation.shape.dimension {
            2 => Box::new(self.detection::<2>(rest)?),
            _ => Box::new(self.detection::<3>(rest)?),
        });
        Ok(())
    }

    /// From here on no step inverts an element, whatever the energy.
    pub(crate) fn keep_positive(&mut self) {
        self.keeps_positive = true;
    }

    fn detection<const D: usize>(&self, rest: &RestShape) -> Result<Detection<D>, BuildError> {
        let slots = rest.vertices.iter().map(|&v| self.slot[v as usize]);
        let elements: Vec<u32> = slots.collect();
        let boundary = Boundary::new(&elements).map_err(|e| {
            let vertex = |s: u32| self.slot.iter().position(|&slot| slot == s).unwrap_or(0);
            BuildError::NonManifoldFacet {
                vertices: e.vertices.map(|s| vertex(s) as u32),
                elements: e.elements,
            }
        })?;
        Ok(Detection {
            boundary,
            broad: BroadPhase::default(),
            to: Vec::new(),
        })
    }
}
