//! What the user edits and undo brings back: where a picture comes from and what was changed in it.

use super::origin::{Origin, Source};
use crate::progressive::Stop;
use crate::recipe::Recipe;
use crate::render::{JobError, RenderJob, RenderSettings};
use crate::scene::{Camera, Scene};
use crate::stages::{Rules, Stage};
use crate::stress::Case;
use std::sync::Arc;

/// What the window shows, as the user has changed it.
#[derive(Clone, Debug)]
pub struct Document {
    /// Where it comes from.
    pub origin: Arc<Origin>,
    /// The camera.
    pub camera: Camera,
    /// Size, depth, sampler, seed, halves.
    pub settings: RenderSettings,
    /// When it ends.
    pub stop: Stop,
}

impl PartialEq for Document {
    /// Origins are never changed, so that it is enough to compare which one it is.
    fn eq(&self, other: &Self) -> bool {
        self.has_same_film(other) && self.camera == other.camera && self.stop == other.stop
    }
}

impl Document {
    /// The origin with nothing changed.
    pub fn new(origin: Origin) -> Self {
        let Recipe { camera, settings, .. } = origin.recipe;
        Document { stop: origin.usual_stop(), camera, settings, origin: Arc::new(origin) }
    }

    /// Makes everything as the origin has it.
    pub fn reset(&mut self) {
        let Recipe { camera, settings, .. } = self.origin.recipe;
        (self.camera, self.settings, self.stop) = (camera, settings, self.origin.usual_stop());
    }

    /// The scene, which is the origin's.
    pub fn scene(&self) -> &Scene {
        &self.origin.recipe.scene
    }

    /// The rules, which are the origin's.
    pub fn rules(&self) -> &Rules {
        &self.origin.recipe.rules
    }

    /// The stage.
    pub fn stage(&self) -> Option<&'static Stage> {
        self.origin.stage()
    }

    /// The extreme scene.
    pub fn case(&self) -> Option<&'static Case> {
        match self.origin.source {
            Source::Extreme(case) => Some(case),
            _ => None,
        }
    }

    /// What a badge or a menu calls the picture.
    pub fn title(&self) -> String {
        match &self.origin.source {
            Source::Stage(stage) => format!("{} {}", stage.section, stage.title),
            Source::Extreme(case) => case.title().to_owned(),
            _ => self.origin.recipe.name.clone(),
        }
    }

    /// Width by height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.settings.width) / f64::from(self.settings.height)
    }

    /// The camera as far as the picture depends on it: a pinhole has no focus distance of its own.
    pub fn acting_camera(&self) -> Camera {
        let is_pinhole = self.camera.defocus_angle_degrees == 0.0;
        Camera { focus_distance: self.camera.focus_distance.filter(|_| !is_pinhole), ..self.camera }
    }

    /// Whether both are made of the same samples.
    pub fn has_same_film(&self, other: &Document) -> bool {
        Arc::ptr_eq(&self.origin, &other.origin)
            && self.acting_camera() == other.acting_camera()
            && self.settings == other.settings
    }

    /// The recipe of the picture.
    pub fn recipe(&self) -> Recipe {
        let origin = &self.origin.recipe;
        Recipe {
            camera: self.acting_camera(),
            settings: self.settings,
            samples_per_pixel: self.stop.samples.unwrap_or(origin.samples_per_pixel),
            ..origin.clone()
        }
    }

    /// The picture, at a whole fraction of its size.
    ///
    /// # Errors
    /// If a value cannot be.
    pub fn job(&self, divisor: u32) -> Result<RenderJob, JobError> {
        let RenderSettings { width, height, .. } = self.settings;
        let divisor = divisor.max(1);
        let settings = RenderSettings {
            width: width.div_ceil(divisor),
            height: height.div_ceil(divisor),
            // What is shown for a moment needs no error.
            estimate_error: self.settings.estimate_error && divisor == 1,
            ..self.settings
        };
        self.origin.job(self.acting_camera(), settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pinhole_has_no_focus() {
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        let before = document.clone();
        document.camera.focus_distance = Some(2.0);
        assert!(document.has_same_film(&before));
        document.camera.defocus_angle_degrees = 1.0;
        assert!(!document.has_same_film(&before));
    }
}
