//! The position and scale of the picture.

use eframe::egui::{Pos2, Rect, Vec2, pos2, vec2};

/// The scale of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zoom {
    /// The largest scale at which the whole picture fits.
    Fit,
    /// The largest scale at which this part fits; its corners are shares of the picture's width and height.
    Part(Rect),
    /// Screen pixels per pixel of the picture.
    Times(f32),
}

/// Screen pixels per pixel of the picture.
const ZOOM_LIMITS: [f32; 2] = [0.05, 128.0];

/// The position and scale of the picture.
#[derive(Clone)]
pub struct Placement {
    pub zoom: Zoom,
    /// Offset of the picture's middle from the middle of the viewport, in points.
    pan: Vec2,
    /// How far it can be moved, points.
    beyond: Vec2,
    /// Screen pixels per picture pixel when it was last drawn.
    pub times: f32,
    /// Where the picture was last drawn.
    pub rect: Rect,
}

impl Default for Placement {
    fn default() -> Self {
        Placement { zoom: Zoom::Fit, pan: Vec2::ZERO, beyond: Vec2::ZERO, times: 1.0, rect: Rect::ZERO }
    }
}

impl Placement {
    /// Fits the whole picture into the viewport.
    pub fn fit(&mut self) {
        self.zoom = Zoom::Fit;
    }

    /// Fits a part of the picture into the viewport: left, top, right and bottom as shares of its width and height.
    pub fn show_part(&mut self, [left, top, right, bottom]: [f64; 4]) {
        let corner = |x: f64, y: f64| pos2(x as f32, y as f32);
        self.zoom = Zoom::Part(Rect::from_min_max(corner(left, top), corner(right, bottom)));
    }

    /// Fits the whole picture, unless the user has chosen the scale.
    pub fn leave_part(&mut self) {
        if matches!(self.zoom, Zoom::Part(_)) {
            self.fit();
        }
    }

    /// Shows one picture pixel per screen pixel.
    pub fn actual_size(&mut self) {
        self.zoom = Zoom::Times(1.0);
        self.pan = Vec2::ZERO;
    }

    /// Zooms around the middle of the viewport.
    pub fn zoom_by(&mut self, factor: f32) {
        let times = self.limited(factor);
        self.pan *= times / self.times;
        self.zoom = Zoom::Times(times);
    }

    /// Zooms around a point of the screen, whose content stays in place.
    pub fn zoom_at(&mut self, at: Pos2, factor: f32) {
        let times = self.limited(factor);
        let from_middle = at - self.rect.center();
        self.pan += from_middle * (1.0 - times / self.times);
        self.zoom = Zoom::Times(times);
    }

    /// Moves the picture by this many points, if it is larger than the viewport.
    pub fn pan_by(&mut self, points: Vec2) {
        if self.beyond == Vec2::ZERO {
            return;
        }
        self.zoom = Zoom::Times(self.times);
        self.pan += points;
    }

    fn limited(&self, factor: f32) -> f32 {
        let [low, high] = ZOOM_LIMITS;
        (self.times * factor).clamp(low, high)
    }

    /// Places a picture of `size` pixels in `room`, aligned to screen pixels.
    pub fn place(&mut self, room: Rect, size: Vec2, pixels_per_point: f32) -> Rect {
        let fitting = (room.width() / size.x).min(room.height() / size.y) * pixels_per_point;
        self.times = match self.zoom {
            Zoom::Fit => {
                self.pan = Vec2::ZERO;
                // A picture made for this room may leave less than a pixel of it free, which is not worth a filter.
                let is_made_for_it = fitting >= 1.0 && (fitting - 1.0) * size.max_elem() < 1.5;
                if is_made_for_it { 1.0 } else { fitting }
            }
            Zoom::Part(part) => {
                let seen = size * part.size();
                let times = (room.width() / seen.x).min(room.height() / seen.y) * pixels_per_point;
                self.pan = (pos2(0.5, 0.5) - part.center()) * size * times / pixels_per_point;
                times
            }
            Zoom::Times(times) => times,
        };
        // The picture's edges stay outside of the room, or in its middle.
        self.beyond = (0.5 * (size * self.times / pixels_per_point - room.size())).max(Vec2::ZERO);
        self.pan = self.pan.clamp(-self.beyond, self.beyond);
        let rect = Rect::from_center_size(room.center() + self.pan, size * self.times / pixels_per_point);
        let corner = (rect.min.to_vec2() * pixels_per_point).round() / pixels_per_point;
        self.rect = Rect::from_min_size(corner.to_pos2(), rect.size());
        self.rect
    }

    /// The pixel at a point of the screen, for a picture of `size` pixels.
    pub fn pixel_at(&self, at: Pos2, size: [u32; 2]) -> Option<[u32; 2]> {
        if !self.rect.contains(at) || self.rect.width() <= 0.0 {
            return None;
        }
        let along = (at - self.rect.min) / self.rect.size();
        // The pointer is at the corner of the screen's pixel, whose middle is drawn.
        let pixel = |along: f32, side: u32| ((along * side as f32 + 0.5 / self.times) as u32).min(side - 1);
        Some([pixel(along.x, size[0]), pixel(along.y, size[1])])
    }
}

