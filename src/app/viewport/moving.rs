//! Moves the camera by drags and the wheel.

use super::placement::Placement;
use super::point::{place_at, point_at};
use super::touch::Touch;
use crate::app::model::document::Document;
use crate::app::navigation;
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
    /// Whether the stage traces rays. Without them the camera has no effect, so it stays where it is.
    pub has_rays: bool,
}

impl Target<'_> {
    /// The point of the scene at a point of the screen, if there is one in the picture at `rect`.
    fn point(&self, camera: &Camera, rect: Rect, at: Pos2) -> Option<DVec3> {
        let pick = rect.contains(at).then(|| self.document.pick(camera, place_at(rect, at)));
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
                    let depth = || navigation::at_depth(&moved, place_at(rect, pointer), aspect);
                    if rect.contains(pointer) { depth() } else { moved.look_at }
                });
                moved = navigation::dolly(&moved, point, (-f64::from(scroll) * DOLLY_PER_POINT).exp());
                touch.pivot = Some(point);
            }
        }
        let is_moved = moved != *camera;
        if !sight.has_rays {
            (self.pivot, touch.pivot) = (None, None);
            touch.is_refused |= is_moved;
        } else if is_moved {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::app::tests::dressed;

    use crate::stages::Stage;
    use eframe::egui::{Event, Modifiers, MouseWheelSource, MouseWheelUnit, Sense, TouchPhase, pos2, vec2};
    use egui_kittest::Harness;

    const ROOM: Rect = Rect { min: pos2(10.0, 10.0), max: pos2(330.0, 190.0) };

    /// Where the ball in the middle is seen.
    const BALL: Pos2 = pos2(170.0, 100.0);

    /// Where there is only sky.
    const SKY: Pos2 = pos2(170.0, 20.0);

    struct Picture {
        document: Document,
        placement: Placement,
        moving: Moving,
        touch: Touch,
        has_rays: bool,
    }

    fn picture() -> Harness<'static, Picture> {
        let draw = |ui: &mut Ui, picture: &mut Picture| {
            let Picture { document, placement, moving, touch, has_rays } = picture;
            let response = ui.allocate_rect(ROOM, Sense::click_and_drag());
            placement.place(ROOM, vec2(16.0, 9.0), 1.0);
            let mut camera = document.camera;
            let sight = Target { document, has_rays: *has_rays };
            moving.handle(ui, &response, placement, (&mut camera, sight), touch);
            document.camera = camera;
            moving.paint(ui, ROOM, placement.rect(), document);
        };
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.set_size([16, 9]);
        let picture = Picture {
            document,
            placement: Placement::default(),
            moving: Moving::default(),
            touch: Touch::default(),
            has_rays: true,
        };
        dressed([340.0, 200.0]).build_ui_state(draw, picture)
    }

    fn camera(harness: &Harness<'_, Picture>) -> Camera {
        harness.state().document.camera
    }

    /// Drags by this many points. The button is still held.
    fn drag(
        harness: &mut Harness<'_, Picture>,
        pos: Pos2,
        by: Vec2,
        button: PointerButton,
        modifiers: Modifiers,
    ) {
        let press = |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers };
        harness.event(Event::PointerMoved(pos));
        harness.event_modifiers(press(pos, true), modifiers);
        harness.event_modifiers(Event::PointerMoved(pos + by), modifiers);
        harness.run_steps(1);
    }

    fn same(a: &Camera, b: &Camera) -> bool {
        a.look_from.distance(b.look_from) < 1e-9 && a.look_at.distance(b.look_at) < 1e-9 && a.vup == b.vup
    }

    #[test]
    fn without_rays_the_camera_stays() {
        let (primary, secondary) = (PointerButton::Primary, PointerButton::Secondary);
        let by = vec2(40.0, -15.0);
        for (button, modifiers, is_refused) in [
            (primary, Modifiers::NONE, true),
            (secondary, Modifiers::NONE, true),
            (primary, Modifiers::SHIFT, false),
        ] {
            let mut harness = picture();
            harness.state_mut().has_rays = false;
            let before = camera(&harness);
            drag(&mut harness, BALL, by, button, modifiers);
            let Picture { touch, moving, .. } = harness.state();
            assert_eq!((touch.is_refused, touch.is_move), (is_refused, false), "{button:?} {modifiers:?}");
            assert!(touch.pivot.is_none() && moving.pivot.is_none() && camera(&harness) == before);
        }
    }

    #[test]
    fn a_right_drag_turns_the_eye() {
        let mut harness = picture();
        let before = camera(&harness);
        drag(&mut harness, BALL, vec2(40.0, -15.0), PointerButton::Secondary, Modifiers::NONE);
        assert!(same(&camera(&harness), &navigation::look(&before, 0.24, 0.09)), "{:?}", camera(&harness));
        let touch = &harness.state().touch;
        assert_eq!((touch.is_move, touch.is_orbit, touch.pivot), (true, false, None));
    }

    #[test]
    fn the_wheel_moves_towards_what_is_under_the_pointer() {
        let modifiers = Modifiers::NONE;
        for (at, has_rays, down) in
            [(BALL, true, 5.0), (BALL, true, -5.0), (SKY, true, 5.0), (BALL, false, 5.0)]
        {
            let mut harness = picture();
            harness.state_mut().has_rays = has_rays;
            let before = camera(&harness);
            let place = place_at(harness.state().placement.rect(), at);
            let point = match at == BALL {
                true => DVec3::new(0.0, 0.0, -0.7),
                false => navigation::at_depth(&before, place, 16.0 / 9.0),
            };
            harness.event(Event::PointerMoved(at));
            harness.run_steps(1);
            assert!(!harness.state().touch.is_move);
            let (unit, phase, source) = (MouseWheelUnit::Point, TouchPhase::Move, MouseWheelSource::Wheel);
            harness.event(Event::MouseWheel { unit, delta: vec2(0.0, down), phase, source, modifiers });
            harness.run_steps(2);
            let touch = &harness.state().touch;
            assert_eq!(touch.is_refused, !has_rays);
            if !has_rays {
                assert!(camera(&harness) == before && !touch.is_move && touch.pivot.is_none());
                continue;
            }
            let expected = navigation::dolly(&before, point, f64::exp(-0.002 * f64::from(down)));
            assert!(same(&camera(&harness), &expected), "{at} {down}: {:?}", camera(&harness));
            assert!(touch.is_move && !touch.is_orbit && touch.pivot.unwrap().distance(point) < 1e-9);
        }
    }
}
