//! Animations: `--frames` and `--turntable`.

use super::check_paths;
use super::render::{AnimationFlags, RenderFlags};
use super::sources;
use super::values::ProgressChoice;
use crate::backends::BackendChoice;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::scene::animation::{CameraPath, FrameNames, Turn};
use crate::stages::Stage;
use crate::system::files::ShownPath;
use anyhow::{Context, Result, bail};
use std::ops::Range;
use std::path::{Path, PathBuf};

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
    /// The command line, if there is one.
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

/// Validates the flags of an animation.
pub(super) fn frames(flags: RenderFlags) -> Result<FramesOptions> {
    let (chosen, job) = sources::picture(&flags.picture, &flags.samples, None)?;
    let (recipe, AnimationFlags { frames, turntable }) = (&chosen.recipe, flags.animation);
    let path = match turntable {
        Some(turn) => CameraPath::Turntable { start: recipe.camera, turn },
        None if recipe.keyframes.is_empty() => {
            bail!("--frames needs --turntable: the scene has no [[keyframes]], so the camera would not move")
        }
        None if flags.picture.camera != Default::default() => bail!(
            "flags of the camera such as --look-from and --vfov cannot be used with the keyframes of the scene file: \
             they set the camera; change them, or use --turntable"
        ),
        None => CameraPath::Keyframes { still: recipe.camera, keyframes: recipe.keyframes.clone() },
    };
    let frames = match (frames, turntable) {
        (Some(frames), _) => frames,
        (None, Some(Turn::FramesPerTurn(count))) => 0..count,
        (None, _) => {
            bail!("--turntable in degrees needs --frames A..B: a turn may not be a whole number of frames")
        }
    };
    let [out] = flags.files.out.as_slice() else {
        bail!(
            "an animation needs --batch and one --out: it writes many pictures; name a directory, or a pattern such as \
             turn-####.png"
        );
    };
    let names = names(out)?;
    let files: Vec<PathBuf> = frames.clone().map(|frame| names.path(frame)).collect();
    let outputs = files.iter().chain(&flags.files.json).map(PathBuf::as_path);
    let scene = sources::inputs(flags.picture.scene.as_deref());
    check_paths(scene.iter().map(PathBuf::as_path), outputs)?;
    let options = FramesOptions {
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        path,
        frames,
        names,
        backend: flags.backend,
        progress: flags.progress,
        json: flags.files.json,
        command: Some(super::command_line()),
    };
    options.check()?;
    Ok(options)
}

/// The files of the frames: `frame-0000.png` and so on in a directory, or named after a pattern.
fn names(out: &Path) -> Result<FrameNames> {
    let is_pattern = out.file_name().is_some_and(|name| name.to_string_lossy().contains('#'));
    let is_directory = out.is_dir() || (out.extension().is_none() && !is_pattern);
    let pattern = if is_directory { out.join("frame-####.png") } else { out.to_owned() };
    let is_png = pattern.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    FrameNames::of_pattern(&pattern).filter(|_| is_png).with_context(|| {
        format!(
            "--out is {}, but an animation is a directory of PNG files, or a pattern with a single row of # such as \
             turn-####.png; other programs, such as ffmpeg, turn them into a video",
            out.shown()
        )
    })
}
