//! Points of the screen and of the picture.

use eframe::egui::{Pos2, Rect, Vec2};

/// The position in the picture of a point of the screen, 0 to 1 from the upper left.
pub(super) fn place_at(rect: Rect, at: Pos2) -> [f64; 2] {
    let along = (at - rect.min) / rect.size();
    [f64::from(along.x), f64::from(along.y)]
}

pub(super) fn point_at(rect: Rect, place: [f64; 2]) -> Pos2 {
    rect.min + Vec2::new(place[0] as f32, place[1] as f32) * rect.size()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn a_point_of_the_screen_is_a_share_of_the_picture() {
        let rect = Rect::from_min_max(pos2(100.0, 50.0), pos2(500.0, 250.0));
        for (at, place) in [
            (pos2(100.0, 50.0), [0.0, 0.0]),
            (pos2(200.0, 200.0), [0.25, 0.75]),
            (pos2(600.0, 0.0), [1.25, -0.25]),
        ] {
            assert_eq!((place_at(rect, at), point_at(rect, place)), (place, at));
        }
    }
}
