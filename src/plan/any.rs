//! Plans of either kind.

use super::error::PlanError;
use super::frames::Frames;
use super::manifest::{MANIFEST, Plan, Work, read_value};
use super::samples::Samples;
use std::path::{Path, PathBuf};

/// A plan, by what it divides.
#[derive(Clone, Debug)]
pub enum AnyPlan {
    /// The samples of a picture.
    Samples(Box<Plan<Samples>>),
    /// The frames of an animation.
    Frames(Box<Plan<Frames>>),
}

impl AnyPlan {
    /// Whether `path` names a plan rather than a film.
    pub fn is_at(path: &Path) -> bool {
        path.join(MANIFEST).exists()
            || path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    }

    /// Reads a plan and its scene. `path` is the manifest, or the directory that it is in.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn load(path: &Path) -> Result<AnyPlan, PlanError> {
        let path = AnyPlan::manifest_at(path)?;
        let (version, value) = read_value(&path)?;
        match version {
            Samples::VERSION => Plan::of(path, value).map(|plan| AnyPlan::Samples(Box::new(plan))),
            Frames::VERSION => Plan::of(path, value).map(|plan| AnyPlan::Frames(Box::new(plan))),
            _ => {
                let what = format!(
                    "it has version {version}, but this program reads version {} and version {}",
                    Samples::VERSION,
                    Frames::VERSION
                );
                Err(PlanError::Damaged { path, what })
            }
        }
    }

    /// The manifest that `path` names: itself, or the one in the directory `path`.
    pub(super) fn manifest_at(path: &Path) -> Result<PathBuf, PlanError> {
        let manifest = path.join(MANIFEST);
        match path.is_dir() {
            true if !manifest.exists() => Err(PlanError::NoManifest { path: path.to_owned() }),
            true => Ok(manifest),
            false => Ok(path.to_owned()),
        }
    }
}
