//! A scene that is checked once, for any number of cameras and sizes.

use crate::job::render::{JobError, RenderJob, RenderSettings};
use crate::scene::{Camera, Scene};
use crate::stages::Rules;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::SystemTime;

/// A scene under the rules of its origin. It never changes: an edit makes another one.
#[derive(Debug)]
pub struct CheckedScene {
    scene: Arc<Scene>,
    rules: Rules,
    /// The job of the scene, or why there is none; usable for any camera and size.
    base: OnceLock<Result<RenderJob, JobError>>,
    /// The scene file that the scene was last saved in, and how it was then.
    file: Mutex<Option<(PathBuf, Option<Stamp>)>>,
}

impl CheckedScene {
    /// A scene that has not been checked yet.
    pub fn new(scene: Arc<Scene>, rules: Rules) -> Self {
        CheckedScene { scene, rules, base: OnceLock::new(), file: Mutex::default() }
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

    /// The scene file that contains the scene, if it was saved and the file is unchanged since.
    pub fn file(&self) -> Option<PathBuf> {
        let (path, stamp) = self.file.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        (stamp_of(&path) == stamp).then_some(path)
    }

    /// Notes that the scene was saved in this file.
    pub fn note_file(&self, path: &Path) {
        *self.file.lock().unwrap_or_else(PoisonError::into_inner) = Some((path.to_owned(), stamp_of(path)));
    }
}

/// A file's length and modification time, which change with its content.
pub type Stamp = (u64, Option<SystemTime>);

/// The stamp of a regular file, if it can be examined.
pub fn stamp_of(path: &Path) -> Option<Stamp> {
    let found = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
    Some((found.len(), found.modified().ok()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stages::Stage;

    #[test]
    fn a_scene_is_in_its_file_as_long_as_nobody_changes_that() {
        let directory = tempfile::tempdir().unwrap();
        let [path, other] = ["mine.toml", "other.toml"].map(|name| directory.path().join(name));
        let scene = CheckedScene::new(Arc::default(), Rules::FINISHED);
        assert_eq!(scene.file(), None);
        std::fs::write(&path, "one").unwrap();
        scene.note_file(&path);
        assert_eq!(scene.file(), Some(path.clone()));
        std::fs::write(&path, "another length").unwrap();
        assert_eq!(scene.file(), None);
        scene.note_file(&path);
        assert_eq!(scene.file(), Some(path.clone()), "it was saved again");
        std::fs::write(&other, "two").unwrap();
        scene.note_file(&other);
        assert_eq!(scene.file(), Some(other.clone()), "the file that it was saved in last");
        std::fs::remove_file(other).unwrap();
        assert_eq!(scene.file(), None);
    }

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
