//! Carries out the commands about spheres.

use super::command::Command;
use super::model::edit::{Edit, first_difference};
use super::model::first_steps::Step;
use super::navigation;
use super::spheres::grip::{new_body, to_copy};
use super::spheres::neighbour;
use super::window::Window;
use std::sync::Arc;

impl Window {
    /// Carries out a command about spheres. Other commands do nothing.
    pub(super) fn perform_on_spheres(&mut self, command: Command) {
        let document = self.document();
        let (scene, camera) = (document.scene(), document.camera);
        let selected = self.spheres.selected(&self.model);
        match (command, selected) {
            (Command::AddSphere, _) => {
                let place = self.viewport.aim();
                let hit = self.surfaces.pick(document, &camera, place);
                let body = new_body(hit, &camera, document.aspect(), place);
                self.edit(Edit::Add(body));
            }
            (Command::NextSphere | Command::PreviousSphere, _) => {
                let is_next = command == Command::NextSphere;
                self.model.selected = neighbour(scene, self.model.selected, is_next);
            }
            (Command::Deselect, _) => self.model.selected = None,
            (Command::ResetSpheres, _) => {
                self.keep_selection_after(|window| {
                    window.model.document.checked = Arc::clone(&window.document().origin.scene);
                });
            }
            (Command::DuplicateSphere, Some(selected)) => {
                let by = to_copy(scene, &camera, document.aspect(), selected.sphere);
                self.edit(Edit::Duplicate(selected.sphere, by));
            }
            (Command::DeleteSphere, Some(selected)) => self.edit(Edit::Delete(selected.sphere)),
            (Command::FocusSphere, Some(selected)) => {
                // The nearest point is what is to be sharp, unless the camera is in the sphere.
                let towards = (camera.look_from - selected.body.center).normalize_or_zero();
                let nearest = selected.body.center + selected.body.radius * towards;
                let is_ahead = camera.depth_of(nearest) > 0.0;
                let point = if is_ahead { nearest } else { selected.body.center };
                self.model.document.camera = navigation::focus(&camera, point);
                if camera.defocus_angle_degrees == 0.0 {
                    self.toasts.good("A pinhole is sharp everywhere: set a defocus angle in the Lens panel");
                }
            }
            (Command::LookAtSphere, Some(selected)) => {
                self.model.document.camera = navigation::recentre(&camera, selected.body.center);
            }
            _ => {}
        }
    }

    /// Edits the scene, or says why not.
    pub(super) fn edit(&mut self, edit: Edit) {
        match self.spheres.edit(&mut self.model, edit) {
            Ok(()) => self.note_step(Step::Change),
            Err(reason) => self.toasts.bad(reason),
        }
    }

    /// Changes the document as a whole, as undo does, and then selects the sphere that this changed or brought back.
    pub(super) fn keep_selection_after(&mut self, change: impl FnOnce(&mut Self)) {
        let (checked, origin) = (Arc::clone(&self.document().checked), Arc::clone(&self.document().origin));
        change(self);
        let after = self.document();
        if Arc::ptr_eq(&checked, &after.checked) {
            return;
        }
        let is_same_origin = Arc::ptr_eq(&origin, &after.origin);
        let [old, new] = [&checked, &after.checked].map(|checked| checked.scene().spheres.len());
        self.model.selected = (is_same_origin && new >= old)
            .then(|| first_difference(checked.scene(), after.scene()))
            .flatten();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::checked::CheckedScene;
    use crate::app::model::document::Document;

    use crate::app::model::origin::Origin;
    use crate::app::tests::window;
    use crate::scene::Scene;
    use crate::stages::Stage;

    fn glass() -> Window {
        window("weekender --stage glass-schlick --size 16x9 --device cpu")
    }

    /// The document with another scene.
    fn with_scene(document: &Document, change: impl FnOnce(&mut Scene)) -> Document {
        let mut scene = document.scene().clone();
        change(&mut scene);
        let checked = CheckedScene::new(Arc::new(scene), *document.rules());
        Document { checked: Arc::new(checked), ..document.clone() }
    }

    #[test]
    fn what_was_changed_or_came_back_is_selected() {
        let mut window = glass();
        let usual = window.document().clone();
        let count = usual.scene().spheres.len();
        let moved = with_scene(&usual, |scene| scene.spheres[2].center.x += 1.0);
        let more = with_scene(&usual, |scene| scene.spheres.push(scene.spheres[0]));
        let fewer = with_scene(&usual, |scene| _ = scene.spheres.remove(1));
        // It has more spheres, but they are others.
        let other = Document::new(Origin::of_stage(Stage::find("book").unwrap()));
        assert!(other.scene().spheres.len() > count);
        for (name, from, to, selected) in [
            ("a sphere is moved", &usual, &moved, Some(2)),
            ("and moved back", &moved, &usual, Some(2)),
            ("one is added", &usual, &more, Some(count)),
            ("and deleted", &more, &usual, None),
            ("one comes back", &fewer, &usual, Some(1)),
            ("and goes", &usual, &fewer, None),
            ("another picture", &usual, &other, None),
            ("the same scene", &usual, &usual, Some(3)),
        ] {
            (window.model.document, window.model.selected) = (from.clone(), Some(3));
            window.keep_selection_after(|window| window.model.document = to.clone());
            assert_eq!(window.selected(), selected, "{name}");
        }
    }
}
