//! Moves the camera, or the picture, by drags and the wheel.

use super::placement::{Placement, Touch, place_at};
use crate::app::model::{Document, navigation};
use crate::scene::Camera;
use eframe::egui::{CursorIcon, PointerButton, Pos2, Response, Ui, Vec2};
use glam::DVec3;

/// Radians of rotation per point of dragging.
const TURN_PER_POINT: f64 = 0.006;

/// An orbit up or down is slower by this factor: the ground and the pole are near.
const UP_SHARE: f64 = 0.5;

/// Share of the distance moved per point of scrolling.
const DOLLY_PER_POINT: f64 = 0.002;

/// The orbit in progress.
#[derive(Default)]
pub(super) struct Moving {
    /// The point that the camera turns about.
    pivot: Option<DVec3>,
}

impl Moving {
    /// Handles drags and the wheel. Nothing moves the camera of a picture that is hidden.
    pub fn handle(
        &mut self,
        ui: &Ui,
        response: &Response,
        placement: &mut Placement,
        (camera, document): (&mut Camera, &Document),
        is_hidden: bool,
        touch: &mut Touch,
    ) {
        let (modifiers, scroll, zoom, pressed) = ui.input(|input| {
            let scroll = input.smooth_scroll_delta().y;
            (input.modifiers, scroll, input.zoom_delta(), input.pointer.press_origin())
        });
        let (rect, delta) = (placement.rect, response.drag_delta());
        let point = |camera: &Camera, at: Pos2| {
            let pick = rect.contains(at).then(|| document.pick(camera, place_at(rect, at)));
            Some(pick??.point)
        };
        let mut moved = *camera;
        let [right, down] = [delta.x, delta.y].map(|points| f64::from(points) * TURN_PER_POINT);
        let is_primary = response.dragged_by(PointerButton::Primary);
        let is_panning =
            response.dragged_by(PointerButton::Middle) || (is_primary && (modifiers.shift || is_hidden));
        let is_orbit = is_primary && !is_panning;
        if !is_orbit {
            self.pivot = None;
        }
        if is_panning {
            placement.pan_by(delta);
            ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
        } else if is_orbit {
            // Where the button went down, before the pointer moved far enough for a drag.
            let begin = pressed.filter(|_| response.drag_started()).or(response.interact_pointer_pos());
            let pivot = *self.pivot.get_or_insert_with(|| {
                let there = begin.and_then(|at| point(camera, at)).unwrap_or(camera.look_at);
                navigation::within_reach(camera, there)
            });
            if delta != Vec2::ZERO {
                moved =
                    navigation::orbit_above_ground(camera, pivot, right, UP_SHARE * down, document.scene());
            }
        } else if response.dragged_by(PointerButton::Secondary) && delta != Vec2::ZERO && !is_hidden {
            moved = navigation::look(&moved, right, -down);
        }
        if let Some(pointer) = response.hover_pos() {
            if zoom != 1.0 {
                placement.zoom_at(pointer, zoom);
            } else if is_hidden && scroll != 0.0 {
                placement.zoom_at(pointer, (scroll * DOLLY_PER_POINT as f32).exp());
            } else if scroll != 0.0 {
                let towards = point(&moved, pointer).unwrap_or_else(|| match rect.contains(pointer) {
                    true => navigation::at_depth(&moved, place_at(rect, pointer), document.aspect()),
                    false => moved.look_at,
                });
                moved = navigation::dolly(&moved, towards, (-f64::from(scroll) * DOLLY_PER_POINT).exp());
            }
        }
        if let Some(reason) = document.no_rays() {
            self.pivot = None;
            touch.said = (moved != *camera).then(|| reason.to_owned());
        } else if moved != *camera {
            *camera = moved;
            touch.is_move = true;
        }
    }
}
