//! Zoom and pan as numbers.

use serde::{Deserialize, Serialize};

/// Which part of a picture is shown, and how large.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Framing {
    /// Screen pixels per pixel of the picture.
    pub times: f32,
    /// The point of the picture in the middle of the viewport, as shares of its width and height.
    pub middle: [f32; 2],
    /// The size of the picture, pixels.
    pub size: [u32; 2],
}

impl Framing {
    /// Whether it can be that of a picture of this size.
    pub fn is_of(&self, size: [u32; 2]) -> bool {
        let is_near = |share: &f32| (-2.0..=3.0).contains(share);
        self.size == size && self.times.is_finite() && self.times > 0.0 && self.middle.iter().all(is_near)
    }
}
