//! The picture and the last steps of its history as text: a few kB, which the window saves after each edit.

use crate::app::model::{CheckedScene, Document, Origin, Source};
use crate::job::recipe::{Recipe, file};
use crate::job::render::RenderSettings;
use crate::progressive::Stop;
use crate::scene::Camera;
use crate::scene::animation::Keyframe;
use crate::stages::Stage;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Undo steps that the next window restores.
pub const STEPS: usize = 10;

#[derive(Default, Serialize, Deserialize)]
struct Edits {
    /// Recipes that are nowhere else: by name, as TOML.
    recipes: Vec<(String, String)>,
    /// Oldest first.
    steps: Vec<Step>,
}

#[derive(Clone, PartialEq, Serialize, Deserialize)]
enum From {
    Stage(String),
    File(PathBuf),
    /// The place of the recipe.
    Recipe(usize),
}

#[derive(Serialize, Deserialize)]
struct Step {
    origin: From,
    /// The place of a recipe with the scene, if the origin has another.
    scene: Option<usize>,
    camera: Camera,
    settings: RenderSettings,
    has_own_size: bool,
    keyframes: Vec<Keyframe>,
    stop: Stop,
}

/// Documents that follow each other, oldest first. Scenes that they share are written once.
pub fn to_text(documents: &[Document]) -> String {
    let (mut edits, mut known) = (Edits::default(), Vec::new());
    let mut place = |address: usize, recipe: &dyn Fn() -> Recipe| {
        known.iter().position(|other| *other == address).unwrap_or_else(|| {
            let recipe = recipe();
            edits.recipes.push((recipe.name.clone(), file::to_picture_toml(&recipe)));
            known.push(address);
            known.len() - 1
        })
    };
    for document in documents {
        let Document { origin, checked, camera, keyframes, settings, has_own_size, stop } = document.clone();
        let from = match &origin.source {
            Source::Stage(stage) => From::Stage(stage.id.to_owned()),
            Source::File(path) => From::File(path.clone()),
            _ => From::Recipe(place(Arc::as_ptr(&origin).addr(), &|| origin.recipe.clone())),
        };
        let scene = document.has_changed_scene();
        let scene = scene.then(|| place(Arc::as_ptr(&checked).addr(), &|| document.recipe()));
        edits.steps.push(Step { origin: from, scene, camera, settings, has_own_size, keyframes, stop });
    }
    serde_json::to_string(&edits).unwrap_or_default()
}

/// The documents of a text, as far as their stages and files are still there.
pub fn read(path: &Path) -> Vec<Document> {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let Ok(Edits { recipes, steps }) = serde_json::from_str(&text) else { return Vec::new() };
    let recipe = |place: usize| {
        let (name, text) = recipes.get(place)?;
        Some(Recipe { name: name.clone(), ..file::parse(text, name).ok()? })
    };
    // Steps with the same origin and scene share them, as undo expects.
    let mut documents: Vec<(&Step, Document)> = Vec::new();
    for step in &steps {
        let like = documents.iter().rev().find(|(other, _)| other.origin == step.origin);
        let fresh = || match &step.origin {
            From::Stage(id) => Stage::find(id).ok().map(Origin::of_stage),
            From::File(path) => Some(Origin::new(file::load(path).ok()?, Source::File(path.clone()))),
            From::Recipe(place) => Some(Origin::guess(&recipe(*place)?, None)),
        };
        let origin = like.map(|(_, like)| Arc::clone(&like.origin));
        let Some(origin) = origin.or_else(|| fresh().map(Arc::new)) else { continue };
        let like = like.filter(|(other, _)| other.scene == step.scene);
        let own = || Some(CheckedScene::new(recipe(step.scene?)?.scene, origin.recipe.rules));
        let checked = like.map(|(_, like)| Arc::clone(&like.checked)).or_else(|| own().map(Arc::new));
        let document = Document {
            checked: checked.unwrap_or_else(|| Arc::clone(&origin.scene)),
            origin,
            camera: step.camera,
            keyframes: step.keyframes.clone(),
            settings: step.settings,
            has_own_size: step.has_own_size,
            stop: step.stop,
        };
        documents.push((step, document));
    }
    documents.into_iter().map(|(_, document)| document).filter(|document| document.job(1).is_ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_radius(document: &Document, radius: f64) -> Document {
        let mut scene = document.scene().clone();
        scene.spheres[0].radius = radius;
        let checked = CheckedScene::new(Arc::new(scene), *document.rules());
        Document { checked: Arc::new(checked), ..document.clone() }
    }

    #[test]
    fn documents_come_back_as_they_were_and_share_what_they_shared() {
        let directory = tempfile::tempdir().unwrap();
        let (scene, path) = (directory.path().join("own.toml"), directory.path().join("edits.json"));
        let cover = Recipe::builtin("book").unwrap();
        std::fs::write(&scene, file::to_toml(&cover)).unwrap();
        let origins = [
            Origin::of_stage(Stage::find("metal").unwrap()),
            Origin::new(file::load(&scene).unwrap(), Source::File(scene.clone())),
            Origin::of_builtin(Recipe::builtin("metals").unwrap()),
            Origin::new_scene(),
            Origin::new(Recipe { name: "mine".to_owned(), ..cover }, Source::Embedded),
        ];
        for origin in origins {
            let first = Document::new(origin);
            let edited = with_radius(&first, 0.1 + 0.2);
            let mut moved = edited.clone();
            moved.camera.look_from.x += 1.0 / 3.0;
            (moved.camera.focus_distance, moved.stop) = (Some(0.7), Stop::at_samples(77));
            moved.give_size([160, 90]);
            moved.add_bookmark();
            let before = [first, edited, moved];
            let text = to_text(&before);
            std::fs::write(&path, &text).unwrap();
            let after = read(&path);
            let name = &before[0].origin.recipe.name;
            assert_eq!(after.len(), 3, "{name}");
            for (before, after) in before.iter().zip(&after) {
                assert_eq!(after.origin.source, before.origin.source, "{name}");
                assert_eq!(after.origin.recipe, before.origin.recipe, "{name}");
                assert_eq!(after.scene(), before.scene());
                assert_eq!((after.camera, after.settings), (before.camera, before.settings));
                assert_eq!((after.stop, after.has_own_size), (before.stop, before.has_own_size));
                assert_eq!(after.keyframes, before.keyframes);
            }
            assert!(Arc::ptr_eq(&after[0].origin, &after[2].origin), "{name}");
            assert!(Arc::ptr_eq(&after[1].checked, &after[2].checked) && !after[0].has_changed_scene());
        }
        std::fs::write(&path, "damaged").unwrap();
        assert!(read(&path).is_empty());
    }

    #[test]
    fn the_text_of_an_edited_stage_has_a_few_kilobytes() {
        let first = Document::new(Origin::of_stage(Stage::find("glass-schlick").unwrap()));
        let edits: Vec<Document> = (0..STEPS).map(|step| with_radius(&first, 1.0 + step as f64)).collect();
        let length = to_text(&edits).len();
        assert!(length < 20_000, "{length}");
    }
}
