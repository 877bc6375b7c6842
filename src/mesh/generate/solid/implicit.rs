//! Solids as functions: round cones, smoothly joined.
//!
//! A function is negative inside and its gradient is nowhere longer than 1: that of a round cone is the
//! distance to its surface, and minimum and smooth minimum are convex combinations of gradients.

use glam::DVec3;

/// A point with a radius.
pub(super) type Ball = (DVec3, f64);

/// The convex hull of two balls, or of one.
struct RoundCone {
    start: Ball,
    axis: DVec3,
    length: f64,
    end_radius: f64,
    sin: f64,
    cos: f64,
}

impl RoundCone {
    fn new(start: Ball, end: Ball) -> Self {
        let length = start.0.distance(end.0);
        // One ball inside the other: the larger one alone.
        if !(length > (start.1 - end.1).abs()) {
            let ball = if start.1 >= end.1 { start } else { end };
            return Self {
                start: ball,
                axis: DVec3::X,
                length: 0.0,
                end_radius: ball.1,
                sin: 0.0,
                cos: 1.0,
            };
        }
        let sin = (start.1 - end.1) / length;
        Self {
            start,
            axis: (end.0 - start.0) / length,
            length,
            end_radius: end.1,
            sin,
            cos: (1.0 - sin * sin).sqrt(),
        }
    }

    /// In the half plane through the axis, its outline is a segment, tangent to two circles.
    fn distance(&self, point: DVec3) -> f64 {
        let offset = point - self.start.0;
        let x = offset.dot(self.axis);
        let y = (offset.length_squared() - x * x).max(0.0).sqrt();
        let along = x * self.cos - y * self.sin;
        if along <= 0.0 {
            x.hypot(y) - self.start.1
        } else if along >= self.length * self.cos {
            (x - self.length).hypot(y) - self.end_radius
        } else {
            x * self.sin + y * self.cos - self.start.1
        }
    }
}

/// Round cones that meet in creases, within one ball.
struct Group {
    cones: Vec<RoundCone>,
    hull: Ball,
    /// How far the join to the groups before it reaches.
    blend: f64,
}

/// A union of groups of round cones, each joined smoothly to those before it.
#[derive(Default)]
pub(super) struct Implicit {
    groups: Vec<Group>,
    /// The shape is stretched along z by a slab of this half thickness.
    slab: f64,
    /// No radius is less.
    least_radius: f64,
    bounds: Option<[DVec3; 2]>,
}

impl Implicit {
    /// Nothing yet; radii will be raised to `least_radius`.
    pub fn new(least_radius: f64, slab: f64) -> Self {
        Self {
            slab,
            least_radius,
            ..Self::default()
        }
    }

    /// Adds chains of balls, each the hulls of its consecutive balls.
    pub fn join(&mut self, blend: f64, chains: &[&[Ball]]) {
        let mut cones = Vec::new();
        let mut corners = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for chain in chains {
            let widened: Vec<Ball> = chain
                .iter()
                .map(|&(at, radius)| (at, radius.max(self.least_radius)))
                .collect();
            for &(at, radius) in &widened {
                corners = [corners[0].min(at - radius), corners[1].max(at + radius)];
            }
            match widened[..] {
                [ball] => cones.push(RoundCone::new(ball, ball)),
                _ => cones.extend(widened.windows(2).map(|w| RoundCone::new(w[0], w[1]))),
            }
        }
        let hull = (
            (corners[0] + corners[1]) * 0.5,
            (corners[1] - corners[0]).length() * 0.5,
        );
        // A smooth join bulges by at most a quarter of its reach.
        let margin = DVec3::splat(0.25 * blend) + DVec3::Z * self.slab;
        let [low, high] = self.bounds.unwrap_or(corners);
        self.bounds = Some([low.min(corners[0] - margin), high.max(corners[1] + margin)]);
        self.groups.push(Group { cones, hull, blend });
    }

    /// A box round the solid.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds.unwrap_or_default()
    }

    /// Negative inside; |value| is at most the distance to the surface.
    pub fn value(&self, mut point: DVec3) -> f64 {
        point.z -= point.z.clamp(-self.slab, self.slab);
        let mut value = f64::INFINITY;
        for group in &self.groups {
            // Too far away to change anything.
            if point.distance(group.hull.0) - group.hull.1 >= value + group.blend {
                continue;
            }
            let distances = group.cones.iter().map(|cone| cone.distance(point));
            value = smooth_minimum(value, distances.fold(f64::INFINITY, f64::min), group.blend);
        }
        value
    }
}

/// The minimum, lowered by at most `blend`/4 where the two differ by less than `blend`: a parabola
/// that joins them with continuous derivatives.
fn smooth_minimum(a: f64, b: f64, blend: f64) -> f64 {
    let overlap = (blend - (a - b).abs()).max(0.0);
    match overlap > 0.0 {
        true => a.min(b) - overlap * overlap / (4.0 * blend),
        false => a.min(b),
    }
}