/// Width and height of a room in whole pixels of the screen.
pub fn whole_pixels(room: Rect, pixels_per_point: f32) -> [u32; 2] {
    // Widths in points are often not exact, such as those of panels.
    const ROUNDING: f32 = 0.01;
    let pixels = room.size() * pixels_per_point + Vec2::splat(ROUNDING);
    [pixels.x.max(0.0) as u32, pixels.y.max(0.0) as u32]
}

/// The user's actions in a frame.
#[derive(Default)]
pub struct Touch {
    /// The camera or a sphere was moved.
    pub is_move: bool,
    /// The pixel under the pointer.
    pub hovered: Option<[u32; 2]>,
    /// A message about the effect of a click, or why it has none.
    pub said: Option<String>,
}

/// The position in the picture of a point of the screen, 0 to 1 from the upper left.
pub(super) fn place_at(rect: Rect, at: Pos2) -> [f64; 2] {
    let along = (at - rect.min) / rect.size();
    [f64::from(along.x), f64::from(along.y)]
}

pub(super) fn point_at(rect: Rect, place: [f64; 2]) -> Pos2 {
    rect.min + vec2(place[0] as f32, place[1] as f32) * rect.size()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: Rect = Rect { min: pos2(100.0, 50.0), max: pos2(900.0, 650.0) };
    const SIZE: Vec2 = vec2(320.0, 240.0);

    fn placed(scale: f32) -> Placement {
        let mut placement = Placement::default();
        placement.place(ROOM, SIZE, scale);
        placement
    }

    #[test]
    fn a_zoom_at_the_pointer_leaves_there_what_is_there() {
        for at in [pos2(150.0, 300.0), pos2(700.0, 200.0), ROOM.center(), pos2(880.0, 560.0)] {
            let mut placement = placed(1.0);
            let under = |placement: &Placement| (at - placement.rect.min) / placement.times;
            for factor in [1.25, 3.0, 0.5, 1.7] {
                let before = under(&placement);
                placement.zoom_at(at, factor);
                placement.place(ROOM, SIZE, 1.0);
                let off = (under(&placement) - before) * placement.times;
                // The corner is aligned to a whole pixel.
                assert!(off.length() < 1.5, "{at}, {factor}: off by {off} points");
            }
        }
    }

    #[test]
    fn no_pan_leaves_a_gap_beside_the_picture() {
        let mut placement = placed(1.0);
        placement.zoom_by(2.0);
        placement.place(ROOM, SIZE, 1.0);
        for pan in [vec2(1e4, -1e4), vec2(-1e5, 1e5), vec2(30.0, 30.0)] {
            placement.pan_by(pan);
            assert!(placement.place(ROOM, SIZE, 1.0).expand(0.5).contains_rect(ROOM), "{pan}");
        }
        // The last pan is not swallowed by what went too far.
        assert_eq!(placement.rect.left(), ROOM.left() - 800.0 + 30.0);
        let mut fitted = placed(1.0);
        fitted.pan_by(vec2(50.0, 50.0));
        assert_eq!(fitted.zoom, Zoom::Fit, "nothing to pan");
        placement.zoom_by(0.1);
        placement.place(ROOM, SIZE, 1.0);
        placement.pan_by(vec2(50.0, 50.0));
        assert!(
            placement.place(ROOM, SIZE, 1.0).center().distance(ROOM.center()) < 1.0,
            "smaller than the room"
        );
    }

    #[test]
    fn the_pixel_at_a_point_is_the_one_that_is_drawn_there() {
        // 760 pixels of the screen from column 283 on.
        let mut placement = Placement::default();
        let room = Rect::from_min_size(pos2(283.0, 0.0), vec2(760.0, 428.0));
        placement.place(room, vec2(760.0, 428.0), 1.0);
        for x in 0..760_u32 {
            assert_eq!(placement.pixel_at(pos2(283.0 + x as f32, 9.0), [760, 428]), Some([x, 9]));
        }
    }

    #[test]
    fn points_count_in_pixels_of_the_screen_and_zooms_have_limits() {
        for scale in [1.0, 1.5, 2.0] {
            let mut placement = placed(scale);
            assert!((placement.rect.size() - ROOM.size()).length() < 1e-3);
            assert!((placement.times - 2.5 * scale).abs() < 1e-5, "{scale}");
            placement.show_part([0.5, 0.5, 1.0, 1.0]);
            let rect = placement.place(ROOM, SIZE, scale);
            assert!((rect.size() - 2.0 * ROOM.size()).length() < 1e-3, "{scale}: {rect}");
            assert!(rect.lerp_inside(vec2(0.75, 0.75)).distance(ROOM.center()) < 1.0, "{scale}: {rect}");
            for (factor, limit) in [(1e6, 128.0), (1e-9, 0.05)] {
                placement.zoom_by(factor);
                assert_eq!(placement.zoom, Zoom::Times(limit));
                placement.place(ROOM, SIZE, scale);
            }
        }
        let odd = Rect::from_min_size(ROOM.min, vec2(99.996, 50.5));
        assert_eq!((whole_pixels(odd, 1.0), whole_pixels(odd, 2.0)), ([100, 50], [200, 101]));
    }
}
