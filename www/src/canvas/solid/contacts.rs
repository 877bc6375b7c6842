//! Contacts: what keeps a boundary from passing through itself. A diamond where a vertex meets a facet, a cross where two
//! edges meet; filled and bold where the contact is active, an outline where it is not; in the colour of its zone, where
//! colours are those of zones.

use std::collections::BTreeSet;

use eframe::egui::{Align2, Color32, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};
use glam::Vec3;

use crate::canvas::bench::Bench;
use crate::canvas::style;
use crate::colour::zones;
use crate::scale::whole;
use crate::solid::contact::{Contact, place};
use crate::solid::field::Field;
use crate::solid::pick::Lens;

/// Half the size of a glyph, in points; of many, which would hide the body, less.
const SIDE: f32 = 5.0;
const SMALL: f32 = 3.2;
const MANY: usize = 120;

/// Draws the contacts of the state on show that are `here`, where many are nearly in one place one of them; returns how
/// many there are of vertices and facets, and of edges, and how many of each were drawn.
pub fn draw(
    painter: &Painter,
    rect: Rect,
    lens: &Lens,
    bench: &Bench,
    (positions, zoned): (&[f32], bool),
    here: impl Fn(Vec3) -> bool,
) -> [usize; 4] {
    // those of a state that was dropped would be drawn on another
    let there = bench.shows_work() && bench.shown_map == bench.shown;
    let Some(contacts) = bench.contacts().filter(|_| there) else {
        return [0; 4];
    };
    let side = if contacts.len() > MANY { SMALL } else { SIDE };
    let mut count = [0; 4];
    let mut taken: BTreeSet<(bool, i32, i32)> = BTreeSet::new();
    // active ones come first to their places
    let mut drawn = Vec::new();
    for active in [true, false] {
        for contact in contacts.iter().filter(|c| c.active == active) {
            let p = place(contact, positions);
            if !p.is_finite() || !here(p) {
                continue;
            }
            count[usize::from(contact.edges)] += 1;
            let (at, _) = lens.project(p);
            let [x, y] = [at.x, at.y].map(|x| (x / (1.5 * side)).floor() as i32);
            if taken.insert((contact.edges, x, y)) {
                count[2 + usize::from(contact.edges)] += 1;
                drawn.push((rect.min + vec2(at.x, at.y), contact));
            }
        }
    }
    // diamonds on top of crosses, active ones on top of others
    for edges in [true, false] {
        for (at, contact) in drawn.iter().rev().filter(|(_, c)| c.edges == edges) {
            let own = match contact.zone {
                0 => bench.theme.ink,
                zone if zoned => zones(f64::from(Field::Zone.position(f64::from(zone)))),
                _ => bench.theme.ink,
            };
            glyph(painter, *at, contact, side, bench, style::colour(own));
        }
    }
    count
}

fn glyph(painter: &Painter, at: Pos2, contact: &Contact, side: f32, bench: &Bench, own: Color32) {
    let ink = style::colour(bench.theme.ink);
    let ground = style::colour(bench.theme.ground);
    if contact.edges {
        let arm = 0.85 * side;
        let strokes = match contact.active {
            true if own != ink => [(4.4, ground), (3.4, ink), (1.6, own)],
            true => [(4.4, ground), (2.2, ink), (2.2, ink)],
            false => [(2.6, ground), (1.0, own), (1.0, own)],
        };
        for (width, ink) in strokes {
            for arm in [vec2(arm, arm), vec2(arm, -arm)] {
                painter.line_segment([at - arm, at + arm], Stroke::new(width, ink));
            }
        }
        return;
    }
    let diamond = |side: f32, fill: Color32, stroke: Stroke| {
        let corners = [(0.0, -side), (side, 0.0), (0.0, side), (-side, 0.0)];
        let corners = corners.map(|(x, y)| at + vec2(x, y)).to_vec();
        painter.add(Shape::convex_polygon(corners, fill, stroke));
    };
    match contact.active {
        true => {
            diamond(side + 1.6, ground, Stroke::NONE);
            diamond(side, own, Stroke::new(1.1, ink));
        }
        false => diamond(side - 0.4, ground, Stroke::new(1.1, own)),
    }
}

/// What is in contact, in words with their glyphs, under the count of what is inverted.
pub fn key(painter: &Painter, rect: Rect, bench: &Bench) {
    let moment = bench.moment().filter(|_| bench.shows_work());
    let Some(meeting) = moment.and_then(|moment| moment.meeting) else {
        return;
    };
    let contacts = bench.contacts().unwrap_or_default();
    let (theme, text) = (bench.theme, bench.text);
    let active = contacts.iter().filter(|c| c.active).count();
    let crossing = match meeting {
        0 => "nothing crosses".to_owned(),
        1 => "1 pair crosses".to_owned(),
        pairs => format!("{} pairs cross", whole(pairs as usize)),
    };
    let kinds = [false, true].map(|edges| contacts.iter().any(|c| c.edges == edges));
    let words = match contacts.len() {
        0 => crossing,
        1 => format!("1 contact, {active} active · {crossing}"),
        all => format!(
            "{} contacts, {} active · {crossing}",
            whole(all),
            whole(active)
        ),
    };
    let at = pos2(rect.right() - 14.0, rect.top() + 11.0 + 21.0 * text);
    let font = style::regular(style::SMALL * text);
    let galley = painter.layout_no_wrap(words, font, style::colour(theme.quiet));
    let place = Align2::RIGHT_TOP.anchor_size(at, galley.size());
    let room = 15.0 * kinds.iter().filter(|any| **any).count() as f32 * text;
    let mut ground = place.expand2(vec2(5.0, 2.0));
    ground.min.x -= room;
    painter.rect_filled(
        ground.intersect(rect),
        4.0,
        style::colour(theme.ground).gamma_multiply(0.8),
    );
    painter.galley(place.min, galley, style::colour(theme.quiet));
    let mut x = place.left() - 9.0 * text;
    for edges in [true, false] {
        if !kinds[usize::from(edges)] {
            continue;
        }
        let sample = Contact {
            vertices: [0; 4],
            edges,
            active: true,
            zone: 0,
        };
        let middle = pos2(x, place.center().y);
        let ink = style::colour(theme.ink);
        glyph(painter, middle, &sample, 4.4 * text, bench, ink);
        x -= 15.0 * text;
    }
}
