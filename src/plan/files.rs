//! The files that belong to a plan, beside its manifest.

use super::any::AnyPlan;
use super::error::PlanError;
use super::frames::Frames;
use super::manifest::{self, MANIFEST, Manifest, SCENE, Work};
use super::samples::Samples;
use super::scripts::ScriptKind;
use crate::animation::FrameNames;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The files of a plan: manifest, scene, parts or frames, and scripts. What the parts are merged into is not among them.
#[derive(Clone, Debug)]
pub struct PlanFiles {
    /// Their directory; empty for the current one.
    pub directory: PathBuf,
    /// The file that the parts are merged into.
    pub result: Option<String>,
    names: Vec<String>,
    frames: Option<(FrameNames, Range<u32>)>,
}

impl PlanFiles {
    /// The files that `weekender plan` writes to `directory`.
    pub fn to_write(directory: &Path) -> PlanFiles {
        let names = [MANIFEST, SCENE].into_iter().chain(ScriptKind::names()).map(str::to_owned).collect();
        PlanFiles { directory: directory.to_owned(), result: None, names, frames: None }
    }

    /// The files of a plan. Only its manifest is read. `path` is the manifest, or the directory that it is in.
    ///
    /// # Errors
    /// [`PlanError`].
    pub fn of(path: &Path) -> Result<PlanFiles, PlanError> {
        let path = AnyPlan::manifest_at(path)?;
        let (version, value) = manifest::read_value(&path)?;
        let damaged = |what| PlanError::Damaged { path: path.clone(), what };
        match version {
            Frames::VERSION => {
                let manifest: Manifest<Frames> = manifest::parse(value).map_err(damaged)?;
                let names = FrameNames::in_directory(Path::new(""));
                let frames = Some((names, manifest.work.range()));
                Ok(PlanFiles { frames, ..PlanFiles::beside(&path, &manifest) })
            }
            _ => {
                let manifest: Manifest<Samples> = manifest::parse(value).map_err(damaged)?;
                Ok(PlanFiles::beside(&path, &manifest))
            }
        }
    }

    fn beside<W: Work>(path: &Path, manifest: &Manifest<W>) -> PlanFiles {
        let directory = path.parent().unwrap_or(Path::new(""));
        let mut files = PlanFiles::to_write(directory);
        let own = path.file_name().map(|name| name.to_string_lossy().into_owned());
        files.names.extend(own);
        files.names.push(manifest.scene_file.clone());
        files.names.extend(manifest.work.files().into_iter().map(str::to_owned));
        files.result = Some(manifest.result.clone());
        files
    }

    /// The names of the files.
    pub fn names(&self) -> impl Iterator<Item = String> {
        let file = |(names, frames): &(FrameNames, Range<u32>)| {
            let names = names.clone();
            frames.clone().map(move |frame| names.path(frame).to_string_lossy().into_owned())
        };
        self.names.iter().cloned().chain(self.frames.iter().flat_map(file))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::Turn;
    use crate::output::FrameRate;
    use crate::plan::{Plan, divide};
    use crate::recipe::Recipe;

    fn written<W: Work>(directory: &Path, work: W) -> PlanFiles {
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        Plan::write(directory, &recipe, &recipe.job().unwrap(), Manifest::new(work)).unwrap();
        PlanFiles::of(directory).unwrap()
    }

    #[test]
    fn a_plan_has_the_files_that_it_reads_and_writes() {
        let directory = tempfile::tempdir().unwrap();
        let files = written(directory.path(), Samples::new(&(0..8), &divide(0..8, 2).unwrap()));
        assert_eq!(
            (files.directory.as_path(), files.result.as_deref()),
            (directory.path(), Some("picture.exr"))
        );
        let mut names: Vec<String> = files.names().collect();
        names.sort();
        names.dedup();
        assert_eq!(
            names,
            [
                "Makefile",
                "merge.sbatch",
                "part-0.exr",
                "part-1.exr",
                "parts.sbatch",
                "plan.json",
                "run.sh",
                "scene.toml",
                "submit.sh"
            ]
        );
    }

    #[test]
    fn a_plan_of_frames_has_its_own_frames() {
        let directory = tempfile::tempdir().unwrap();
        let rate = FrameRate { frames: 30, seconds: 1 };
        let files =
            written(directory.path(), Frames::new(&(5..9), Some(Turn::FramesPerTurn(20)), rate, 2).unwrap());
        assert_eq!(files.result.as_deref(), Some("animation.png"));
        let frames: Vec<String> = files.names().filter(|name| name.ends_with(".png")).collect();
        assert_eq!(frames, ["frame-0005.png", "frame-0006.png", "frame-0007.png", "frame-0008.png"]);
    }

    #[test]
    fn a_plan_that_was_copied_beside_itself_has_its_own_name_among_its_files() {
        let directory = tempfile::tempdir().unwrap();
        written(directory.path(), Samples::new(&(0..8), &divide(0..8, 2).unwrap()));
        let copy = directory.path().join("copy.json");
        std::fs::copy(directory.path().join(MANIFEST), &copy).unwrap();
        let files = PlanFiles::of(&copy).unwrap();
        let names: Vec<String> = files.names().collect();
        assert_eq!(files.directory, directory.path());
        for name in ["copy.json", "plan.json", "scene.toml", "part-1.exr"] {
            assert!(names.iter().any(|found| found == name), "{name} is not in {names:?}");
        }
    }
}
