//! The flags of animations, which rendering and planning share.

use super::error::CliError;
use super::raw::RawPicture;
use super::values::{parse_rate, parse_turn, range};
use crate::job::output::FrameRate;
use crate::job::recipe::Recipe;
use crate::job::render::RenderJob;
use crate::scene::animation::{CameraPath, FRAME_LIMIT, Turn};
use clap::Args;
use std::ops::Range;

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
    pub fps: Option<FrameRate>,
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
