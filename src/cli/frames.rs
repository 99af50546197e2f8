//! `--frames`: an animation.

use super::Request;
use super::backend;
use super::error::CliError;
use super::paths::{Paths, same_name};
use super::raw::{self, ProgressChoice, RawAnimation, RawPicture, RawRender};
use super::sources;
use super::unused;
use super::values::JsonTarget;
use crate::animation::{CameraPath, FrameNames, Turn};
use crate::backends::BackendChoice;
use crate::output::FrameRate;
use crate::recipe::Recipe;
use crate::render::RenderJob;
use crate::stages::Stage;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The rate of an animated PNG.
pub(super) const DEFAULT_RATE: FrameRate = FrameRate { frames: 30, seconds: 1 };

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
    /// The backend.
    pub backend: BackendChoice,
    /// Whether progress is shown.
    pub progress: ProgressChoice,
    /// Where the JSON is written.
    pub json: Option<JsonTarget>,
    /// The command that renders them.
    pub command: String,
    /// Warnings about flags that have no effect.
    pub notes: Vec<String>,
}

/// Validates the flags of an animation; `None` if they ask for none.
pub(super) fn request(raw: &RawRender, command: &str) -> Result<Option<Request>, CliError> {
    let RawAnimation { frames, turntable, fps } = &raw.animation;
    if frames.is_none() && turntable.is_none() {
        return match fps {
            Some(_) => Err(CliError::Needs {
                flag: "--fps",
                other: "--frames",
                reason: "a single picture has no rate; add --frames A..B or --turntable",
            }),
            None => Ok(None),
        };
    }
    let flag = if frames.is_some() { "--frames" } else { "--turntable" };
    if !raw.batch {
        let reason = "the window shows one picture; frames are rendered to files";
        return Err(CliError::Needs { flag, other: "--batch", reason });
    }
    refuse_others(raw, flag)?;
    let mut chosen = sources::find(&raw.picture, None)?;
    raw::change(&mut chosen.recipe, &raw.picture, raw.estimate_error);
    chosen.recipe.samples_per_pixel = raw.samples.unwrap_or(chosen.recipe.samples_per_pixel);
    let job = chosen.recipe.job()?;
    let path = path_of(&raw.animation, &raw.picture, &chosen.recipe)?;
    let frames = frames_of(&raw.animation, &path, &job)?;
    let out = raw.out.as_deref().ok_or(CliError::Needs {
        flag,
        other: "--out",
        reason: "it writes many pictures; name a directory, a pattern such as turn-####.png, or an animated turn.png",
    })?;
    let (names, animation) = places(out)?;
    if fps.is_some() && animation.is_none() {
        let reason = "single frames have no rate; give it to the program that makes a film of them";
        return Err(CliError::Needs { flag: "--fps", other: "--out FILE.png", reason });
    }
    let json = raw.json.clone().map(JsonTarget::from);
    Paths::default()
        .read("--scene", sources::scene_file(raw.picture.scene.as_deref()))
        .write("--out", animation.as_deref())
        .write_json(json.as_ref())
        .own("a frame of the animation", &names.directory, {
            let (names, frames) = (names.clone(), frames.clone());
            move |name| same_name(name, frames.clone().filter_map(|frame| file_name(&names, frame)))
        })
        .check(&[])?;
    Ok(Some(Request::Frames(Box::new(FramesOptions {
        notes: unused::notes(&job, chosen.stage, &raw.picture, &raw.animation, raw.samples),
        recipe: chosen.recipe,
        job,
        stage: chosen.stage,
        path,
        frames,
        names,
        animation: animation.map(|file| (file, fps.unwrap_or(DEFAULT_RATE))),
        backend: backend::choice(&raw.backend)?,
        progress: raw.progress,
        json,
        command: command.to_owned(),
    }))))
}

/// The name of a frame's file.
fn file_name(names: &FrameNames, frame: u32) -> Option<String> {
    names.path(frame).file_name().map(|name| name.to_string_lossy().into_owned())
}

