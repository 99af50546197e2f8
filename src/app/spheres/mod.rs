//! Editing of the scene's spheres. A small scene changes at once. A large one is copied and checked on a thread, so that
//! the window never waits for it.

pub mod grip;
pub mod silhouette;

use super::answers::Answers;
use super::model::Model;
use super::model::checked::CheckedScene;
use super::model::document::Document;
use super::model::edit::{Body, Edit};
use super::tracer::Tracer;
use crate::job::recipe::Recipe;
use crate::job::render::TRACING_BYTES_PER_SPHERE;
use crate::scene::{Scene, Sphere};
use crate::system::memory;
use eframe::egui::Context;
use std::collections::VecDeque;
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// Scenes with more spheres than this take longer to copy, search and prepare than a frame lasts.
pub const LARGE: usize = 50_000;

/// An edited scene and the sphere that is selected then, or why there is none.
type Outcome = Result<(Arc<CheckedScene>, Option<usize>), String>;

/// The outcome of an edit on a thread.
struct Made {
    /// The scene that was edited.
    from: Arc<CheckedScene>,
    outcome: Outcome,
    took: Duration,
}

/// The selected sphere as the panel and the picture show it.
#[derive(Clone, Debug)]
pub struct Selected {
    /// Its index.
    pub sphere: usize,
    /// Its values, those of waiting edits included.
    pub body: Body,
    /// The name of its material.
    pub material: String,
    /// The number of spheres of the scene.
    pub count: usize,
}

impl Selected {
    /// Its name in the picture, with the words that the inspector uses.
    pub fn name(&self) -> String {
        format!("sphere {}, {} ({})", self.sphere, self.material, self.body.material.kind())
    }
}

/// Edits of large scenes that wait, and what is told about them.
#[derive(Default)]
pub struct Spheres {
    /// The edits that are to be made, oldest first. While a thread works, it makes the first of them.
    queue: VecDeque<Edit>,
    /// The scene that they edit.
    from: Weak<CheckedScene>,
    made: Answers<Made>,
    is_working: bool,
    /// A large scene that was edited: how long the copy took, and the longest time of building its hierarchy.
    untold: Option<(Duration, Duration)>,
}

impl Spheres {
    /// The selected sphere, with the edits that wait.
    pub fn selected(&self, model: &Model) -> Option<Selected> {
        let sphere = model.selected?;
        let scene = model.document.scene();
        let last = self.queue.iter().rev().find_map(|edit| match edit {
            Edit::Change(index, body) if *index == sphere => Some(*body),
            _ => None,
        });
        let body = last.or_else(|| Body::of(scene, sphere))?;
        let material = scene.materials[scene.spheres.get(sphere)?.material].name.clone();
        Some(Selected { sphere, body, material, count: scene.spheres.len() })
    }

    /// Edits the scene, or puts the edit in the queue if the scene is large.
    ///
    /// # Errors
    /// Why the scene would be invalid; it is then as before.
    pub fn edit(&mut self, model: &mut Model, edit: Edit) -> Result<(), String> {
        let document = &model.document;
        if document.scene().spheres.len() <= LARGE {
            let (scene, selected) = edited(&document.checked, &document.origin.recipe, edit)?;
            // A value that was typed or dragged back is no change.
            let is_back = *scene.scene() == document.origin.recipe.scene;
            model.document.checked = if is_back { Arc::clone(&document.origin.scene) } else { scene };
            model.selected = selected;
            return Ok(());
        }
        self.keep_to(document);
        // Of several changes to one sphere, only the last one matters.
        let is_older =
            |earlier: &Edit| matches!((earlier, &edit), (Edit::Change(a, _), Edit::Change(b, _)) if a == b);
        let is_begun = self.is_working && self.queue.len() == 1;
        if !is_begun && self.queue.back().is_some_and(is_older) {
            self.queue.pop_back();
        }
        self.queue.push_back(edit);
        Ok(())
    }

    /// Drops the queue if the document's scene has become another one.
    fn keep_to(&mut self, document: &Document) {
        if !std::ptr::eq(self.from.as_ptr(), Arc::as_ptr(&document.checked)) {
            self.queue.clear();
            self.from = Arc::downgrade(&document.checked);
        }
    }

