//! Fonts, sizes and colours for egui.

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, FontData, FontDefinitions, FontFamily, FontId, Painter, Pos2, Rect,
};

use super::bench::Bench;
use crate::colour::Rgb;

/// Size of body text, in points.
pub const BODY: f32 = 13.0;

/// Size of captions and ticks, in points.
pub const SMALL: f32 = 11.5;

/// Installs the page's fonts: a subset of Inter, with tabular digits.
pub fn install(context: &egui::Context) {
    let mut fonts = FontDefinitions::empty();
    for (name, bytes) in [
        (
            "regular",
            &include_bytes!("../../assets/fonts/Inter-Regular.otf")[..],
        ),
        (
            "medium",
            &include_bytes!("../../assets/fonts/Inter-Medium.otf")[..],
        ),
    ] {
        fonts
            .font_data
            .insert(name.into(), Arc::new(FontData::from_static(bytes)));
    }
    fonts
        .families
        .insert(FontFamily::Proportional, vec!["regular".into()]);
    fonts
        .families
        .insert(FontFamily::Monospace, vec!["regular".into()]);
    fonts
        .families
        .insert(FontFamily::Name("medium".into()), vec!["medium".into()]);
    context.set_fonts(fonts);
}

/// Follows the bench's theme and text size.
pub fn follow(context: &egui::Context, bench: &Bench) {
    let theme = bench.theme;
    let mut visuals = if theme.dark {
        egui::Visuals::dark()
    } else {
        egui::Visuals::light()
    };
    visuals.panel_fill = colour(theme.ground);
    visuals.window_fill = colour(theme.ground);
    visuals.override_text_color = Some(colour(theme.ink));
    visuals.window_stroke = egui::Stroke::new(1.0, colour(theme.line));
    context.set_visuals(visuals);
    context.all_styles_mut(|style| {
        style.interaction.tooltip_delay = 0.15;
        style.spacing.tooltip_width = 300.0 * bench.text;
        for (_, font) in &mut style.text_styles {
            *font = regular(BODY * bench.text);
        }
    });
}

/// An egui colour.
pub fn colour([r, g, b]: Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// The regular face.
pub fn regular(size: f32) -> FontId {
    FontId::new(size, FontFamily::Proportional)
}

/// The medium face.
pub fn medium(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name("medium".into()))
}

/// Text with a soft ground behind it, so that it reads over a drawing.
pub fn label(
    painter: &Painter,
    bench: &Bench,
    at: Pos2,
    anchor: Align2,
    text: &str,
    quiet: bool,
) -> Rect {
    let theme = bench.theme;
    let ink = if quiet { theme.quiet } else { theme.ink };
    let galley = painter.layout_no_wrap(text.to_owned(), regular(SMALL * bench.text), colour(ink));
    let rect = anchor.anchor_size(at, galley.size());
    painter.rect_filled(
        rect.expand2(egui::vec2(3.0, 1.0)),
        3.0,
        colour(theme.ground).gamma_multiply(0.82),
    );
    painter.galley(rect.min, galley, colour(ink));
    rect
}

/// The heading of a view, top left; returns where it ends.
///
/// `rest` is left out where it would not fit before `right`.
pub fn heading(
    painter: &Painter,
    bench: &Bench,
    view: Rect,
    right: f32,
    title: &str,
    rest: &str,
) -> Rect {
    let at = view.min + egui::vec2(14.0, 10.0);
    let theme = bench.theme;
    let first = painter.text(
        at,
        Align2::LEFT_TOP,
        title,
        medium(BODY * bench.text),
        colour(theme.ink),
    );
    if rest.is_empty() {
        return first;
    }
    let after = Pos2::new(first.right() + 8.0, first.center().y);
    let room = (right - after.x - 10.0).max(0.0);
    let galley = painter.layout_no_wrap(
        rest.to_owned(),
        regular(SMALL * bench.text),
        colour(theme.quiet),
    );
    if galley.size().x > room {
        return first;
    }
    let place = Align2::LEFT_CENTER.anchor_size(after + egui::vec2(0.0, 0.5), galley.size());
    painter.galley(place.min, galley, colour(theme.quiet));
    first.union(place)
}
