//! Charts side by side.

use core::ops::Range;
use glam::DVec2;

/// Between charts, relative to the side of a square of all their boxes.
const GAP: f64 = 0.02;

/// Moves charts apart, on shelves of about the width of a square that holds them: no two boxes meet, or come nearer than
/// `room` to each other. The first stays where it is, and one alone, too.
pub(super) fn lay_out(map: &mut [DVec2], charts: &[Range<u32>], room: f64) {
    if charts.len() < 2 {
        return;
    }
    let boxes: Vec<(DVec2, DVec2)> = charts
        .iter()
        .map(|chart| {
            let points = &map[chart.start as usize..chart.end as usize];
            points
                .iter()
                .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| {
                    (low.min(p), high.max(p))
                })
        })
        .collect();
    let sizes = boxes.iter().map(|(low, high)| *high - *low);
    let area: f64 = sizes.clone().map(|s| s.x * s.y).sum();
    let widest = sizes.map(|s| s.x).fold(0.0, f64::max);
    let gap = (GAP * area.sqrt()).max(room);
    let width = widest.max(1.2 * (area + (charts.len() as f64) * room * room).sqrt());
    let origin = boxes[0].0;
    let (mut at, mut shelf) = (origin, 0.0f64);
    for (chart, (low, high)) in charts.iter().zip(boxes) {
        let size = high - low;
        if at.x > origin.x && at.x + size.x > origin.x + width {
            at = DVec2::new(origin.x, at.y + shelf + gap);
            shelf = 0.0;
        }
        let shift = at - low;
        let points = &mut map[chart.start as usize..chart.end as usize];
        points.iter_mut().for_each(|p| *p += shift);
        at.x += size.x + gap;
        shelf = shelf.max(size.y);
    }
}