    /// Takes the outcome of a thread, and starts the next one unless the user still holds something.
    ///
    /// # Errors
    /// Why an edit was not made.
    pub fn follow(&mut self, context: &Context, model: &mut Model) -> Result<(), String> {
        self.keep_to(&model.document);
        while let Some(Made { from, outcome, took }) = self.made.take() {
            self.is_working = false;
            if !Arc::ptr_eq(&from, &model.document.checked) {
                continue;
            }
            self.queue.pop_front();
            let (scene, selected) = outcome.inspect_err(|_| self.queue.clear())?;
            self.from = Arc::downgrade(&scene);
            model.document.checked = scene;
            model.selected = selected;
            self.untold = Some((took, Duration::ZERO));
        }
        let is_held = context.input(|input| input.pointer.any_down());
        if let Some(edit) = self.queue.front().copied().filter(|_| !self.is_working && !is_held) {
            let (from, origin) = (Arc::clone(&model.document.checked), Arc::clone(&model.document.origin));
            let work = move || {
                let begin = Instant::now();
                let outcome = edited(&from, &origin.recipe, edit);
                Made { from, outcome, took: begin.elapsed() }
            };
            let of = Arc::clone(&model.document.checked);
            let substitute = |reason: String| {
                let outcome = Err(format!("the scene was not changed: {reason}"));
                Made { from: of, outcome, took: Duration::ZERO }
            };
            self.made.ask("edit", context, work, substitute);
            self.is_working = true;
        }
        // The selection may be of another scene.
        model.selected = model.selected.filter(|sphere| *sphere < model.document.scene().spheres.len());
        Ok(())
    }

    /// What an edit of a large scene took, once its picture has samples.
    pub fn told(&mut self, document: &Document, main: &Tracer) -> Option<String> {
        let (_, hierarchy) = self.untold.as_mut().filter(|_| main.is_of(document))?;
        // The full-size render that follows a preview takes over the hierarchy.
        *hierarchy = main.status().hierarchy.max(*hierarchy);
        let (copy, hierarchy) = self.untold.take_if(|_| main.has_samples(document))?;
        let count = document.scene().spheres.len();
        let [copy, hierarchy] = [copy, hierarchy].map(|time| time.as_secs_f64());
        Some(format!(
            "Changed 1 of {count} spheres: {copy:.2} s for the copy, {hierarchy:.2} s for its hierarchy"
        ))
    }
}

/// The scene after an edit, checked.
fn edited(from: &CheckedScene, recipe: &Recipe, edit: Edit) -> Outcome {
    let count = from.scene().spheres.len() as u64;
    memory::check(
        || format!("a changed copy of {count} spheres"),
        (count + 1) * (size_of::<Sphere>() as u64 + TRACING_BYTES_PER_SPHERE),
        "save the scene and open it again, which frees the copies that undo keeps",
    )
    .map_err(|error| error.to_string())?;
    let (scene, selected) = edit.apply(from.scene());
    let checked = CheckedScene::new(Arc::new(scene), recipe.rules);
    checked.check().map_err(|error| error.to_string())?;
    Ok((Arc::new(checked), selected))
}

