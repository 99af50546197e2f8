//! Camera paths: the camera of each frame of an animation. A frame's camera depends on its number alone, and it has the
//! same bits on every machine.

mod keyframes;
mod names;
mod turntable;

pub use keyframes::Keyframe;
pub use names::FrameNames;
pub use turntable::{FRAMES_PER_TURN, Turn};

use crate::scene::Camera;

/// Limit on the numbers of frames, exclusive, and so on their count: an hour at 27 frames a second.
pub const FRAME_LIMIT: u32 = 100_000;

/// How the camera moves.
#[derive(Clone, Debug, PartialEq)]
pub enum CameraPath {
    /// The camera circles around the point that it looks at, about `vup`.
    Turntable {
        /// The camera of frame 0.
        start: Camera,
        /// How fast it circles.
        turn: Turn,
    },
    /// The camera moves smoothly from keyframe to keyframe. It rests before the first and after the last.
    Keyframes {
        /// The camera if there are no keyframes.
        still: Camera,
        /// The keyframes by rising frame number.
        keyframes: Vec<Keyframe>,
    },
}

impl CameraPath {
    /// The camera of a frame. It is not checked: between valid keyframes, a camera may for instance look along its `vup`.
    pub fn camera(&self, frame: u32) -> Camera {
        match self {
            CameraPath::Turntable { start, turn } => turn.turned(start, frame),
            CameraPath::Keyframes { still, keyframes } => {
                keyframes::camera(keyframes, frame).unwrap_or(*still)
            }
        }
    }
}
