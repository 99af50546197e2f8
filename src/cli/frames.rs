//! `--frames` and `--turntable`: animations.

use super::error::CliError;
use super::raw::{ProgressChoice, RawPicture};
use super::render::RenderFlags;
use super::values::{JsonTarget, parse_rate, parse_turn, range};
use super::{Line, Paths, Request, sources};
use crate::backends::BackendChoice;
use crate::job::output::FrameRate;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::scene::animation::{CameraPath, FRAME_LIMIT, FrameNames, Turn};
use crate::stages::Stage;
use crate::system::files::ShownPath;
use clap::Args;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The rate of an animated PNG.
const DEFAULT_RATE: FrameRate = FrameRate { frames: 30, seconds: 1 };

#[derive(Debug, Args)]
#[command(next_help_heading = "Animation")]
pub(super) struct AnimationFlags {
    /// Render frames A to B - 1 of an animation to --out; the camera moves by --turntable or by the keyframes of the scene
    /// file [default with --turntable: one turn]
    #[arg(long, value_name = "A..B", value_parser = range(FRAME_LIMIT, "0..120"), allow_hyphen_values = true)]
    frames: Option<Range<u32>>,
    /// Let the camera circle around --look-at about --vup: the frames of a turn, or the degrees between two frames, such
    /// as 1.5deg or -3deg [without a value: 120 frames]
    #[arg(long, value_name = "FRAMES|DEGREES", value_parser = parse_turn, num_args = 0..=1,
          require_equals = true, default_missing_value = "120")]
    turntable: Option<Turn>,
    /// Frames per second of an animated PNG: a whole number or a fraction such as 30000/1001 [default: 30]
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    fps: Option<FrameRate>,
}

/// Frames to render, and how the camera moves.
#[derive(Debug)]
pub(super) struct Animation {
    /// Numbers of the frames, whose cameras are valid.
    pub frames: Range<u32>,
    pub path: CameraPath,
    /// How the camera circles, unless it follows keyframes.
    pub turntable: Option<Turn>,
    pub rate: FrameRate,
}

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

impl AnimationFlags {
    /// The flag that asks for an animation, if any does.
    pub fn check(&self) -> Result<Option<&'static str>, CliError> {
        match self {
            AnimationFlags { frames: Some(_), .. } => Ok(Some("--frames")),
            AnimationFlags { turntable: Some(_), .. } => Ok(Some("--turntable")),
            AnimationFlags { fps: None, .. } => Ok(None),
            AnimationFlags { fps: Some(_), .. } => {
                let reason = "a single picture has no rate; add --frames A..B or --turntable";
                Err(CliError::Needs { flag: "--fps", other: "--frames", reason })
            }
        }
    }

    /// The animation of a picture.
    pub fn of(&self, job: &RenderJob, recipe: &Recipe, picture: &RawPicture) -> Result<Animation, CliError> {
        let needs = |flag, other, reason| Err(CliError::Needs { flag, other, reason });
        let path = match (self.turntable, picture.camera.given().first()) {
            (Some(turn), _) => CameraPath::Turntable { start: recipe.camera, turn },
            (None, _) if recipe.keyframes.is_empty() => {
                let reason = "the scene has no [[keyframes]], so the camera would not move";
                return needs("--frames", "--turntable", reason);
            }
            (None, Some(flag)) => {
                let reason = "they set the camera; change them, or use --turntable";
                return Err(CliError::Together { flag, other: "the keyframes of the scene file", reason });
            }
            (None, None) => {
                CameraPath::Keyframes { still: recipe.camera, keyframes: recipe.keyframes.clone() }
            }
        };
        let frames = match (&self.frames, self.turntable) {
            (Some(frames), _) => frames.clone(),
            (None, Some(Turn::FramesPerTurn(count))) => 0..count,
            (None, _) => {
                let reason = "it has no whole number of frames a turn; give A..B";
                return needs("--turntable in degrees", "--frames", reason);
            }
        };
        for frame in frames.clone() {
            job.seen_by(path.camera(frame), *job.settings())
                .map_err(|reason| CliError::Refused(format!("frame {frame}: {reason}")))?;
        }
        let rate = self.fps.unwrap_or(DEFAULT_RATE);
        Ok(Animation { frames, path, turntable: self.turntable, rate })
    }
}

/// Validates the flags of an animation.
pub(super) fn request(flags: RenderFlags, line: &Line) -> Result<Request, CliError> {
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
    Ok(Request::Frames(Box::new(FramesOptions {
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
    })))
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
