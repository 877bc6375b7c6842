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

/// The same where solvers are compared: maps side by side and a taller plot; one view alone is the maps with
/// the plot below them, or the plot, or the inspector.
pub fn arrange_race(
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
    let plot = (0.46 * height).clamp(150.0 * text, 340.0 * text);
    let plot = plot.min(0.5 * height);
    let top = height - plot;
    let stacked = |w: f32| {
        vec![
            (View::Map, area(0.0, 0.0, w, top)),
            (View::Plot, area(0.0, top, w, plot)),
        ]
    };
    match alone {
        Some(View::Map | View::Shape) => return stacked(width),
        Some(view) => return vec![(view, area(0.0, 0.0, width, height))],
        None => {}
    }
    let column = if inspector { 292.0 * text } else { 0.0 };
    let wide = width >= 1000.0 * text;
    let mut all = stacked(if wide { width - column } else { width });
    if !inspector {
        return all;
    }
    if wide {
        all.push((View::Inspector, area(width - column, 0.0, column, height)));
    } else {
        // A tablet: the inspector stands beside the plot.
        all[1].1.w = width - column;
        all.push((View::Inspector, area(width - column, top, column, plot)));
    }
    all
}

/// Cells for `count` maps side by side, all of one size: as many rows as make them largest.
pub fn grid(count: usize, width: f32, height: f32) -> Vec<Area> {
    let cell = |columns: usize| {
        let rows = count.div_ceil(columns);
        (width / columns as f32, height / rows as f32)
    };
    let size = |columns: &usize| {
        let (w, h) = cell(*columns);
        w.min(h)
    };
    let columns = (1..=count).max_by(|a, b| size(a).total_cmp(&size(b)));
    let Some(columns) = columns else {
        return Vec::new();
    };
    let (w, h) = cell(columns);
    (0..count)
        .map(|i| {
            let (row, column) = (i / columns, i % columns);
            let (x, y) = ((column as f32 * w).round(), (row as f32 * h).round());
            let right = ((column + 1) as f32 * w).round();
            let bottom = ((row + 1) as f32 * h).round();
            Area {
                x,
                y,
                w: right - x,
                h: bottom - y,
            }
        })
        .collect()
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
    fn compared_maps_tile_the_canvas_with_their_plot() {
        for (w, h) in [(1300.0, 690.0), (820.0, 900.0), (2560.0, 1300.0)] {
            for inspector in [true, false] {
                let all = arrange_race(w, h, None, inspector, 1.0);
                let covered: f32 = all.iter().map(|(_, a)| a.w * a.h).sum();
                assert!((covered - w * h).abs() < 2.0 * (w + h), "{w}×{h}: {all:?}");
                assert!(all.iter().all(|(view, _)| *view != View::Shape));
                assert_eq!(all.len(), 2 + usize::from(inspector));
            }
        }
        let phone = arrange_race(390.0, 500.0, Some(View::Map), true, 1.0);
        assert_eq!(
            phone.iter().map(|(view, _)| *view).collect::<Vec<_>>(),
            [View::Map, View::Plot]
        );
        assert_eq!(phone[0].1.h + phone[1].1.h, 500.0);
    }

    #[test]
    fn a_grid_makes_its_cells_as_large_as_they_can_be() {
        let columns = |cells: &[Area]| cells.iter().filter(|a| a.y == 0.0).count();
        assert_eq!(columns(&grid(4, 1000.0, 350.0)), 4);
        assert_eq!(columns(&grid(4, 600.0, 600.0)), 2);
        assert_eq!(columns(&grid(2, 300.0, 700.0)), 1);
        assert!(grid(0, 10.0, 10.0).is_empty());
        for cells in [grid(3, 1001.0, 400.0), grid(4, 601.0, 599.0)] {
            let (w, h) = (cells[0].w, cells[0].h);
            assert!(
                cells
                    .iter()
                    .all(|a| (a.w - w).abs() <= 1.0 && (a.h - h).abs() <= 1.0)
            );
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
