//! Animations: `--frames` and `--turntable`.

use super::check_paths;
use super::render::{self, AnimationFlags, RenderFlags};
use super::sources;
use crate::batch::{FrameNames, FramesOptions};
use crate::job::output::OutputFormat;
use crate::scene::animation::CameraPath;
use crate::system::files::{STANDARD, ShownPath};
use anyhow::{Context, Result, bail, ensure};
use std::path::PathBuf;

/// Validates the flags of an animation.
pub(super) fn frames(mut flags: RenderFlags, command: String) -> Result<FramesOptions> {
    let (files, AnimationFlags { frames, turntable }) = (&mut flags.files, flags.animation.clone());
    let own = "each frame is a file of its own, and complete ones are kept when the command is repeated";
    for (flag, is_given, reason) in [
        ("--checkpoint", files.checkpoint.is_some(), own),
        ("--resume", files.resume.is_some(), own),
        ("--sample-range", flags.samples.sample_range.is_some(), "share an animation by --frames A..B"),
        ("--save-scene", files.save_scene.is_some(), "write the scene without the flags of the animation"),
    ] {
        ensure!(!is_given, "{flag} cannot be used with --frames and --turntable: {reason}");
    }
    let [out] = files.out.as_mut_slice() else {
        bail!(
            "an animation needs --batch and one --out: it writes many pictures; name a directory, or a pattern such as \
             turn-####.png"
        );
    };
    let names = names(out, files.format.unwrap_or(OutputFormat::Png))?;
    let moves_camera = flags.picture.camera != Default::default();
    let scene = sources::inputs(flags.picture.scene.as_deref());
    let picture = render::batch(flags, command)?;
    let path = match turntable {
        Some(frames) => CameraPath::Turntable { start: picture.recipe.camera, frames },
        None if picture.recipe.keyframes.is_empty() => {
            bail!("--frames needs --turntable: the scene has no [[keyframes]], so the camera would not move")
        }
        None if moves_camera => bail!(
            "flags of the camera such as --look-from and --vfov cannot be used with the keyframes of the scene file: \
             they set the camera; change them, or use --turntable"
        ),
        None => CameraPath::Keyframes(picture.recipe.keyframes.clone()),
    };
    let frames = frames.unwrap_or(0..turntable.unwrap_or_default());
    let files: Vec<PathBuf> = frames.clone().map(|frame| names.path(frame)).collect();
    let outputs = files.iter().chain(&picture.json).map(PathBuf::as_path);
    check_paths(scene.iter().map(PathBuf::as_path), outputs)?;
    Ok(FramesOptions { picture, path, frames, names })
}

/// The files of the frames: `frame-0000.png` and so on in a directory, or named after a pattern, which `out` becomes.
fn names(out: &mut PathBuf, format: OutputFormat) -> Result<FrameNames> {
    let is_pattern = out.file_name().is_some_and(|name| name.to_string_lossy().contains('#'));
    let named = out.shown();
    if out.is_dir() || (out.extension().is_none() && !is_pattern) {
        out.push(format!("frame-####{}", format.ending()));
    }
    FrameNames::of_pattern(out).filter(|_| named != STANDARD && OutputFormat::from_path(out).is_ok()).with_context(|| {
        format!(
            "--out is {named}, but an animation is a directory of pictures, or a pattern with a single row of # such as \
             turn-####.png; other programs, such as ffmpeg, turn them into a video"
        )
    })
}
