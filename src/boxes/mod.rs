//! Boxes along the axes, and a tree of them: pairs of boxes, or boxes around a point, of which others find out what they
//! enclose. Coordinates are only compared where that decides, so that nothing is lost to rounding.

mod bounds;
mod tree;

pub(crate) use bounds::Bounds;
pub(crate) use tree::Tree;
