//! The scene's axes in a corner of the viewport. A click on an end looks from that side, and a drag orbits.

use super::Touch;
use super::moving::orbited;
use crate::app::command::Command;
use crate::app::model::document::Document;
use crate::app::model::viewpoint::Viewpoint;
use crate::app::theme;
use crate::scene::Camera;
use eframe::egui::{
    Align2, Color32, CursorIcon, FontId, Id, Pos2, Rect, Role, Sense, Stroke, Ui, Vec2, WidgetInfo, vec2,
};

/// From the middle to an end, and the radius of an end, in points.
const LENGTH: f32 = 30.0;
const END: f32 = 8.5;

/// From the edge of the viewport to the middle, in points.
const MARGIN: f32 = 56.0;

/// A viewport smaller than this has no room for it, in points.
const LEAST_ROOM: Vec2 = vec2(240.0, 180.0);

/// The colours of the axes: where the normals view is red, green or blue.
const COLOURS: [Color32; 3] =
    [Color32::from_rgb(232, 84, 84), Color32::from_rgb(92, 186, 96), Color32::from_rgb(86, 142, 246)];

/// Handles input on the axes in the corner of `room` and draws them.
pub(super) fn ui(
    ui: &Ui,
    room: Rect,
    (camera, document): (&mut Camera, &Document),
    commands: &mut Vec<Command>,
    touch: &mut Touch,
) {
    if room.width() < LEAST_ROOM.x || room.height() < LEAST_ROOM.y {
        return;
    }
    let (middle, reach) = (room.right_bottom() - Vec2::splat(MARGIN), LENGTH + END + 3.0);
    let disc = Rect::from_center_size(middle, Vec2::splat(2.0 * reach));
    let id = Id::unique("axes");
    // Without the keyboard focus, which its ends have.
    let mut held = ui.interact(disc, id, Sense::CLICK | Sense::DRAG);
    held.widget_info(|| WidgetInfo::labeled(Role::Group, true, "Axes"));
    let basis = camera.basis();
    // Each end with its place and its direction towards the viewer, the nearest last.
    let mut ends = Viewpoint::ALL.map(|side| {
        let [right, up, depth] = [basis.u, basis.v, basis.w].map(|axis| axis.dot(side.direction()));
        (side, middle + LENGTH * vec2(right as f32, -up as f32), depth)
    });
    ends.sort_by(|a, b| a.2.total_cmp(&b.2));
    let pointer = ui.input(|input| input.pointer.hover_pos());
    let mut hot = None;
    for (side, at, _) in ends {
        let response = ui.interact(
            Rect::from_center_size(at, Vec2::splat(2.0 * END)),
            id.with(side.name()),
            Sense::click_and_drag(),
        );
        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, side.name()));
        if response.clicked() {
            commands.push(Command::ViewFrom(side));
        }
        let is_under = pointer.is_some_and(|pointer| pointer.distance(at) <= END + 1.0);
        if response.has_focus() || (response.hovered() && is_under) {
            hot = Some(side);
        }
        held = held.union(response);
    }
    if held.dragged() {
        let moved = orbited(camera, camera.look_at, held.drag_delta(), document);
        (touch.is_move, touch.is_orbit) = (touch.is_move || moved != *camera, true);
        *camera = moved;
    }
    if held.hovered() || held.dragged() {
        let icon = if hot.is_some() { CursorIcon::PointingHand } else { CursorIcon::Grab };
        ui.ctx().set_cursor_icon(if held.dragged() { CursorIcon::Grabbing } else { icon });
        ui.painter().circle_filled(middle, reach, ui.visuals().panel_fill.gamma_multiply(0.5));
    }
    for (side, at, depth) in ends {
        paint_end(ui, middle, (side, at, depth), hot == Some(side));
    }
    if let Some(side) = hot {
        held.on_hover_text_at_pointer(side.name());
    }
}

fn paint_end(ui: &Ui, middle: Pos2, (side, at, depth): (Viewpoint, Pos2, f64), is_hot: bool) {
    let (painter, surround) = (ui.painter(), theme::colours(ui).surround);
    // What points away is paler.
    let colour = surround.lerp_to_gamma(COLOURS[side.axis()], 0.81 + 0.19 * depth as f32);
    let edge = if is_hot { Stroke::new(1.5, ui.visuals().strong_text_color()) } else { Stroke::NONE };
    if side.is_positive() {
        let tip = middle + (at - middle).normalized() * (at.distance(middle) - END).max(0.0);
        painter.line_segment([middle, tip], Stroke::new(4.0, Color32::from_black_alpha(60)));
        painter.line_segment([middle, tip], Stroke::new(2.5, colour));
        painter.circle(at, END, colour, edge);
        let letter = ["x", "y", "z"][side.axis()];
        painter.text(at, Align2::CENTER_CENTER, letter, FontId::proportional(11.0), Color32::from_gray(16));
    } else {
        let edge = if is_hot { edge } else { Stroke::new(1.75, colour) };
        painter.circle(at, END - 2.0, surround.gamma_multiply(0.75), edge);
    }
}
