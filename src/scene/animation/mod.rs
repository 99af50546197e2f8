//! Camera paths: the camera of each frame of an animation. It depends only on the frame number, and has the same bits
//! on every machine.

mod keyframes;
mod names;
mod turntable;

pub use keyframes::Keyframe;
pub use names::FrameNames;
pub use turntable::{FRAMES_PER_TURN, Turn};

use crate::scene::Camera;

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
        /// By rising frame number.
        keyframes: Vec<Keyframe>,
    },
}

impl CameraPath {
    /// The camera of a frame, not validated: between valid keyframes, it may for instance look along its `vup`.
    pub fn camera(&self, frame: u32) -> Camera {
        match self {
            CameraPath::Turntable { start, turn } => turn.turned(start, frame),
            CameraPath::Keyframes { still, keyframes } => {
                keyframes::camera(keyframes, frame).unwrap_or(*still)
            }
        }
    }
}
