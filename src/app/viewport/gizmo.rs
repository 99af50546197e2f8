//! The scene's axes in a corner of the viewport. They turn with the camera. A click on an end looks from that side, and a
//! drag orbits.

use super::moving::{Target, angles};
use super::touch::Touch;
use crate::app::command::Command;
use crate::app::model::viewpoint::Viewpoint;
use crate::app::navigation;
use crate::app::theme;
use crate::scene::Camera;
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Id, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo,
    vec2,
};

/// From the middle to an end, in points.
const LENGTH: f32 = 30.0;

/// The radius of an end, in points.
const END: f32 = 8.5;

/// From the edge of the viewport to the disc, in points.
const MARGIN: f32 = 14.0;

/// A viewport smaller than this has no room for it, in points.
const LEAST_ROOM: Vec2 = vec2(240.0, 180.0);

/// The colours of the axes: where the normals view is red, green or blue.
const COLOURS: [Color32; 3] =
    [Color32::from_rgb(232, 84, 84), Color32::from_rgb(92, 186, 96), Color32::from_rgb(86, 142, 246)];

/// The letters of the axes.
const LETTERS: [&str; 3] = ["x", "y", "z"];

/// An end of an axis on the screen.
struct End {
    side: Viewpoint,
    at: Pos2,
    /// Towards the viewer, -1 to 1.
    depth: f64,
}

/// Handles input on the axes in the corner of `room` and draws them.
pub(super) fn ui(
    ui: &Ui,
    room: Rect,
    (camera, sight): (&mut Camera, Target<'_>),
    commands: &mut Vec<Command>,
    touch: &mut Touch,
) {
    if room.width() < LEAST_ROOM.x || room.height() < LEAST_ROOM.y {
        return;
    }
    let reach = LENGTH + END + 3.0;
    let middle = room.right_bottom() - Vec2::splat(MARGIN + reach);
    let disc = Rect::from_center_size(middle, Vec2::splat(2.0 * reach));
    let id = Id::unique("axes");
    // Without the keyboard focus, which its ends have.
    let whole = ui.interact(disc, id, Sense::CLICK | Sense::DRAG);
    whole.widget_info(|| WidgetInfo::labeled(Role::Group, true, "Axes"));
    let ends = ends(camera, middle);
    let mut held = whole;
    let mut named = None;
    for end in &ends {
        let area = Rect::from_center_size(end.at, Vec2::splat(2.0 * END));
        let response = ui.interact(area, id.with(end.side.name()), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, end.side.name()));
        // Of two ends at one place, the one in front is meant.
        let in_front = response.interact_pointer_pos().and_then(|at| front(&ends, at));
        if response.clicked() {
            commands.push(Command::ViewFrom(in_front.map_or(end.side, |end| end.side)));
        }
        if response.has_focus() {
            named = Some(end.side);
        }
        held = held.union(response);
    }
    if held.dragged() && held.drag_delta() != Vec2::ZERO {
        orbit(&held, (camera, sight), touch);
    }
    let hovered =
        ui.input(|input| input.pointer.hover_pos()).filter(|at| held.hovered() && disc.contains(*at));
    let hot = hovered.and_then(|at| front(&ends, at)).map(|end| end.side).or(named);
    if let Some(side) = hot {
        held = held.on_hover_text_at_pointer(side.name());
    }
    if held.hovered() || held.dragged() {
        let icon = if hot.is_some() { CursorIcon::PointingHand } else { CursorIcon::Grab };
        ui.ctx().set_cursor_icon(if held.dragged() { CursorIcon::Grabbing } else { icon });
        ui.painter().circle_filled(middle, reach, ui.visuals().panel_fill.gamma_multiply(0.5));
    }
    paint(ui, middle, ends, hot);
}

