//! `--frames` and `--turntable`: animations.

use super::animation::Animation;
use super::error::CliError;
use super::raw::ProgressChoice;
use super::render::RenderFlags;
use super::values::JsonTarget;
use super::{Line, Paths, sources};
use crate::backends::BackendChoice;
use crate::job::output::FrameRate;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::scene::animation::{CameraPath, FrameNames};
use crate::stages::Stage;
use crate::system::files::ShownPath;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Options of `--batch --frames`.
#[derive(Debug)]
pub struct FramesOptions {
    /// The scene and its settings. The camera is not that of a frame.
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
    /// The animated PNG to make of them, if any.
    pub animation: Option<(PathBuf, FrameRate)>,
    pub backend: BackendChoice,
    pub progress: ProgressChoice,
    pub json: Option<JsonTarget>,
    /// The command that renders them.
    pub command: String,
    /// Warnings about flags that have no effect.
    pub notes: Vec<String>,
}

/// Validates the flags of an animation.
pub(super) fn frames(flags: RenderFlags, line: &Line) -> Result<FramesOptions, CliError> {
    let flag = flags.animation.check()?.unwrap_or("--frames");
    if !flags.batch {
        let reason = "the window shows one picture; frames are rendered to files";
        return Err(CliError::Needs { flag, other: "--batch", reason });
    }
    let (chosen, job) = sources::picture(&flags.picture, &flags.samples, None)?;
    let Animation { frames, path, rate, .. } = flags.animation.of(&job, &chosen.recipe, &flags.picture)?;
    let out = flags.files.out.as_deref().ok_or(CliError::Needs {
        flag,
        other: "--out",
        reason: "it writes many pictures; name a directory, a pattern such as turn-####.png, or an animated turn.png",
    })?;
    let (names, animation) = places(out)?;
    if flags.animation.fps.is_some() && animation.is_none() {
        let reason = "single frames have no rate; give it to the program that makes a film of them";
        return Err(CliError::Needs { flag: "--fps", other: "--out FILE.png", reason });
    }
    let paths = Paths::default().read("--scene", sources::scene_file(flags.picture.scene.as_deref()));
    frames
        .clone()
        .fold(paths, |paths, frame| paths.read("a frame of the animation", Some(&names.path(frame))))
        .write("--out", animation.as_deref())
        .write_json(flags.files.json.as_ref())
        .check(&[])?;
    Ok(FramesOptions {
        notes: sources::notes(&job, &chosen, &flags.picture, &flags.samples),
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        path,
        frames,
        names,
        animation: animation.map(|file| (file, rate)),
        backend: flags.backend,
        progress: flags.progress,
        json: flags.files.json,
        command: line.command.clone(),
    })
}

/// The files of the frames, and the animated PNG if `out` is one. Its frames are in a directory beside it.
fn places(out: &Path) -> Result<(FrameNames, Option<PathBuf>), CliError> {
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let is_pattern = out.file_name().is_some_and(|name| name.to_string_lossy().contains('#'));
    match (ending.as_deref(), FrameNames::of_pattern(out)) {
        _ if out.is_dir() => Ok((FrameNames::in_directory(out), None)),
        (Some("png"), Some(names)) => Ok((names, None)),
        (None, _) if !is_pattern => Ok((FrameNames::in_directory(out), None)),
        (Some("png" | "apng"), _) if !is_pattern => {
            let mut directory = out.file_stem().unwrap_or_default().to_owned();
            directory.push("-frames");
            Ok((FrameNames::in_directory(&out.with_file_name(directory)), Some(out.to_owned())))
        }
        _ => Err(CliError::Refused(format!(
            "--out is {}, but an animation is a directory of PNG files, a pattern with a single row of # such as \
             turn-####.png, or an animated turn.png; it has no film",
            out.shown()
        ))),
    }
}
