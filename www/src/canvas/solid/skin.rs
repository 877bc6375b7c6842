//! The whole solid: translucent skin, inverted tetrahedra inside, handles to drag.

use eframe::egui::{self, Align2, CursorIcon, PointerButton, Pos2, Rect, Response, Sense, pos2};
use glam::{Vec2, Vec3};

use super::{Body, Grab, contacts, handles};
use crate::canvas::bench::{Bench, Event};
use crate::canvas::{gpu, legend, style};
use crate::scale::whole;
use crate::solid::field::Field;
use crate::solid::pick::{Lens, vertex_at, vertices_in};

/// How far beside the solid a pointer may be and still mean a vertex, in points.
const BESIDE: f32 = 9.0;

/// Points of a drag sideways that turn a handle by one radian.
const RADIAN: f32 = 70.0;

/// Draws the view and answers the pointer.
pub fn show(ui: &mut egui::Ui, rect: Rect, bench: &mut Bench) {
    let response = ui.interact(rect, ui.scope_id().with("skin"), Sense::click_and_drag());
    let size = Vec2::new(rect.width(), rect.height()).max(Vec2::ONE);
    let lens = Lens::new(bench.orbit.matrix(rect.aspect_ratio()), size);
    answer(ui, rect, &response, &lens, bench);
    let lens = Lens::new(bench.orbit.matrix(rect.aspect_ratio()), size);

    let Some(mut body) = bench.body.take() else {
        return;
    };
    body.view = Some((rect, lens));
    let look = bench.look(ui.pixels_per_point());
    let planar = body.solid.planar;
    let tint = if bench.tinted || planar { 0.9 } else { 0.0 };
    let solid = body.look(&bench.orbit, rect.aspect_ratio(), tint, None);
    ui.painter().add(egui::PaintCallback {
        rect,
        callback: std::sync::Arc::new(eframe::egui_glow::CallbackFn::new(move |_, _| {
            gpu::with(|gpu| match planar {
                true => gpu.draw_planar(solid, look),
                false => gpu.draw_skin(solid, look),
            });
        })),
    });
    if !planar {
        handles::plane_outline(ui.painter(), rect, &lens, bench, &body);
    }
    if let Some(frame) = bench.map() {
        handles::draw(
            ui.painter(),
            rect,
            &lens,
            bench,
            &body,
            body.positions(frame),
        );
        let shown = (body.positions(frame), body.field == Field::Zone);
        body.drawn_contacts = contacts::draw(ui.painter(), rect, &lens, bench, shown, |_| true);
    }
    contacts::key(ui.painter(), rect, bench);
    handles::rubber(ui.painter(), ui, bench, &body);
    let mut at = pos2(rect.left() + 14.0, rect.bottom() - 12.0);
    let legend = bench.tinted || planar;
    if legend {
        at.y = legend::ramp(ui.painter(), rect, bench, &body.legend()).top() - 6.0;
    }
    // beside a legend there is room for what cannot be guessed
    if !legend || bench.is_untangling() && body.movable && !body.grabbed {
        let hint = hint(bench, &body);
        style::label(ui.painter(), bench, at, Align2::LEFT_BOTTOM, hint, true);
    }
    let title = match (bench.is_untangling(), planar) {
        (true, _) if bench.shown == 0 => "The start",
        (true, _) => bench.state.title(),
        (false, true) => "Figure",
        (false, false) => "Solid",
    };
    let elements = if planar { "triangles" } else { "tetrahedra" };
    let size = format!("{} {elements}", whole(body.solid.tetrahedra.len()));
    let right = legend::inverted_key(ui.painter(), rect, bench, body.inverted.len());
    style::heading(ui.painter(), bench, rect, right, title, &size);
    bench.body = Some(body);
}

fn hint(bench: &Bench, body: &Body) -> &'static str {
    if handles::all_is_held(bench, body) {
        "all of the outside is held; drag to turn"
    } else if bench.is_untangling() && body.movable {
        match body.solid.planar {
            true => "drag a square to move what it holds",
            false => "drag a square to move what it holds; drag beside it to turn",
        }
    } else if bench.is_untangling() {
        "drag to turn"
    } else if body.handles.is_empty() {
        "click a vertex to pin it, or shift-drag a box around some"
    } else if body.box_tool {
        "drag a box around the vertices to pin"
    } else if bench.run.records.len() < 2 || body.over.is_some() {
        match body.solid.planar {
            true => "drag a square or the figure; click pins a vertex",
            false => "drag a square or the skin; click pins a vertex; drag beside it to turn",
        }
    } else {
        ""
    }
}

