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
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Exclusive limit on frame numbers, and so on their count: an hour at 27 frames a second.
pub const FRAME_LIMIT: u32 = 100_000;

#[derive(Clone, Debug, PartialEq)]
pub enum CameraPath {
    /// Circles about `vup` around `look_at`.
    Turntable {
        /// The camera of frame 0.
        start: Camera,
        turn: Turn,
    },
    /// Moves smoothly between keyframes, and rests before the first and after the last.
    Keyframes {
        /// The camera if there are no keyframes.
        still: Camera,
        /// In ascending order of frames.
        keyframes: Vec<Keyframe>,
    },
}

impl CameraPath {
    /// The camera of a frame, not validated: between valid keyframes, it may for instance look along its `vup`.
    pub fn camera(&self, frame: u32) -> Camera {
        match self {
            CameraPath::Turntable { start, turn } => turn.turned(start, frame),
            CameraPath::Keyframes { still, keyframes } => between(keyframes, frame).unwrap_or(*still),
        }
    }
}

/// Default frames per turn: four seconds at 30 frames a second.
pub const FRAMES_PER_TURN: u32 = 120;

/// The speed of a turntable. Seen from above, the camera circles counterclockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Frames per turn, at least 1.
    FramesPerTurn(u32),
    /// Degrees between frames; negative for clockwise.
    DegreesPerFrame(f64),
}

impl Turn {
    /// The angle of a frame in turns, strictly between -1 and 1. Whole turns are exactly 0.
    fn angle(self, frame: u32) -> f64 {
        match self {
            Turn::FramesPerTurn(frames) => f64::from(frame % frames.max(1)) / f64::from(frames.max(1)),
            Turn::DegreesPerFrame(degrees) => (f64::from(frame) * degrees % 360.0) / 360.0,
        }
    }

    /// The camera of a frame; `start` is that of frame 0.
    fn turned(self, start: &Camera, frame: u32) -> Camera {
        let angle = self.angle(frame);
        if angle == 0.0 {
            return *start;
        }
        // From libm, because the system's sines differ between machines.
        let (sine, cosine) = libm::sincos(angle * TAU);
        let axis = unit(start.vup);
        let arm = start.look_from - start.look_at;
        let along = axis * axis.dot(arm);
        Camera {
            look_from: start.look_at + along + (arm - along) * cosine + axis.cross(arm) * sine,
            ..*start
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Keyframe {
    /// Below `FRAME_LIMIT`.
    pub frame: u32,
    pub camera: Camera,
}

/// `keyframes` must be in ascending order of frames; `None` if there are none.
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

/// Where an animation's frames are: a directory, and a name with a place for the number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FrameNames {
    pub directory: PathBuf,
    before: String,
    /// Minimum number of digits.
    digits: usize,
    after: String,
}

impl FrameNames {
    /// Names from a pattern such as `shots/turn-####.png`, whose `#` signs stand for the number and its minimum digits.
    /// `None` unless the file name has exactly one run of them.
    pub fn of_pattern(pattern: &Path) -> Option<FrameNames> {
        let name = pattern.file_name()?.to_str()?;
        let (before, rest) = name.split_once('#')?;
        let after = rest.trim_start_matches('#');
        if after.contains('#') {
            return None;
        }
        Some(FrameNames {
            directory: pattern.parent().map(Path::to_owned).unwrap_or_default(),
            before: before.to_owned(),
            digits: name.len() - before.len() - after.len(),
            after: after.to_owned(),
        })
    }

    pub fn path(&self, frame: u32) -> PathBuf {
        let FrameNames { directory, before, digits, after } = self;
        directory.join(format!("{before}{frame:0digits$}{after}"))
    }
}
