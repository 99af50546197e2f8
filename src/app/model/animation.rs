//! The animation of a picture: the bookmarks of its camera, in their order, are the keyframes of a path.

use super::Document;
use crate::scene::Camera;
use crate::scene::animation::{CameraPath, FRAME_LIMIT, FRAMES_PER_TURN, Keyframe};

/// Frames a second when it is played.
pub const FRAMES_PER_SECOND: f64 = 30.0;

/// Frames from a bookmark to the next: two seconds.
const APART: u32 = 60;

/// An animation that is played.
#[derive(Clone)]
pub struct Play {
    pub path: CameraPath,
    /// When it began, seconds of the window.
    pub since: f64,
    /// The camera before it.
    pub before: Camera,
    pub frame: u32,
    /// The camera of the frame that is shown.
    pub shown: Camera,
}

impl Document {
    /// Adds the camera to the bookmarks, as many as an animation has frames for.
    pub fn add_bookmark(&mut self) {
        let frame = self.keyframes.last().map_or(0, |last| last.frame + APART);
        if frame < FRAME_LIMIT {
            self.keyframes.push(Keyframe { frame, camera: self.camera });
        }
    }

    /// The place of the last bookmark of this camera.
    pub fn bookmark(&self) -> Option<usize> {
        self.keyframes.iter().rposition(|keyframe| keyframe.camera == self.camera)
    }

    /// The path through the bookmarks; with fewer than two of them, once around what the camera looks at.
    pub fn path(&self, frames: u32) -> CameraPath {
        match self.keyframes.len() {
            0 | 1 => CameraPath::Turntable { start: self.camera, frames },
            _ => CameraPath::Keyframes(self.keyframes.clone()),
        }
    }

    pub fn frame_count(&self) -> u32 {
        match &self.keyframes[..] {
            [_, .., last] => last.frame + 1,
            _ => FRAMES_PER_TURN,
        }
    }

    /// Gives the animation this number of frames, at least one for each bookmark: they come sooner or later.
    pub fn stretch(&mut self, frames: u32) {
        let (count, last) = (self.keyframes.len() as u32, f64::from(self.frame_count() - 1));
        let end = frames.clamp(count.max(2), FRAME_LIMIT) - 1;
        if count < 2 || f64::from(end) == last {
            return;
        }
        for (place, keyframe) in (0..).zip(&mut self.keyframes) {
            let frame = (f64::from(keyframe.frame) / last * f64::from(end)).round() as u32;
            // Each has its own frame, and so have those before and after it.
            keyframe.frame = frame.clamp(place, end - (count - 1 - place));
        }
        for place in 1..self.keyframes.len() {
            let least = self.keyframes[place - 1].frame + 1;
            self.keyframes[place].frame = self.keyframes[place].frame.max(least);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;

    fn with_bookmarks(count: usize) -> Document {
        let mut document = Document::new(Origin::new_scene());
        for _ in 0..count {
            document.camera.look_from.x += 1.0;
            document.add_bookmark();
        }
        document
    }

    #[test]
    fn camera_follows_bookmarks_or_turns() {
        let document = with_bookmarks(3);
        let path = document.path(document.frame_count());
        assert_eq!(document.frame_count(), 121);
        for keyframe in &document.keyframes {
            assert_eq!(path.camera(keyframe.frame), keyframe.camera);
        }
        let turning = with_bookmarks(1);
        let path = turning.path(8);
        assert_eq!(path.camera(0), turning.camera);
        let [near, far] = [0, 4].map(|frame| path.camera(frame).look_from);
        let axis = glam::DVec3 { y: near.y, ..turning.camera.look_at };
        assert!((0.5 * (near + far)).distance(axis) < 1e-9, "half a turn");
    }

    #[test]
    fn stretched_path_keeps_a_frame_for_each_bookmark() {
        for (count, frames, expected) in [
            (3, 241, vec![0, 120, 240]),
            (3, 3, vec![0, 1, 2]),
            (3, 1, vec![0, 1, 2]),
            (4, 5, vec![0, 1, 3, 4]),
            (2, 121, vec![0, 120]),
        ] {
            let mut document = with_bookmarks(count);
            document.stretch(frames);
            let found: Vec<_> = document.keyframes.iter().map(|keyframe| keyframe.frame).collect();
            assert_eq!(found, expected, "{count} in {frames}");
        }
        let mut close = with_bookmarks(3);
        (close.keyframes[1].frame, close.keyframes[2].frame) = (1, 1000);
        close.stretch(11);
        let found: Vec<_> = close.keyframes.iter().map(|keyframe| keyframe.frame).collect();
        assert_eq!(found, [0, 1, 10]);
    }
}