/// The sphere after or before the selected one, in the order of the scene; the first or last if none is selected.
pub fn neighbour(scene: &Scene, selected: Option<usize>, is_next: bool) -> Option<usize> {
    let last = scene.spheres.len().checked_sub(1)?;
    Some(match (selected, is_next) {
        (None, true) => 0,
        (None, false) => last,
        (Some(sphere), true) => {
            if sphere >= last {
                0
            } else {
                sphere + 1
            }
        }
        (Some(sphere), false) => sphere.checked_sub(1).unwrap_or(last),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::app::tests::{until, window};
    use crate::app::window::Window;
    use eframe::egui::{Event, Modifiers, PointerButton, Pos2, RawInput};

    const FIELD: &str = "weekender --scene field:60000 --size 16x9 --samples 1 --device cpu";

    /// An edit that gives a sphere this radius.
    fn with_radius(document: &Document, sphere: usize, radius: f64) -> Edit {
        Edit::Change(sphere, Body { radius, ..Body::of(document.scene(), sphere).unwrap() })
    }

    #[test]
    fn of_the_edits_that_wait_the_last_one_of_each_sphere_is_made() {
        let mut window = window(FIELD);
        let model = &mut window.model;
        let edit = |sphere, radius| with_radius(&model.document, sphere, radius);
        let edits = [edit(1, 0.125), edit(1, 0.25), edit(2, 0.5), edit(1, 0.0625)];
        let mut spheres = Spheres::default();
        for edit in edits {
            spheres.edit(model, edit).unwrap();
        }
        assert_eq!(spheres.queue, &edits[1..]);
        // Another picture has spheres of its own.
        model.document = Document::new(Origin::usual());
        spheres.follow(&Context::default(), model).unwrap();
        assert!(spheres.queue.is_empty() && !spheres.is_working);
    }

    #[test]
    fn a_thread_makes_one_edit_at_a_time_and_none_while_a_button_is_held() {
        let mut window = window(FIELD);
        let model = &mut window.model;
        let (mut spheres, context) = (Spheres::default(), Context::default());
        let [first, second, third] = [0.125, 0.25, 0.5].map(|radius| with_radius(&model.document, 1, radius));
        let follow = |spheres: &mut Spheres, model: &mut Model, pressed: bool| {
            let (pos, button, modifiers) = (Pos2::ZERO, PointerButton::Primary, Modifiers::NONE);
            let events = vec![Event::PointerButton { pos, button, pressed, modifiers }];
            let input = RawInput { events, ..RawInput::default() };
            let _ = context.run_ui(input, |ui| spheres.follow(ui.ctx(), model).unwrap());
        };
        let make = |spheres: &mut Spheres| {
            let made = spheres.made.wait().unwrap();
            spheres.made.answer(&context).give(made);
        };
        spheres.edit(model, first).unwrap();
        follow(&mut spheres, model, true);
        assert!(!spheres.is_working, "the sphere is still dragged");
        follow(&mut spheres, model, false);
        assert!(spheres.is_working);
        // The thread works on the first one, so it stays.
        spheres.edit(model, second).unwrap();
        spheres.edit(model, third).unwrap();
        assert_eq!(spheres.queue, [first, third]);
        make(&mut spheres);
        follow(&mut spheres, model, false);
        assert_eq!((model.document.scene().spheres[1].radius, model.selected), (0.125, Some(1)));
        assert!(spheres.is_working && spheres.queue == [third]);
        // Another picture is opened meanwhile.
        make(&mut spheres);
        model.document = Document::new(Origin::usual());
        follow(&mut spheres, model, false);
        assert!(!spheres.is_working && spheres.queue.is_empty() && !model.document.has_changed_scene());
    }

    #[test]
    fn an_edit_of_a_large_scene_that_cannot_be_made_is_told_and_changes_nothing() {
        let mut window = window(FIELD);
        let edit = with_radius(window.document(), 1, 0.0);
        window.spheres.edit(&mut window.model, edit).unwrap();
        let is_told = |window: &Window| window.messages().iter().any(|text| text.contains("radius is 0"));
        until(&mut window, &Context::default(), "why not", is_told);
        assert!(!window.document().has_changed_scene() && window.spheres.queue.is_empty());
    }

    #[test]
    fn an_edit_that_panics_is_told_and_not_waited_for() {
        let mut window = window(FIELD);
        let model = &mut window.model;
        let (mut spheres, context) = (Spheres::default(), Context::default());
        let edit = with_radius(&model.document, 1, 0.25);
        spheres.edit(model, edit).unwrap();
        let of = Arc::clone(&model.document.checked);
        let substitute = |reason| Made { from: of, outcome: Err(reason), took: Duration::ZERO };
        spheres.made.answer_or(&context, substitute).give_from("edit", || panic!("on purpose"));
        spheres.is_working = true;
        let made = spheres.made.wait().unwrap();
        spheres.made.answer(&context).give(made);
        let told = spheres.follow(&context, model).unwrap_err();
        assert_eq!(told, "the program failed (on purpose)");
        assert!(!spheres.is_working && spheres.queue.is_empty());
    }
}
