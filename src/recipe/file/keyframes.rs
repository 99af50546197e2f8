//! `[[keyframes]]`: cameras at frames of an animation.

use super::error::{Reason, Refusal};
use super::numbers::{Real, Whole};
use super::place::{Step, path_of};
use super::triple::Triple;
use crate::animation::{FRAME_LIMIT, Keyframe};
use crate::render::JobError;
use crate::scene::Camera;
use serde::Deserialize;

/// What a keyframe leaves out is as in `[camera]`, except for the focus distance: without it, the focus is on `look_at`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawKeyframe {
    frame: Whole,
    look_from: Option<Triple>,
    look_at: Option<Triple>,
    vup: Option<Triple>,
    vfov_degrees: Option<Real>,
    defocus_angle_degrees: Option<Real>,
    focus_distance: Option<Real>,
}

/// The keyframes, with what they leave out taken from `camera`.
pub(super) fn keyframes_of(raw: &[RawKeyframe], camera: &Camera) -> Result<Vec<Keyframe>, Refusal> {
    let mut keyframes: Vec<Keyframe> = Vec::with_capacity(raw.len());
    for (index, raw) in raw.iter().enumerate() {
        let in_keyframe = |keys: Vec<Step>, reason: Reason| {
            let mut path = vec![Step::Key("keyframes".to_owned()), Step::Index(index)];
            path.extend(keys);
            Refusal { path, reason }
        };
        let at_frame = |reason| in_keyframe(vec![Step::Key("frame".to_owned())], reason);
        let last = FRAME_LIMIT - 1;
        let frame = raw.frame.within("frame", [0, last.into()], "count frames from 0").map_err(at_frame)?;
        let frame = u32::try_from(frame).unwrap_or(last);
        if let Some(Keyframe { frame: before, .. }) = keyframes.last()
            && *before >= frame
        {
            return Err(at_frame(Reason::FrameOrder { frame, before: *before }));
        }
        let vector = |raw: &Option<Triple>, default| raw.as_ref().map_or(default, |triple| triple.0);
        let number = |raw: Option<Real>, default| raw.map_or(default, |Real(number)| number);
        let camera = Camera {
            look_from: vector(&raw.look_from, camera.look_from),
            look_at: vector(&raw.look_at, camera.look_at),
            vup: vector(&raw.vup, camera.vup),
            vfov_degrees: number(raw.vfov_degrees, camera.vfov_degrees),
            defocus_angle_degrees: number(raw.defocus_angle_degrees, camera.defocus_angle_degrees),
            focus_distance: raw.focus_distance.map(|Real(number)| number),
        };
        camera.validate().map_err(|error| {
            let error = JobError::from(error);
            in_keyframe(path_of(&error).split_off(1), error.into())
        })?;
        keyframes.push(Keyframe { frame, camera });
    }
    Ok(keyframes)
}
