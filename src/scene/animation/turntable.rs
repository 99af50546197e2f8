//! A turntable: the camera circles around the point it looks at.

use crate::scene::Camera;
use glam::DVec3;
use std::f64::consts::TAU;

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
    /// The angle of a frame in turns, exclusively between -1 and 1. Whole turns are exactly 0.
    fn angle(self, frame: u32) -> f64 {
        match self {
            Turn::FramesPerTurn(frames) => f64::from(frame % frames.max(1)) / f64::from(frames.max(1)),
            Turn::DegreesPerFrame(degrees) => (f64::from(frame) * degrees % 360.0) / 360.0,
        }
    }

    /// The camera of a frame; `start` is that of frame 0.
    pub(super) fn turned(self, start: &Camera, frame: u32) -> Camera {
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

/// Normalises `v`, even where its square would overflow or underflow.
pub(super) fn unit(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize()
}
