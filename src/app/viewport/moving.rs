//! Moves the camera by drags and the wheel.

use super::placement::Placement;
use super::selection::{place_at, point_at};
use super::touch::Touch;
use crate::app::model::document::Document;
use crate::app::navigation;
use crate::app::surfaces::Surfaces;
use crate::scene::Camera;
use eframe::egui::{Color32, CursorIcon, PointerButton, Pos2, Rect, Response, Stroke, Ui, Vec2};
use glam::DVec3;

/// Radians of rotation per point of dragging.
const TURN_PER_POINT: f64 = 0.006;

/// Share of the distance moved per point of scrolling.
pub(super) const DOLLY_PER_POINT: f64 = 0.002;

/// Turns by a drag of this many points: to the right and down.
pub(super) fn angles(drag: Vec2) -> [f64; 2] {
    [drag.x, drag.y].map(|points| f64::from(points) * TURN_PER_POINT)
}

/// What the camera sees.
#[derive(Clone, Copy)]
pub(super) struct Target<'a> {
    pub document: &'a Document,
    pub surfaces: &'a Surfaces,
    /// Whether the stage traces rays, so that there is something to turn about.
    pub has_rays: bool,
}

impl Target<'_> {
    /// The point of the scene at a point of the screen, if there is one in the picture at `rect`.
    fn point(&self, camera: &Camera, rect: Rect, at: Pos2) -> Option<DVec3> {
        let is_seen = self.has_rays && rect.contains(at);
        let pick = is_seen.then(|| self.surfaces.pick(self.document, camera, place_at(rect, at)));
        Some(pick??.point)
    }

    /// What is up in the scene: the camera's own up direction may be that of a view from the top.
    pub fn up(&self) -> DVec3 {
        self.document.origin.recipe.camera.vup
    }
}

/// The orbit in progress.
#[derive(Default)]
pub(super) struct Moving {
    /// The point that the camera turns about.
    pivot: Option<DVec3>,
}

impl Moving {
    /// Handles drags and the wheel.
    pub fn handle(
        &mut self,
        ui: &Ui,
        response: &Response,
        placement: &mut Placement,
        (camera, sight): (&mut Camera, Target<'_>),
        touch: &mut Touch,
    ) {
        let (modifiers, scroll, zoom, pressed) = ui.input(|input| {
            let scroll = input.smooth_scroll_delta().y;
            (input.modifiers, scroll, input.zoom_delta(), input.pointer.press_origin())
        });
        let rect = placement.rect();
        let delta = response.drag_delta();
        let [right, down] = angles(delta);
        let mut moved = *camera;
        let is_primary = response.dragged_by(PointerButton::Primary);
        let is_panning = response.dragged_by(PointerButton::Middle) || (is_primary && modifiers.shift);
        let is_orbit = is_primary && !is_panning;
        if !is_orbit {
            self.pivot = None;
        }
        if is_panning {
            placement.pan_by(delta);
            ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
        } else if is_orbit {
            // What was under the pointer before the drag was told from a click.
            let begin = pressed.filter(|_| response.drag_started()).or(response.interact_pointer_pos());
            let pivot = *self.pivot.get_or_insert_with(|| {
                begin.and_then(|at| sight.point(camera, rect, at)).unwrap_or(camera.look_at)
            });
            if delta != Vec2::ZERO {
                moved =
                    navigation::orbit(&navigation::upright(&moved, pivot, sight.up()), pivot, right, down);
                touch.pivot = Some(pivot);
            }
        } else if response.dragged_by(PointerButton::Secondary) && delta != Vec2::ZERO {
            let upright = navigation::upright(&moved, moved.look_from, sight.up());
            moved = navigation::look(&upright, right, -down);
        }
        if let Some(pointer) = response.hover_pos() {
            if zoom != 1.0 {
                placement.zoom_at(pointer, zoom);
            } else if scroll != 0.0 {
                let aspect = sight.document.aspect();
                let point = sight.point(&moved, rect, pointer).unwrap_or_else(|| {
                    let is_in_picture = sight.has_rays && rect.contains(pointer);
                    let depth = || navigation::at_depth(&moved, place_at(rect, pointer), aspect);
                    if is_in_picture { depth() } else { moved.look_at }
                });
                moved = navigation::dolly(&moved, point, (-f64::from(scroll) * DOLLY_PER_POINT).exp());
                touch.pivot = Some(point);
            }
        }
        if moved != *camera {
            *camera = moved;
            touch.is_move = true;
            touch.is_orbit = is_primary;
        }
    }

    /// Draws the point that the camera turns about.
    pub fn paint(&self, ui: &Ui, clip: Rect, rect: Rect, document: &Document) {
        let place = self.pivot.and_then(|pivot| document.camera.place_of(pivot, document.aspect()));
        let Some(at) = place.map(|place| point_at(rect, place)) else { return };
        let painter = ui.painter().with_clip_rect(clip);
        painter.circle_stroke(at, 6.0, Stroke::new(3.0, Color32::from_black_alpha(70)));
        painter.circle_stroke(at, 6.0, Stroke::new(1.25, Color32::from_white_alpha(150)));
        painter.circle_filled(at, 1.5, Color32::from_white_alpha(190));
    }
}
