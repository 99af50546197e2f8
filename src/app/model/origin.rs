//! Where a picture comes from.

use crate::progressive::Stop;
use crate::recipe::Recipe;
use crate::render::{JobError, RenderJob, RenderSettings};
use crate::scene::Camera;
use crate::stages::{Shading, Stage, Surface};
use crate::stress::{Case, by_the_book};
use std::path::PathBuf;
use std::sync::OnceLock;

/// Where a picture comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A stage of the book.
    Stage(&'static Stage),
    /// A built-in scene, which has the recipe's name.
    Builtin,
    /// A scene file.
    File(PathBuf),
    /// An extreme scene.
    Extreme(&'static Case),
    /// Another picture by the book's own arithmetic.
    ByTheBook,
    /// A picture that said how it was made, of a scene that is in no file.
    Embedded,
}

/// A recipe as it was before anyone changed it.
#[derive(Debug)]
pub struct Origin {
    /// The recipe.
    pub recipe: Recipe,
    /// Where it is from.
    pub source: Source,
    /// Its scene under its rules, checked, for any camera and size.
    base: OnceLock<Result<RenderJob, JobError>>,
}

impl Origin {
    /// A recipe from somewhere.
    pub fn new(recipe: Recipe, source: Source) -> Self {
        Origin { recipe, source, base: OnceLock::new() }
    }

    /// A stage's picture.
    pub fn of_stage(stage: &'static Stage) -> Self {
        Origin::new(stage.recipe(), Source::Stage(stage))
    }

    /// An extreme scene's picture.
    pub fn of_case(case: &'static Case) -> Self {
        Origin::new(case.shown(), Source::Extreme(case))
    }

    /// The same picture by the book's own arithmetic.
    pub fn by_the_book(&self) -> Self {
        let recipe = Recipe { name: "The book's arithmetic".to_owned(), ..by_the_book(&self.recipe) };
        Origin::new(recipe, Source::ByTheBook)
    }

    /// Whether the book's own arithmetic would give a picture to hold against this one.
    pub fn is_other_by_the_book(&self) -> bool {
        let rules = &self.recipe.rules;
        rules.surface == Surface::Exact && rules.shading != Shading::ImageGradient
    }

    /// The origin of a recipe from elsewhere, which may have been changed. If a stage or a built-in scene has
    /// the same spheres and rules, it is that one.
    pub fn guess(recipe: &Recipe, stage: Option<&'static Stage>) -> Self {
        let is_same = |other: &Recipe| other.scene == recipe.scene && other.rules == recipe.rules;
        if let Some(stage) = stage.filter(|stage| is_same(&stage.recipe())) {
            return Origin::of_stage(stage);
        }
        match Recipe::builtin(&recipe.name) {
            Some(builtin) if is_same(&builtin) => Origin::new(builtin, Source::Builtin),
            _ => Origin::new(recipe.clone(), Source::Embedded),
        }
    }

    /// When its render ends, unless someone says otherwise: pictures without chance are done with their samples,
    /// others when they are clean.
    pub fn usual_stop(&self) -> Stop {
        let Recipe { rules, settings, samples_per_pixel, .. } = &self.recipe;
        let is_noisy = rules.antialiasing && rules.shading == Shading::Path;
        if is_noisy && settings.estimate_error {
            Stop { noise: Some(Stop::NOISE), ..Stop::default() }
        } else {
            Stop::at_samples(*samples_per_pixel)
        }
    }

    /// The stage.
    pub fn stage(&self) -> Option<&'static Stage> {
        match self.source {
            Source::Stage(stage) => Some(stage),
            _ => None,
        }
    }

    /// The picture that `camera` and `settings` give of it. All that are asked for share one scene.
    pub(super) fn job(&self, camera: Camera, settings: RenderSettings) -> Result<RenderJob, JobError> {
        let checked = || {
            let (scene, rules) = (self.recipe.scene.clone(), self.recipe.rules);
            RenderJob::new(scene, Camera::BOOK, RenderSettings::default(), rules)
        };
        self.base.get_or_init(checked).clone()?.seen_by(camera, settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_recipe_of_a_stage_is_known_again() {
        let stage = Stage::find("defocus").unwrap();
        let mut recipe = stage.recipe();
        recipe.camera.vfov_degrees = 50.0;
        assert_eq!(Origin::guess(&recipe, Some(stage)).source, Source::Stage(stage));
        std::sync::Arc::make_mut(&mut recipe.scene).sky.top = DVec3::ZERO;
        assert_eq!(Origin::guess(&recipe, Some(stage)).source, Source::Embedded);
        let builtin = Recipe::builtin("book").unwrap();
        assert_eq!(Origin::guess(&builtin, None).source, Source::Builtin);
    }

    #[test]
    fn pictures_without_chance_end_with_their_samples() {
        let stop = |id| Origin::of_stage(Stage::find(id).unwrap()).usual_stop();
        assert_eq!(stop("ppm-tiny").samples, Some(1));
        assert_eq!(stop("book"), Stop { samples: None, seconds: None, noise: Some(Stop::NOISE) });
    }
}
