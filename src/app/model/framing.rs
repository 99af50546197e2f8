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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_framing_is_of_a_picture_of_its_size_and_shows_some_of_it() {
        let framing = Framing { times: 3.0, middle: [0.25, 0.75], size: [32, 18] };
        assert!(framing.is_of([32, 18]));
        assert!(!framing.is_of([33, 18]) && !framing.is_of([32, 17]) && !framing.is_of([18, 32]));
        for (times, is_possible) in
            [(1e-3, true), (0.0, false), (-3.0, false), (f32::INFINITY, false), (f32::NAN, false)]
        {
            assert_eq!(Framing { times, ..framing }.is_of([32, 18]), is_possible, "{times}");
        }
        for (middle, is_possible) in [
            ([-2.0, 3.0], true),
            ([3.0, -2.0], true),
            ([-2.1, 0.5], false),
            ([0.5, 3.1], false),
            ([f32::NAN, 0.5], false),
        ] {
            assert_eq!(Framing { middle, ..framing }.is_of([32, 18]), is_possible, "{middle:?}");
        }
    }
}
