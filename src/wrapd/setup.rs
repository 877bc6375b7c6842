//! What ADMM prepares once: the factored system, and where elements and their corners lie.

use super::block::Block;
use super::elements::Shape;
use super::external::{External, Terms};
use super::layout::{build_blocks, corner_lists};
use super::system::System;
use crate::geometry::{Elimination, RestShape};
use crate::optim::BuildError;
use crate::parallel;

/// See the functions these come from.
pub struct Setup {
    pub system: System,
    pub blocks: Vec<Block>,
    pub corner_begin: Vec<u32>,
    pub corners: Vec<u32>,
}

impl Setup {
    /// Both at the same time where there are threads. Elements begin with the stiffness they have at rest.
    pub fn new(
        rest: &RestShape,
        elimination: &Elimination,
        shape: &Shape,
        external: Option<&External>,
        terms: Option<&Terms>,
    ) -> Result<Self, BuildError> {
        let (system, (blocks, (corner_begin, corners))) = parallel::join(
            || {
                let mut system = System::new(rest, elimination, external)?;
                system
                    .factorize(terms, |_| shape.constants.rest_stiffness)
                    .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
                Ok::<_, BuildError>(system)
            },
            || {
                let blocks = build_blocks(rest, &elimination.slot, shape);
                let corners = corner_lists(rest, &elimination.slot, elimination.free);
                (blocks, corners)
            },
        );
        Ok(Self {
            system: system?,
            blocks,
            corner_begin,
            corners,
        })
    }
}