fn orbit(held: &Response, (camera, sight): (&mut Camera, Target<'_>), touch: &mut Touch) {
    let (pivot, [right, down]) = (camera.look_at, angles(held.drag_delta()));
    let moved = navigation::orbit(&navigation::upright(camera, pivot, sight.up()), pivot, right, down);
    if moved != *camera {
        *camera = moved;
        (touch.is_move, touch.is_orbit, touch.pivot) = (true, true, Some(pivot));
    }
}

/// The ends in the order of [`Viewpoint::ALL`], in which the keyboard goes through them.
fn ends(camera: &Camera, middle: Pos2) -> Vec<End> {
    let basis = camera.basis();
    let end = |side: Viewpoint| {
        let direction = side.direction();
        let [right, up, depth] = [basis.u, basis.v, basis.w].map(|axis| axis.dot(direction));
        End { side, at: middle + LENGTH * vec2(right as f32, -up as f32), depth }
    };
    Viewpoint::ALL.map(end).into()
}

/// The end in front at a point of the screen.
fn front(ends: &[End], at: Pos2) -> Option<&End> {
    let there = ends.iter().filter(|end| end.at.distance(at) <= END + 1.0);
    there.max_by(|a, b| a.depth.total_cmp(&b.depth))
}

fn paint(ui: &Ui, middle: Pos2, mut ends: Vec<End>, hot: Option<Viewpoint>) {
    ends.sort_by(|a, b| a.depth.total_cmp(&b.depth));
    let painter = ui.painter();
    let font = FontId::proportional(11.0);
    for End { side, at, depth } in ends {
        let is_hot = hot == Some(side);
        // What points away is paler.
        let strength = 0.62 + 0.38 * (0.5 + 0.5 * depth as f32);
        let surround = theme::surround(ui);
        let colour = surround.lerp_to_gamma(COLOURS[side.axis()], strength);
        let edge = if is_hot { Stroke::new(1.5, ui.visuals().strong_text_color()) } else { Stroke::NONE };
        if side.is_positive() {
            let outwards = (at - middle).normalized() * (at.distance(middle) - END).max(0.0);
            painter
                .line_segment([middle, middle + outwards], Stroke::new(4.0, Color32::from_black_alpha(60)));
            painter.line_segment([middle, middle + outwards], Stroke::new(2.5, colour));
            painter.circle_filled(at, END + 0.75, Color32::from_black_alpha(60));
            painter.circle(at, END, colour, edge);
            let letter = LETTERS[side.axis()];
            painter.text(at, Align2::CENTER_CENTER, letter, font.clone(), Color32::from_gray(16));
        } else {
            painter.circle_filled(at, END - 1.5, surround.gamma_multiply(0.75));
            let edge = if is_hot { edge } else { Stroke::new(1.75, colour) };
            painter.circle_stroke(at, END - 2.0, edge);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::document::Document;
    use crate::app::model::origin::Origin;
    use crate::app::tests::dressed;
    use crate::stages::Stage;
    use eframe::egui::{Event, Modifiers, PointerButton, pos2};
    use egui_kittest::Harness;

    struct Axes {
        document: Document,
        commands: Vec<Command>,
        touch: Touch,
        room: Rect,
    }

    fn axes(camera: Camera, room: Rect) -> Harness<'static, Axes> {
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.camera = camera;
        let draw = |ui: &mut Ui, axes: &mut Axes| {
            let mut camera = axes.document.camera;
            let sight = Target { document: &axes.document, has_rays: true };
            super::ui(ui, axes.room, (&mut camera, sight), &mut axes.commands, &mut axes.touch);
            axes.document.camera = camera;
        };
        let touch = Touch::default();
        dressed([400.0, 300.0]).build_ui_state(draw, Axes { document, commands: Vec::new(), touch, room })
    }

    /// A camera that looks down at all axes.
    const ABOVE: Camera = Camera {
        look_from: glam::DVec3::new(3.0, 2.0, 4.0),
        look_at: glam::DVec3::new(0.0, 0.0, -1.0),
        ..Camera::BOOK
    };

    const ROOM: Rect = Rect { min: pos2(10.0, 10.0), max: pos2(390.0, 290.0) };

    /// The middle of the axes in that room.
    const MIDDLE: Pos2 = pos2(390.0 - MARGIN - LENGTH - END - 3.0, 290.0 - MARGIN - LENGTH - END - 3.0);

    #[test]
    fn a_drag_orbits_about_what_is_looked_at() {
        let mut harness = axes(ABOVE, ROOM);
        for from in [MIDDLE, ends(&ABOVE, MIDDLE)[1].at] {
            let axes = harness.state_mut();
            (axes.touch, axes.document.camera) = (Touch::default(), ABOVE);
            let button = |pos: Pos2, pressed| {
                let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
                Event::PointerButton { pos, button, pressed, modifiers }
            };
            harness.event(Event::PointerMoved(from));
            harness.event(button(from, true));
            harness.event(Event::PointerMoved(from + vec2(20.0, 5.0)));
            harness.run_steps(1);
            assert_eq!(harness.output().platform_output.cursor_icon, CursorIcon::Grabbing);
            harness.event(button(from + vec2(20.0, 5.0), false));
            harness.run_steps(1);
            let Axes { document, touch, .. } = harness.state();
            let [right, down] = angles(vec2(20.0, 5.0));
            let expected = navigation::orbit(&ABOVE, ABOVE.look_at, right, down);
            assert!(document.camera.look_from.distance(expected.look_from) < 1e-9, "{:?}", document.camera);
            assert_eq!((touch.is_move, touch.is_orbit, touch.pivot), (true, true, Some(ABOVE.look_at)));
            assert!(harness.state().commands.is_empty(), "a drag is no click");
        }
    }
}
