//! A recipe: everything that defines a picture. A scene file contains one, a stage is one, and the window edits one.
//! Validation turns it into a [`RenderJob`].

pub mod file;

use crate::job::render::{JobError, RenderJob, RenderSettings, TRACING_BYTES_PER_SPHERE};
use crate::scene::animation::{CameraPath, Keyframe};
use crate::scene::builtin::{BuiltinScene, FIELD_COUNT_LIMITS, field};
use crate::scene::{Camera, Scene, Sphere};
use crate::stages::{Rules, Setup, Stage};
use crate::system::memory;
use anyhow::{Context, Result, bail};
use std::sync::Arc;

/// Samples per pixel of a scene file that does not set them.
pub const DEFAULT_SAMPLES_PER_PIXEL: u64 = 200;

/// Scene, camera, settings, rules and the wanted number of samples, not validated yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    /// The name of a built-in scene, the id of a stage, or the stem of a file name.
    pub name: String,
    /// Spheres, materials and sky. All jobs of the recipe share it.
    pub scene: Arc<Scene>,
    pub camera: Camera,
    /// The keyframes of an animation in ascending order of frames. Not part of the job, which is one picture.
    pub keyframes: Vec<Keyframe>,
    /// Size, depth, sampler, seed.
    pub settings: RenderSettings,
    pub rules: Rules,
    /// Samples per pixel that the picture should have, `1..=2^32`. Not part of the job: a film can have any number.
    pub samples_per_pixel: u64,
}

impl Recipe {
    /// The picture of a frame.
    pub fn at_frame(&self, path: &CameraPath, frame: u32) -> Recipe {
        Recipe { camera: path.camera(frame), keyframes: Vec::new(), ..self.clone() }
    }

    /// The built-in scene of this name; `field:N` is a field of `N` spheres.
    pub fn builtin(name: &str) -> Option<Recipe> {
        Self::find(name).ok()
    }

    /// The built-in scene of this name; `field:N` is a field of `N` spheres.
    ///
    /// # Errors
    /// If there is none.
    pub fn find(name: &str) -> Result<Recipe> {
        if let Some(builtin) = BuiltinScene::find(name) {
            let (scene, camera) = (builtin.build)();
            return Ok(Self::of_builtin(builtin, name, scene, camera));
        }
        let Some(count) = name.strip_prefix("field:") else {
            bail!("there is no scene {name:?}; --list shows all");
        };
        let number = count.parse().ok().filter(|number| FIELD_COUNT_LIMITS.contains(number));
        let number = number.with_context(|| {
            let (lowest, highest) = (FIELD_COUNT_LIMITS.start(), FIELD_COUNT_LIMITS.end());
            format!(
                "field:{count} has {count:?} for its number of spheres, which must be between {lowest} and {highest}; \
                 try field:10000"
            )
        })?;
        let bytes = number * (size_of::<Sphere>() as u64 + TRACING_BYTES_PER_SPHERE);
        memory::check(|| format!("field:{number}"), bytes, "choose a field of fewer spheres")?;
        let (scene, camera) = field(number);
        Ok(Self::of_builtin(&BuiltinScene::FIELD, name, scene, camera))
    }

    fn of_builtin(builtin: &BuiltinScene, name: &str, scene: Scene, camera: Camera) -> Recipe {
        let BuiltinScene { width, height, samples_per_pixel, max_depth, .. } = *builtin;
        Recipe {
            name: name.to_owned(),
            scene: Arc::new(scene),
            camera,
            keyframes: Vec::new(),
            settings: RenderSettings { width, height, max_depth, ..RenderSettings::default() },
            rules: Rules::FINISHED,
            samples_per_pixel,
        }
    }

    /// Checks scene, camera, settings and rules.
    ///
    /// # Errors
    /// See [`RenderJob::new`].
    pub fn job(&self) -> Result<RenderJob, JobError> {
        RenderJob::new(Arc::clone(&self.scene), self.camera, self.settings, self.rules)
    }
}

/// A name that every file system accepts, with other characters replaced by dashes.
pub fn plain_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_. ".contains(c) { c } else { '-' }).collect()
}

impl Stage {
    /// The picture that shows this stage.
    pub fn recipe(&self) -> Recipe {
        let Setup { scene, camera, rules, width, height, samples_per_pixel, max_depth, .. } = self.setup;
        Recipe {
            name: self.id.to_owned(),
            scene: Arc::new(scene()),
            camera,
            keyframes: Vec::new(),
            settings: RenderSettings { width, height, max_depth, ..RenderSettings::default() },
            rules,
            samples_per_pixel,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_found_by_name() {
        let field = Recipe::builtin("field:123").expect("a field");
        assert_eq!((field.name.as_str(), field.scene.spheres.len()), ("field:123", 124));
        assert_eq!(field.settings, Recipe::builtin("field").expect("a field").settings);
    }

    #[test]
    fn unknown_scenes_are_refused() {
        let message = |name: &str| Recipe::find(name).expect_err("unknown").to_string();
        assert_eq!(message("xylophone"), "there is no scene \"xylophone\"; --list shows all");
        for count in ["0", "10000001", "-1", "many", ""] {
            let refused = message(&format!("field:{count}"));
            assert!(refused.contains("must be between 1 and 10000000"), "{refused}");
        }
        assert_eq!(Recipe::builtin("xylophone"), None);
    }

    #[test]
    fn plain_names_suit_every_file_system() {
        assert_eq!(plain_name("field:100"), "field-100");
        assert_eq!(plain_name("a/b\\c\"d*e?f<g>h|i\0j"), "a-b-c-d-e-f-g-h-i-j");
        assert_eq!(plain_name("Köln 1_2.3-4"), "Köln 1_2.3-4");
    }
}
