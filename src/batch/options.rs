//! What the headless programs are asked to do, validated.

use crate::backends::BackendChoice;
use crate::job::output::OutputFormat;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::progressive::Plan;
use crate::scene::animation::CameraPath;
use crate::stages::Stage;
use crate::system::terminal::ProgressChoice;
use anyhow::{Context, Result};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options of `--batch`.
#[derive(Clone, Debug)]
pub struct BatchOptions {
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// Which samples, and when to stop.
    pub plan: Plan,
    /// Whether the picture is denoised.
    pub denoise: bool,
    /// The files of the picture and of its film, in the order in which they are written: a film is worth most.
    pub outputs: Vec<Output>,
    /// Interval at which the checkpoint is written.
    pub every: Duration,
    /// The film to resume.
    pub resume: Option<PathBuf>,
    /// A scene file to write as well.
    pub save_scene: Option<PathBuf>,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<PathBuf>,
    /// The command line, as files record it.
    pub command: String,
}

/// A file of a picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    pub path: PathBuf,
    pub format: OutputFormat,
    /// Whether it is written at intervals, too, and replaces only the film that the render continues.
    pub is_checkpoint: bool,
}

impl BatchOptions {
    pub fn checkpoint(&self) -> Option<&Path> {
        self.outputs.iter().find(|output| output.is_checkpoint).map(|output| output.path.as_path())
    }
}

/// Options of `--batch --frames`.
#[derive(Debug)]
pub struct FramesOptions {
    /// The scene and its settings. Each frame replaces its camera.
    pub recipe: Recipe,
    /// The validated job of the recipe.
    pub job: RenderJob,
    /// The stage that it comes from.
    pub stage: Option<&'static Stage>,
    /// How the camera moves. The camera of every frame is valid.
    pub path: CameraPath,
    /// Numbers of the frames, at least one.
    pub frames: Range<u32>,
    /// The files of the frames.
    pub names: FrameNames,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<PathBuf>,
    /// The command line, as files record it; `None` in the window.
    pub command: Option<String>,
}

impl FramesOptions {
    /// Checks the camera of every frame.
    ///
    /// # Errors
    /// The first frame that cannot be rendered, and why.
    pub fn check(&self) -> Result<()> {
        let FramesOptions { job, path, frames, .. } = self;
        for frame in frames.clone() {
            job.seen_by(path.camera(frame), *job.settings()).with_context(|| format!("frame {frame}"))?;
        }
        Ok(())
    }
}

/// Where an animation's frames are: a directory, and a name with a place for the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    pub directory: PathBuf,
    before: String,
    /// Minimum number of digits.
    digits: usize,
    after: String,
}

impl FrameNames {
    /// Names from a pattern such as `shots/turn-####.png`, whose `#` signs stand for the number and its minimum digits.
    /// `None` unless the file name has exactly one run of them.
    pub fn of_pattern(pattern: &Path) -> Option<FrameNames> {
        let name = pattern.file_name()?.to_str()?;
        let (before, rest) = name.split_once('#')?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return None;
        }
        Some(FrameNames {
            directory: pattern.parent().map(Path::to_owned).unwrap_or_default(),
            before: before.to_owned(),
            digits: name.len() - before.len() - after.len(),
            after: after.to_owned(),
        })
    }

    pub fn path(&self, frame: u32) -> PathBuf {
        let FrameNames { directory, before, digits, after } = self;
        directory.join(format!("{before}{frame:0digits$}{after}"))
    }
}
