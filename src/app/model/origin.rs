//! The origin of a picture.

use super::CheckedScene;
use crate::job::recipe::{DEFAULT_SAMPLES_PER_PIXEL, Recipe};
use crate::job::render::RenderSettings;
use crate::measure::stress::{Case, by_the_book};
use crate::progressive::Stop;
use crate::scene::{Camera, Material, Scene};
use crate::stages::{Rules, Shading, Stage, SurfaceRule};
use glam::DVec3;
use std::path::PathBuf;
use std::sync::Arc;

/// Where a picture comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A stage of the book.
    Stage(&'static Stage),
    /// A new scene, which is in no file.
    New,
    /// A built-in scene, or one by the book's own arithmetic. The recipe has its name.
    Builtin,
    /// A scene file.
    File(PathBuf),
    /// An extreme scene.
    Extreme(&'static Case),
    /// A picture that contains its recipe. Its scene is in no other file.
    Embedded,
}

/// A recipe before any edits.
#[derive(Debug)]
pub struct Origin {
    /// The recipe.
    pub recipe: Recipe,
    /// The source of the recipe.
    pub source: Source,
    /// The scene of the recipe.
    pub scene: Arc<CheckedScene>,
}

impl Origin {
    /// An origin from its parts.
    pub fn new(recipe: Recipe, source: Source) -> Self {
        let scene = Arc::new(CheckedScene::new(Arc::clone(&recipe.scene), recipe.rules));
        Origin { recipe, source, scene }
    }

    /// The origin of a stage.
    pub fn of_stage(stage: &'static Stage) -> Self {
        Origin::new(stage.recipe(), Source::Stage(stage))
    }

    /// The origin of the picture that is shown if none is named: the last stage, which is on the book's cover.
    pub fn usual() -> Self {
        Origin::of_stage(Stage::ALL.last().unwrap_or(&Stage::ALL[0]))
    }

    /// A new scene: a ball on the ground, which the camera looks at.
    pub fn new_scene() -> Self {
        let mut scene = Scene::default();
        for (name, albedo, radius, y) in
            [("ground", DVec3::splat(0.5), 1000.0, -1000.0), ("ball", DVec3::new(0.8, 0.3, 0.2), 1.0, 1.0)]
        {
            let material = scene.add_material(name, Material::Lambertian { albedo });
            scene.add_sphere(DVec3::Y * y, radius, material);
        }
        let look_from = DVec3::new(3.0, 2.5, 9.0);
        let recipe = Recipe {
            name: "scene".to_owned(),
            scene: Arc::new(scene),
            camera: Camera { look_from, look_at: DVec3::Y, vfov_degrees: 25.0, ..Camera::BOOK },
            keyframes: Vec::new(),
            settings: RenderSettings::default(),
            rules: Rules::FINISHED,
            samples_per_pixel: DEFAULT_SAMPLES_PER_PIXEL,
        };
        Origin::new(recipe, Source::New)
    }

    /// The origin of a built-in scene. One that is also a stage is opened as that stage.
    pub fn of_builtin(recipe: Recipe) -> Self {
        match Stage::find(&recipe.name) {
            Ok(stage) if stage.recipe().scene == recipe.scene => Origin::of_stage(stage),
            _ => Origin::new(recipe, Source::Builtin),
        }
    }

    /// The origin of an extreme scene.
    pub fn of_case(case: &'static Case) -> Self {
        Origin::new(case.shown(), Source::Extreme(case))
    }

    /// The same picture by the book's own arithmetic, with this scene instead of its own.
    pub fn by_the_book(&self, scene: &CheckedScene) -> Self {
        let recipe = Recipe {
            name: "The book's arithmetic".to_owned(),
            scene: Arc::clone(scene.scene()),
            ..by_the_book(&self.recipe)
        };
        Origin::new(recipe, Source::Builtin)
    }

    /// Whether the book's own arithmetic would give a picture that differs from this one.
    pub fn is_other_by_the_book(&self) -> bool {
        let rules = &self.recipe.rules;
        rules.surface == SurfaceRule::Exact && rules.shading != Shading::ImageGradient
    }

    /// The origin of a recipe that may have been changed elsewhere. If a stage or a built-in scene has the same spheres
    /// and rules, the result is that one.
    pub fn guess(recipe: &Recipe, stage: Option<&'static Stage>) -> Self {
        let is_same = |other: &Recipe| other.scene == recipe.scene && other.rules == recipe.rules;
        if let Some(stage) = stage.filter(|stage| is_same(&stage.recipe())) {
            return Origin::of_stage(stage);
        }
        let new = Origin::new_scene();
        if recipe.name == new.recipe.name && is_same(&new.recipe) {
            return new;
        }
        match Recipe::builtin(&recipe.name) {
            Some(builtin) if is_same(&builtin) => Origin::new(builtin, Source::Builtin),
            _ => Origin::new(recipe.clone(), Source::Embedded),
        }
    }

    /// The default stop condition: deterministic pictures end after their samples, others when their noise is low
    /// enough.
    pub fn usual_stop(&self) -> Stop {
        let Recipe { rules, samples_per_pixel, .. } = &self.recipe;
        let is_noisy = rules.antialiasing && rules.shading == Shading::Path;
        if is_noisy {
            Stop { noise: Some(Stop::NOISE), ..Stop::default() }
        } else {
            Stop::at_samples(*samples_per_pixel)
        }
    }

    /// The stage, if the source is one.
    pub fn stage(&self) -> Option<&'static Stage> {
        match self.source {
            Source::Stage(stage) => Some(stage),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Transfer;

    #[test]
    fn pictures_without_chance_end_with_their_samples() {
        let stop = |id| Origin::of_stage(Stage::find(id).unwrap()).usual_stop();
        assert_eq!(stop("ppm-tiny").samples, Some(1));
        assert_eq!(stop("book"), Stop { noise: Some(Stop::NOISE), ..Stop::default() });
    }

    #[test]
    fn a_recipe_is_known_by_its_spheres_and_its_rules() {
        let (stage, sky) = (Stage::find("metal").unwrap(), Stage::find("sky").unwrap());
        let builtin = Recipe::builtin("metals").unwrap();
        let linear = |recipe: &Recipe| {
            let rules = Rules { transfer: Transfer::Linear, ..recipe.rules };
            Recipe { rules, ..recipe.clone() }
        };
        let named = Recipe { name: "mine".to_owned(), ..builtin.clone() };
        let other = Recipe { scene: Recipe::builtin("two-spheres").unwrap().scene, ..builtin.clone() };
        for (index, (recipe, stage, source)) in [
            (stage.recipe(), Some(stage), Source::Stage(stage)),
            (stage.recipe(), Some(sky), Source::Embedded),
            (stage.recipe(), None, Source::Embedded),
            (linear(&stage.recipe()), Some(stage), Source::Embedded),
            (builtin.clone(), None, Source::Builtin),
            (builtin.clone(), Some(sky), Source::Builtin),
            (linear(&builtin), None, Source::Embedded),
            (named, None, Source::Embedded),
            (other, None, Source::Embedded),
        ]
        .into_iter()
        .enumerate()
        {
            let origin = Origin::guess(&recipe, stage);
            assert_eq!((origin.source, origin.recipe), (source, recipe), "recipe {index}");
        }
        // Its camera is that of the built-in scene, to which a reset leads.
        let mut moved = builtin.clone();
        moved.camera.vfov_degrees = 33.0;
        assert_eq!(Origin::guess(&moved, None).recipe, builtin);
    }

    #[test]
    fn the_books_arithmetic_traces_the_edited_spheres() {
        let origin = Origin::of_stage(Stage::find("metal").unwrap());
        let mut scene = (*origin.recipe.scene).clone();
        scene.spheres[0].radius += 0.25;
        let edited = CheckedScene::new(Arc::new(scene.clone()), origin.recipe.rules);
        let book = origin.by_the_book(&edited);
        assert_eq!((&*book.recipe.scene, &**book.scene.scene()), (&scene, &scene));
        let rules = Rules { surface: SurfaceRule::Book, ..origin.recipe.rules };
        assert_eq!((&book.source, book.recipe.rules), (&Source::Builtin, rules));
        assert!(origin.is_other_by_the_book() && !book.is_other_by_the_book(), "it is that already");
        let is_other = |id| Origin::of_stage(Stage::find(id).unwrap()).is_other_by_the_book();
        // The first one traces no rays, and the last one has another threshold than the book.
        assert_eq!(["ppm-tiny", "normals", "shadow-acne"].map(is_other), [false, true, false]);
    }
}
