//! Carries out the commands that fly the camera, and flies it.

use super::command::Command;
use super::flight::{self, Flight};
use super::window::Window;
use crate::job::recipe::Recipe;
use crate::scene::Camera;
use crate::scene::animation::Keyframe;
use eframe::egui::{self, Event};
use std::path::PathBuf;
use std::sync::Arc;

impl Window {
    /// Carries out a command that moves the camera along a path. Other commands do nothing.
    pub(super) fn perform_flight(&mut self, context: &egui::Context, command: Command) {
        let document = self.document();
        match command {
            Command::ViewFrom(side) => {
                let up = document.origin.recipe.camera.vup;
                self.fly_to(context, side.camera(&document.camera, up));
            }
            Command::Bookmark(place) => {
                if let Some(bookmark) = self.model.remembered.bookmarks.get(place) {
                    self.fly_to(context, bookmark.camera());
                }
            }
            Command::FlyBookmarks => {
                let keyframes = flight::keyframes(&self.model.remembered.bookmarks);
                let now = context.input(|input| input.time);
                self.tell_fault(&keyframes);
                self.flight = Some(Flight::along(&keyframes, &self.document().camera, now));
                context.request_repaint();
            }
            _ => {}
        }
    }

    /// Flies to a camera, or jumps there if the user prefers that or holds Shift.
    fn fly_to(&mut self, context: &egui::Context, camera: Camera) {
        let (now, is_jump) = context.input(|input| (input.time, input.modifiers.shift));
        let before = self.document().camera;
        if is_jump || !self.model.remembered.has_flights {
            self.model.document.camera = camera;
        } else if before != camera {
            self.flight = Some(Flight::between(&before, &camera, now));
            context.request_repaint();
        }
    }

    /// Goes on with the flight. It ends early if the user presses a button or a key, scrolls, or moves the camera.
    pub(super) fn go_on_flying(&mut self, context: &egui::Context) {
        let Some(mut flight) = self.flight.take() else { return };
        let is_interrupted = context.input(|input| input.raw.events.iter().any(is_input));
        if is_interrupted || self.document().camera != *flight.camera() {
            return;
        }
        let is_over = flight.go_on(context.input(|input| input.time));
        self.model.document.camera = *flight.camera();
        self.changes.note_move();
        context.request_repaint();
        if !is_over {
            self.flight = Some(flight);
        }
    }

    /// Writes the scene with the bookmarks as keyframes.
    pub(super) fn save_flight(&mut self, context: &egui::Context, path: PathBuf) {
        let keyframes = flight::keyframes(&self.model.remembered.bookmarks);
        let Some(last) = keyframes.last().map(|keyframe| keyframe.frame) else { return };
        if !self.tell_fault(&keyframes) {
            let frames = last + 1;
            self.toasts.good(format!("The path has {frames} frames; render them with --frames 0..{frames}"));
        }
        let mut document = self.document().clone();
        let recipe = Recipe { keyframes, ..document.origin.recipe.clone() };
        document.origin = Arc::new(document.origin.with_recipe(recipe));
        self.files.save_scene(context, path, &document);
    }

    /// Says which frame of a path has a camera that is not valid. Returns whether there is one.
    fn tell_fault(&mut self, keyframes: &[Keyframe]) -> bool {
        let Some((frame, reason)) = flight::first_fault(keyframes) else { return false };
        self.toasts
            .bad(format!("Frame {frame} of the path cannot be rendered: {reason}; add a bookmark before it"));
        true
    }
}

/// Whether an event is something that the user did on purpose. The pointer may move.
fn is_input(event: &Event) -> bool {
    matches!(
        event,
        Event::PointerButton { pressed: true, .. }
            | Event::Key { pressed: true, repeat: false, .. }
            | Event::MouseWheel { .. }
            | Event::Zoom(_)
            | Event::Touch { phase: egui::TouchPhase::Start, .. }
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::model::viewpoint::Viewpoint;
    use crate::app::tests::window;
    use eframe::egui::Context;
    use glam::DVec3;

    /// A window with a camera that can look elsewhere.
    fn distant() -> Window {
        window("weekender --stage view-distant --size 16x9 --device cpu")
    }

    #[test]
    fn a_view_from_a_side_has_the_up_of_the_scene_not_that_of_a_turned_camera() {
        let (mut window, context) = (distant(), Context::default());
        window.model.remembered.has_flights = false;
        let up = window.document().camera.vup;
        window.model.document.camera.vup = DVec3::new(1.0, 0.25, 0.0);
        let before = window.document().camera;
        let expected = Viewpoint::Left.camera(&before, up);
        assert_ne!(expected, Viewpoint::Left.camera(&before, before.vup));
        window.perform_flight(&context, Command::ViewFrom(Viewpoint::Left));
        assert_eq!(window.document().camera, expected);
    }
}
