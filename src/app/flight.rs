//! Flights of the camera: to another camera, or from bookmark to bookmark as an animation goes from keyframe to keyframe.

use super::model::remembered::Bookmark;
use crate::scene::Camera;
use crate::scene::animation::{CameraPath, Keyframe};
use eframe::egui::emath::easing;
use glam::{DMat3, DQuat, DVec3};

/// How long the flight to another camera takes.
const SECONDS: f64 = 0.6;

/// Legs of the flight to another camera. The animation room's curve through their ends goes around what is looked at.
const LEGS: u32 = 12;

/// Steps of a leg.
const STEPS: u32 = 1000;

/// Frames from one bookmark to the next: two seconds at the usual rate.
pub const FRAMES_PER_BOOKMARK: u32 = 60;

/// Frames a second of an animated PNG, unless another rate is given.
const FRAMES_PER_SECOND: u32 = 30;

/// Steps between two frames, so that the flight is smooth on any screen. A power of two scales the path without rounding.
const STEPS_PER_FRAME: u32 = 64;

/// A camera that moves by itself.
pub struct Flight {
    path: CameraPath,
    /// The last frame of the path.
    last: u32,
    seconds: f64,
    is_eased: bool,
    /// When it began, seconds of the window's clock.
    begin: f64,
    /// The camera that it has led to.
    camera: Camera,
}

impl Flight {
    /// A flight from a camera to another one, which begins and ends slowly.
    pub fn between(from: &Camera, to: &Camera, now: f64) -> Flight {
        let keyframes = (0..=LEGS).map(|leg| Keyframe { frame: leg * STEPS, camera: between(from, to, leg) });
        let path = CameraPath::Keyframes { still: *to, keyframes: keyframes.collect() };
        Flight { path, last: LEGS * STEPS, seconds: SECONDS, is_eased: true, begin: now, camera: *from }
    }

    /// A flight along keyframes, as the animation is rendered. `camera` is the present one.
    pub fn along(keyframes: &[Keyframe], camera: &Camera, now: f64) -> Flight {
        let fine = |keyframe: &Keyframe| Keyframe { frame: keyframe.frame * STEPS_PER_FRAME, ..*keyframe };
        let last = keyframes.last().map_or(0, |keyframe| keyframe.frame);
        let path = CameraPath::Keyframes { still: *camera, keyframes: keyframes.iter().map(fine).collect() };
        let seconds = f64::from(last) / f64::from(FRAMES_PER_SECOND);
        Flight { path, last: last * STEPS_PER_FRAME, seconds, is_eased: false, begin: now, camera: *camera }
    }

    /// The camera that the flight has led to.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Goes on to the camera of this time. Returns whether the flight is over. A camera that is not valid is left out.
    pub fn go_on(&mut self, now: f64) -> bool {
        let share =
            if self.seconds > 0.0 { ((now - self.begin) / self.seconds).clamp(0.0, 1.0) } else { 1.0 };
        let eased = if self.is_eased { f64::from(easing::cubic_in_out(share as f32)) } else { share };
        let camera = self.path.camera((eased * f64::from(self.last)).round() as u32);
        if camera.validate().is_ok() {
            self.camera = camera;
        }
        share >= 1.0
    }
}

/// The bookmarks as keyframes of an animation.
pub fn keyframes(bookmarks: &[Bookmark]) -> Vec<Keyframe> {
    let frames = (0..).map(|place| place * FRAMES_PER_BOOKMARK);
    frames.zip(bookmarks).map(|(frame, bookmark)| Keyframe { frame, camera: bookmark.camera() }).collect()
}

/// The first frame whose camera is not valid, and why.
pub fn first_fault(keyframes: &[Keyframe]) -> Option<(u32, String)> {
    let last = keyframes.last()?;
    let path = CameraPath::Keyframes { still: last.camera, keyframes: keyframes.to_vec() };
    (0..=last.frame)
        .find_map(|frame| path.camera(frame).validate().err().map(|error| (frame, error.to_string())))
}

/// The camera after so many legs of the way from one camera to another. What it looks at and its lens change as in an
/// animation with two keyframes. The eye goes around that point instead of straight on, which could lead through it.
fn between(from: &Camera, to: &Camera, leg: u32) -> Camera {
    match leg {
        0 => return *from,
        LEGS => return *to,
        _ => {}
    }
    let ends = [(0, from), (LEGS, to)].map(|(frame, camera)| Keyframe { frame, camera: *camera });
    let straight = CameraPath::Keyframes { still: *to, keyframes: ends.to_vec() }.camera(leg);
    let share = f64::from(leg) / f64::from(LEGS);
    let [near, far] = [from, to].map(|camera| camera.look_from.distance(camera.look_at));
    let distance = near * (far / near).powf(share);
    let (away, vup) = direction_between(from, to, share);
    Camera { look_from: straight.look_at + distance * away, vup, ..straight }
}

/// The direction from what is looked at to the eye, and an up vector, part of the way from one camera to another.
fn direction_between(from: &Camera, to: &Camera, share: f64) -> (DVec3, DVec3) {
    let [a, b] = [from, to].map(Camera::basis);
    let [up, other] = [from, to].map(|camera| camera.vup.normalize_or_zero());
    if up.distance(other) < 1e-9 {
        // The horizon stays level.
        let height = |w: DVec3| up.dot(w).clamp(-1.0, 1.0).asin();
        let level = |w: DVec3| (w - up * up.dot(w)).normalize_or_zero();
        let (start, end) = (level(a.w), level(b.w));
        let turn = up.dot(start.cross(end)).atan2(start.dot(end));
        let along = DQuat::from_axis_angle(up, share * turn) * start;
        let (sine, cosine) = (height(a.w) + share * (height(b.w) - height(a.w))).sin_cos();
        return (cosine * along + sine * up, from.vup);
    }
    let [a, b] = [a, b].map(|basis| DQuat::from_mat3(&DMat3::from_cols(basis.u, basis.v, basis.w)));
    let between = a.slerp(b, share);
    (between * DVec3::Z, between * DVec3::Y)
}
