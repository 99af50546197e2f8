//! A recipe: everything that a picture is made from. A scene file holds one, a stage is one, the window edits
//! one; checked, it becomes a [`RenderJob`].

pub mod file;

use crate::render::{JobError, RenderJob, RenderSettings};
use crate::scene::{Camera, Scene};
use crate::stages::Rules;

/// Scene, camera, settings and rules, not checked yet, and how many samples are wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Recipe {
    /// What the user calls it: a built-in scene's name, a stage's id or a file's stem.
    pub name: String,
    /// Spheres, materials and sky.
    pub scene: Scene,
    /// The camera.
    pub camera: Camera,
    /// Size, depth, sampler, seed, halves.
    pub settings: RenderSettings,
    /// The rules in force.
    pub rules: Rules,
    /// Samples per pixel that the picture should have. It is no part of the job: a film can have any number.
    pub samples_per_pixel: u64,
}

impl Recipe {
    /// Checks it.
    ///
    /// # Errors
    /// See [`RenderJob::new`].
    pub fn job(&self) -> Result<RenderJob, JobError> {
        RenderJob::new(self.scene.clone(), self.camera, self.settings, self.rules)
    }
}
