//! A scene that is checked once, for any number of cameras and sizes.

use crate::files::Stamp;
use crate::render::{JobError, RenderJob, RenderSettings};
use crate::scene::{Camera, Scene};
use crate::stages::Rules;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

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

    /// The scene file that contains the scene, if it was saved and nobody has changed the file since.
    pub fn file(&self) -> Option<PathBuf> {
        let (path, stamp) = self.file.lock().unwrap_or_else(PoisonError::into_inner).clone()?;
        (stamp_of(&path) == stamp).then_some(path)
    }

    /// Notes that the scene was saved in this file.
    pub fn note_file(&self, path: &Path) {
        *self.file.lock().unwrap_or_else(PoisonError::into_inner) = Some((path.to_owned(), stamp_of(path)));
    }
}

/// The stamp of a file; `None` if there is no such file, or it cannot be examined.
pub(crate) fn stamp_of(path: &Path) -> Option<Stamp> {
    Stamp::of(path).ok().flatten()
}
