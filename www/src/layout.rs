//! Where each view stands on the canvas.

/// A rectangle in points: left, top, width, height.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Area {
    /// Left edge.
    pub x: f32,
    /// Top edge.
    pub y: f32,
    /// Width.
    pub w: f32,
    /// Height.
    pub h: f32,
}

/// The views.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum View {
    /// The surface in 3D.
    Shape,
    /// The map in 2D.
    Map,
    /// The convergence plot.
    Plot,
    /// What this step did.
    Inspector,
}

impl View {
    /// From the name the page uses for a tab; anything else means all views.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "shape" => Some(Self::Shape),
            "map" => Some(Self::Map),
            "plot" => Some(Self::Plot),
            "inspector" => Some(Self::Inspector),
            _ => None,
        }
    }
}

/// Narrower than this (in points), one view is shown at a time.
pub const NARROW: f32 = 720.0;

/// Places the views on a canvas: one alone, or all of them; `inspector` false leaves that out.
pub fn arrange(
    width: f32,
    height: f32,
    alone: Option<View>,
    inspector: bool,
    text: f32,
) -> Vec<(View, Area)> {
    let area = |x: f32, y: f32, w: f32, h: f32| Area {
        x: x.round(),
        y: y.round(),
        w: w.round(),
        h: h.round(),
    };
    if let Some(view) = alone {
        return vec![(view, area(0.0, 0.0, width, height))];
    }
    let plot = (0.3 * height)
        .clamp(130.0 * text, 250.0 * text)
        .min(0.45 * height);
    let top = height - plot;
    let column = if inspector { 292.0 * text } else { 0.0 };
    if width >= 1000.0 * text || !inspector {
        let views = width - column;
        let half = (0.5 * views).round();
        let mut all = vec![
            (View::Shape, area(0.0, 0.0, half, top)),
            (View::Map, area(half, 0.0, views - half, top)),
            (View::Plot, area(0.0, top, views, plot)),
        ];
        if inspector {
            all.push((View::Inspector, area(views, 0.0, column, height)));
        }
        return all;
    }
    // A tablet: the inspector stands beside the plot.
    let plot = (0.42 * height).max(plot).min(330.0 * text);
    let top = height - plot;
    let half = (0.5 * width).round();
    vec![
        (View::Shape, area(0.0, 0.0, half, top)),
        (View::Map, area(half, 0.0, width - half, top)),
        (View::Plot, area(0.0, top, width - column, plot)),
        (View::Inspector, area(width - column, top, column, plot)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_tile_the_canvas() {
        for (w, h) in [
            (1440.0, 760.0),
            (1100.0, 600.0),
            (820.0, 900.0),
            (2560.0, 1300.0),
        ] {
            for inspector in [true, false] {
                let all = arrange(w, h, None, inspector, 1.0);
                let covered: f32 = all.iter().map(|(_, a)| a.w * a.h).sum();
                assert!((covered - w * h).abs() < 2.0 * (w + h), "{w}×{h}: {all:?}");
                assert!(all.iter().all(|(_, a)| a.w > 100.0
                    && a.h > 100.0
                    && a.x + a.w <= w + 1.0
                    && a.y + a.h <= h + 1.0));
            }
        }
    }

    #[test]
    fn a_tab_fills_the_canvas() {
        let only = arrange(390.0, 500.0, View::from_name("map"), true, 1.0);
        assert_eq!(
            only,
            [(
                View::Map,
                Area {
                    x: 0.0,
                    y: 0.0,
                    w: 390.0,
                    h: 500.0
                }
            )]
        );
        assert_eq!(View::from_name("all"), None);
    }
}
