//! Camera paths: the camera of each frame of an animation. It depends only on the frame number, and has the same bits
//! on every machine.
//!
//! Between keyframes, positions and the up direction follow a Catmull-Rom spline: cubics whose slope at each keyframe is that of the
//! parabola through it and its neighbours. Field of view, defocus and focus distance follow a monotone cubic (Fritsch
//! and Butland 1984), which never leaves the range of two keyframes. They are interpolated where equal steps look
//! equal: the field of view as the logarithm of the picture's height at distance 1, the focus distance as a logarithm,
//! the defocus angle as the radius of the lens at focus distance 1.

use super::camera::unit;
use crate::scene::Camera;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Exclusive limit on frame numbers, and so on their count: an hour at 27 frames a second.
pub const FRAME_LIMIT: u32 = 100_000;

/// Default frames per turn: four seconds at 30 frames a second.
pub const FRAMES_PER_TURN: u32 = 120;

#[derive(Clone, Debug, PartialEq)]
pub enum CameraPath {
    /// Circles about `vup` around `look_at`; counterclockwise, seen from above.
    Turntable {
        /// The camera of frame 0.
        start: Camera,
        /// Frames per turn.
        frames: u32,
    },
    /// Moves smoothly between keyframes in ascending order of frames, and rests before the first and after the last.
    Keyframes(Vec<Keyframe>),
}

impl CameraPath {
    /// The camera of a frame, not validated: between valid keyframes, it may for instance look along its `vup`.
    pub fn camera(&self, frame: u32) -> Camera {
        match self {
            CameraPath::Turntable { start, frames } => turned(start, frame % (*frames).max(1), *frames),
            CameraPath::Keyframes(keyframes) => between(keyframes, frame).unwrap_or_default(),
        }
    }
}

/// The camera after `frame` of the `frames` of a turn.
fn turned(start: &Camera, frame: u32, frames: u32) -> Camera {
    if frame == 0 {
        return *start;
    }
    // From libm, because the system's sines differ between machines.
    let (sine, cosine) = libm::sincos(f64::from(frame) / f64::from(frames) * TAU);
    let axis = unit(start.vup);
    let arm = start.look_from - start.look_at;
    let along = axis * axis.dot(arm);
    let look_from = start.look_at + along + (arm - along) * cosine + axis.cross(arm) * sine;
    Camera { look_from, ..*start }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Keyframe {
    /// Below `FRAME_LIMIT`.
    pub frame: u32,
    pub camera: Camera,
}

/// `None` without keyframes.
fn between(keyframes: &[Keyframe], frame: u32) -> Option<Camera> {
    // Index of the first keyframe after this frame.
    let next = keyframes.partition_point(|keyframe| keyframe.frame <= frame);
    let Some(last) = next.checked_sub(1) else { return Some(keyframes.first()?.camera) };
    // At a keyframe, return its own camera bit for bit.
    if next == keyframes.len() || keyframes[last].frame == frame {
        return Some(keyframes[last].camera);
    }
    let vector = |point: &dyn Fn(&Camera) -> DVec3| {
        let along = |axis| Channel { keyframes, point, axis, bend: Bend::Smooth }.at(last, frame);
        DVec3::from_array([0, 1, 2].map(along))
    };
    let number = |value: &dyn Fn(&Camera) -> f64| {
        let point = &|camera: &Camera| DVec3::splat(value(camera));
        Channel { keyframes, point, axis: 0, bend: Bend::Monotone }.at(last, frame)
    };
    let has_focus = keyframes.iter().any(|keyframe| keyframe.camera.focus_distance.is_some());
    let half_height = number(&|camera| libm::log(half_tangent(camera.vfov_degrees)));
    let lens = number(&|camera| half_tangent(camera.defocus_angle_degrees));
    let focus = || number(&|camera| libm::log(camera.effective_focus_distance()));
    Some(Camera {
        look_from: vector(&|camera| camera.look_from),
        look_at: vector(&|camera| camera.look_at),
        vup: vector(&|camera| unit(camera.vup)),
        vfov_degrees: angle_degrees(libm::exp(half_height)),
        defocus_angle_degrees: angle_degrees(lens),
        focus_distance: has_focus.then(|| libm::exp(focus())),
    })
}

fn half_tangent(degrees: f64) -> f64 {
    libm::tan(degrees.to_radians() / 2.0)
}

/// The angle whose half has this tangent.
fn angle_degrees(half_tangent: f64) -> f64 {
    (2.0 * libm::atan(half_tangent)).to_degrees()
}

/// How a number bends at a keyframe.
#[derive(Clone, Copy, PartialEq)]
enum Bend {
    /// Like the parabola through three keyframes, so the path may overshoot a keyframe. Flat where the point stays
    /// until the next one.
    Smooth,
    /// Never beyond the keyframes.
    Monotone,
}

/// One number of the camera over time.
struct Channel<'a> {
    keyframes: &'a [Keyframe],
    /// The point of the camera that this is a coordinate of.
    point: &'a dyn Fn(&Camera) -> DVec3,
    axis: usize,
    bend: Bend,
}

impl Channel<'_> {
    fn point(&self, index: usize) -> DVec3 {
        (self.point)(&self.keyframes[index].camera)
    }

    fn value(&self, index: usize) -> f64 {
        self.point(index)[self.axis]
    }

    /// Whether the point stays from keyframe `index` to the next.
    fn stays(&self, index: usize) -> bool {
        self.point(index) == self.point(index + 1)
    }

    /// Frames from keyframe `index` to the next.
    fn length(&self, index: usize) -> f64 {
        f64::from(self.keyframes[index + 1].frame - self.keyframes[index].frame)
    }

    /// Mean slope from keyframe `index` to the next.
    fn secant(&self, index: usize) -> f64 {
        (self.value(index + 1) - self.value(index)) / self.length(index)
    }

    fn slope(&self, index: usize) -> f64 {
        let end = self.keyframes.len() - 1;
        match (index, self.bend) {
            _ if end == 1 => self.secant(0),
            (0, Bend::Monotone) => self.secant(0),
            (_, Bend::Monotone) if index == end => self.secant(end - 1),
            // Zero curvature at both ends.
            (0, Bend::Smooth) => 1.5 * self.secant(0) - 0.5 * self.slope(1),
            (_, Bend::Smooth) if index == end => 1.5 * self.secant(end - 1) - 0.5 * self.slope(end - 1),
            _ => self.inner_slope(index),
        }
    }

    fn inner_slope(&self, index: usize) -> f64 {
        let [before, after] = [index - 1, index].map(|index| self.secant(index));
        let [h, k] = [index - 1, index].map(|index| self.length(index));
        match self.bend {
            Bend::Smooth if self.stays(index - 1) || self.stays(index) => 0.0,
            Bend::Smooth => (k * before + h * after) / (h + k),
            Bend::Monotone if before * after <= 0.0 => 0.0,
            Bend::Monotone => 3.0 * (h + k) / ((h + 2.0 * k) / before + (2.0 * h + k) / after),
        }
    }

    /// The value at a frame between keyframe `index` and the next.
    fn at(&self, index: usize, frame: u32) -> f64 {
        let length = self.length(index);
        let t = f64::from(frame - self.keyframes[index].frame) / length;
        let (start, rise) = (self.value(index), self.value(index + 1) - self.value(index));
        let [leaving, arriving] = [index, index + 1].map(|index| self.slope(index));
        let bends = (1.0 - t) * (1.0 - t) * t * leaving - (1.0 - t) * t * t * arriving;
        start + rise * (3.0 - 2.0 * t) * t * t + length * bends
    }
}
