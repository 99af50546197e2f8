//! A scene that is checked once, for any number of cameras and sizes.

use crate::job::render::{JobError, RenderJob, RenderSettings};
use crate::scene::{Camera, Scene};
use crate::stages::Rules;
use std::sync::{Arc, OnceLock};

/// A scene under the rules of its origin. It never changes: an edit makes another one.
#[derive(Debug)]
pub struct CheckedScene {
    scene: Arc<Scene>,
    rules: Rules,
    /// The edit that made it, in words.
    pub change: &'static str,
    /// The job of the scene, or why there is none; usable for any camera and size.
    base: OnceLock<Result<RenderJob, JobError>>,
}

impl CheckedScene {
    /// A scene that has not been checked yet.
    pub fn new(scene: Arc<Scene>, rules: Rules) -> Self {
        CheckedScene { scene, rules, change: "spheres", base: OnceLock::new() }
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Checks every number of the scene against its limits.
    ///
    /// # Errors
    /// The first invalid value, with its limit and a remedy.
    pub fn check(&self) -> Result<(), JobError> {
        self.base().as_ref().map(drop).map_err(Clone::clone)
    }

    /// The job with this `camera` and `settings`. All jobs share the scene.
    pub(super) fn job(&self, camera: Camera, settings: RenderSettings) -> Result<RenderJob, JobError> {
        self.base().as_ref().map_err(Clone::clone)?.seen_by(camera, settings)
    }

    fn base(&self) -> &Result<RenderJob, JobError> {
        self.base.get_or_init(|| {
            let scene = Arc::clone(&self.scene);
            RenderJob::new(scene, Camera::BOOK, RenderSettings::default(), self.rules)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;

    #[test]
    fn jobs_have_the_requested_camera_and_settings() {
        let stage = Stage::find("lambertian-linear").unwrap().recipe();
        let checked = CheckedScene::new(Arc::clone(&stage.scene), stage.rules);
        let camera = Camera { vfov_degrees: 33.0, ..stage.camera };
        let settings = RenderSettings { width: 31, seed: 9, ..stage.settings };
        let expected = RenderJob::new(Arc::clone(&stage.scene), camera, settings, stage.rules).unwrap();
        checked.check().unwrap();
        assert_eq!(checked.job(camera, settings).unwrap(), expected);
        assert!(checked.job(Camera { vfov_degrees: 0.0, ..camera }, settings).is_err());
        assert!(checked.job(camera, RenderSettings { width: 0, ..settings }).is_err());
        let mut broken = (*stage.scene).clone();
        broken.spheres[0].radius = f64::NAN;
        let broken = CheckedScene::new(Arc::new(broken), stage.rules);
        let reason = broken.check().unwrap_err();
        assert!(reason.to_string().contains("radius"), "{reason}");
        assert_eq!(broken.job(camera, settings).unwrap_err().to_string(), reason.to_string());
    }
}