fn answer(ui: &egui::Ui, rect: Rect, response: &Response, lens: &Lens, bench: &mut Bench) {
    let local = |p: Pos2| Vec2::new(p.x - rect.left(), p.y - rect.top());
    let touch = ui.input(|i| i.multi_touch());
    if response.hovered() {
        let (zoom, scroll) = ui.input(|i| (i.zoom_delta(), i.smooth_scroll_delta.y));
        bench.orbit.magnify(zoom * (scroll * 0.004).exp());
    }
    if response.double_clicked() && bench.body.as_ref().is_some_and(|b| b.over.is_none()) {
        bench.orbit.zoom = 1.0;
    }
    let Some(mut body) = bench.body.take() else {
        return;
    };
    let (shift, turning, origin, pointer) = ui.input(|i| {
        (
            i.modifiers.shift,
            i.modifiers.command,
            i.pointer.press_origin(),
            i.pointer.latest_pos(),
        )
    });
    let by_main = response.dragged_by(PointerButton::Primary);
    if let Some(touch) = touch {
        if matches!(body.grab, Some(Grab::Vertices(..) | Grab::Turn(_))) {
            bench.events.push(Event::Drop);
        }
        body.grab = Some(Grab::Camera);
        let d = touch.translation_delta;
        let d = Vec2::new(d.x, d.y);
        if body.solid.planar {
            let delta = lens.drag(bench.orbit.centre, Vec2::ZERO, d);
            bench.orbit.shift(delta);
        } else {
            bench.orbit.drag(d, rect.size().min_elem());
        }
    } else if response.drag_started() {
        body.grab = Some(begin(bench, &body, lens, by_main, shift, origin, local));
        // Only a handle can be turned; the skin is pulled, whatever key is held.
        let handle = matches!(bench.events.last(), Some(Event::GrabHandle(_)));
        body.grabbed |= handle;
        if let (Some(Grab::Vertices(_, from)), true) = (body.grab, turning && handle) {
            body.grab = Some(Grab::Turn(from));
        }
    }
    if response.dragged() && touch.is_none() {
        match body.grab {
            Some(Grab::Vertices(anchor, from)) => {
                if let Some(p) = pointer {
                    let delta = lens.drag(anchor, from, local(p));
                    bench.events.push(Event::Drag(delta));
                }
            }
            Some(Grab::Turn(from)) => {
                if let Some(p) = pointer {
                    let d = local(p) - from;
                    bench.events.push(Event::Turn((d.x + d.y) / RADIAN));
                }
            }
            Some(Grab::Camera) if body.solid.planar => {
                let d = response.drag_delta();
                let centre = bench.orbit.centre;
                let delta = lens.drag(centre, Vec2::ZERO, Vec2::new(d.x, d.y));
                bench.orbit.shift(delta);
            }
            Some(Grab::Camera) => {
                let d = response.drag_delta();
                bench
                    .orbit
                    .drag(Vec2::new(d.x, d.y), rect.size().min_elem());
            }
            _ => {}
        }
    }
    if response.drag_stopped() {
        match body.grab {
            Some(Grab::Vertices(..) | Grab::Turn(_)) => bench.events.push(Event::Drop),
            Some(Grab::Box(from)) => {
                if let (Some(frame), Some(to)) = (bench.map(), pointer) {
                    let positions = body.positions(frame);
                    let found = vertices_in(lens, positions, local(from), local(to));
                    bench.events.push(Event::Pin(found));
                }
            }
            _ => {}
        }
        body.grab = None;
    }
    let untangling = bench.is_untangling();
    let free = body.grab.is_none() && !shift && !body.box_tool && (!untangling || body.movable);
    body.over = None;
    if let (Some(p), Some(frame)) = (response.hover_pos().filter(|_| free), bench.map()) {
        let positions = body.positions(frame);
        let handle = handles::under(&body, lens, positions, local(p));
        let solid = &body.solid;
        let vertex = || {
            vertex_at(
                lens,
                &solid.skin,
                &solid.outside,
                positions,
                local(p),
                BESIDE,
            )
        };
        match handle {
            Some((i, _)) => {
                ui.ctx().set_cursor_icon(CursorIcon::Grab);
                if response.clicked() {
                    bench.events.push(Event::Select(Some(i)));
                }
            }
            None if untangling => {}
            None => {
                body.over = vertex();
                if response.clicked() {
                    let event = body
                        .over
                        .map_or(Event::Select(None), |v| Event::Pin(vec![v]));
                    bench.events.push(event);
                }
            }
        }
    }
    match body.grab {
        Some(Grab::Vertices(..) | Grab::Turn(_)) => ui.ctx().set_cursor_icon(CursorIcon::Grabbing),
        Some(Grab::Box(_)) => ui.ctx().set_cursor_icon(CursorIcon::Crosshair),
        None if response.hovered() && (shift || body.box_tool) && !bench.is_untangling() => {
            ui.ctx().set_cursor_icon(CursorIcon::Crosshair);
        }
        _ => {}
    }
    bench.body = Some(body);
}

/// What a drag that begins moves; tells the page of it if it is vertices.
fn begin(
    bench: &mut Bench,
    body: &Body,
    lens: &Lens,
    by_main: bool,
    shift: bool,
    origin: Option<Pos2>,
    local: impl Fn(Pos2) -> Vec2,
) -> Grab {
    // What is held while a body is untangled stays where it is, unless it is kept from passing through itself.
    let untangling = bench.is_untangling();
    let (Some(origin), true) = (origin, by_main && (!untangling || body.movable)) else {
        return Grab::Camera;
    };
    if !untangling && (shift || body.box_tool) {
        return Grab::Box(origin);
    }
    let Some(frame) = bench.map() else {
        return Grab::Camera;
    };
    let positions = body.positions(frame);
    let from = local(origin);
    if let Some((handle, anchor)) = handles::under(body, lens, positions, from) {
        bench.events.push(Event::GrabHandle(handle));
        return Grab::Vertices(anchor, from);
    }
    if untangling {
        return Grab::Camera;
    }
    let solid = &body.solid;
    if let Some(v) = vertex_at(lens, &solid.skin, &solid.outside, positions, from, BESIDE) {
        let anchor = Vec3::from_slice(&positions[3 * v as usize..]);
        bench.events.push(Event::GrabVertex(v));
        return Grab::Vertices(anchor, from);
    }
    Grab::Camera
}
