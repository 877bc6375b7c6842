//! How much of all directions something takes up.

use core::f64::consts::PI;
use glam::DVec3;

/// The part of all directions in which a facet is seen from the origin: of a circle for D = 2 (two points with z = 0), of
/// a sphere for D = 3 (van Oosterom & Strackee 1983). Negative for one that is turned the other way.
pub(crate) fn seen_part<const D: usize>(facet: &[DVec3; D]) -> f64 {
    let (a, b, c) = (facet[0], facet[1], facet[D - 1]);
    if D == 2 {
        return f64::atan2(a.cross(b).z, a.dot(b)) / (2.0 * PI);
    }
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let scale = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    f64::atan2(a.dot(b.cross(c)), scale) / (2.0 * PI)
}
