//! Animations: `--frames` and `--turntable`.

use super::check_paths;
use super::render::{AnimationFlags, RenderFlags};
use super::sources;
use crate::batch::{FrameNames, FramesOptions};
use crate::scene::animation::CameraPath;
use crate::system::files::ShownPath;
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// Validates the flags of an animation.
pub(super) fn frames(flags: RenderFlags, command: String) -> Result<FramesOptions> {
    let (chosen, job) = sources::picture(&flags.picture, &flags.samples, None)?;
    let (recipe, AnimationFlags { frames, turntable }) = (&chosen.recipe, flags.animation);
    let path = match turntable {
        Some(frames) => CameraPath::Turntable { start: recipe.camera, frames },
        None if recipe.keyframes.is_empty() => {
            bail!("--frames needs --turntable: the scene has no [[keyframes]], so the camera would not move")
        }
        None if flags.picture.camera != Default::default() => bail!(
            "flags of the camera such as --look-from and --vfov cannot be used with the keyframes of the scene file: \
             they set the camera; change them, or use --turntable"
        ),
        None => CameraPath::Keyframes(recipe.keyframes.clone()),
    };
    let frames = frames.unwrap_or(0..turntable.unwrap_or_default());
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
        command: Some(command),
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