/// Returns an error if a flag makes no sense for an animation.
fn refuse_others(raw: &RawRender, flag: &'static str) -> Result<(), CliError> {
    let same = "every frame must have the same samples, whenever it is rendered; give --samples";
    let films = "an animation is kept frame by frame, and whole frames are not rendered again";
    for (other, is_given, reason) in [
        ("--stage all", raw.picture.is_every_stage(), "an animation shows one scene; choose one stage"),
        ("--resume", raw.resume.is_some(), films),
        ("--checkpoint", raw.checkpoint.is_some(), films),
        ("--every", raw.every.is_some(), films),
        ("--time-limit", raw.time_limit.is_some(), same),
        ("--noise-target", raw.noise_target.is_some(), same),
        ("--sample-range", raw.sample_range.is_some(), same),
        ("--ppm", raw.ppm.is_some(), "frames are PNG files"),
        ("--save-scene", raw.save_scene.is_some(), "write the scene file by a command of its own"),
        ("--simulate-crash", raw.backend.simulate_crash.is_some(), "it is for single pictures"),
    ] {
        if is_given {
            return Err(CliError::Together { flag, other, reason });
        }
    }
    Ok(())
}

/// Numbers of the frames, whose cameras are valid.
pub(super) fn frames_of(
    animation: &RawAnimation,
    path: &CameraPath,
    job: &RenderJob,
) -> Result<Range<u32>, CliError> {
    let frames = match (&animation.frames, animation.turntable) {
        (Some(frames), _) => frames.clone(),
        (None, Some(Turn::FramesPerTurn(count))) => 0..count,
        (None, _) => {
            let reason = "it has no whole number of frames a turn; give A..B";
            return Err(CliError::Needs { flag: "--turntable in degrees", other: "--frames", reason });
        }
    };
    for frame in frames.clone() {
        job.seen_by(path.camera(frame), *job.settings())
            .map_err(|reason| CliError::Frame { frame, reason: Box::new(reason) })?;
    }
    Ok(frames)
}

/// How the flags and the scene file move the camera.
pub(super) fn path_of(
    animation: &RawAnimation,
    picture: &RawPicture,
    recipe: &Recipe,
) -> Result<CameraPath, CliError> {
    if let Some(turn) = animation.turntable {
        return Ok(CameraPath::Turntable { start: recipe.camera, turn });
    }
    if recipe.keyframes.is_empty() {
        return Err(CliError::Needs {
            flag: "--frames",
            other: "--turntable",
            reason: "the scene has no [[keyframes]], so the camera would not move",
        });
    }
    match picture.camera_flags().into_iter().find(|(_, is_given)| *is_given) {
        Some((flag, _)) => Err(CliError::Together {
            flag,
            other: "the keyframes of the scene file",
            reason: "they set the camera; change them, or use --turntable",
        }),
        None => Ok(CameraPath::Keyframes { still: recipe.camera, keyframes: recipe.keyframes.clone() }),
    }
}

/// The files of the frames, and the animated PNG if `out` is one. Its frames are in a directory beside it.
fn places(out: &Path) -> Result<(FrameNames, Option<PathBuf>), CliError> {
    let refuse = |reason| Err(CliError::FramesOut { path: out.to_owned(), reason });
    let ending = out.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let is_png = ending.as_deref() == Some("png");
    if out.is_dir() {
        return Ok((FrameNames::in_directory(out), None));
    }
    if out.file_name().is_some_and(|name| name.to_string_lossy().contains('#')) {
        return match FrameNames::of_pattern(out) {
            Some(names) if is_png => Ok((names, None)),
            Some(_) => refuse("but frames are PNG files: let the pattern end in .png"),
            None => refuse("but a pattern has a single row of #, such as turn-####.png"),
        };
    }
    match ending.as_deref() {
        None => Ok((FrameNames::in_directory(out), None)),
        Some("png" | "apng") => {
            let mut directory = out.file_stem().unwrap_or_default().to_owned();
            directory.push("-frames");
            Ok((FrameNames::in_directory(&out.with_file_name(directory)), Some(out.to_owned())))
        }
        Some("exr") => {
            refuse("but an animation has no film: name a directory, or render single pictures as films")
        }
        Some(_) => refuse(
            "but an animation is a directory of PNG files, a pattern such as turn-####.png, or an animated turn.png",
        ),
    }
}
